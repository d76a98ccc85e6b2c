"""Measures the program in build/bench and compares it with its limits: see docs/performance.md."""

import argparse
import json
import platform
import sys
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from benching.cases import CASES, BenchError, Case, available_solvers, write_deck  # noqa: E402
from benching.judging import limits_of  # noqa: E402
from benching.kernels import measure_kernel, measure_location  # noqa: E402
from benching.measuring import key_of, main_solver  # noqa: E402
from benching.page import page_text, report_text  # noqa: E402
from benching.plots import draw_plots  # noqa: E402
from benching.post import bench_post  # noqa: E402
from benching.running import (  # noqa: E402
    environment,
    largest_difference,
    read_history,
    run_deck,
)

BUILD = ROOT / "build" / "bench"
ALONE = ("kernel", "location", "post")  # what is measured beside the cases


def make_parser() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser(
        prog="tools/bench",
        description="Measure the program with a fixed set of cases, one and two threads, and"
        " compare it with its limits.",
        epilog="exit codes: 0 all limits are kept, 1 one is not, 2 something cannot be measured",
        allow_abbrev=False,
    )
    names = ", ".join([*(case.name for case in CASES), *ALONE])
    add = parser.add_argument
    add("--runs", type=positive, default=5, metavar="N",
        help="runs of each case (default: 5; the largest ones have fewer)")  # fmt: skip
    add("--case", nargs="+", metavar="NAME", help=f"some of {names}; default: all")
    add("--quick", action="store_true", help="small cases only, one run")
    add("--page", action="store_true", help="write docs/performance.md and draw its figures")
    add("--from", dest="source", type=Path, metavar="FILE",
        help="figures of an earlier bench; nothing is run")  # fmt: skip
    add("-o", "--output", type=Path, default=BUILD / "bench.json", metavar="FILE",
        help="all figures (default: build/bench/bench.json)")  # fmt: skip
    return parser


def positive(text: str) -> int:
    """A number of runs."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"expected an integer above 0, found {text}")
    return value


def main(arguments: Sequence[str] | None = None) -> int:
    """The program."""
    parser = make_parser()
    options = parser.parse_args(arguments)
    known = [*(case.name for case in CASES), *ALONE]
    for name in options.case or []:
        if name not in known:
            parser.error(f"--case: expected some of {', '.join(known)}, found {name}")
    try:
        found = read_figures(options.source) if options.source else measure(options)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 2
    limits = limits_of(found, CASES)
    print(report_text(found, CASES, limits))
    if options.page:
        draw_plots(found, CASES, ROOT / "docs" / "figures")
        (ROOT / "docs" / "performance.md").write_text(
            page_text(found, CASES, limits), encoding="utf-8"
        )
    met = all(limit.verdict != "FAILED" for limit in limits) and found["post_ok"]
    return 0 if met else 1


def read_figures(path: Path) -> dict:
    """The figures that an earlier bench has written."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BenchError(f"{path} cannot be read: {error}") from None


def measure(options: argparse.Namespace) -> dict:
    """Runs everything that was asked for and keeps it."""
    start = time.monotonic()
    chosen = [
        case
        for case in CASES
        if (case.is_quick or not options.quick) and (not options.case or case.name in options.case)
    ]
    alone = [name for name in ALONE if not options.case or name in options.case]
    if options.quick and not options.case:
        alone.remove("post")
    n_runs = 1 if options.quick else options.runs
    found: dict = {
        "processor": processor(),
        "runs": n_runs,
        "solvers": list(available_solvers(BUILD / "bin" / "tessera")),
        "cases": {},
        "kernel": {},
        "location": [],
        "post_ok": True,
    }
    measure_alone(found, alone, n_runs)
    for case in chosen:
        found["cases"][case.name] = measure_case(case, found["solvers"], n_runs)
        keep(found, options.output)
    if "post" in alone:
        program = BUILD / "bin" / "tessera"
        found["post_ok"] = bench_post(min(n_runs, 3), program, ROOT, environment(1))
    found["minutes"] = (time.monotonic() - start) / 60.0
    keep(found, options.output)
    return found


def measure_alone(found: dict, names: Sequence[str], n_runs: int) -> None:
    """Kernel and location."""
    for i in range(n_runs):
        if "kernel" in names:
            tell(f"stress update, run {i + 1} of {n_runs}")
            for n_threads in (1, 2):
                runs = found["kernel"].setdefault(str(n_threads), [])
                runs.append(measure_kernel(BUILD / "bin" / "bench_kernel", n_threads))
        if "location" in names:
            found["location"].append(measure_location(BUILD / "bin" / "bench_location"))


def measure_case(case: Case, solvers: Sequence[str], n_runs: int) -> dict:
    """All runs of a case, solvers and threads in turn."""
    ways = [(solver, 1) for solver in solvers] + [(main_solver(solvers), 2)]
    n_runs = min(n_runs, case.most_runs)
    entry: dict = {"n_runs": n_runs, "runs": {key_of(*way): [] for way in ways}}
    for i in range(n_runs):
        histories = []
        for solver, n_threads in ways:
            tell(f"{case.name}, {solver}, threads {n_threads}, run {i + 1} of {n_runs}")
            deck = write_deck(case, solver, BUILD / "runs" / case.name, ROOT)
            entry["runs"][key_of(solver, n_threads)].append(
                run_deck(BUILD / "bin" / "tessera", deck, n_threads)
            )
            histories.append(read_history(deck.with_suffix(".vtkhdf")))
        if len(solvers) > 1:
            entry["difference"] = largest_difference(histories[0], histories[1])
    return entry


def keep(found: dict, path: Path) -> None:
    """Writes what was found so far."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(found, indent=1), encoding="utf-8")


def tell(text: str) -> None:
    """What is running."""
    print(text, file=sys.stderr, flush=True)


def processor() -> str:
    """Name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


if __name__ == "__main__":
    sys.exit(main())
