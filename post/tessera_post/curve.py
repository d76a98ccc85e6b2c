"""Curves of the history: any column against time or against another column."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tessera_post.cli import wrote
from tessera_post.columns import Column, default_pair, find_column, partner
from tessera_post.errors import PostError
from tessera_post.job import Job, labels_of
from tessera_post.output import finite, open_for_drawing
from tessera_post.style import COLORS, MARKERS, colors_of, plt, save, shown
from tessera_post.units import conversion

EXAMPLE = """\
  tessera-post curve footing_standard footing_fbar -y 'RF3[FOOTING]' -x 'U3[FOOTING]' \\
    --positive --x-unit mm --line 0.70 "upper bound"
"""
NOTABLE = 1.005  # a larger value on the way, over the last one
STILL_RISING = 0.03  # a curve that gains more over its second half has no limit


@dataclass(frozen=True)
class Curve:
    """One line of the picture; values in the units of the axes."""

    label: str
    x: np.ndarray  # (n)
    y: np.ndarray  # (n)


@dataclass(frozen=True)
class Axis:
    """A coordinate of the picture: which column, in which unit, with which sign."""

    label: str
    unit: str
    sign: float = 1.0
    is_named: bool = False  # by the user

    @property
    def text(self) -> str:
        """For the axis."""
        minus = "\N{MINUS SIGN}" if self.sign < 0.0 and not self.is_named else ""
        return f"{minus}{self.label} [{self.unit}]"


@dataclass(frozen=True)
class Curves:
    """Everything that is drawn."""

    x: Axis
    y: Axis
    curve: list[Curve]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", nargs="+", metavar="JOB", help="job, deck or result file")
    parser.add_argument(
        "-y",
        nargs="+",
        metavar="COLUMN",
        help="history columns, such as RF3[FOOTING]; the set may be left out where only one has it"
        " (default: the largest reaction of the set that moves most)",
    )
    parser.add_argument(
        "-x",
        metavar="COLUMN",
        help="time, increment or a history column (default: the displacement of the same set and"
        " direction, time without one)",
    )
    parser.add_argument(
        "--positive", action="store_true", help="turn the sign of columns that are negative"
    )
    parser.add_argument("--x-unit", metavar="UNIT", help="unit of the x axis, such as mm")
    parser.add_argument("--y-unit", metavar="UNIT", help="unit of the y axis, such as MN")
    parser.add_argument("--x-label", metavar="TEXT", help="in place of the name of the column")
    parser.add_argument("--y-label", metavar="TEXT", help="in place of the name of the column")
    parser.add_argument(
        "--line",
        nargs=2,
        action="append",
        default=[],
        metavar=("VALUE", "LABEL"),
        help="horizontal line, for example an exact limit; may be repeated",
    )
    parser.add_argument(
        "--band",
        nargs=3,
        action="append",
        default=[],
        metavar=("FROM", "TO", "LABEL"),
        help="horizontal band, for example two bounds; may be repeated",
    )
    parser.add_argument("--labels", nargs="+", metavar="TEXT", help="legend, one text per job")
    parser.add_argument("--title", help="default: the heading of the deck, for one job")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="PNG, PDF or SVG")


def run(options: argparse.Namespace) -> int:
    """Draws the curves and says in words what they do."""
    jobs, path = open_for_drawing(options, "_curve.png")
    curves = collect(jobs, options)
    lines = [(number(value, "--line"), label) for value, label in options.line]
    bands = [(number(a, "--band"), number(b, "--band"), label) for a, b, label in options.band]
    figure = draw(curves, lines, bands, title_of(jobs, options))
    save(figure, path)
    for curve in curves.curve:
        print(describe(curve, curves))
    wrote(path)
    return 0


def title_of(jobs: Sequence[Job], options: argparse.Namespace) -> str:
    """The heading of the deck, which may name one formulation, does for one job only."""
    if options.title is not None:
        return options.title
    return jobs[0].heading if len(jobs) == 1 else ""


def number(text: str, option: str) -> float:
    """A number of an option that takes a text as well."""
    try:
        return finite(text)
    except argparse.ArgumentTypeError as problem:
        raise PostError(f"{option}: {problem}") from None


def collect(jobs: Sequence[Job], options: argparse.Namespace) -> Curves:
    """The curves that the options ask for."""
    names_y = options.y or [default_pair(jobs[0])[1]]
    name_x = options.x or default_x(jobs[0], names_y[0])
    columns_y = [[find_column(job, name) for name in names_y] for job in jobs]
    columns_x = [find_column(job, name_x) for job in jobs]
    dimensions = {column.dimension for column in columns_y[0]}
    if len(dimensions) > 1:
        raise PostError(f"-y: expected columns of one unit, found {', '.join(sorted(dimensions))}")
    x = make_axis(jobs[0], columns_x[0], options.x_unit, options.positive)
    y = make_axis(jobs[0], columns_y[0][0], options.y_unit, options.positive)
    if len(names_y) > 1:
        y = replace(y, label=", ".join(dict.fromkeys(c.generic for c in columns_y[0])))
    x, y = named(x, options.x_label), named(y, options.y_label)
    curves = []
    for job, label, column_x, of_job in zip(jobs, legend_of(jobs, options), columns_x, columns_y):
        for column in of_job:
            name = f"{label}: {column.name}" if len(of_job) > 1 else label
            values = scaled(job, column_x, x), scaled(job, column, y)
            curves.append(Curve(name, *values))
    return Curves(x, y, curves)


def named(axis: Axis, label: str | None) -> Axis:
    """An axis with the text of the user, which knows about the sign."""
    return axis if label is None else replace(axis, label=label, is_named=True)


def default_x(job: Job, name_y: str) -> str:
    """The displacement that belongs to a force, if the history has it and it moves; else time."""
    name = partner(find_column(job, name_y).name)
    if name != name_y and np.abs(job.history.get(name, np.zeros(1))).max(initial=0.0) > 0.0:
        return name
    return "time"


def legend_of(jobs: Sequence[Job], options: argparse.Namespace) -> list[str]:
    """One label per job: those of the user, else the formulations."""
    if options.labels is None:
        return labels_of(jobs)
    if len(options.labels) != len(jobs):
        raise PostError(f"--labels: expected {len(jobs)} texts, found {len(options.labels)}")
    return options.labels


def make_axis(job: Job, column: Column, unit: str | None, positive: bool) -> Axis:
    """An axis for a column of the first job; its sign makes the largest value positive."""
    sign = 1.0
    if positive and len(column.values):
        largest = column.values[np.abs(column.values).argmax()]
        sign = -1.0 if largest < 0.0 else 1.0
    return Axis(column.label, unit or job.units.of(column.dimension), sign)


def scaled(job: Job, column: Column, axis: Axis) -> np.ndarray:
    """Values of a column in the unit and with the sign of the axis."""
    unit = job.units.of(column.dimension)
    factor = 1.0 if unit == axis.unit else conversion(unit, axis.unit)
    if factor is None:
        raise PostError(f"'{job.name}' has {column.name} in '{unit}': no way to '{axis.unit}'")
    return axis.sign * factor * column.values


def draw(
    curves: Curves,
    lines: Sequence[tuple[float, str]],
    bands: Sequence[tuple[float, float, str]],
    title: str,
) -> Figure:
    """The picture."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for low, high, label in bands:
        axes.axhspan(low, high, color="0.87", zorder=0, label=shown(label))
    colors = colors_of([curve.label for curve in curves.curve])
    for i, (curve, color) in enumerate(zip(curves.curve, colors)):
        marker = MARKERS[i % len(MARKERS)] if len(curve.x) <= 80 else ""
        size = 4 if len(curve.x) > 1 else 8
        axes.plot(
            curve.x, curve.y, color=color, marker=marker, markersize=size, label=shown(curve.label)
        )
    for i, (value, label) in enumerate(lines):
        style = ("--", "-.", ":")[i % 3]
        axes.axhline(value, color=COLORS[-1], linestyle=style, linewidth=1.3, label=shown(label))
    axes.set(xlabel=curves.x.text, ylabel=curves.y.text, title=title)
    axes.margins(y=0.08)
    axes.ticklabel_format(scilimits=(-2, 5))
    axes.locator_params(nbins=7)
    axes.legend(loc="best")
    return figure


def describe(curve: Curve, curves: Curves) -> str:
    """Largest and last value, and whether it has come to a limit."""
    if len(curve.y) == 0:
        return f"{curve.label}: no increment yet"
    x, y = curve.x, curve.y
    last = f"{y[-1]:.4g} {curves.y.unit} at {x[-1]:.4g} {curves.x.unit}"
    extreme = int(np.abs(y).argmax())
    text = f"{curve.label}: {last}"
    if abs(y[extreme]) > NOTABLE * abs(y[-1]):
        text += f", extreme {y[extreme]:.4g} at {x[extreme]:.4g}"
    half = value_at_half(x, y)
    if half is not None and half != 0.0:
        rise = y[-1] / half - 1.0
        verdict = "still rising" if rise > STILL_RISING else "levelled off"
        if rise < -STILL_RISING:
            verdict = "falling"
        text += f", {verdict} ({rise:+.1%} over the second half)"
    return text


def value_at_half(x: np.ndarray, y: np.ndarray) -> float | None:
    """The curve at half of its last x; None when x does not go one way."""
    if len(x) < 3 or x[-1] == 0.0:
        return None
    towards = x / x[-1]
    if np.any(np.diff(towards) <= 0.0):
        return None
    return float(np.interp(0.5, towards, y))
