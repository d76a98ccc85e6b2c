"""A field of all points against time or increment, with its mean, extremes and scatter."""

import argparse
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tessera_post.cli import wrote
from tessera_post.curve import number
from tessera_post.fields import Quantity
from tessera_post.job import Job, labels_of
from tessera_post.output import finite, open_for_drawing
from tessera_post.picture import PictureOptions, find_field, parse_limits
from tessera_post.style import COLORS, colors_of, plt, save, shown

EXAMPLE = """\
  tessera-post scatter stretch_standard stretch_fbar --field TAU33 --exact 400 "yield stress"
"""
MOST_DOTS = 1500  # points drawn per output; the statistics are those of all


@dataclass(frozen=True)
class Scatter:
    """A field over the outputs of a job; all arrays (n_outputs) but the dots."""

    label: str
    x: np.ndarray  # increment or time
    dots: list[np.ndarray]  # values of the points that are drawn, per output
    low: np.ndarray
    mean: np.ndarray
    high: np.ndarray
    deviation: np.ndarray  # standard deviation, over the number of points


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", nargs="+", metavar="JOB", help="job, deck or result file")
    parser.add_argument(
        "--field",
        metavar="NAME",
        help="S11, TAU33, S:mises, pressure, PEEQ, JBAR, ... (default: pressure, PEEQ or U)",
    )
    parser.add_argument(
        "--against", choices=("increment", "time"), default="increment", help="the x axis"
    )
    parser.add_argument(
        "--exact",
        nargs=2,
        action="append",
        default=[],
        metavar=("VALUE", "LABEL"),
        help="horizontal line of the exact value; may be repeated",
    )
    parser.add_argument(
        "--range", nargs=2, type=finite, metavar=("MIN", "MAX"), help="ends of the y axis"
    )
    parser.add_argument("--title", default="", help="above the picture")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="PNG, PDF or SVG")


def run(options: argparse.Namespace) -> int:
    """Draws the scatter and prints the statistics of the last output."""
    jobs, path = open_for_drawing(options, "_scatter.png")
    limits = parse_limits(options.range)
    exact = [(number(value, "--exact"), label) for value, label in options.exact]
    quantity = find_field(jobs, PictureOptions(field=options.field))
    scatters = [
        collect(job, quantity, label, options.against) for job, label in zip(jobs, labels_of(jobs))
    ]
    axis = jobs[0].units.axis(quantity.label, quantity.dimension)
    figure = draw(scatters, f"{options.against} [-]", axis, exact)
    if limits:
        figure.axes[0].set_ylim(*limits)
    if options.title:
        figure.suptitle(options.title)
    save(figure, path)
    for scatter in scatters:
        print(describe(scatter, jobs[0].units.of(quantity.dimension)))
    wrote(path)
    return 0


def collect(job: Job, quantity: Quantity, label: str, against: str = "increment") -> Scatter:
    """Values and statistics, read one output at a time."""
    dots, rows = [], []
    for output in range(job.points.n_steps):
        values = job.values(quantity, output)
        if len(values) == 0:
            dots.append(values)
            rows.append([np.nan] * 4)
            continue
        every = -(-len(values) // MOST_DOTS)
        dots.append(values[::every])
        rows.append([values.min(), values.mean(), values.max(), values.std()])
    low, mean, high, deviation = np.array(rows).T
    x = job.increments if against == "increment" else job.points.times
    return Scatter(label, np.asarray(x, dtype=float), dots, low, mean, high, deviation)


def draw(
    scatters: Sequence[Scatter], x_axis: str, y_axis: str, exact: Sequence[tuple[float, str]]
) -> Figure:
    """One panel per job with a common y axis."""
    n = len(scatters)
    figure, grid = plt.subplots(
        1, n, figsize=(min(7.0, 2.0 + 4.6 * n) if n == 1 else 4.9 * n, 4.6), squeeze=False
    )
    for axes, color, scatter in zip(grid[0], colors_of([s.label for s in scatters]), scatters):
        axes.sharey(grid[0, 0])
        draw_one(axes, scatter, color)
        for i, (value, text) in enumerate(exact):
            style = ("-", "--", ":")[i % 3]
            axes.axhline(value, color=COLORS[-1], linestyle=style, linewidth=1.0, label=shown(text))
        axes.set(xlabel=x_axis, title=scatter.label)
        axes.xaxis.get_major_locator().set_params(integer="increment" in x_axis)
    grid[0, 0].set_ylabel(y_axis)
    handles, names = grid[0, 0].get_legend_handles_labels()
    if n > 1:
        handles = [in_grey(handle) for handle in handles]
    figure.legend(handles, names, loc="outside lower center", ncols=len(names))
    return figure


def in_grey(handle: Artist) -> Artist:
    """An entry of the legend that stands for the colours of all panels."""
    grey = copy(handle)
    if grey.get_label() in ("mean", "min, max", "standard deviation"):
        grey.set_color("0.35")
    return grey


def draw_one(axes: Axes, scatter: Scatter, color: str) -> None:
    """Dots, band of one standard deviation, mean and extremes."""
    x = np.concatenate([np.full(len(d), at) for at, d in zip(scatter.x, scatter.dots)])
    axes.plot(
        x, np.concatenate(scatter.dots), ".", color="0.6", markersize=2, label="points", zorder=1
    ).pop().set_rasterized(True)
    axes.fill_between(
        scatter.x,
        scatter.mean - scatter.deviation,
        scatter.mean + scatter.deviation,
        color=color,
        alpha=0.3,
        linewidth=0,
        label="standard deviation",
    )
    axes.plot(scatter.x, scatter.mean, "o-", color=color, markersize=4, label="mean")
    for values, label in ((scatter.low, "min, max"), (scatter.high, None)):
        axes.plot(scatter.x, values, "--", color=color, linewidth=1.0, label=label)


def describe(scatter: Scatter, unit: str) -> str:
    """Statistics of the last output that has points."""
    there = np.flatnonzero(np.isfinite(scatter.mean))
    if len(there) == 0:
        return f"{scatter.label}: no points"
    low, mean, high, deviation = (
        values[there[-1]] for values in (scatter.low, scatter.mean, scatter.high, scatter.deviation)
    )
    when = "at the end" if there[-1] == len(scatter.mean) - 1 else f"at {scatter.x[there[-1]]:g}"
    return (
        f"{scatter.label}: {when} mean {mean:.6g}, standard deviation {deviation:.4g},"
        f" min {low:.6g}, max {high:.6g} {unit}"
    )
