"""Pictures of points, elements or mesh coloured by a field; several jobs share one scale."""

import argparse
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from tessera_post.body import Clip, Frame, Layer, make_layers
from tessera_post.cli import wrote
from tessera_post.errors import PostError
from tessera_post.fields import Quantity, parse
from tessera_post.job import Job, check_units, labels_of
from tessera_post.output import finite, open_for_drawing
from tessera_post.panels import Panel, Sheet, compose, pixels_of
from tessera_post.scene import Renderer, find_view, find_window
from tessera_post.style import make_scale, save

EXAMPLE = """\
  tessera-post picture footing_standard footing_fbar --field pressure --as elements \\
    --view x- --clip 'y<1.6' --clip 'z>3.4'
"""
WHAT = ("points", "elements", "mesh")
MOST_ENLARGED = 1e6
PREFERRED = ("S:pressure", "PEEQ", "U", "J")


@dataclass(frozen=True)
class PictureOptions:
    """What a picture shows; the defaults are those of the command line."""

    field: str | None = None  # None: the first of pressure, PEEQ, U, J, or whatever is there
    what: str = "points"
    increment: int | None = None
    time: float | None = None
    view: str | None = None
    clips: Sequence[Clip] = ()
    limits: tuple[float, float] | None = None
    warp: float = 1.0
    zoom: float = 1.0
    title: str = ""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", nargs="+", metavar="JOB", help="job, deck or result file")
    add_when(parser)
    add_look(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="PNG file")


def add_when(parser: argparse.ArgumentParser) -> None:
    """Which output is drawn."""
    when = parser.add_mutually_exclusive_group()
    when.add_argument(
        "--increment",
        type=int,
        metavar="N",
        help="counted over all steps, 0 before loading, -1 the last (default)",
    )
    when.add_argument("--time", type=float, metavar="T", help="total time")


def add_look(parser: argparse.ArgumentParser) -> None:
    """Options of everything that draws bodies."""
    parser.add_argument(
        "--field",
        metavar="NAME",
        help="S11, TAU33, S:mises, pressure, norm, PEEQ, JBAR, U, U3, PATCH, ...; with --as mesh"
        " J, JPATCH, NPOINTS, RF, ... (default: pressure, PEEQ or U, what is there)",
    )
    parser.add_argument(
        "--as",
        dest="what",
        choices=WHAT,
        default="points",
        help="points: spheres as large as their volumes; elements: those that hold points, coloured"
        " by the mean of their points; mesh: the background mesh (default: points)",
    )
    parser.add_argument(
        "--view",
        metavar="VIEW",
        help="iso, x, y, z (from that side; y from the front), x-, y-, z- (from the other side), or"
        " a direction to the camera such as --view=-1,-1,0.6 (default: iso, 2-D z)",
    )
    parser.add_argument(
        "--clip",
        action="append",
        default=[],
        metavar="PLANE",
        help="keep one side of a plane: 'x<0.5', 'z>3' or, with a normal, '1,1,0<2'; repeatable",
    )
    parser.add_argument(
        "--range",
        nargs=2,
        type=finite,
        metavar=("MIN", "MAX"),
        help="ends of the colour scale (default: of all values of all jobs)",
    )
    parser.add_argument(
        "--warp", type=finite, default=1.0, metavar="F", help="enlarge displacements F times"
    )
    parser.add_argument("--zoom", type=finite, default=1.0, metavar="F", help="larger than to fit")
    parser.add_argument("--title", default="", help="above the picture")


def run(options: argparse.Namespace) -> int:
    """Draws the picture."""
    jobs, path = open_for_drawing(options, "_picture.png")
    figure = draw(jobs, options_of(options))
    save(figure, path)
    wrote(path)
    return 0


def options_of(options: argparse.Namespace) -> PictureOptions:
    """From the command line."""
    for name in ("warp", "zoom"):
        if not 0.0 < getattr(options, name) <= MOST_ENLARGED:
            raise PostError(f"--{name}: expected a number above 0, at most {MOST_ENLARGED:g}")
    return PictureOptions(
        field=options.field,
        what=options.what,
        increment=getattr(options, "increment", None),
        time=getattr(options, "time", None),
        view=options.view,
        clips=[parse_clip(text) for text in options.clip],
        limits=parse_limits(options.range),
        warp=options.warp,
        zoom=options.zoom,
        title=options.title,
    )


def parse_limits(limits: list[float] | None) -> tuple[float, float] | None:
    """Ends of the colour scale."""
    if limits is None:
        return None
    if not limits[0] < limits[1]:
        raise PostError(f"--range: expected MIN below MAX, found {limits[0]:g} and {limits[1]:g}")
    return limits[0], limits[1]


def parse_clip(text: str) -> Clip:
    """A plane and the side that is kept."""
    found = re.fullmatch(r"\s*(?P<normal>[^<>]+?)\s*(?P<sign>[<>])=?\s*(?P<offset>\S+)\s*", text)
    try:
        if found is None:
            raise ValueError
        name = found["normal"].lower()
        if name in ("x", "y", "z"):
            normal = [float(axis == name) for axis in "xyz"]
        else:
            normal = [float(number) for number in name.split(",")]
        offset = float(found["offset"])
        if len(normal) != 3 or not any(normal) or not np.isfinite([*normal, offset]).all():
            raise ValueError
    except ValueError:
        raise PostError(
            f"--clip: expected a plane such as 'x<0.5' or '1,1,0<2', found '{text}'"
        ) from None
    sign = 1.0 if found["sign"] == "<" else -1.0
    x, y, z = (sign * number for number in normal)
    return Clip((x, y, z), sign * offset)


def find_field(jobs: Sequence[Job], options: PictureOptions) -> Quantity:
    """The quantity to draw, one that all jobs have, in the same unit."""
    if options.what == "mesh":
        found = [job.mesh_quantity(options.field or "J") for job in jobs]
    elif options.field:
        found = [job.quantity(options.field) for job in jobs]
    else:
        found = [default_field(jobs)]
    check_units(jobs, [found[0].dimension])
    return found[0]


def default_field(jobs: Sequence[Job]) -> Quantity:
    """The first quantity that is worth seeing and that all jobs have."""
    fields = [job.points.point_fields for job in jobs]
    for name in (*PREFERRED, *fields[0]):
        quantity = parse(name)
        if quantity is not None and all(quantity.field in there for there in fields):
            return quantity
    raise PostError(f"'{jobs[0].path.name}' has no field to draw that all jobs have")


def frames_of(jobs: Sequence[Job], options: PictureOptions) -> list[Frame]:
    """The output of each job."""
    return [
        Frame(job, job.output_of(options.increment, options.time), options.warp, options.clips)
        for job in jobs
    ]


def title_of(frame: Frame, label: str) -> str:
    """Label of the job, increment and time of an output."""
    job, output = frame.job, frame.output
    when = f"increment {job.increments[output]}, time {job.points.times[output]:g}"
    if frame.warp != 1.0:
        when += f", displacements \N{MULTIPLICATION SIGN} {frame.warp:g}"
    return f"{label}\n{when}"


def draw(jobs: Sequence[Job], options: PictureOptions) -> Figure:
    """The picture: one panel per job, one colour scale."""
    return draw_frames([frames_of(jobs, options)], options)


def draw_frames(rows: Sequence[Sequence[Frame]], options: PictureOptions) -> Figure:
    """A picture of rows of frames with one scale, one camera and one size."""
    frames = [frame for row in rows for frame in row]
    jobs = list(dict.fromkeys(frame.job for frame in frames))
    check_units(jobs, ["length"])
    quantity = find_field(jobs, options)
    label = dict(zip(jobs, labels_of(jobs)))
    layers = [[make_layers(frame, options.what, quantity) for frame in row] for row in rows]
    drawn = [stack for row in layers for stack in row]
    values = [stack[0].values for stack in drawn]
    scale = make_scale(quantity, [v for v in values if v is not None], options.limits)
    view = find_view(options.view, frames[0].job.n_dim)
    window = find_window([layer.data for stack in drawn for layer in shown_fully(stack)], view)
    window = window.zoomed(options.zoom)
    sheet = Sheet(
        *(view, window, frames[0].job.units, quantity, scale),
        title=options.title,
        categories=categories_of(quantity, values),
    )
    renderer = Renderer(view, window, pixels_of(window, max(len(row) for row in rows)))
    panels = [
        [
            Panel(title_of(frame, label[frame.job]), renderer.draw(stack, quantity, scale))
            for frame, stack in zip(row, row_layers)
        ]
        for row, row_layers in zip(rows, layers)
    ]
    renderer.close()
    return compose(panels, sheet)


def categories_of(quantity: Quantity, values: Sequence[np.ndarray | None]) -> tuple[int, ...]:
    """Numbers of things for the legend; none for other quantities."""
    if not quantity.is_category:
        return ()
    there = np.concatenate([np.empty(0), *(v for v in values if v is not None)])
    return tuple(int(v) for v in np.unique(there[np.isfinite(there)]))


def shown_fully(stack: Sequence[Layer]) -> Sequence[Layer]:
    """The layers that the window must hold: all that have points."""
    return [layer for layer in stack if layer.data.n_points > 0]
