"""What the results of a widened cylinder or sphere say, to compare with ThickRing."""

import numpy as np
from tessera_post.job import Job

from verification.solutions.thick_ring import ThickRing

SAME_RADIUS = 1e-9  # relative


def inner_facets(cells: np.ndarray, on_inner: np.ndarray, n_dim: int) -> np.ndarray:
    """(n, n_dim) nodes of the edges (3-D: faces) of elements that lie on the inner surface."""
    counts = on_inner[cells].sum(axis=1)
    chosen = cells[counts == n_dim]
    return chosen[on_inner[chosen]].reshape(-1, n_dim)


def unit_pressure_forces(x: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """(n_nodes, 3) nodal forces of a pressure of 1 on the facets, away from the origin.

    x (n_nodes, 3) places; facets (n, 2) edges in the plane z = 0 or (n, 3) triangles.
    """
    corner = x[facets]
    if facets.shape[1] == 2:
        edge = corner[:, 1] - corner[:, 0]
        area = np.stack([edge[:, 1], -edge[:, 0], np.zeros(len(edge))], axis=1)
    else:
        area = 0.5 * np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    outward = np.sign(np.sum(area * corner.mean(axis=1), axis=1))
    force = np.zeros_like(x)
    np.add.at(force, facets, (outward[:, None] * area / facets.shape[1])[:, None, :])
    return force


def radius_of(x: np.ndarray) -> np.ndarray:
    """(n) distance from the origin of places (n, 3)."""
    return np.linalg.norm(x, axis=1)


def inner_pressures(job: Job, inner: float) -> tuple[np.ndarray, np.ndarray]:
    """Inner radius and pressure on the inner surface at every output.

    The pressure is the one that does the work of the reactions when the surface widens: radial
    reactions over the radial nodal forces of a pressure of 1. Reactions of the planes of symmetry
    stand across the radius and do no work. inner: inner radius before loading [length].
    """
    mesh = job.need_mesh()
    start = mesh.points(0)
    on_inner = np.abs(radius_of(start) - inner) <= SAME_RADIUS * inner
    facets = inner_facets(mesh.cells(0), on_inner, job.n_dim)
    radial = start[on_inner] / radius_of(start[on_inner])[:, None]
    radii, pressures = [], []
    for step in range(mesh.n_steps):
        x = mesh.points(step)
        reaction = mesh.field("RF", step)[on_inner]
        per_pressure = unit_pressure_forces(x, facets)[on_inner]
        work = np.sum(reaction * radial[:, : reaction.shape[1]])
        radii.append(radius_of(x[on_inner]).mean())
        pressures.append(work / np.sum(per_pressure * radial))
    return np.array(radii), np.array(pressures)


def outer_ratio(job: Job, ring: ThickRing) -> float:
    """Mean radial displacement of the outer surface at the last output over the exact one."""
    mesh = job.need_mesh()
    start, now = (radius_of(mesh.points(step)) for step in (0, mesh.n_steps - 1))
    outer, inner = (
        start >= (1.0 - SAME_RADIUS) * ring.outer,
        start <= (1.0 + SAME_RADIUS) * ring.inner,
    )
    a = now[inner].mean()
    return (now[outer] - start[outer]).mean() / (ring.outer_radius(a) - ring.outer)


def mean_stresses(job: Job, ring: ThickRing) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radius of the material points, their mean stress and the exact one, at the last output."""
    radii, _ = inner_pressures(job, ring.inner)
    last = job.points.n_steps - 1
    r = radius_of(job.points.points(last))
    found = job.points.field("S", last)[:, :3].mean(axis=1)
    return r, found, ring.mean_stress(r, radii[-1])


def mean_stress_error(job: Job, ring: ThickRing) -> float:
    """Error of the mean stress over the mean stress, both as norms over the volume."""
    _, found, exact = mean_stresses(job, ring)
    volume = job.points.field("VOL", job.points.n_steps - 1)
    return float(np.sqrt(np.sum(volume * (found - exact) ** 2) / np.sum(volume * exact**2)))
