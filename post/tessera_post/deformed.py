"""The body at several increments, side by side in one scale; a row for each job."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tessera_post.body import Frame
from tessera_post.cli import wrote
from tessera_post.errors import PostError
from tessera_post.job import Job
from tessera_post.output import open_for_drawing
from tessera_post.picture import add_look, draw_frames, options_of
from tessera_post.style import save

EXAMPLE = """\
  tessera-post deformed stretch_fbar --increments 0,5,11,17 --field TAU33 --view y
"""
DEFAULT_PANELS = 4


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", nargs="+", metavar="JOB", help="job, deck or result file")
    parser.add_argument(
        "--increments",
        metavar="N,N,...",
        help="counted over all steps, 0 before loading, -1 the last (default: four, evenly spaced)",
    )
    add_look(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="PNG file")


def run(options: argparse.Namespace) -> int:
    """Draws the picture."""
    jobs, path = open_for_drawing(options, "_deformed.png")
    look = options_of(options)
    rows = [
        [Frame(job, output, look.warp, look.clips) for output in outputs_of(job, options)]
        for job in jobs
    ]
    figure = draw_frames(rows, replace(look, field=options.field))
    save(figure, path)
    wrote(path)
    return 0


def outputs_of(job: Job, options: argparse.Namespace) -> Sequence[int]:
    """The outputs of the increments asked for."""
    if options.increments is None:
        count = min(DEFAULT_PANELS, job.points.n_steps)
        return [int(i) for i in np.linspace(0, job.points.n_steps - 1, count).round()]
    try:
        wanted = [int(text) for text in options.increments.split(",")]
    except ValueError:
        raise PostError(
            f"--increments: expected whole numbers such as 0,5,11, found '{options.increments}'"
        ) from None
    return [job.output_of(increment=increment) for increment in wanted]
