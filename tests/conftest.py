"""What the tests of the program share: where it is and how it is run."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
pytest_plugins = ["post_runs"]  # results for the tests of tessera-post


@dataclass
class Run:
    """A finished run of the program."""

    code: int
    stdout: str
    stderr: str
    folder: Path  # working directory; the deck and, without -o, the results are here

    def read(self, name):
        """Text of a file that the run wrote."""
        return (self.folder / name).read_text(encoding="utf-8")


def executable(variable, build):
    path = Path(os.environ.get(variable, ROOT / "build" / build / "bin" / "tessera"))
    if not path.is_file():
        pytest.fail(f"{path} does not exist: build it, or set {variable}", pytrace=False)
    return path


@pytest.fixture(scope="session")
def tessera():
    """The program with all checks (TESSERA_EXE, set by tools/test.sh)."""
    return executable("TESSERA_EXE", "debug")


@pytest.fixture(scope="session")
def tessera_release():
    """The optimised program, for runs that take long (TESSERA_RELEASE_EXE)."""
    return executable("TESSERA_RELEASE_EXE", "release")


@pytest.fixture
def run_program(tmp_path):
    """run_program(program, *arguments): runs it in a folder of this test, one thread by default."""

    def run(program, *arguments, threads=1, timeout=600):
        result = subprocess.run(
            [str(program), *map(str, arguments)],
            cwd=tmp_path,
            env={**os.environ, "OMP_NUM_THREADS": str(threads)},
            capture_output=True,
            timeout=timeout,
            check=False,
        )
        stdout, stderr = (text.decode(errors="replace") for text in (result.stdout, result.stderr))
        return Run(result.returncode, stdout, stderr, tmp_path)

    return run


@pytest.fixture
def run_tessera(tessera, run_program, tmp_path):
    """run_tessera(deck, *arguments, name="job.inp"): writes the deck, text or bytes; runs it."""

    def run(deck, *arguments, name="job.inp", **options):
        data = deck if isinstance(deck, bytes) else deck.encode()
        (tmp_path / name).write_bytes(data)
        return run_program(tessera, name, *arguments, **options)

    return run
