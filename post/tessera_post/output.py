"""Where a command writes: checked before anything is drawn."""

import argparse
import math
import os
from collections.abc import Sequence
from pathlib import Path

from tessera_post.cli import tell
from tessera_post.errors import PostError
from tessera_post.job import Job, open_jobs

PICTURES = (".png", ".pdf", ".svg")


def find_output(given: Path | None, default: Path, endings: Sequence[str]) -> Path:
    """The file to write. Raises PostError for a folder, another ending, or no way to write it."""
    path = default if given is None else given
    if path.is_dir():
        raise PostError(f"'{path}' is a folder: expected the name of a file")
    if path.suffix.lower() not in endings:
        last = f" or {endings[-1]}" if len(endings) > 1 else ""
        wanted = ", ".join(endings[:-1] or endings) + last
        raise PostError(f"'{path}': expected a name that ends in {wanted}")
    if not path.parent.is_dir():
        raise PostError(f"cannot write '{path}': there is no folder '{path.parent}'")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise PostError(f"cannot write '{path}': no permission")
    return path


def open_for_drawing(
    options: argparse.Namespace, name: str, endings: Sequence[str] = PICTURES
) -> tuple[list[Job], Path]:
    """The jobs of a command and the file to write, by default JOB_name; notes are told."""
    jobs = open_jobs(options.job)
    path = find_output(options.output, jobs[0].folder / f"{jobs[0].name}{name}", endings)
    for job in jobs:
        tell(job.notes)
    return jobs, path


def finite(text: str) -> float:
    """A number of an option, for argparse."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a number, found '{text}'")
    return value
