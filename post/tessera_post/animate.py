"""MP4 or GIF over the outputs, with one camera and one colour scale throughout."""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import imageio.v3 as iio
import numpy as np
from matplotlib.figure import Figure
from PIL import Image
from tqdm import tqdm

from tessera_post.body import Frame, make_layers
from tessera_post.cli import wrote
from tessera_post.errors import PostError
from tessera_post.job import Job, check_units, labels_of
from tessera_post.output import finite, open_for_drawing
from tessera_post.panels import Panel, Sheet, compose, pixels_of
from tessera_post.picture import (
    PictureOptions,
    add_look,
    categories_of,
    find_field,
    options_of,
    title_of,
)
from tessera_post.scene import Renderer, Window, find_view, find_window
from tessera_post.style import ColorScale, make_scale, plt

EXAMPLE = """\
  tessera-post animate stretch_standard stretch_fbar --field TAU33 -o stretch.mp4
"""
FORMATS = (".mp4", ".gif")
DPI = 110
LEAST_FPS, MOST_FPS = 0.1, 100.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", nargs="+", metavar="JOB", help="job, deck or result file")
    add_look(parser)
    parser.add_argument(
        "--every", type=int, default=1, metavar="N", help="only each N-th output, and the last"
    )
    parser.add_argument(
        "--fps", type=finite, default=5.0, metavar="F", help="pictures per second (default: 5)"
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="no progress bar")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help=".mp4 (default) or .gif")


def run(options: argparse.Namespace) -> int:
    """Makes the film."""
    if options.every < 1:
        raise PostError("--every: expected a whole number above 0")
    if not LEAST_FPS <= options.fps <= MOST_FPS:
        raise PostError(f"--fps: expected a number from {LEAST_FPS:g} to {MOST_FPS:g}")
    jobs, path = open_for_drawing(options, ".mp4", FORMATS)
    film = Film(jobs, options_of(options), options.every)
    bar = tqdm(film.images(), total=len(film), unit="frame", disable=options.quiet)
    write_film(path, bar, options.fps)
    wrote(path)
    return 0


class Film:
    """All frames of the jobs, drawn one after the other."""

    def __init__(self, jobs: Sequence[Job], look: PictureOptions, every: int) -> None:
        self._look = look
        self._rows = rows_of(jobs, look, every)
        check_units(jobs, ["length"])
        self._quantity = find_field(jobs, look)
        self._labels = labels_of(jobs)
        self._view = find_view(look.view, jobs[0].n_dim)
        window, self._scale, self._categories = self._survey()
        self._window = window.zoomed(look.zoom)
        self._units = jobs[0].units

    def __len__(self) -> int:
        """Number of frames."""
        return len(self._rows)

    def _survey(self) -> tuple[Window, ColorScale, tuple[int, ...]]:
        """The window, the colour scale and the numbers of things that hold all frames."""
        windows, ends = [], []
        categories: set[int] = set()
        for row in self._rows:
            for frame in row:
                layers = make_layers(frame, self._look.what, self._quantity)
                bodies = [layer.data for layer in layers if layer.data.n_points > 0]
                windows.append(find_window(bodies, self._view))
                values = layers[0].values
                categories.update(categories_of(self._quantity, [values]))
                if values is not None and np.isfinite(values).any():
                    ends.append(np.array([np.nanmin(values), np.nanmax(values)]))
        scale = make_scale(self._quantity, ends, self._look.limits)
        return union(windows), scale, tuple(sorted(categories))

    def images(self) -> Iterator[np.ndarray]:
        """(height, width, 3) pictures with even sides, as MP4 needs them."""
        pixels = pixels_of(self._window, len(self._rows[0]))
        renderer = Renderer(self._view, self._window, pixels)
        sheet = Sheet(
            *(self._view, self._window, self._units, self._quantity, self._scale),
            title=self._look.title,
            categories=self._categories,
        )
        try:
            for row in self._rows:
                yield image_of(compose([self._panels(row, renderer)], sheet))
        finally:
            renderer.close()

    def _panels(self, row: Sequence[Frame], renderer: Renderer) -> list[Panel]:
        panels = []
        for frame, label in zip(row, self._labels):
            layers = make_layers(frame, self._look.what, self._quantity)
            image = renderer.draw(layers, self._quantity, self._scale)
            panels.append(Panel(title_of(frame, label), image))
        return panels


def rows_of(jobs: Sequence[Job], look: PictureOptions, every: int) -> list[list[Frame]]:
    """Frames of all jobs at the outputs of the first one, nearest in time."""
    n_steps = jobs[0].points.n_steps
    outputs = sorted({*range(0, n_steps, every), n_steps - 1})
    rows = []
    for output in outputs:
        when = jobs[0].points.times[output]
        near = [int(np.abs(job.points.times - when).argmin()) for job in jobs]
        rows.append([Frame(job, i, look.warp, look.clips) for job, i in zip(jobs, near)])
    return rows


def union(windows: Sequence[Window]) -> Window:
    """The smallest window that holds all."""
    return Window(
        min(window.left for window in windows),
        max(window.right for window in windows),
        min(window.bottom for window in windows),
        max(window.top for window in windows),
    )


def image_of(figure: Figure) -> np.ndarray:
    """The pixels of a figure, cut to even sides."""
    figure.set_dpi(DPI)
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy()
    plt.close(figure)
    height, width = (side - side % 2 for side in pixels.shape[:2])
    return pixels[:height, :width]


def write_film(path: Path, images: Iterator[np.ndarray], fps: float) -> None:
    """Writes the frames as they come, to a name beside that is renamed at the end."""
    unfinished = path.with_name(f".{path.stem}.unfinished{path.suffix}")
    try:
        if path.suffix.lower() == ".gif":
            frames = (Image.fromarray(image) for image in images)
            next(frames).save(
                unfinished, save_all=True, append_images=frames, duration=1000.0 / fps, loop=0
            )
        else:
            with iio.imopen(unfinished, "w", plugin="pyav") as film:
                film.init_video_stream("libx264", fps=fps)
                for image in images:
                    film.write_frame(image)
        unfinished.replace(path)
    except OSError as problem:
        raise PostError(f"cannot write '{path}': {problem.strerror or problem}") from problem
    finally:
        unfinished.unlink(missing_ok=True)
