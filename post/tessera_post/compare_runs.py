"""The differences of two runs: histories, points and mesh, one output at a time."""

import re

import numpy as np

from tessera_post.columns import COUNTED, column_names
from tessera_post.compare_match import common_ids, common_times, shared
from tessera_post.compare_measure import Difference
from tessera_post.components import component_names
from tessera_post.errors import PostError
from tessera_post.fields import CATEGORIES
from tessera_post.job import Job
from tessera_post.series import Series

POSITION = "POSITION"


def shared_columns(a: Job, b: Job) -> list[str]:
    """Names of the history columns that both have, without those that count."""
    return [name for name in column_names(a) if name in b.history and name not in COUNTED]


def history_differences(a: Job, b: Job) -> list[Difference]:
    """One for each column that both have, over the increments that both have."""
    in_a, in_b = common_times(a.history["time"], b.history["time"])
    differences = []
    for name in shared_columns(a, b):
        difference = Difference("history", name)

        def place(row: int, _component: int) -> str:
            return moment(a, a.history["time"][in_a[row]])

        difference.add(a.history[name][in_a], b.history[name][in_b], place)
        differences.append(difference)
    share_scales(differences)
    return differences


def share_scales(differences: list[Difference]) -> None:
    """Gives the components of one quantity of one set or point the largest of their scales: a
    reaction that ought to be 0 is measured by the one beside it, not by its own noise."""
    scales: dict[str, float] = {}
    for one in differences:
        quantity = without_component(one.name)
        scales[quantity] = max(scales.get(quantity, 0.0), one.scale)
    for one in differences:
        one.scale = scales[without_component(one.name)]


def without_component(name: str) -> str:
    """RF[FOOTING] of the column RF3[FOOTING]."""
    return re.sub(r"^([A-Z]+)\d+(?=\[)", r"\1", name)


def point_differences(a: Job, b: Job, names: list[str]) -> list[Difference]:
    """One for each of the point fields, over the outputs and the points that both have."""
    result = make_differences("points", names)
    for output_a, output_b in zip(*common_times(a.points.times, b.points.times)):
        when = moment(a, a.points.times[output_a])
        ids, ids_b = a.points.field("ID", output_a), b.points.field("ID", output_b)
        rows, rows_b = common_ids(ids, ids_b)
        if "ID" in result:
            n_unmatched = len(ids) + len(ids_b) - 2 * len(rows)
            result["ID"].add_unmatched(n_unmatched, f"{when}, points of one run only")
        for name, difference in result.items():
            values = values_of(a.points, name, output_a)[rows]
            values_b = values_of(b.points, name, output_b)[rows_b]
            check_shapes(name, values, values_b)
            difference.add(values, values_b, Places(when, "point", ids[rows], name, values))
    return list(result.values())


def mesh_differences(a: Job, b: Job, names: list[str]) -> list[Difference]:
    """One for each of the fields of the mesh, over the outputs that both have."""
    result = make_differences("mesh", names)
    mesh_a, mesh_b = a.need_mesh(), b.need_mesh()
    for output_a, output_b in zip(*common_times(mesh_a.times, mesh_b.times)):
        when = moment(a, mesh_a.times[output_a])
        for name, difference in result.items():
            values = values_of(mesh_a, name, output_a)
            values_b = values_of(mesh_b, name, output_b)
            check_shapes(name, values, values_b)
            thing = "element" if name in mesh_a.cell_fields else "node"
            numbers = np.arange(1, len(values) + 1)
            difference.add(values, values_b, Places(when, thing, numbers, name, values))
    return list(result.values())


def make_differences(kind: str, names: list[str]) -> dict[str, Difference]:
    """A difference to be built up for each field."""
    return {name: Difference(kind, name, name in CATEGORIES) for name in names}


class Places:
    """Where a value of a field is: time, increment, number of the thing, component."""

    def __init__(
        self, when: str, thing: str, numbers: np.ndarray, name: str, values: np.ndarray
    ) -> None:
        self.when = when
        self.thing = thing
        self.numbers = numbers
        self.name = name
        self.n_components = values.shape[1] if values.ndim > 1 else 1

    def __call__(self, row: int, component: int) -> str:
        text = f"{self.when}, {self.thing} {self.numbers[row]}"
        if self.n_components == 1:
            return text
        if self.name == POSITION:
            return f"{text}, component {'xyz'[component]}"
        names = component_names(self.name, self.n_components)
        return f"{text}, component {names[component].removeprefix('_')}"


def moment(job: Job, time: float) -> str:
    """A total time in words, with its increment."""
    if len(job.history["time"]) == 0:
        return f"time {time:g}"
    return f"time {time:g}, increment {job.increment_at(time)}"


def values_of(series: Series, name: str, output: int) -> np.ndarray:
    """A field or the positions at an output."""
    return series.points(output) if name == POSITION else series.field(name, output)


def check_shapes(name: str, a: np.ndarray, b: np.ndarray) -> None:
    """Raises PostError when a field has other components or rows in the two files."""
    if a.shape != b.shape:
        raise PostError(
            f"the field '{name}' has the shape {a.shape} in one file, {b.shape} in the other one"
        )


def select_fields(text: str | None, a: Job, b: Job) -> tuple[list[str], list[str]]:
    """Fields of the points and of the mesh to compare: those of the option, else all of both.

    Raises PostError with the names that there are.
    """
    of_points = [POSITION, *shared(a.points, b.points)]
    of_mesh = []
    if a.mesh is not None and b.mesh is not None:
        of_mesh = [POSITION, *shared(a.mesh, b.mesh)]
    if text is None:
        return of_points, of_mesh
    wanted = [name.strip().upper() for name in text.split(",") if name.strip()]
    there = list(dict.fromkeys([*of_points, *of_mesh]))
    unknown = [name for name in wanted if name not in there]
    if unknown or not wanted:
        named = f"'{unknown[0]}' is no field" if unknown else "--fields names no field"
        raise PostError(f"{named} of both runs: there are {', '.join(there)}")
    return (
        [name for name in of_points if name in wanted],
        [name for name in of_mesh if name in wanted],
    )
