"""What two runs have in common: times, points, nodes and elements."""

import numpy as np

from tessera_post.errors import PostError
from tessera_post.job import SAME_TIME, Job
from tessera_post.series import Series

SAME_PLACE = 1e-6  # relative to the size of the body: points of one deck start there in every run

Indices = np.ndarray


def common_times(a: np.ndarray, b: np.ndarray) -> tuple[Indices, Indices]:
    """Indices into ascending times a and b of those that both have."""
    if len(a) == 0 or len(b) == 0:
        none = np.zeros(0, dtype=int)
        return none, none
    after = np.searchsorted(b, a).clip(0, len(b) - 1)
    before = (after - 1).clip(0)
    nearest = np.where(np.abs(b[before] - a) <= np.abs(b[after] - a), before, after)
    span = max(np.abs(a).max(), np.abs(b).max())
    in_a = np.flatnonzero(np.abs(b[nearest] - a) <= SAME_TIME * span)
    return in_a, nearest[in_a]


def common_ids(a: np.ndarray, b: np.ndarray) -> tuple[Indices, Indices]:
    """Indices into unique numbers a and b of those that both have."""
    if np.array_equal(a, b):
        every = np.arange(len(a))
        return every, every
    _, in_a, in_b = np.intersect1d(a, b, assume_unique=True, return_indices=True)
    return in_a, in_b


def not_comparable(a: Job, b: Job, why: str) -> PostError:
    """The error that tells why two runs cannot be compared."""
    return PostError(f"'{a.name}' and '{b.name}' are not comparable: {why}")


def check_points(a: Job, b: Job) -> None:
    """Raises PostError unless both runs begin with the same points at the same places."""
    ids = [job.points.field("ID", 0) for job in (a, b)]
    in_a, in_b = common_ids(*ids)
    if not len(ids[0]) == len(ids[1]) == len(in_a):
        raise not_comparable(
            a, b, f"other material points, {len(ids[0])} and {len(ids[1])} at the start"
        )
    if not stand_together(a.points.points(0)[in_a], b.points.points(0)[in_b]):
        raise not_comparable(a, b, "their material points start at other places")


def check_meshes(a: Job, b: Job) -> None:
    """Raises PostError unless both runs have the same mesh at the start."""
    mesh_a, mesh_b = a.need_mesh(), b.need_mesh()
    cells_a, cells_b = mesh_a.cells(0), mesh_b.cells(0)
    sizes = [
        f"{mesh.n_points(0)} nodes and {len(cells)} elements"
        for mesh, cells in ((mesh_a, cells_a), (mesh_b, cells_b))
    ]
    if sizes[0] != sizes[1] or cells_a.shape != cells_b.shape:
        raise not_comparable(a, b, f"other mesh, {sizes[0]} against {sizes[1]}")
    if not np.array_equal(cells_a, cells_b):
        raise not_comparable(a, b, "other mesh, the elements connect other nodes")
    if not stand_together(mesh_a.points(0), mesh_b.points(0)):
        raise not_comparable(a, b, "other mesh, its nodes start at other places")


def stand_together(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two sets of positions are the same, measured by the size of the body."""
    size = float(np.ptp(a, axis=0).max(initial=0.0)) if len(a) else 0.0
    return bool(np.abs(a - b).max(initial=0.0) <= SAME_PLACE * size)


def shared(a: Series, b: Series) -> list[str]:
    """Names of the fields of both files, in the order of the first one."""
    return [name for name in a.field_names if name in b.field_names]
