"""Stress of the ground at rest and of the ground that heaves."""

from pathlib import Path

import numpy as np
from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save


def heights(job: Job) -> np.ndarray:
    """(n) initial heights of the points."""
    return job.points.points(0)[:, job.n_dim - 1]


def stress_error_at_rest(job: Job) -> float:
    """Largest error of the vertical stress at the end, over the stress at the base."""
    height = heights(job)
    exact = np.where(height > 3.0, -16.0 * (5.0 - height), -32.0 - 20.0 * (3.0 - height))
    stress = job.points.field("S", job.points.n_steps - 1)[:, job.n_dim - 1]
    return float(np.abs(stress - exact).max() / 92.0)


def stress_change(job: Job) -> float:
    """Largest change of a stress component from the beginning to the end, over the same."""
    start, end = job.points.field("S", 0), job.points.field("S", job.points.n_steps - 1)
    return float(np.abs(end - start).max() / 92.0)


def stress_left(job: Job) -> float:
    """Mean size of the stress that is left when the weight is gone, over the stress before."""
    stress = job.points.field("S", job.points.n_steps - 1)
    return float(np.abs(stress[:, :3]).max(axis=1).mean() / 100.0)


def draw_rest(jobs: dict[str, Job], path: Path) -> None:
    """Stress over height at the beginning and at the end."""
    job = jobs["rest-half-fbar-2d"]
    start, end = job.points.field("S", 0), job.points.field("S", job.points.n_steps - 1)
    height = heights(job)
    order = np.argsort(height)
    figure, axes = plt.subplots(figsize=(6.0, 4.6))
    for i, name in enumerate(("horizontal", "vertical", "out of plane")):
        axes.plot(start[order, i], height[order], color=COLORS[i], label=f"{name}, given")
        style = {"linestyle": "none", "marker": MARKERS[i], "markersize": 3.0}
        axes.plot(end[:, i], height, color=COLORS[i], label=f"{name}, at the end", **style)
    axes.set(xlabel="stress [kPa]", ylabel="height [m]")
    axes.legend(loc="best", fontsize=9)
    save(figure, path)
