"""Columns of the history: found by what a user types, labelled, with units."""

import re
from dataclasses import dataclass

import numpy as np

from tessera_post.errors import PostError, one_of
from tessera_post.fields import parse
from tessera_post.job import Job

WORDS = {
    "RF": ("reaction", "force"),
    "CF": ("applied force", "force"),
    "U": ("displacement", "length"),
}
COUNTED = {"time": "time", "increment": "increment", "step": "step"}


@dataclass(frozen=True)
class Column:
    """A column of the history of one job."""

    name: str  # as in the file, such as RF3[FOOTING]
    label: str  # in words
    generic: str  # in words, without component and place
    dimension: str  # force, length, stress, number ...
    values: np.ndarray  # (n_increments + 1)


def column_names(job: Job) -> list[str]:
    """Names of the columns, `step`, `increment` and `time` first."""
    fixed = [name for name in ("step", "increment", "time") if name in job.history]
    return fixed + [name for name in job.history if name not in fixed]


def find_column(job: Job, text: str) -> Column:
    """The column that a user means: its name in any case; without the set where only one has it.

    `increment` counts over all steps. Raises PostError with the names that there are.
    """
    wanted = text.strip().upper()
    names = [name for name in job.history if name.upper() == wanted]
    if not names:
        names = [name for name in job.history if name.upper().partition("[")[0] == wanted]
    if len(names) != 1:
        problem = "has no column" if not names else "has more than one column"
        there = one_of(names or column_names(job))
        raise PostError(f"the history of '{job.name}' {problem} '{text}': expected one of {there}")
    return make_column(job, names[0])


def make_column(job: Job, name: str) -> Column:
    """A column of that name with its label and its dimension."""
    if name in COUNTED:
        values = job.history[name]
        if name == "increment":
            values = np.arange(len(values))
        return Column(name, COUNTED[name], COUNTED[name], "number", values)
    return Column(name, *describe(name), job.history[name])


def describe(name: str) -> tuple[str, str, str]:
    """Label in words, with and without component and place, and dimension of a column such as
    RF3[FOOTING] or S11[1 2 3]."""
    quantity, bracket, label = name.partition("[")
    where = f" of {label.removesuffix(']')}" if bracket else ""
    found = re.fullmatch(r"(RF|CF|U)([123])", quantity)
    if found:
        words, dimension = WORDS[found[1]]
        return f"{words} {found[2]}{where}", words, dimension
    field = parse(quantity)
    if field is None:
        return name, name, "number"
    at = f" at {label.removesuffix(']')}" if bracket else ""
    return field.label + at, re.sub(r" [123]{1,2}$", "", field.label), field.dimension


def default_pair(job: Job) -> tuple[str, str]:
    """What is worth seeing first: the largest reaction over the displacement of the same set and
    direction; over time, if that is not there; the first column over time without reactions."""
    forces = [name for name in column_names(job) if re.match(r"(RF|CF)[123]\[", name)]
    moved = {name for name in job.history if re.match(r"U[123]\[", name)}

    def size(name: str) -> float:
        return float(np.abs(job.history[name]).max(initial=0.0))

    paired = [name for name in forces if partner(name) in moved and size(partner(name)) > 0.0]
    if paired:
        driven = max(paired, key=lambda name: (size(partner(name)), size(name)))
        return partner(driven), driven
    if forces:
        return "time", max(forces, key=size)
    others = [name for name in column_names(job) if name not in COUNTED]
    if not others:
        raise PostError(f"the history of '{job.name}' has no columns: the deck asks for none")
    return "time", others[0]


def partner(force: str) -> str:
    """The displacement of the set and direction of a force."""
    return re.sub(r"^(RF|CF)", "U", force)
