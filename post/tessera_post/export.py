"""export JOB: VTK XML files, a table of a field, or the deck."""

import argparse
import sys
from pathlib import Path

from tessera_post.cli import wrote
from tessera_post.errors import PostError
from tessera_post.export_csv import STDOUT, export_csv
from tessera_post.export_files import Batch, refuse_existing
from tessera_post.job import Job, open_job

EXAMPLE = """\
  tessera-post export footing_fbar vtk
  tessera-post export footing_fbar csv --field TAU33,S:mises,PEEQ --time 0.5 -o half.csv
  tessera-post export footing_fbar csv --mesh nodes --field RF -o -
  tessera-post export footing_fbar deck -o again.inp

vtk   one compressed .vtu file per output for the points and for the mesh, and JOB.pvd and
      JOB_mesh.pvd, which ParaView opens with all times
csv   fields of all points, nodes or elements at one output: comment lines with #, names of the
      columns, then number, x, y, z and the values with 17 significant digits; for an element x, y,
      z are its middle. The name of a field gives all its components (S: S11, S22, S33, S12, S23,
      S13); TAU33, S:mises, S:pressure, S:norm, S:max, S:min and the like give one column.
deck  the deck that was run, byte for byte, the text of *INCLUDE files in its place"""
ONLY_FOR_CSV = ("field", "increment", "time", "mesh")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("job", metavar="JOB", help="a job, or one of its files")
    parser.add_argument("format", choices=("vtk", "csv", "deck"), help="see below")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        help="folder of vtk (default JOB_vtk beside the results), file of csv (default"
        " JOB_points_INCREMENT.csv beside the results) or deck (default: standard output);"
        " - means standard output",
    )
    parser.add_argument("-f", "--force", action="store_true", help="overwrite files")
    parser.add_argument("--field", metavar="NAMES", help="csv: such as S,PEEQ (default: all)")
    parser.add_argument("--mesh", choices=("nodes", "elements"), help="csv: not of the points")
    when = parser.add_mutually_exclusive_group()
    when.add_argument(
        "--increment", type=int, help="csv: counted over all steps, from -1 backwards from the end"
    )
    when.add_argument("--time", type=float, help="csv: total time (default: the last output)")


def run(options: argparse.Namespace) -> int:
    """Exports; 0, as errors are raised."""
    if options.format != "csv":
        for name in ONLY_FOR_CSV:
            if getattr(options, name) is not None:
                raise PostError(f"--{name} goes with csv, not with {options.format}")
    job = open_job(options.job)
    if options.format == "csv":
        export_csv(job, options)
    elif options.format == "deck":
        export_deck(job, options.output or STDOUT, options.force)
    else:
        from tessera_post.export_vtk import export_vtk  # VTK takes long to import

        if options.output == STDOUT:
            raise PostError("vtk writes several files: expected a folder, not standard output")
        export_vtk(job, options.output or job.folder / f"{job.name}_vtk", options.force)
    return 0


def export_deck(job: Job, path: Path, force: bool) -> None:
    """Writes the stored deck as it is."""
    if path == STDOUT:
        sys.stdout.buffer.write(job.deck)
        sys.stdout.buffer.flush()
        return
    refuse_existing([path], force)
    with Batch() as batch:
        batch.open_name(path).write_bytes(job.deck)
    wrote(path)
