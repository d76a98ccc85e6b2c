"""Tries hostile decks, meshes and restart files: see docs/reliability.md."""

import argparse
import multiprocessing
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from fuzzing.campaign import Campaign, Figures  # noqa: E402


def make_parser() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser(
        prog="tools/fuzz",
        description="Try hostile input: no crash, no hang, no exit code outside the table.",
        epilog="exit codes: 0 nothing found, 1 something found, 2 cannot start",
        allow_abbrev=False,
    )
    build = ROOT / "build" / "sanitize" / "bin"
    add = parser.add_argument
    add("--decks", type=int, default=10000, metavar="N", help="mutations of decks")
    add("--meshes", type=int, default=1000, metavar="N", help="mutations of meshes")
    add("--restarts", type=int, default=1000, metavar="N", help="mutations of restart files")
    add("--seed", default="1", metavar="S", help="other mutations for each seed")
    add("--jobs", type=int, default=1, metavar="N", help="processes at a time")
    add("--no-extremes", action="store_true", help="without the very large files")
    add("--driver", type=Path, default=build / "fuzz_driver", metavar="PATH",
        help="what reads the inputs (default: that of build/sanitize)")  # fmt: skip
    add("--program", type=Path, default=build / "tessera", metavar="PATH",
        help="tessera, asked for its keywords (default: that of build/sanitize)")  # fmt: skip
    add("--keep", type=Path, default=ROOT / "build" / "fuzz", metavar="DIR",
        help="where inputs with findings go (default: build/fuzz)")  # fmt: skip
    return parser


def try_share(options: argparse.Namespace, job: int) -> list[Figures]:
    """What one of several processes tries."""
    campaign = Campaign(options.driver.resolve(), options.program.resolve(), options.seed,
                        options.keep, (job, options.jobs))  # fmt: skip
    try:
        found = []
        if not options.no_extremes:
            found += [campaign.unchanged(), campaign.hostile()]
        found.append(campaign.decks(options.decks))
        found.append(campaign.meshes(options.meshes))
        found.append(campaign.restarts(options.restarts))
    finally:
        campaign.close()
    return found


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    options = make_parser().parse_args(arguments)
    for path in (options.driver, options.program):
        if not path.is_file():
            print(f"fuzz: error: there is no program '{path}': build it first", file=sys.stderr)
            return 2
    with multiprocessing.Pool(options.jobs) as pool:
        shares = pool.starmap(try_share, [(options, job) for job in range(options.jobs)])
    found = shares[0]
    for share in shares[1:]:
        for figures, more in zip(found, share):
            figures.add(more)
    for figures in found:
        print(figures.text())
    return 1 if any(figures.findings for figures in found) else 0


if __name__ == "__main__":
    sys.exit(main())
