"""Interactive plots of the report: reaction curve and histories."""

import html
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from tessera_post.columns import COUNTED, Column, column_names, default_pair, find_column
from tessera_post.errors import PostError
from tessera_post.job import Job
from tessera_post.style import COLORS

FONT = '"DejaVu Sans", "Segoe UI", "Helvetica Neue", Arial, sans-serif'
INK = "#1a1a1a"
GRID = "#d9d9d9"
DASHES = ("solid", "dash", "dot", "dashdot")
MOST_MARKERS = 120  # more of them would hide the line
PAGE_WIDTH = 900  # of a legend beside nothing else [px]
LEGEND_LINE, LEGEND_LETTER = 50, 8  # width of an entry: its line, and each letter [px]
DIMENSIONS = {"force": "Forces", "length": "Displacements", "stress": "Stresses"}


@dataclass(frozen=True)
class Plot:
    """A figure of plotly in the page."""

    name: str  # id of its element
    title: str
    figure: go.Figure
    height: int  # [px]
    note: str = ""

    @property
    def json(self) -> str:
        """For a script element: the characters that could end it are written as escapes."""
        text = self.figure.to_json(engine="json")
        return json.dumps(json.loads(text), separators=(",", ":")).translate(JSON_ESCAPES)


JSON_ESCAPES = {ord(c): f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


def safe(text: str) -> str:
    """Text that plotly shows as it is: neither a tag nor a variable of a hover label."""
    return html.escape(text, quote=False).replace("%", "&#37;")


def axis(title: str, **more: object) -> dict[str, object]:
    """An axis with its title, as all plots of the page have it."""
    common = {"title": {"text": safe(title), "standoff": 8}, "automargin": True, "zeroline": False}
    look = {"gridcolor": GRID, "linecolor": INK, "ticks": "outside", "showline": True}
    return {**common, **look, "exponentformat": "power", **more}


def layout(figure: go.Figure, x: dict[str, object], y: dict[str, object]) -> None:
    """Applies the look of the page."""
    figure.update_layout(
        template="none",
        font={"family": FONT, "size": 13, "color": INK},
        xaxis=x,
        yaxis=y,
        margin={"l": 60, "r": 16, "t": 34, "b": 50},
        hoverlabel={"font": {"family": FONT, "size": 13}},
        legend={"orientation": "h", "x": 0.0, "y": 1.02, "yanchor": "bottom"},
        hovermode="closest",
    )


def make_room(figure: go.Figure) -> None:
    """Shows the legend, with room above it for the buttons of the plot."""
    names = [trace.name for trace in figure.data if trace.name and trace.showlegend is not False]
    width = sum(LEGEND_LINE + LEGEND_LETTER * len(name) for name in names)
    rows = 1 + int(width // PAGE_WIDTH)
    figure.update_layout(showlegend=True, margin_t=48 + 22 * rows)


def capital(text: str) -> str:
    """With a capital at the start of a sentence; the rest stays as it is."""
    return text[:1].upper() + text[1:]


def value_line(name: str, variable: str, unit: str) -> str:
    """A line of a hover label."""
    return f"{safe(name)} = %{{{variable}:.6~g}}{'' if unit == '-' else ' ' + safe(unit)}"


def mode_of(values: Sequence[float] | np.ndarray) -> str:
    """Markers as long as they do not hide the line."""
    return "lines+markers" if len(values) <= MOST_MARKERS else "lines"


def column_trace(job: Job, x: Column, y: Column, **look: object) -> go.Scatter:
    """A column over another one; the hover label shows both with units, and the increment."""
    unit_x, unit_y = job.units.of(x.dimension), job.units.of(y.dimension)
    lines = [value_line(y.name, "y", unit_y), value_line(x.name, "x", unit_x)]
    return go.Scatter(
        x=np.asarray(x.values, dtype=float),
        y=np.asarray(y.values, dtype=float),
        customdata=np.arange(len(y.values)),
        mode=mode_of(y.values),
        name=safe(y.name),
        hovertemplate="<br>".join([*lines, "increment %{customdata}"]) + "<extra></extra>",
        **look,
    )


def reaction_plot(job: Job) -> Plot | None:
    """The pair of columns that is worth seeing first; None when the history has no columns."""
    try:
        x, y = (find_column(job, name) for name in default_pair(job))
    except PostError:
        return None
    figure = go.Figure(
        column_trace(job, x, y, line={"color": COLORS[0], "width": 2}, marker={"size": 6})
    )
    layout(
        figure,
        axis(job.units.axis(x.label, x.dimension)),
        axis(job.units.axis(y.label, y.dimension)),
    )
    return Plot("reaction", f"{y.name} over {x.name}", figure, 420)


def history_plots(job: Job) -> list[Plot]:
    """All columns over time, one plot for each unit."""
    columns = [find_column(job, name) for name in column_names(job) if name not in COUNTED]
    time = find_column(job, "time")
    plots = []
    for dimension in dict.fromkeys(column.dimension for column in columns):
        alike = [column for column in columns if column.dimension == dimension]
        title = DIMENSIONS.get(dimension, "Values")
        figure = go.Figure(
            [
                column_trace(job, time, column, line=line_look(i), marker={"size": 5})
                for i, column in enumerate(alike)
            ]
        )
        what = title.lower().removesuffix("es" if title == "Stresses" else "s")
        layout(figure, axis("time [-]"), axis(job.units.axis(what, dimension)))
        make_room(figure)
        plots.append(Plot(f"history-{dimension}", f"{title} over time", figure, 400))
    return plots


def line_look(index: int) -> dict[str, object]:
    """Colour and dashes: one curve on top of another one lets it be seen; the first 28 differ."""
    dash = DASHES[index % len(DASHES)]
    return {"color": COLORS[index % len(COLORS)], "dash": dash, "width": 2}
