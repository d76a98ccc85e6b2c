"""Runs the cases of input/verification and judges what comes out: see docs/verification.md."""

import argparse
import os
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from verification.case import Case, load_cases  # noqa: E402
from verification.figures import draw_figures  # noqa: E402
from verification.freezing import freeze  # noqa: E402
from verification.judging import CaseResult, judge  # noqa: E402
from verification.measuring import measure_all  # noqa: E402
from verification.page import FIGURES, page_text  # noqa: E402
from verification.running import Runner, Settings, is_checked  # noqa: E402
from verification.table import case_text  # noqa: E402
from verification.toml_table import CaseError  # noqa: E402

CASES = ROOT / "input" / "verification"
PROGRAM = ROOT / "build" / "release" / "bin" / "tessera"


def make_parser() -> argparse.ArgumentParser:
    """The options."""
    parser = argparse.ArgumentParser(
        prog="tools/verify",
        description="Run the verification cases and judge what comes out.",
        epilog="exit codes: 0 all is as it should be, 1 something misses, 2 cannot start",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("case", nargs="*", metavar="CASE", help="folders of input/verification; default: all")
    add("--all", action="store_true", help="slow decks, too")
    add("--list", action="store_true", help="name cases and decks, run nothing")
    add("--jobs", type=positive, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    add("--threads", type=positive, default=1, metavar="N", help="threads of each run")
    add("--exe", type=Path, metavar="PATH", help="another build, such as the one with checks")
    add("--freeze", action="store_true", help="write what was found into the frozen values")
    add("--page", action="store_true", help="write docs/verification.md and draw its figures")
    add("--cases", type=Path, default=CASES, metavar="DIR",
        help="folder of the cases (default: input/verification)")  # fmt: skip
    add("-o", "--output", type=Path, default=ROOT / "build" / "verification", metavar="DIR",
        help="results (default: build/verification)")  # fmt: skip
    return parser


def positive(text: str) -> int:
    """A number of jobs or threads."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"expected an integer above 0, found {text}")
    return value


def main(arguments: list[str] | None = None) -> int:
    """The program."""
    parser = make_parser()
    options = parser.parse_args(arguments)
    if options.page and (options.case or not options.all or options.cases != CASES):
        parser.error("--page: expected --all, no CASE and no --cases: the page shows everything")
    program = (options.exe or PROGRAM).resolve()
    try:
        cases = load_cases(options.cases.resolve(), options.case)
        if options.list:
            print("\n".join(list_text(case) for case in cases))
            return 0
        if not os.access(program, os.X_OK) or program.is_dir():
            raise CaseError(f"there is no program '{program}': expected a build, or --exe PATH")
        settings = Settings(program, options.output.resolve(), options.jobs, options.threads)
        return verify(cases, settings, options)
    except (CaseError, OSError) as problem:
        print(f"verify: error: {problem}", file=sys.stderr)
        return 2


def list_text(case: Case) -> str:
    """A case and its decks."""
    decks = (f"  {deck.file}  {deck.label}" for deck in case.decks)
    return "\n".join([f"{case.name}: {case.title}", *decks])


def verify(cases: list[Case], settings: Settings, options: argparse.Namespace) -> int:
    """Runs, judges, freezes, writes the page; 1 when anything misses."""
    start = time.monotonic()
    results: list[CaseResult] = []
    timed = settings.n_threads == 1 and not is_checked(settings.program)
    runner = Runner(cases, options.all, settings)
    try:
        for case in cases:
            runs = runner.runs_of(case)
            result = judge(case, runs, measure_all(case, runs), timed)
            results.append(result)
            if runs:
                print(case_text(result), flush=True)
    finally:
        runner.close()
    if options.freeze:
        for path in (path for result in results for path in freeze(result)):
            print(f"froze {path}")
    if options.page:
        write_page(results)
    print(summary_text(results, time.monotonic() - start))
    return 1 if any(result.n_failed for result in results) else 0


def write_page(results: list[CaseResult]) -> None:
    """The page and its figures."""
    for result in results:
        draw_figures(result, ROOT / "docs" / FIGURES)
    page = ROOT / "docs" / "verification.md"
    page.write_text(page_text(results), encoding="utf-8")
    print(f"wrote {page.relative_to(ROOT)}")


def summary_text(results: list[CaseResult], seconds: float) -> str:
    """The last line."""
    n_cases = sum(bool(result.runs) for result in results)
    n_decks = sum(len(result.runs) for result in results)
    n_rows = sum(len(result.rows) + len(result.studies) for result in results)
    n_failed = sum(result.n_failed for result in results)
    cpu = sum(run.cpu_seconds for result in results for run in result.runs)
    return (
        f"verify: {n_cases} cases, {n_decks} decks, {n_rows} quantities and orders,"
        f" {n_failed} failed; {seconds:.0f} s, {cpu:.0f} s of CPU"
    )


if __name__ == "__main__":
    sys.exit(main())
