"""Runs the shipped examples with both formulations and draws the figures of the documentation."""

import argparse
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from tessera_post.cli import run_command
from tessera_post.errors import PostError

EXAMPLE = """\
  tessera-post paper                        # in a checkout: into docs/figures
  tessera-post paper --results DIR -o DIR   # from runs that are there already
"""
EXPECTATION_FAILED = 7  # exit code of a run that is complete


@dataclass(frozen=True)
class PaperFigure:
    """A picture of an example: the command that draws it, without -o."""

    name: str
    example: str
    command: str
    jobs: tuple[str, ...]
    options: tuple[str, ...]


BOTH = ("standard", "fbar")
FIGURES = (
    PaperFigure(
        "footing_curves.png",
        "footing",
        "curve",
        BOTH,
        (
            *("-x", "U3[FOOTING]", "-y", "RF3[FOOTING]", "--positive", "--x-unit", "mm"),
            *("--x-label", "settlement of the footing"),
            *("--y-label", "reaction of a quarter of the footing"),
            *("--band", "0.53", "0.70", "bounds of limit analysis"),
        ),
    ),
    PaperFigure(
        "footing_pressure.png",
        "footing",
        "picture",
        BOTH,
        (
            *("--field", "pressure", "--as", "elements", "--view=-1,-1,0.7"),
            *("--clip", "x<1.6", "--clip", "y<1.6", "--clip", "z>3.4", "--range", "-20", "20"),
        ),
    ),
    PaperFigure(
        "strip_footing_strain.png",
        "strip-footing",
        "picture",
        BOTH,
        (
            *("--field", "PEEQ", "--as", "elements"),
            *("--clip", "x<1.5", "--clip", "y>4", "--range", "0", "0.02"),
        ),
    ),
    PaperFigure(
        "stretch_deformed.png",
        "stretch",
        "deformed",
        ("fbar",),
        ("--increments", "0,5,11,17", "--field", "TAU33", "--range", "380", "420"),
    ),
    PaperFigure(
        "stretch_scatter.png",
        "stretch",
        "scatter",
        BOTH,
        ("--field", "TAU33", "--range", "330", "470", "--exact", "400", "yield stress"),
    ),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--examples",
        type=Path,
        metavar="DIR",
        help="folder with footing/footing.inp and the others (default: input/ of the checkout)",
    )
    parser.add_argument(
        "--tessera",
        type=Path,
        metavar="FILE",
        help="the program (default: TESSERA_EXE, build/release/bin of the checkout, or the PATH)",
    )
    parser.add_argument(
        "--results",
        type=Path,
        metavar="DIR",
        help="finished runs: JOB.vtkhdf or EXAMPLE/JOB.vtkhdf; nothing is run",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: docs/figures of the checkout"
    )


def run(options: argparse.Namespace) -> int:
    """Runs what must be run, and draws the figures."""
    output = options.output or checkout() / "docs" / "figures"
    if not output.is_dir():
        raise PostError(f"-o: there is no folder '{output}'")
    if options.results is not None:
        draw_figures(options.results, output)
        return 0
    examples = options.examples or checkout() / "input"
    program = find_program(options.tessera)
    with tempfile.TemporaryDirectory(prefix="tessera-paper-") as folder:
        for name in dict.fromkeys(figure.example for figure in FIGURES):
            run_example(program, examples / name / f"{name}.inp", Path(folder) / name)
        draw_figures(Path(folder), output)
    return 0


def find_checkout() -> Path | None:
    """The folder of the project that the working directory lies in."""
    here = Path.cwd().resolve()
    for folder in (here, *here.parents):
        if (folder / "input" / "footing" / "footing.inp").is_file():
            return folder
    return None


def checkout() -> Path:
    """The folder of the project, or an error that says what to give instead."""
    folder = find_checkout()
    if folder is None:
        raise PostError("this is no checkout of Tessera: expected --examples and -o, or --results")
    return folder


def find_program(given: Path | None) -> Path:
    """The executable of Tessera: the one given, or the first that there is."""
    build = find_checkout() or Path()
    candidates = [
        os.environ.get("TESSERA_EXE"),
        build / "build" / "release" / "bin" / "tessera",
        shutil.which("tessera"),
    ]
    for candidate in candidates if given is None else [given]:
        if candidate and os.access(candidate, os.X_OK) and Path(candidate).is_file():
            return Path(candidate).resolve()
    where = f"'{given}' is no program" if given else "cannot find the program"
    raise PostError(f"{where}: expected --tessera FILE, or a release build in the checkout")


def run_example(program: Path, deck: Path, folder: Path) -> None:
    """Runs a deck with both formulations."""
    if not deck.is_file():
        raise PostError(f"there is no deck '{deck}'")
    print(f"running {deck.name} with both formulations", flush=True)
    command = [program, "--compare", ",".join(BOTH), "-q", "-o", folder, deck]
    result = subprocess.run(
        [str(part) for part in command], capture_output=True, text=True, check=False
    )
    if result.returncode not in (0, EXPECTATION_FAILED):
        last = (result.stderr.strip().splitlines() or ["no message"])[-1]
        raise PostError(f"'{deck}' ended with exit code {result.returncode}: {last}")


def draw_figures(results: Path, output: Path) -> None:
    """All figures from finished runs."""
    for figure in FIGURES:
        jobs = [find_run(results, figure.example, method) for method in figure.jobs]
        path = output / figure.name
        run_command(figure.command, [*map(str, jobs), *figure.options, "-o", str(path)])


def find_run(results: Path, example: str, method: str) -> Path:
    """The result file of an example, in the folder itself or in one of the example's name."""
    name = f"{example}_{method}.vtkhdf"
    for path in (results / name, results / example / name):
        if path.is_file():
            return path
    raise PostError(f"there is no '{name}' in '{results}' or '{results / example}'")
