"""A few thousand mutations of decks, meshes and restart files; tools/fuzz tries many more."""

import subprocess
import sys

import pytest
from conftest import ROOT

KINDS = {"decks": 3000, "meshes": 2000, "restarts": 300}


@pytest.mark.parametrize("kind", KINDS)
def test_mutations_do_no_harm(kind, tessera, tmp_path):
    """The driver is that of the build with all checks of the compiler."""
    driver = tessera.parent / "fuzz_driver"
    if not driver.is_file():
        pytest.fail(f"{driver} does not exist: build the target fuzz_driver", pytrace=False)
    command = [sys.executable, ROOT / "tools" / "fuzzing", "--no-extremes", "--seed", "test"]
    for name, n in KINDS.items():
        command += [f"--{name}", n if name == kind else 0]
    command += ["--driver", driver, "--program", tessera, "--keep", tmp_path]
    run = subprocess.run(
        list(map(str, command)), capture_output=True, text=True, check=False, timeout=600
    )  # fmt: skip
    assert f"{kind}: {KINDS[kind]} tried" in run.stdout, run.stderr
    assert run.returncode == 0, run.stdout
