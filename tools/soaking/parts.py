"""The parts of the soak: what each found, and those that other programs run."""

import os
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

KILLS = 1000  # at full length
DECKS, MESHES, RESTARTS = 1_000_000, 100_000, 20_000  # mutations at full length
KILLS_LINE = re.compile(r"kills tried\D+(\d+)\D+survived\D+(\d+)", re.IGNORECASE)


class SoakError(Exception):
    """A part that cannot be carried out or ends in a way that it should not."""


@dataclass(frozen=True)
class Part:
    """What a part found."""

    name: str
    figures: list[str]  # for docs/reliability.md
    failed: list[str]  # what should not have been

    def text(self) -> str:
        """The figures, what failed, the verdict."""
        lines = [f"{self.name}:", *(f"  {line}" for line in self.figures)]
        lines += [f"  FAILED: {line}" for line in self.failed]
        return "\n".join([*lines, f"  {'FAILED' if self.failed else 'passed'}"])


def scaled(number: int, scale: float) -> int:
    """A part of the full length, at least one."""
    return max(1, round(number * scale))


def run_command(command: Sequence[object], root: Path, **variables: str) -> tuple[int, list[str]]:
    """Exit code and lines of what a program says, on both of its streams."""
    try:
        run = subprocess.run(
            [str(part) for part in command],
            cwd=root,
            env={**os.environ, **variables},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as problem:
        raise SoakError(f"{command[0]}: {problem.strerror}") from problem
    return run.returncode, run.stdout.splitlines()


def check_kills(root: Path, python: str, program: Path, scale: float) -> Part:
    """The tests that kill the program, with many kills."""
    n = scaled(KILLS, scale)
    command = [python, "-m", "pytest", "-q", "-s", "-n", "0", "tests/test_kill.py"]
    variables = {"TESSERA_KILLS": str(n), "TESSERA_EXE": str(program)}
    variables["TESSERA_RELEASE_EXE"] = str(program)
    code, lines = run_command(command, root, **variables)
    failed = []
    if code != 0:
        failed.append(f"tests/test_kill.py ended with exit code {code}: {last_of(lines)}")
    counts = [match for match in map(KILLS_LINE.search, lines) if match]
    tried, survived = (sum(int(match[i]) for match in counts) for i in (1, 2))
    if tried < n or survived < tried:
        failed.append(f"expected {n} kills or more, all survived")
    return Part("kills", [f"kills tried {tried}, survived {survived}"], failed)


def check_fuzz(root: Path, seed: int, scale: float) -> Part:
    """Mutations of decks, meshes and restart files."""
    command: list[object] = ["tools/fuzz", "--seed", seed]
    for option, number in (("decks", DECKS), ("meshes", MESHES), ("restarts", RESTARTS)):
        command += [f"--{option}", scaled(number, scale)]
    code, lines = run_command(command, root)
    failed = [] if code == 0 else [f"tools/fuzz ended with exit code {code}: {last_of(lines)}"]
    return Part("fuzz", [" ".join(map(str, command)), *lines[-20:]], failed)


def last_of(lines: Sequence[str]) -> str:
    """The last line that says something."""
    return next((line for line in reversed(lines) if line.strip()), "it said nothing")
