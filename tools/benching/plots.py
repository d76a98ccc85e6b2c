"""The figures of docs/performance.md."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from benching.cases import Case
from benching.kernels import FLOPS, WAYS
from benching.measuring import (
    costs_of,
    growth,
    kernel_table,
    key_of,
    linear_seconds,
    main_solver,
    median,
    roofline,
    series_of,
    unit_of,
)
from benching.running import PARTS

# Name of the file: heading under which it stands, caption.
PLOTS = {
    "performance_parts": (
        "Growth: exponent over the unknowns, over the points",
        "CPU seconds of each part over the unknowns",
    ),
    "performance_solvers": (
        "DIRECT against RECYCLED",
        "CPU seconds of linear algebra per Newton iteration over the unknowns",
    ),
    "performance_kernels": (
        "Stress update alone, microseconds of CPU per point",
        "cost of a stress update over the number of points",
    ),
    "performance_roofline": (
        "Roofline of the stress update, one thread",
        "the stress update under the roofs of the machine",
    ),
}
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MARKS = "osD^vP*"


def draw_plots(found: dict, cases: Sequence[Case], folder: Path) -> None:
    """Draws all figures for which there is something; earlier ones of the others disappear."""
    draws = {
        "performance_parts": draw_parts,
        "performance_solvers": draw_solvers,
        "performance_kernels": draw_kernels,
        "performance_roofline": draw_roofline,
    }
    for name, draw in draws.items():
        path = folder / f"{name}.png"
        path.unlink(missing_ok=True)
        figure = Figure(figsize=(7.0, 4.6), layout="constrained")
        axes = figure.add_subplot()
        if draw(axes, found, cases):
            axes.grid(which="major", color="0.9")
            axes.set_axisbelow(True)
            figure.savefig(path, dpi=110, metadata={"Software": None})


def logarithmic(axes: Axes, across: str, up: str) -> None:
    """Both axes logarithmic, with their labels."""
    axes.set(xscale="log", yscale="log", xlabel=across, ylabel=up)


def mark_sizes(axes: Axes, sizes: Sequence[float]) -> None:
    """Marks at the sizes that were run, instead of powers of ten."""
    axes.xaxis.set_minor_locator(NullLocator())
    axes.set_xticks(sizes, [f"{size:,.0f}" for size in sizes])


def draw_parts(axes: Axes, found: dict, cases: Sequence[Case]) -> bool:
    """Cost per iteration of each part."""
    series = series_of(found, cases, key_of(main_solver(found["solvers"]), 1))
    if len(series) < 2:
        return False
    unknowns = [median(runs, "unknowns") for _, runs in series]
    for part, colour, mark in zip(PARTS, COLOURS, MARKS):
        costs = costs_of(series, part)
        label = f"{part} (per {unit_of(part)[:-1]}), exponent {growth(unknowns, costs):.2f}"
        axes.plot(unknowns, costs, color=colour, marker=mark, label=label)
    logarithmic(axes, "unknowns", "CPU seconds")
    mark_sizes(axes, unknowns)
    axes.legend(fontsize=8)
    return True


def draw_solvers(axes: Axes, found: dict, cases: Sequence[Case]) -> bool:
    """Linear algebra of all solvers there are."""
    drawn = False
    for solver, colour, mark in zip(found["solvers"], COLOURS, MARKS):
        series = series_of(found, cases, key_of(solver, 1))
        if len(series) < 2 or len(found["solvers"]) < 2:
            continue
        unknowns = [median(runs, "unknowns") for _, runs in series]
        costs = [
            float(np.median([linear_seconds(run) / max(1, run["iterations"]) for run in runs]))
            for _, runs in series
        ]
        label = f"{solver}, exponent {growth(unknowns, costs):.2f}"
        axes.plot(unknowns, costs, color=colour, marker=mark, label=label)
        drawn = True
    logarithmic(axes, "unknowns", "CPU seconds per iteration")
    if drawn:
        mark_sizes(axes, unknowns)
        axes.legend()
    return drawn


def draw_kernels(axes: Axes, found: dict, _: Sequence[Case]) -> bool:
    """Both kernels, elastic and plastic."""
    if not found["kernel"]:
        return False
    table = kernel_table(found["kernel"]["1"])
    for kind, colour in zip(FLOPS, COLOURS):
        for way, mark, line in zip(WAYS, MARKS, ("-", "--")):
            pairs = sorted((n, c) for (k, w, n), c in table.items() if (k, w) == (kind, way))
            axes.plot(*zip(*pairs), line, color=colour, marker=mark, label=f"{kind}, {way}")
    axes.set(xscale="log", xlabel="points", ylabel="microseconds of CPU per point")
    axes.set_ylim(0.0, 1.1 * max(table.values()))
    axes.legend()
    return True


def draw_roofline(axes: Axes, found: dict, _: Sequence[Case]) -> bool:
    """Rates over operations per byte, under the peak and the memory of the machine."""
    if not found["kernel"]:
        return False
    runs = found["kernel"]["1"]
    peak, triad = median(runs, "peak_gflops"), median(runs, "triad_gbytes")
    intensity = np.array([0.1, peak / triad, 100.0])
    roof = np.minimum(peak, triad * intensity)
    axes.plot(intensity, roof, color="0.3", label=f"{triad:.1f} GB/s, {peak:.0f} GFLOP/s")
    for row in roofline(runs):
        colour = COLOURS[list(FLOPS).index(row["kind"])]
        filled = colour if row["way"] == WAYS[0] else "none"
        axes.plot(
            row["intensity"], row["gflops"], MARKS[list(FLOPS).index(row["kind"])],
            color=colour, markerfacecolor=filled, label=f"{row['kind']}, {row['way']}",
        )  # fmt: skip
    logarithmic(axes, "operations per byte", "GFLOP/s")
    axes.set_xlim(0.1, 100.0)
    axes.set_ylim(0.5, 2.0 * peak)
    axes.legend(loc="upper left")
    return True
