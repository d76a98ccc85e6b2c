"""The limits that the program is held to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from benching.cases import Case
from benching.measuring import (
    compare_solvers,
    kernel_growth,
    kernel_sum,
    kernel_table,
    key_of,
    main_solver,
    median,
    series_of,
    thread_speed_up,
)

PAPER = "footing-522"  # the paper's footing
LARGEST = "footing-16000"
GROWTH = 1.1  # of the cost per point up to a million points
DIFFERENCE = 1e-8  # of histories of DIRECT and RECYCLED
KERNEL_DIFFERENCE = 1e-10  # of both kernels, relative to the largest sum


@dataclass(frozen=True)
class Limit:
    """A figure and its limit; without a figure it was not measured."""

    what: str
    found: float | None
    limit: float
    unit: str = ""
    is_least: bool = False

    @property
    def verdict(self) -> str:
        """In words."""
        if self.found is None:
            return "not measured"
        if math.isnan(self.found):
            return "FAILED"
        met = self.found >= self.limit if self.is_least else self.found <= self.limit
        return "ok" if met else "FAILED"

    @property
    def relation(self) -> str:
        """The limit with its sign and unit."""
        return f"{'>=' if self.is_least else '<='} {self.limit:.3g}{self.unit and ' ' + self.unit}"


def limits_of(found: dict, cases: Sequence[Case]) -> list[Limit]:
    """All limits; those of cases that were not run have no figure."""
    return [
        *limits_of_points(found, cases),
        *limits_of_paper(found),
        *limits_of_solvers(found, cases),
        *limits_of_largest(found),
        *limits_of_threads(found),
        *limits_of_location(found),
    ]


def runs_of(found: dict, case: str, n_threads: int = 1) -> list[dict] | None:
    """Runs of a case with the solver that the program should use."""
    entry = found["cases"].get(case, {"runs": {}})
    return entry["runs"].get(key_of(main_solver(found["solvers"]), n_threads))


def limits_of_points(found: dict, cases: Sequence[Case]) -> list[Limit]:
    """Kinematics, stress and assembly."""
    series = series_of(found, cases, key_of(main_solver(found["solvers"]), 1))
    costs = {case.name: kernel_sum(runs) for case, runs in series}
    limits = [
        Limit(f"kinematics + stress + assembly, {case.name}", costs.get(case.name), 0.6,
              "us per point and iteration")
        for case in cases if case.is_series
    ]  # fmt: skip
    rest = [cost for name, cost in costs.items() if name != PAPER]
    ratio = max(rest) / costs[PAPER] if rest and PAPER in costs else None
    limits.append(Limit(f"the same, largest of the series over {PAPER}", ratio, GROWTH))
    kernel = found["kernel"].get("1")
    ratio = kernel_growth(kernel_table(kernel)) if kernel else None
    limits.append(Limit("stress update, cost per point at a million over fewer", ratio, GROWTH))
    difference = max(run["difference"] for run in kernel) if kernel else None
    limits.append(Limit("both kernels, largest difference", difference, KERNEL_DIFFERENCE))
    return limits


def limits_of_paper(found: dict) -> list[Limit]:
    """The footing of the paper, 20 increments."""
    runs = runs_of(found, PAPER)
    cpu = median(runs, "cpu") if runs else None
    output = 100.0 * median(runs, "seconds", "output") / cpu if runs else None
    return [
        Limit(f"everything, {PAPER}", cpu, 6.0, "s of CPU"),
        Limit(f"output every increment, {PAPER}", output, 5.0, "% of the run"),
    ]


def limits_of_solvers(found: dict, cases: Sequence[Case]) -> list[Limit]:
    """DIRECT against RECYCLED."""
    compared = {
        case.name: compare_solvers(found["cases"][case.name])
        for case in cases
        if case.name in found["cases"]
    }
    rows = {name: row for name, row in compared.items() if row}
    limits = [
        Limit(f"linear algebra of RECYCLED over DIRECT, {PAPER}",
              rows[PAPER]["share"] if PAPER in rows else None, 1.0 / 3.0),
        Limit(f"linear algebra of 7 iterations, {LARGEST}",
              rows[LARGEST]["factorisations"] if LARGEST in rows else None, 2.5,
              "factorisations"),
    ]  # fmt: skip
    counts = [row["iterations"][1] / max(1, row["iterations"][0]) for row in rows.values()]
    limits.append(
        Limit("Newton iterations of RECYCLED over DIRECT", max(counts, default=None), 1.15)
    )
    differences = [row["difference"] for row in rows.values() if row["difference"] is not None]
    limits.append(Limit("histories of both", max(differences, default=None), DIFFERENCE))
    return limits


def limits_of_largest(found: dict) -> list[Limit]:
    """Memory of the largest case: of every solver, beside what UMFPACK reports for its factors."""
    entry = found["cases"].get(LARGEST, {"runs": {}})
    limits = []
    for solver in found["solvers"]:
        exact, runs = (entry["runs"].get(key_of(s, 1)) for s in (found["solvers"][0], solver))
        share = None
        if exact and runs:
            allowed = 1.3 * median(exact, "factor_memory") + 600.0 * median(runs, "points")
            share = median(runs, "memory") / allowed
        what = f"peak memory over 1.3 factors of UMFPACK + 600 bytes per point, {LARGEST}, {solver}"
        limits.append(Limit(what, share, 1.0))
    return limits


def limits_of_threads(found: dict) -> list[Limit]:
    """Two threads against one."""
    solver = main_solver(found["solvers"])
    limits = []
    for name in (PAPER, LARGEST):
        entry = found["cases"].get(name)
        ratio = thread_speed_up(entry, solver) if entry else None
        limits.append(Limit(f"point loop with two threads, {name}", ratio, 1.7, "x", True))
    return limits


def limits_of_location(found: dict) -> list[Limit]:
    """Point location against testing every element."""
    runs = found["location"]
    time = 100.0 * median(runs, "share_of_time") if runs else None
    tests = 100.0 * median(runs, "share_of_tests") if runs else None
    wrong = max(run["disagreements"] + run["lost"] for run in runs) if runs else None
    return [
        Limit("location, CPU time over a naive search", time, 0.02, "%"),
        Limit("location, element tests over a naive search", tests, 0.02, "%"),
        Limit("location, hosts other than those of a naive search", wrong, 0.0),
    ]
