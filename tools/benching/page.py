"""Tables of what was found: for the terminal, and as docs/performance.md."""

import math
from collections.abc import Sequence
from pathlib import Path

from benching.cases import Case
from benching.judging import Limit
from benching.kernels import BYTES, FLOPS, OPERATIONS, WAYS
from benching.measuring import (
    both_solvers,
    compare_solvers,
    exponents,
    kernel_sum,
    kernel_table,
    key_of,
    main_solver,
    median,
    roofline,
    series_of,
    thread_speed_up,
)
from benching.plots import PLOTS
from benching.running import KERNELS, PARTS

HEAD = Path(__file__).with_name("page_head.md")
Table = tuple[Sequence[str], list[Sequence[str]]]


def number(value: float | None, digits: int = 3) -> str:
    """A number with so many digits that count."""
    if value is None or math.isnan(value):
        return "-"
    if value == 0.0:
        return "0"
    places = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:.2e}" if places > 6 else f"{value:,.{places}f}"


def report_text(found: dict, cases: Sequence[Case], limits: Sequence[Limit]) -> str:
    """Everything as text."""
    parts = [f"processor: {found['processor']}"]
    for title, table in tables_of(found, cases):
        parts.append(f"\n{title}\n{plain_table(*table)}")
    rows = [(row.what, figure(row), row.relation, row.verdict) for row in limits]
    parts.append(f"\nlimits\n{plain_table(('', 'found', 'limit', ''), rows)}")
    return "\n".join(parts)


def figure(limit: Limit) -> str:
    """What was found."""
    return number(limit.found)


def plain_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns of the width that they need; the first one begins at the left."""
    lines = [head, *rows]
    width = [max(len(line[k]) for line in lines) for k in range(len(head))]
    return "\n".join(
        "  ".join([line[0].ljust(width[0]), *(c.rjust(w) for c, w in zip(line[1:], width[1:]))])
        for line in lines
    )


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The same for the page; numbers stand at the right."""
    marks = ["---", *["---:"] * (len(head) - 1)]
    return "".join(f"| {' | '.join(c or ' ' for c in line)} |\n" for line in (head, marks, *rows))


def tables_of(found: dict, cases: Sequence[Case]) -> list[tuple[str, Table]]:
    """All tables with their titles; without rows none."""
    tables = [
        ("Sizes", sizes(found, cases)),
        ("CPU seconds by part", seconds(found, cases)),
        ("Microseconds of CPU per point and Newton iteration, plastic increments",
         points(found, cases)),
        ("Growth: exponent over the unknowns, over the points", growth_rows(found, cases)),
        ("DIRECT against RECYCLED", solvers(found, cases)),
        ("Two threads", threads(found, cases)),
        ("Stress update alone, microseconds of CPU per point", kernels(found)),
        ("Roofline of the stress update, one thread", roof_rows(found)),
        ("Location of points", location(found)),
    ]  # fmt: skip
    return [(title, table) for title, table in tables if table[1]]


def entries_of(found: dict, cases: Sequence[Case], n_threads: int = 1) -> list[tuple[str, list]]:
    """Cases with their runs, with the solver that the program should use."""
    key = key_of(main_solver(found["solvers"]), n_threads)
    entries = [(case.name, found["cases"].get(case.name)) for case in cases]
    return [(name, entry["runs"][key]) for name, entry in entries if entry]


def sizes(found: dict, cases: Sequence[Case]) -> Table:
    """What is solved, and the memory that it takes: with DIRECT, and with the main solver."""
    head = ("case", "runs", "unknowns", "nonzeros", "points", "increments", "iterations",
            "peak MiB", "factor MiB", "bytes per point")  # fmt: skip
    rows = []
    for name, runs in entries_of(found, cases):
        both = both_solvers(found["cases"][name]) or (runs,)
        counts = [
            f"{int(median(runs, key)):,}"
            for key in ("unknowns", "nonzeros", "points", "increments", "iterations")
        ]
        memory = [
            ", ".join(f"{median(r, key) / unit:,.0f}" for r in both)
            for key, unit in (
                ("memory", 2**20),
                ("factor_memory", 2**20),
                ("memory", median(runs, "points")),
            )
        ]
        rows.append((name, str(len(runs)), *counts, *memory))
    return head, rows


def seconds(found: dict, cases: Sequence[Case]) -> Table:
    """Whole runs, each way."""
    rows = []
    for case in cases:
        for key, runs in found["cases"].get(case.name, {"runs": {}})["runs"].items():
            solver, n_threads = key.split("/")
            parts = [number(median(runs, "seconds", part)) for part in PARTS]
            whole = [number(median(runs, "cpu")), number(median(runs, "wall"))]
            rows.append((case.name, solver, n_threads, *parts, *whole))
    return ("case", "solver", "threads", *PARTS, "all", "wall"), rows


def points(found: dict, cases: Sequence[Case]) -> Table:
    """The point kernels, one thread."""
    rows = []
    for name, runs in entries_of(found, cases):
        parts = [number(median(runs, "plastic", part)) for part in KERNELS]
        sums = [sum(run["plastic"][part] for part in KERNELS) for run in runs]
        spread = f"{number(min(sums))} to {number(max(sums))}"
        count = f"{int(median(runs, 'plastic_iterations')):,}"
        rows.append((name, count, *parts, number(kernel_sum(runs)), spread))
    return ("case", "iterations", *KERNELS, "sum", "sums"), rows


def growth_rows(found: dict, cases: Sequence[Case]) -> Table:
    """Exponents of each part over the footing's meshes."""
    rows = []
    for solver in found["solvers"]:
        if len(series_of(found, cases, key_of(solver, 1))) < 2:
            continue
        table = exponents(found, cases, key_of(solver, 1))
        rows.append((solver, *(f"{a:.2f}, {b:.2f}" for a, b in table.values())))
    return ("solver", *PARTS), rows


def solvers(found: dict, cases: Sequence[Case]) -> Table:
    """Both linear solvers, case by case."""
    head = ("case", "iterations", "DIRECT [s]", "RECYCLED [s]", "RECYCLED / DIRECT",
            "7 iterations [factorisations]", "histories differ by")  # fmt: skip
    rows = []
    for case in cases:
        row = compare_solvers(found["cases"].get(case.name, {"runs": {}}))
        if row:
            counts = f"{row['iterations'][0]}, {row['iterations'][1]}"
            names = ("direct", "recycled", "share", "factorisations")
            difference = "-" if row["difference"] is None else f"{row['difference']:.1e}"
            rows.append((case.name, counts, *(number(row[key]) for key in names), difference))
    return head, rows


def threads(found: dict, cases: Sequence[Case]) -> Table:
    """One and two threads: wall seconds."""
    solver = main_solver(found["solvers"])
    rows = []
    for name, two in entries_of(found, cases, 2):
        entry = found["cases"][name]
        one = entry["runs"][key_of(solver, 1)]
        walls = [median(runs, "wall") for runs in (one, two)]
        loops = [median(runs, "seconds", "point_loop") for runs in (one, two)]
        speed = [number(thread_speed_up(entry, solver)), number(walls[0] / walls[1])]
        rows.append((name, *(number(v) for v in loops), speed[0], *map(number, walls), speed[1]))
    head = ("case", "point loop, 1 [s]", "2 [s]", "faster by", "whole run, 1 [s]", "2 [s]",
            "faster by")  # fmt: skip
    return head, rows


def kernels(found: dict) -> Table:
    """Both kernels over the number of points."""
    if not found["kernel"]:
        return (), []
    table = kernel_table(found["kernel"]["1"])
    two = kernel_table(found["kernel"]["2"], "wall")
    wall = kernel_table(found["kernel"]["1"], "wall")
    rows = []
    for kind in FLOPS:
        for n in sorted({n for k, _, n in table if k == kind}):
            batched, pointwise = (table[kind, way, n] for way in WAYS)
            faster = wall[kind, WAYS[0], n] / two[kind, WAYS[0], n]
            residual = table[kind, "residual", n]
            cells = (batched, residual, pointwise, pointwise / batched, faster)
            rows.append((kind, f"{n:,}", *(number(cell) for cell in cells)))
    head = ("points are", "points", "batched", "without moduli", "pointwise",
            "pointwise / batched", "two threads, wall")  # fmt: skip
    return head, rows


def roof_rows(found: dict) -> Table:
    """Rates and shares of the machine."""
    if not found["kernel"]:
        return (), []
    runs = found["kernel"]["1"]
    rows = [
        (
            f"{row['kind']}, {row['way']}",
            *(number(row[key]) for key in ("cost", "gflops", "gbytes", "intensity")),
            f"{100.0 * row['of_peak']:.1f} %",
            f"{100.0 * row['of_triad']:.1f} %",
        )
        for row in roofline(runs)
    ]
    peak, triad = median(runs, "peak_gflops"), median(runs, "triad_gbytes")
    rows.append(("machine", "", number(peak), number(triad), number(peak / triad), "", ""))
    return ("", "us per point", "GFLOP/s", "GB/s", "flops per byte", "of peak", "of triad"), rows


def location(found: dict) -> Table:
    """The moved box."""
    runs = found["location"]
    if not runs:
        return (), []
    names = ("points", "elements", "crossed")
    cells = [f"{median(runs, name):,.0f}" for name in names]
    tests = (median(runs, "walk_tests") + median(runs, "bin_tests")) / median(runs, "points")
    cells += [number(tests), number(1e3 * median(runs, "location_seconds"))]
    cells += [f"{100.0 * median(runs, name):.4f}" for name in ("share_of_tests", "share_of_time")]
    return (
        ("points", "elements", "changed element", "tests per point", "CPU [ms]",
         "tests, % of naive", "CPU time, % of naive"),
        [cells],
    )  # fmt: skip


def page_text(found: dict, cases: Sequence[Case], limits: Sequence[Limit]) -> str:
    """The whole page; the same figures give the same text."""
    text = HEAD.read_text(encoding="utf-8")
    n_runs = found["runs"]
    text += f"\nProcessor: {found['processor']}. "
    text += "One run of each case" if n_runs == 1 else f"Medians of {n_runs} runs"
    fewer = [name for name, entry in found["cases"].items() if entry["n_runs"] < n_runs]
    text += f" (fewer of {', '.join(fewer)}: see *Sizes*).\n" if fewer else ".\n"
    rows = [(row.what, figure(row), row.relation, verdict_cell(row)) for row in limits]
    text += "\n## Limits\n\n" + markdown_table(("", "found", "limit", ""), rows)
    for title, table in tables_of(found, cases):
        text += f"\n## {title}\n\n" + markdown_table(*table)
        text += "".join(
            f"\n![{caption}](figures/{name}.png)\n"
            for name, (heading, caption) in PLOTS.items()
            if heading == title
        )
    text += "\n## Operations and bytes of a material point\n\n"
    rows = [(step, str(e), str(p)) for step, e, p in OPERATIONS]
    rows.append(("sum", str(FLOPS["elastic"]), str(FLOPS["plastic"])))
    text += markdown_table(("step", "elastic", "plastic"), rows)
    text += f"\nBytes read and written: {BYTES}, without what a cache reads before it writes.\n"
    return text


def verdict_cell(limit: Limit) -> str:
    """A limit that is passed catches the eye."""
    return f"**{limit.verdict}**" if limit.verdict == "FAILED" else limit.verdict
