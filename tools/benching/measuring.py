"""From runs to figures: medians, growth with the size, comparison of solvers and threads."""

from collections.abc import Sequence

import numpy as np

from benching.cases import DECK_SOLVERS, DEFAULT, Case
from benching.kernels import BYTES, FLOPS, WAYS
from benching.running import KERNELS, LINEAR, PARTS

FEW = 5000  # points


def median(runs: Sequence[dict], *path: str) -> float:
    """Median over runs of the value at a path of keys."""
    values = []
    for run in runs:
        value = run
        for key in path:
            value = value[key]
        values.append(value)
    return float(np.median(values))


def key_of(solver: str, n_threads: int) -> str:
    """Name of the runs with a solver and a number of threads."""
    return f"{solver}/{n_threads}"


def main_solver(solvers: Sequence[str]) -> str:
    """The one that the program should use: the last, if there is a choice."""
    return solvers[-1] if solvers else DEFAULT


def unit_of(part: str) -> str:
    """What the cost of a part is counted by."""
    return {"location": "increments", "output": "outputs"}.get(part, "iterations")


def unit_cost(runs: Sequence[dict], part: str) -> float:
    """Median CPU seconds of a part per Newton iteration; of location per increment, of output per
    output of fields."""
    per = unit_of(part)
    return float(np.median([run["seconds"][part] / max(1, run[per]) for run in runs]))


def kernel_sum(runs: Sequence[dict]) -> float:
    """Median microseconds per point and iteration of kinematics, stress and assembly together."""
    return float(np.median([sum(run["plastic"][part] for part in KERNELS) for run in runs]))


def linear_seconds(run: dict) -> float:
    """CPU seconds of linear algebra in a run."""
    return sum(run["seconds"][part] for part in LINEAR)


def growth(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Exponent of a power law through costs over sizes; no number with fewer than two."""
    pairs = [(s, c) for s, c in zip(sizes, costs) if s > 0.0 and c > 0.0]
    if len({s for s, _ in pairs}) < 2:
        return float("nan")
    x, y = np.log(np.array(pairs)).T
    return float(np.polyfit(x, y, 1)[0])


def series_of(found: dict, cases: Sequence[Case], key: str) -> list[tuple[Case, list[dict]]]:
    """The cases of the series that were run in a way, by size."""
    runs = [(case, found["cases"].get(case.name, {}).get("runs", {}).get(key)) for case in cases]
    return [(case, list(some)) for case, some in runs if case.is_series and some]


def exponents(found: dict, cases: Sequence[Case], key: str) -> dict[str, tuple[float, float]]:
    """Growth of each part, with the unknowns and with the points."""
    series = series_of(found, cases, key)
    unknowns = [median(runs, "unknowns") for _, runs in series]
    points = [median(runs, "points") for _, runs in series]
    result = {}
    for part in PARTS:
        costs = costs_of(series, part)
        result[part] = (growth(unknowns, costs), growth(points, costs))
    return result


def costs_of(series: Sequence[tuple[Case, list[dict]]], part: str) -> list[float]:
    """Cost of a part over the series; the deck as it is writes other fields than the short ones
    and has no number for output."""
    return [
        float("nan") if part == "output" and not case.size else unit_cost(runs, part)
        for case, runs in series
    ]


def both_solvers(entry: dict) -> tuple[list[dict], list[dict]] | None:
    """Runs of a case with DIRECT and with RECYCLED, one thread; None without both."""
    runs = [entry["runs"].get(key_of(solver, 1)) for solver in DECK_SOLVERS]
    return (runs[0], runs[1]) if all(runs) else None


def compare_solvers(entry: dict) -> dict | None:
    """DIRECT against RECYCLED: seconds of linear algebra, iterations, difference of histories."""
    both = both_solvers(entry)
    if both is None:
        return None
    seconds = [float(np.median([linear_seconds(run) for run in runs])) for runs in both]
    return {
        "direct": seconds[0],
        "recycled": seconds[1],
        "share": seconds[1] / max(seconds[0], 1e-9),
        "iterations": [int(runs[0]["iterations"]) for runs in both],
        "difference": entry.get("difference"),
        "factorisations": worst_increment(both[1], factorisation_of(both[0])),
    }


def factorisation_of(runs: Sequence[dict]) -> float:
    """Median CPU seconds of one factorisation, from runs with one per iteration."""
    return unit_cost(runs, "factorisation")


def worst_increment(runs: Sequence[dict], factorisation: float, n: int = 7) -> float:
    """Linear algebra of the most expensive increment in factorisations; of one with more than n
    iterations, that of n."""
    worst = []
    for run in runs:
        costs = [i["seconds"] * min(1.0, n / max(1, i["iterations"])) for i in run["linear"]]
        worst.append(max(costs) / max(factorisation, 1e-9))
    return float(np.median(worst))


def thread_speed_up(entry: dict, solver: str) -> float | None:
    """Wall time of the point loop with one thread over that with two; None without both."""
    one, two = (entry["runs"].get(key_of(solver, n)) for n in (1, 2))
    if not one or not two:
        return None
    return median(one, "seconds", "point_loop") / median(two, "seconds", "point_loop")


def kernel_table(runs: Sequence[dict], clock: str = "cpu") -> dict[tuple[str, str, int], float]:
    """Median microseconds per point, by kind, way and number of points."""
    values: dict[tuple[str, str, int], list[float]] = {}
    for run in runs:
        for line in run["lines"]:
            key = (line["kind"], line["way"], line["points"])
            values.setdefault(key, []).append(line[clock])
    return {key: float(np.median(some)) for key, some in values.items()}


def kernel_growth(table: dict[tuple[str, str, int], float]) -> float:
    """Cost per point of the update in batches at the most points over the least at fewer points
    (not so few that all fit into a cache of the core), the worse of elastic and plastic."""
    worst = 0.0
    for kind in FLOPS:
        some = {
            n: cost
            for (k, way, n), cost in table.items()
            if (k, way) == (kind, WAYS[0]) and n > FEW
        }
        most = max(some)
        worst = max(worst, some[most] / min(cost for n, cost in some.items() if n < most))
    return worst


def roofline(runs: Sequence[dict]) -> list[dict]:
    """For the largest body: rates of each kind and way, and their shares of both roofs."""
    peak, triad = median(runs, "peak_gflops"), median(runs, "triad_gbytes")
    table = kernel_table(runs)
    n_points = max(n for _, _, n in table)
    rows = []
    for (kind, way, n), cost in table.items():
        if n != n_points or way not in WAYS:
            continue
        flops, traffic = FLOPS[kind] / cost * 1e-3, BYTES / cost * 1e-3
        rows.append(
            {
                "kind": kind, "way": way, "points": n, "cost": cost,
                "gflops": flops, "gbytes": traffic, "intensity": FLOPS[kind] / BYTES,
                "of_peak": flops / peak, "of_triad": traffic / triad,
            }
        )  # fmt: skip
    return rows
