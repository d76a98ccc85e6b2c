"""One self-contained HTML page of a run: it needs neither a network nor other files."""

import argparse
from pathlib import Path

from tessera_post.body import Frame
from tessera_post.cli import tell, wrote
from tessera_post.fields import Quantity
from tessera_post.job import Job, open_job
from tessera_post.output import find_output
from tessera_post.picture import add_when
from tessera_post.report_page import Sections, render

EXAMPLE = """\
  tessera-post report footing_fbar
  tessera-post report footing_fbar --field PEEQ --increment 10 -o footing.html
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("job", metavar="JOB", help="job, deck or result file")
    add_when(parser)
    parser.add_argument(
        "--field",
        metavar="NAME",
        help="colours the pictures and the 3-D view: S11, S:mises, pressure, PEEQ, U3, PATCH, ..."
        " (default: pressure, PEEQ or U, what is there)",
    )
    parser.add_argument("--no-3d", action="store_true", help="leave out the view that turns")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="HTML file (default: JOB_report.html)"
    )


def run(options: argparse.Namespace) -> int:
    """Writes the page."""
    job = open_job(options.job)
    path = find_output(options.output, job.folder / f"{job.name}_report.html", (".html", ".htm"))
    tell(job.notes)
    output = job.output_of(options.increment, options.time)
    quantity = find_quantity(job, options.field)
    page = make_page(Frame(job, output), quantity, with_view=not options.no_3d)
    path.write_text(page, encoding="utf-8")
    wrote(path)
    return 0


def find_quantity(job: Job, field: str | None) -> Quantity:
    """The field of pictures and view."""
    from tessera_post.picture import PictureOptions, find_field

    return find_field([job], PictureOptions(field=field))


def make_page(frame: Frame, quantity: Quantity, with_view: bool) -> str:
    """The page as text."""
    from tessera_post.report_attempts import collect_trials
    from tessera_post.report_convergence import convergence_plots
    from tessera_post.report_pictures import make_pictures
    from tessera_post.report_plots import history_plots, reaction_plot
    from tessera_post.report_scene import scene_plot
    from tessera_post.report_tables import newton_tolerance

    job = frame.job
    trials = collect_trials(job)
    sections = Sections(
        trials=trials,
        reaction=reaction_plot(job),
        histories=history_plots(job),
        convergence=convergence_plots(trials, newton_tolerance(job)),
        pictures=make_pictures(frame, quantity),
        view=scene_plot(frame, quantity) if with_view else None,
    )
    return render(job, sections)
