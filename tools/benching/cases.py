"""The runs that are measured: decks of input/, the footing also with finer meshes."""

import json
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

DECK_SOLVERS = ("DIRECT", "RECYCLED")  # of *CONTROLS, LINEAR SOLVER
DEFAULT = "default"  # of a program that has no such choice


class BenchError(Exception):
    """Something that cannot be measured, with the reason."""


@dataclass(frozen=True)
class Case:
    """A deck; with a size, the footing with a mesh of make_mesh.py and a few increments."""

    name: str
    deck: str  # below input
    size: str = ""  # of make_mesh.py
    n_increments: int = 0  # of 0.1 mm; 0: the deck as it is
    most_runs: int = 1000  # large ones are not repeated as often
    is_series: bool = False  # for the growth with the size
    is_quick: bool = False
    controls: str = ""  # of *CONTROLS

    @property
    def job(self) -> str:
        """Name of the results."""
        return self.name


FOOTING = "footing/footing.inp"
CASES = (
    # Small lateral reactions of the stretch differ by 3e-8 of their largest between DIRECT with a
    # tolerance of 1e-9 and DIRECT with 1e-10: they are compared where that does not matter.
    Case("stretch", "stretch/stretch.inp", is_quick=True, controls="TOLERANCE=1e-10"),
    Case("strip", "strip-footing/strip-footing.inp", most_runs=3),
    Case("footing-522", FOOTING, is_series=True, is_quick=True),
    Case("footing-1300", FOOTING, "medium", 6, is_series=True, is_quick=True),
    Case("footing-2500", FOOTING, "fine", 4, is_series=True),
    Case("footing-8000", FOOTING, "finer", 2, most_runs=2, is_series=True),
    Case("footing-16000", FOOTING, "finest", 2, most_runs=1, is_series=True),
)


def available_solvers(program: Path) -> tuple[str, ...]:
    """What LINEAR SOLVER of *CONTROLS offers, of those that are compared."""
    answer = subprocess.run([program, "--schema"], capture_output=True, check=True).stdout
    for keyword in json.loads(answer)["keywords"]:
        for parameter in keyword.get("parameters", []):
            if (keyword["keyword"], parameter["name"]) == ("*CONTROLS", "LINEAR SOLVER"):
                choices = parameter.get("choices", [])
                return tuple(name for name in DECK_SOLVERS if name in choices) or (DEFAULT,)
    return (DEFAULT,)


def write_deck(case: Case, solver: str, folder: Path, root: Path) -> Path:
    """The deck of a case with a linear solver, in a folder with its mesh."""
    source = root / "input" / case.deck
    text = source.read_text(encoding="utf-8")
    folder.mkdir(parents=True, exist_ok=True)
    if "*MESH, FILE=" in text:
        mesh = make_mesh(case.size, folder.parent / "meshes", root) if case.size else None
        text = re.sub(r'FILE="[^"]*"', f'FILE="{mesh or source.parent / "footing.msh"}"', text)
    if case.n_increments:
        text = shorten(text, case.n_increments)
    controls = [case.controls] if case.controls else []
    if solver != DEFAULT:
        controls.append(f"LINEAR SOLVER={solver}")
    if controls:
        text = put_before(text, "*BOUNDARY", f"*CONTROLS, {', '.join(controls)}\n")
    deck = folder / f"{case.job}.inp"
    deck.write_text(text, encoding="utf-8")
    return deck


def put_before(text: str, keyword: str, line: str) -> str:
    """A line before the first keyword of a name."""
    if f"\n{keyword}\n" not in text:
        raise BenchError(f"a deck has changed: expected {keyword} without parameters")
    return text.replace(f"\n{keyword}\n", f"\n{line}{keyword}\n", 1)


def shorten(text: str, n_increments: int) -> str:
    """The first increments of the footing, plastic strain alone in the fields and only at the
    end, and no expectation."""
    period = 0.05 * n_increments
    for old, new in (
        ("\n0.05, 1.0\n", f"\n0.05, {period:g}\n"),
        ("-0.002\n", f"{-0.002 * period:g}\n"),
        ("FREQUENCY=1\n", f"FREQUENCY={n_increments}\n"),
        ("S, TAU, LE, PEEQ, PATCH, ELEMENT\n", "PEEQ\n"),
    ):
        if text.count(old) != 1:
            raise BenchError(f"the footing's deck has changed: expected one {old.strip()}")
        text = text.replace(old, new)
    return re.sub(r"\*EXPECT[^*]*", "", text)


def make_mesh(size: str, folder: Path, root: Path) -> Path:
    """A mesh of the footing; made once."""
    path = folder / f"footing_{size}.msh"
    if path.is_file():
        return path
    folder.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part.msh")
    script = root / "input" / "footing" / "make_mesh.py"
    command = [sys.executable, script, "--size", size, "-o", part]
    run = subprocess.run(command, stdout=sys.stderr, check=False)
    if run.returncode != 0:
        raise BenchError(f"the mesh '{size}' could not be made")
    part.rename(path)
    return path
