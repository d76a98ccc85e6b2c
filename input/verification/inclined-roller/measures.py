"""Differences between a job on the inclined plane and the same job on the level one."""

import sys
from pathlib import Path

import numpy as np
from tessera_post import style
from tessera_post.job import Job, open_job

sys.path.insert(0, str(Path(__file__).resolve().parent))
from inclination import turn


def tensors(voigt):
    """(n, 3, 3) of (n, 6) in the order 11, 22, 33, 12, 23, 13."""
    rows = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
    return voigt[:, rows]


def largest_difference(found, level):
    """Largest difference of two fields over the largest value of the second."""
    return float(np.abs(found - level).max() / np.abs(level).max())


def field_difference(job: Job, field: str) -> float:
    """Largest relative difference of a field of all points, turned back to the level axes."""
    level = open_job(str(job.folder / job.name.removesuffix("-inclined")))
    q = turn(job.n_dim)
    here, there = job.output_of(), level.output_of()
    if field == "x":
        found, expected = job.points.points(here) @ q, level.points.points(there)
    else:
        found, expected = job.points.field(field, here), level.points.field(field, there)
        if field == "U":
            found = found @ q
        elif field in ("S", "LE"):
            found, expected = q.T @ tensors(found) @ q, tensors(expected)
        elif field == "F":
            found = q.T @ found.reshape(-1, 3, 3) @ q
            expected = expected.reshape(-1, 3, 3)
    level.close()
    return largest_difference(found, expected)


def reaction_difference(job: Job) -> float:
    """Largest relative difference of the reactions of all nodes, turned back to the level axes."""
    level = open_job(str(job.folder / job.name.removesuffix("-inclined")))
    found = job.need_mesh().field("RF", job.output_of()) @ turn(job.n_dim)
    difference = largest_difference(found, level.need_mesh().field("RF", level.output_of()))
    level.close()
    return difference


def draw_blocks(jobs: dict[str, Job], path: Path) -> None:
    """The plane block with F-bar patches at its end, level and on the slope."""
    figure, axes = style.plt.subplots(1, 2, figsize=(9.6, 4.4))
    pair = [jobs["plane-fbar"], jobs["plane-fbar-inclined"]]
    strains = [100.0 * job.points.field("PEEQ", job.output_of()) for job in pair]
    for ax, job, strain in zip(axes, pair, strains):
        output = job.output_of()
        mesh = job.need_mesh()
        x, corners = mesh.points(output), mesh.cells(output)
        ax.triplot(x[:, 0], x[:, 1], corners, color="0.8", linewidth=0.6)
        place = job.points.points(output)
        shown = ax.scatter(
            place[:, 0], place[:, 1], c=strain, s=9.0, cmap=style.cm.batlow, vmax=strains[0].max()
        )
        ax.set(aspect="equal", xlabel="x", ylabel="y", title=job.name)
        ax.grid(visible=False)
    figure.colorbar(shown, ax=axes, label="accumulated plastic strain [%]")
    style.save(figure, path)
