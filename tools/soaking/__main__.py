"""Runs the long tests and prints the figures of docs/reliability.md."""

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from soaking.determinism import Settings, check_determinism  # noqa: E402
from soaking.parts import Part, SoakError, check_fuzz, check_kills  # noqa: E402

DECK = ROOT / "input" / "footing" / "footing.inp"
PROGRAM = ROOT / "build" / "release" / "bin" / "tessera"
PARTS = ("kills", "fuzz", "determinism")


def make_parser() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser(
        prog="tools/soak",
        description="Run the long tests and print the figures that docs/reliability.md quotes:"
        " kills at any moment, mutated decks, meshes and restart files, and one checksum for any"
        " number of threads.",
        epilog="exit codes: 0 all is as it should be, 1 something failed, 2 cannot start",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("part", nargs="*", metavar="PART", help=f"some of {', '.join(PARTS)}; default: all")
    add("--scale", type=scale_of, default=1.0, metavar="X",
        help="part of the full length, above 0 and at most 1 (default: 1)")  # fmt: skip
    add("--seed", type=int, default=1, metavar="N", help="of the mutations (default: 1)")
    add("--exe", type=Path, default=PROGRAM, metavar="PATH", help="another build")
    add("--deck", type=Path, default=DECK, metavar="PATH",
        help="deck of the part determinism (default: input/footing/footing.inp)")  # fmt: skip
    add("-o", "--output", type=Path, default=ROOT / "build" / "soak", metavar="DIR",
        help="results while they are needed (default: build/soak)")  # fmt: skip
    return parser


def scale_of(text: str) -> float:
    """A part of the full length."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value <= 1.0:
        raise argparse.ArgumentTypeError(f"expected a number above 0, at most 1, found {text}")
    return value


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = make_parser()
    options = parser.parse_args(arguments)
    for name in options.part:
        if name not in PARTS:
            parser.error(f"there is no part '{name}': expected some of {', '.join(PARTS)}")
    program = options.exe.resolve()
    if not os.access(program, os.X_OK) or program.is_dir():
        parser.error(f"there is no program '{program}': expected a build, or --exe PATH")
    if not options.deck.is_file():
        parser.error(f"there is no deck '{options.deck}': expected a file")
    settings = Settings(program, options.deck.resolve(), options.output.resolve())
    scale, python = options.scale, sys.executable
    checks = {
        "kills": lambda: check_kills(ROOT, python, program, scale),
        "fuzz": lambda: check_fuzz(ROOT, options.seed, scale),
        "determinism": lambda: check_determinism(settings, scale),
    }
    start = time.monotonic()
    parts = [run_part(name, checks[name]) for name in options.part or PARTS]
    failed = [part.name for part in parts if part.failed]
    print(f"soak: {len(parts)} parts, scale {scale:g}, {time.monotonic() - start:.0f} s:"
          f" {'FAILED: ' + ', '.join(failed) if failed else 'passed'}")  # fmt: skip
    return 1 if failed else 0


def run_part(name: str, check: Callable[[], Part]) -> Part:
    """Carries out a part and tells what it found; one that breaks has failed."""
    start = time.monotonic()
    try:
        part = check()
    except (SoakError, OSError) as problem:
        part = Part(name, [], [str(problem)])
    print(f"{part.text()} ({time.monotonic() - start:.0f} s)", flush=True)
    return part


if __name__ == "__main__":
    sys.exit(main())
