"""The view of the report that can be turned: surface of the elements, points, outline."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go

from tessera_post.body import Frame, Layer, elements, outline
from tessera_post.fields import Quantity
from tessera_post.report_plots import FONT, INK, Plot, capital, safe
from tessera_post.style import ColorScale, category_shades, make_scale

MOST_POINTS = 60_000
N_SHADES = 33
MOST_TICKS = 7  # of the longest axis
SIDE = 560  # height of the view [px]
EYE = {"x": 1.25, "y": -1.75, "z": 1.05}
DIAGONAL = 1.6  # of the box in the view, where the camera stands at a distance of 2.4
FLAT_WIDTH, FLAT_HEIGHT = 3.2, 1.45  # largest sides in the view from above
LIGHT = {"ambient": 0.88, "diffuse": 0.2, "specular": 0.0, "roughness": 1.0, "fresnel": 0.0}


@dataclass(frozen=True)
class Body:
    """What the view shows of an output."""

    frame: Frame
    quantity: Quantity
    points: np.ndarray  # (n, 3) of those that are drawn
    values: np.ndarray  # (n) their values
    n_all: int  # points there are
    surface: Layer | None  # None without the mesh
    outline: Layer | None


def make_body(frame: Frame, quantity: Quantity) -> Body:
    """Reads one output, and thins out its points."""
    job = frame.job
    x, values = job.points.points(frame.output), job.values(quantity, frame.output)
    keep = np.arange(len(x))
    if len(x) > MOST_POINTS:
        keep = np.linspace(0, len(x) - 1, MOST_POINTS).astype(int)
    surface = edges = None
    if job.mesh is not None:
        surface, edges = elements(frame, quantity), outline(frame)
        if surface.data.n_points == 0:
            surface = None
    return Body(frame, quantity, x[keep], values[keep], len(x), surface, edges)


def scene_plot(frame: Frame, quantity: Quantity) -> Plot:
    """The view with its buttons."""
    body = make_body(frame, quantity)
    scale = make_scale(quantity, [body.values], None)
    traces: list[object] = []
    if body.surface is not None:
        traces.append(surface_trace(body))
    traces.append(points_trace(body, visible=body.surface is None))
    if body.outline is not None:
        traces.append(outline_trace(body.outline))
    figure = go.Figure(traces)
    figure.update_layout(
        template="none",
        font={"family": FONT, "size": 13, "color": INK},
        margin={"l": 0, "r": 0, "t": 44, "b": 0},
        showlegend=False,
        coloraxis=color_axis(body, scale),
        scene=scene_layout(body),
    )
    if body.surface is not None:
        figure.update_layout(updatemenus=[buttons(len(traces))])
    job, when = frame.job, frame.output
    moment = f"increment {job.increments[when]}, time {job.points.times[when]:g}"
    title = f"{capital(quantity.label)} at {moment}"
    return Plot("view", title, figure, SIDE, note_of(body))


def note_of(body: Body) -> str:
    """What the view leaves out."""
    notes = []
    if len(body.points) < body.n_all:
        notes.append(f"{len(body.points)} of {body.n_all} points are drawn, evenly chosen.")
    if body.surface is None:
        notes.append("Without the mesh file only the points are drawn.")
    else:
        notes.append("Elements that hold points have the mean of their points.")
    return " ".join(notes)


def shades(body: Body, values: np.ndarray) -> np.ndarray:
    """What the colour scale takes: values, or scattered numbers for numbers of things."""
    colors = category_shades(values) if body.quantity.is_category else values
    return colors.astype(np.float32)


def hover(body: Body, variable: str) -> str:
    """Label of a point or face."""
    unit = body.frame.job.units.of(body.quantity.dimension)
    unit = "" if unit == "-" else f" {safe(unit)}"
    return f"{safe(body.quantity.label)} = %{{{variable}:.5~g}}{unit}<extra></extra>"


def surface_trace(body: Body) -> go.Mesh3d:
    """The outer faces of the elements that hold points, each with one colour."""
    assert body.surface is not None
    data = body.surface.data.triangulate()
    faces = data.regular_faces.astype(np.int32)
    x, y, z = np.asarray(data.points, dtype=np.float32).T
    values = np.asarray(data.cell_data["value"])
    return go.Mesh3d(
        x=x,
        y=y,
        z=z,
        i=faces[:, 0],
        j=faces[:, 1],
        k=faces[:, 2],
        intensity=shades(body, values),
        intensitymode="cell",
        coloraxis="coloraxis",
        flatshading=True,
        lighting={**LIGHT, "ambient": 1.0, "diffuse": 0.0} if is_flat(body) else LIGHT,
        hoverinfo="skip",
        name="surface",
    )


def points_trace(body: Body, visible: bool) -> go.Scatter3d:
    """The material points."""
    x, y, z = body.points.astype(np.float32).T
    return go.Scatter3d(
        x=x,
        y=y,
        z=z,
        mode="markers",
        marker={
            "size": marker_size(len(body.points)),
            "color": shades(body, body.values),
            "coloraxis": "coloraxis",
            "line": {"width": 0},
        },
        customdata=body.values.astype(np.float32),
        hovertemplate=hover(body, "customdata"),
        visible=visible,
        name="points",
    )


def marker_size(count: int) -> float:
    """Smaller markers for more points [px]."""
    return float(np.clip(60.0 / max(count, 1) ** 0.32, 2.0, 9.0))


def outline_trace(layer: Layer) -> go.Scatter3d:
    """The edges of the mesh as one broken line."""
    lines = np.asarray(layer.data.lines).reshape(-1, 3)[:, 1:]
    ends = np.asarray(layer.data.points, dtype=np.float32)[lines]
    gap = np.full((len(ends), 1, 3), np.nan, dtype=np.float32)
    x, y, z = np.concatenate([ends, gap], axis=1).reshape(-1, 3).T
    line = {"color": INK, "width": 3}
    return go.Scatter3d(
        x=x, y=y, z=z, mode="lines", line=line, hoverinfo="skip", name="outline of the mesh"
    )


def is_flat(body: Body) -> bool:
    """Whether the job is in plane strain."""
    return body.frame.job.n_dim == 2


def color_axis(body: Body, scale: ColorScale) -> dict[str, object]:
    """Colour scale and bar; numbers of things have no bar."""
    stops = np.linspace(0.0, 1.0, N_SHADES)
    rgb = (np.asarray(scale.cmap(stops))[:, :3] * 255.0).round().astype(int)
    colors = [[float(stop), f"rgb({r},{g},{b})"] for stop, (r, g, b) in zip(stops, rgb)]
    units, quantity = body.frame.job.units, body.quantity
    text = safe(units.axis(quantity.label, quantity.dimension))
    bar = {
        "title": {"text": text, "side": "right"},
        "thickness": 16,
        "len": 0.8,
        "outlinewidth": 0,
        "exponentformat": "power",
    }
    return {
        "colorscale": colors,
        "cmin": scale.low,
        "cmax": scale.high,
        "colorbar": bar,
        "showscale": not quantity.is_category,
    }


def scene_layout(body: Body) -> dict[str, object]:
    """Axes with units and one scale, and the camera: aslant, in 2-D from above and parallel."""
    unit = body.frame.job.units.of("length")
    low, high = box(body)
    sides = high - low
    look = {"backgroundcolor": "white", "gridcolor": "#d9d9d9", "zeroline": False}
    axes = {}
    for i, name in enumerate("xyz"):
        ticks = max(2, round(MOST_TICKS * float(sides[i] / sides.max())))
        title = {"text": f"{name} [{unit}]"}  # drawn in WebGL, which knows no entities
        ends = [float(low[i]), float(high[i])]
        axes[f"{name}axis"] = {"title": title, "range": ends, "nticks": ticks, **look}
    camera: dict[str, object] = {"eye": EYE, "up": {"x": 0, "y": 0, "z": 1}}
    ratio = sides * DIAGONAL / np.linalg.norm(sides)
    if is_flat(body):
        axes["xaxis"]["tickangle"] = axes["yaxis"]["tickangle"] = 0
        axes["zaxis"]["visible"] = False
        camera = {"eye": {"x": 0, "y": 0, "z": 2}, "up": {"x": 0, "y": 1, "z": 0}}
        camera["projection"] = {"type": "orthographic"}
        ratio = sides * min(FLAT_WIDTH / sides[0], FLAT_HEIGHT / sides[1])
    return {
        **axes,
        "aspectmode": "manual",
        "aspectratio": dict(zip("xyz", ratio.tolist())),
        "camera": camera,
        "dragmode": "pan" if is_flat(body) else "turntable",
    }


def box(body: Body) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner of what is drawn, with a margin [length]."""
    seen = [body.points]
    seen += [np.asarray(layer.data.points) for layer in (body.surface, body.outline) if layer]
    x = np.concatenate(seen) if sum(map(len, seen)) else np.zeros((1, 3))
    low, high = x.min(axis=0), x.max(axis=0)
    margin = 0.02 * max(float((high - low).max()), 1e-30)
    return low - margin, high + margin


def buttons(n_traces: int) -> dict[str, object]:
    """Buttons that switch between surface and points; the outline stays."""
    rest: Sequence[bool] = [True] * (n_traces - 2)
    return {
        "type": "buttons",
        "direction": "right",
        "x": 0.0,
        "y": 1.0,
        "xanchor": "left",
        "yanchor": "bottom",
        "pad": {"b": 6},
        "showactive": True,
        "buttons": [
            {"label": "surface", "method": "restyle", "args": ["visible", [True, False, *rest]]},
            {"label": "points", "method": "restyle", "args": ["visible", [False, True, *rest]]},
        ],
    }
