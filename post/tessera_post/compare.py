"""compare A B: the differences between two runs, and whether they are within a tolerance."""

import argparse
from itertools import zip_longest

import numpy as np

from tessera_post.cli import tell
from tessera_post.compare_match import (
    check_meshes,
    check_points,
    common_times,
    not_comparable,
)
from tessera_post.compare_measure import Difference, Tolerance
from tessera_post.compare_runs import (
    history_differences,
    mesh_differences,
    point_differences,
    select_fields,
)
from tessera_post.job import Job, open_job
from tessera_post.output import finite

EXAMPLE = """\
  tessera-post compare footing_fbar reference/footing_fbar
  tessera-post compare old/footing_fbar new/footing_fbar --rtol 1e-6 --fields S,PEEQ
  tessera-post compare coarse fine --no-fields --rtol 0.02

Two values are the same when |a - b| <= rtol * scale + atol. The scale of a history column is the
largest absolute value that either run has, over all increments that both have, in this column and
in those of the other components (RF1, RF2, RF3) of the same set or point. The scale of a field is
the largest absolute value of either run, over all components, all points (or nodes, or elements)
and all outputs that both have. rms is the root of the mean of (a - b)^2 over the column or the
field, relative the worst difference over the scale. Fields that number things (MAT, PATCH,
ELEMENT, ACTIVE, ID) must be equal; a point that only one run has is a difference of ID.

Increments and outputs are matched by total time, points by ID, nodes and elements by their number.
What only one run has is left out, with a note. NaN in both runs at the same place is the same.

The exit code is 0 when the runs are the same, 1 when they differ, 2 when they are not comparable:
other mesh or points (this does not matter with --no-fields), or no time in common but 0."""
SAME, DIFFERENT = 0, 1
HEAD = ("what", "worst", "rms", "scale", "relative", "where the worst one is")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declares the options."""
    parser.add_argument("a", metavar="A", help="a job, or one of its files")
    parser.add_argument("b", metavar="B", help="the job to compare it with")
    parser.add_argument(
        "--rtol",
        type=tolerance,
        default=1e-9,
        help="tolerance relative to the scale of a column or field (default 1e-9)",
    )
    parser.add_argument(
        "--atol", type=tolerance, default=0.0, help="absolute tolerance (default 0)"
    )
    which = parser.add_mutually_exclusive_group()
    which.add_argument(
        "--fields",
        metavar="NAMES",
        help="fields of points and mesh to compare, such as S,TAU; position for where they are"
        " (default: all that both runs have)",
    )
    which.add_argument("--no-fields", action="store_true", help="compare the histories only")
    parser.add_argument("-q", "--quiet", action="store_true", help="print the last line only")


def tolerance(text: str) -> float:
    """A tolerance."""
    value = finite(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"'{text}' is no tolerance: expected a number from 0 on")
    return value


def run(options: argparse.Namespace) -> int:
    """Compares and prints; 1 when the runs differ."""
    a, b = open_job(options.a), open_job(options.b)
    with_fields = not options.no_fields
    check_times(a, b, with_fields)
    differences = find_differences(a, b, options)
    if not any(difference.n_values for difference in differences):
        raise not_comparable(a, b, "they have no history column and no field in common")
    tolerance = Tolerance(options.rtol, options.atol)
    if not options.quiet:
        notes = [*a.notes, *b.notes, *about_runs(a, b), *left_out(a, b, with_fields)]
        tell(list(dict.fromkeys(notes)))
        print_table(differences, tolerance)
    exceeding = sort_by_size([d for d in differences if d.exceeds(tolerance)], tolerance)
    print(verdict(differences, exceeding, tolerance))
    return DIFFERENT if exceeding else SAME


def find_differences(a: Job, b: Job, options: argparse.Namespace) -> list[Difference]:
    """All differences that are asked for."""
    if options.no_fields:
        return history_differences(a, b)
    of_points, of_mesh = select_fields(options.fields, a, b)
    if a.mesh is not None and b.mesh is not None:
        check_meshes(a, b)
    check_points(a, b)
    return [
        *history_differences(a, b),
        *(point_differences(a, b, of_points) if of_points else []),
        *(mesh_differences(a, b, of_mesh) if of_mesh else []),
    ]


# --- what is compared ----------------------------------------------------------------------------


def check_times(a: Job, b: Job, with_fields: bool) -> None:
    """Raises PostError when they have no time but 0 in common, unless neither has a later one."""
    both = [(a.history["time"], b.history["time"])]
    if with_fields:
        both.append((a.points.times, b.points.times))
    for times_a, times_b in both:
        in_a, _ = common_times(times_a, times_b)
        both_at_start = len(in_a) == len(times_a) == len(times_b) == 1
        if both_at_start or np.any(times_a[in_a] > 0.0):
            return
    raise not_comparable(a, b, "they have no time after 0 in common")


def about_runs(a: Job, b: Job) -> list[str]:
    """Differences of the runs that are no differences of their results."""
    notes = []
    if a.formulation != b.formulation and a.text("formulation") != b.text("formulation"):
        notes.append(f"other formulation: {a.formulation} against {b.formulation}")
    versions = [f"{job.text('version')} {job.text('git')}" for job in (a, b)]
    if versions[0] != versions[1]:
        notes.append(f"other version of Tessera: {versions[0]} against {versions[1]}")
    if a.text("units") != b.text("units"):
        notes.append(
            f"other units: '{a.text('units')}' against '{b.text('units')}'; numbers are compared"
            " as they are"
        )
    return notes + about_decks(a, b)


def about_decks(a: Job, b: Job) -> list[str]:
    """Where the decks begin to differ."""
    if a.deck == b.deck:
        return []
    lines = [job.deck.decode(errors="replace").splitlines() for job in (a, b)]
    for number, (line_a, line_b) in enumerate(zip_longest(*lines, fillvalue=""), start=1):
        if line_a != line_b:
            return [f"other deck, first in line {number}: '{line_a}' against '{line_b}'"]
    return ["other deck: only the line ends differ"]


def left_out(a: Job, b: Job, with_fields: bool) -> list[str]:
    """What only one of the runs has."""
    notes = unmatched_times(a, b, "increments", a.history["time"], b.history["time"])
    notes += unshared(a, b, "history columns", list(a.history), list(b.history))
    if not with_fields:
        return notes
    notes += unmatched_times(a, b, "outputs", a.points.times, b.points.times)
    notes += unshared(a, b, "point fields", a.points.field_names, b.points.field_names)
    if a.mesh is None or b.mesh is None:
        missing = " and ".join(f"'{job.name}'" for job in (a, b) if job.mesh is None)
        return [*notes, f"meshes are not compared: {missing} has none"]
    notes += unmatched_times(a, b, "outputs of the mesh", a.mesh.times, b.mesh.times)
    return notes + unshared(a, b, "mesh fields", a.mesh.field_names, b.mesh.field_names)


def unmatched_times(
    a: Job, b: Job, what: str, times_a: np.ndarray, times_b: np.ndarray
) -> list[str]:
    """How many increments or outputs are left out."""
    in_a, in_b = common_times(times_a, times_b)
    only_a, only_b = len(times_a) - len(in_a), len(times_b) - len(in_b)
    if only_a == only_b == 0:
        return []
    return [
        f"{len(in_a)} {what} compared, time 0 included; left out: {only_a} of '{a.name}',"
        f" {only_b} of '{b.name}'"
    ]


def unshared(a: Job, b: Job, what: str, names_a: list[str], names_b: list[str]) -> list[str]:
    """Names that only one run has."""
    notes = []
    for job, names, others in ((a, names_a, names_b), (b, names_b, names_a)):
        only = [name for name in names if name not in others]
        if only:
            notes.append(f"{what} left out, only in '{job.name}': {', '.join(only)}")
    return notes


# --- what is printed -----------------------------------------------------------------------------


def sort_by_size(differences: list[Difference], tolerance: Tolerance) -> list[Difference]:
    """The worst first: those beyond the tolerance before the others."""
    return sorted(differences, key=lambda one: (one.exceeds(tolerance), one.relative), reverse=True)


def print_table(differences: list[Difference], tolerance: Tolerance) -> None:
    """A row per column and field."""
    rows = [HEAD, *(row_of(one) for one in sort_by_size(differences, tolerance) if one.n_values)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    for row in rows:
        numbers = "  ".join(f"{text:>{width}}" for text, width in zip(row[1:-1], widths[1:]))
        print(f"{row[0]:<{widths[0]}}  {numbers}  {row[-1]}".rstrip())
    print()


def row_of(one: Difference) -> tuple[str, ...]:
    """A row of the table."""
    name = f"{one.kind} {one.name}"
    where = "identical" if one.is_identical else one.where or "equal"
    if one.numbers_things:
        return (name, f"{one.n_unequal} unequal", f"of {one.n_values}", "-", "-", where)
    numbers = (one.worst, one.rms, one.scale, one.relative)
    return (name, *(f"{number:.3e}" for number in numbers), where)


def verdict(
    differences: list[Difference], exceeding: list[Difference], tolerance: Tolerance
) -> str:
    """The last line."""
    compared = [one for one in differences if one.n_values]
    if exceeding:
        worst = exceeding[0]
        size = f"by {worst.relative:.3g} of its scale"
        if worst.numbers_things:
            size = f"in {worst.n_unequal} of {worst.n_values}"
        return (
            f"they differ: {len(exceeding)} of {len(compared)} beyond {tolerance}; most"
            f" {worst.kind} {worst.name}, {size}, at {worst.where}"
        )
    counts = [
        f"{sum(one.kind == kind for one in compared)} {words}"
        for kind, words in (
            ("history", "history columns"),
            ("points", "point fields"),
            ("mesh", "mesh fields"),
        )
        if any(one.kind == kind for one in compared)
    ]
    identical = " (bitwise identical)" if all(one.is_identical for one in compared) else ""
    return f"the same within {tolerance}{identical}: {', '.join(counts)}"
