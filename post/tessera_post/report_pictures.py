"""Pictures of the report: the body and the scatter of a field, as PNG inside the page."""

import base64
import io
from dataclasses import dataclass

from matplotlib.figure import Figure

from tessera_post import picture, scatter
from tessera_post.body import Frame
from tessera_post.fields import Quantity
from tessera_post.report_plots import capital
from tessera_post.style import plt


@dataclass(frozen=True)
class Picture:
    """A PNG and what it shows."""

    caption: str
    base64: str


def encode(figure: Figure) -> str:
    """A figure as PNG in base64; the figure is freed."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png")
    plt.close(figure)
    return base64.b64encode(stream.getvalue()).decode("ascii")


def make_pictures(frame: Frame, quantity: Quantity) -> list[Picture]:
    """The body at one output, and the field over all outputs."""
    job = frame.job
    options = picture.PictureOptions(field=quantity.name)
    body = picture.draw_frames([[frame]], options)
    values = scatter.collect(job, quantity, job.label)
    axis = job.units.axis(quantity.label, quantity.dimension)
    spread = scatter.draw([values], "increment [-]", axis, [])
    increment, time = job.increments[frame.output], job.points.times[frame.output]
    when = f"increment {increment}, time {time:g}"
    return [
        Picture(f"Material points coloured by {quantity.label}, {when}.", encode(body)),
        Picture(f"{capital(quantity.label)} of the points over the outputs.", encode(spread)),
    ]
