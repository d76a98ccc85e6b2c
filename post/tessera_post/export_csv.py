"""export JOB csv: the fields of one output as a table."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TextIO

import numpy as np

from tessera_post.cli import tell, wrote
from tessera_post.components import component_names
from tessera_post.errors import PostError, one_of
from tessera_post.export_files import Batch, refuse_existing
from tessera_post.fields import find_quantity, quantities_of
from tessera_post.job import SAME_TIME, Job
from tessera_post.series import Series

STDOUT = Path("-")
NUMBER_OF = {"points": "ID", "nodes": "NODE", "elements": "ELEMENT"}
Columns = dict[str, np.ndarray]


def export_csv(job: Job, options: argparse.Namespace) -> None:
    """Writes fields of the points, the nodes or the elements at one output."""
    tell(job.notes)
    what = options.mesh or "points"
    series = job.points if what == "points" else job.need_mesh()
    output = output_of(job, series, options)
    columns = place_columns(series, what, output)
    for name, values in field_columns(series, what, output, options.field).items():
        columns.setdefault(name, values)
    comments = comment_lines(job, what, float(series.times[output]))
    if options.output == STDOUT:
        write_table(sys.stdout, comments, columns)
        return
    increment = job.increment_at(float(series.times[output]))
    path = options.output or job.folder / f"{job.name}_{what}_{increment:04d}.csv"
    refuse_existing([path], options.force)
    with Batch() as batch, batch.open_name(path).open("w", encoding="utf-8") as file:
        write_table(file, comments, columns)
    wrote(path)


def output_of(job: Job, series: Series, options: argparse.Namespace) -> int:
    """The output of a series that is asked for, by default its last one."""
    if options.increment is None and options.time is None:
        return series.n_steps - 1
    output = job.output_of(options.increment, options.time)
    if series is job.points:
        return output
    time = job.points.times[output]
    nearest = int(np.abs(series.times - time).argmin())
    if abs(series.times[nearest] - time) > SAME_TIME * max(float(job.points.times[-1]), 1e-300):
        raise PostError(
            f"'{series.path.name}' has no output at time {time:g}: there are"
            f" {one_of([f'{value:g}' for value in series.times])}"
        )
    return nearest


def place_columns(series: Series, what: str, output: int) -> Columns:
    """Number and position of every row; the middle of an element."""
    places = series.points(output)
    if what == "points":
        numbers = series.field("ID", output)
    else:
        if what == "elements":
            places = places[series.cells(output)].mean(axis=1)
        numbers = np.arange(1, len(places) + 1)
    return {NUMBER_OF[what]: numbers} | dict(zip("xyz", places.T))


def field_columns(series: Series, what: str, output: int, asked: str | None) -> Columns:
    """The columns of the fields that are asked for, by default of all of them."""
    there = series.cell_fields if what == "elements" else series.point_fields
    names = there if asked is None else [name for name in asked.split(",") if name.strip()]
    if not names:
        raise PostError(f"--field names no field: there are {one_of(quantities_of(there), 60)}")
    where = f"'{series.path.name}'" + ("" if what == "points" else f" on {what}")
    columns: Columns = {}
    for text in names:
        name = text.strip().upper()
        if name in there:
            values = series.field(name, output)
            values = values[:, None] if values.ndim == 1 else values
            components = component_names(name, values.shape[1])
            columns |= {name + end: values[:, i] for i, end in enumerate(components)}
        else:
            quantity = find_quantity(text, there, where)
            columns[quantity.name] = quantity.evaluate(series.field(quantity.field, output))
    return columns


def comment_lines(job: Job, what: str, time: float) -> list[str]:
    """What the table is, for people and for scripts that skip `#`."""
    units = ", ".join(f"{name} {job.units.of(name)}" for name in ("length", "force", "stress"))
    return [
        f"# job {job.name}, deck {job.deck_name}, {job.formulation}",
        f"# {job.heading}",
        f"# units: {units}" if job.text("units") else "# units: not stated by the deck",
        f"# {what} at time {time!r}, increment {job.increment_at(time)}",
    ]


def write_table(file: TextIO, comments: list[str], columns: Columns) -> None:
    """Writes numbers so that reading them back gives the same ones."""
    file.writelines(f"{line}\n" for line in comments)
    file.write(",".join(columns) + "\n")
    formats = [format_of(values) for values in columns.values()]
    for row in zip(*(values.tolist() for values in columns.values())):
        file.write(",".join(show(value) for show, value in zip(formats, row)) + "\n")


def format_of(values: np.ndarray) -> Callable[[float], str]:
    """How to write a column: integers as they are, others with 17 significant digits."""
    return str if np.issubdtype(values.dtype, np.integer) else "{:.17g}".format
