"""Error norm of the stress in the column, and its pictures."""

from pathlib import Path

import numpy as np
from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save

HEIGHT = 50.0  # m
WEIGHT = 800.0  # N/m^3
MESHES = {"fixed": "fixed mesh", "driver": "driven mesh", "carried": "carried mesh"}
FORMULATIONS = {"standard": "standard MPM", "fbar": "F-bar patch"}


def profile(job: Job) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n) initial height, vertical Cauchy stress and initial volume of the points at the end."""
    points, end = job.points, job.points.n_steps - 1
    axis = job.n_dim - 1
    height = points.points(end)[:, axis] - points.field("U", end)[:, axis]
    volume = points.field("VOL", end) / points.field("JBAR", end)
    return height, points.field("S", end)[:, axis], volume


def stress_error(job: Job) -> float:
    """Mean of |stress - exact| over the initial volume, over the stress at the foot."""
    height, stress, volume = profile(job)
    exact = -WEIGHT * (HEIGHT - height)
    return float(np.abs(stress - exact) @ volume / (WEIGHT * HEIGHT * volume.sum()))


def draw_stress(jobs: dict[str, Job], path: Path) -> None:
    """Stress over initial height in the columns of 32 rows."""
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 5.0), sharex=True, sharey=True)
    for panel, (form, title) in zip(axes, FORMULATIONS.items()):
        for i, (mesh, label) in enumerate(MESHES.items()):
            height, stress, _ = profile(jobs[f"{mesh}-{form}-032"])
            style = {"linestyle": "none", "marker": MARKERS[i], "markersize": 2.5}
            panel.plot(stress / 1e3, height, color=COLORS[i], label=label, **style)
        panel.plot([-WEIGHT * HEIGHT / 1e3, 0], [0, HEIGHT], color="black", label="exact")
        panel.set(title=title, xlabel="vertical stress [kPa]")
    axes[0].set_ylabel("initial height [m]")
    axes[0].legend(loc="upper left")
    save(figure, path)


def draw_errors(jobs: dict[str, Job], path: Path) -> None:
    """Error norm over the size of the cells."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, (mesh, label) in enumerate(MESHES.items()):
        for form, title in FORMULATIONS.items():
            names = sorted(name for name in jobs if name.startswith(f"{mesh}-{form}-0"))
            names += sorted(name for name in jobs if name.startswith(f"{mesh}-{form}-1"))
            h = [HEIGHT / int(name.rsplit("-", 1)[1]) for name in names]
            errors = [stress_error(jobs[name]) for name in names]
            line = {"color": COLORS[i], "marker": MARKERS[i]}
            line["linestyle"] = "-" if form == "standard" else "--"
            axes.loglog(h, errors, label=f"{label}, {title}", **line)
    axes.set(xlabel="height of a row of cells [m]", ylabel="error norm of the stress")
    axes.set_xticks([0.4, 0.8, 1.6, 3.1, 6.2], ["0.4", "0.8", "1.6", "3.1", "6.2"])
    axes.set_xticks([], minor=True)
    ticks = [0.002, 0.005, 0.01, 0.02, 0.05, 0.1]
    axes.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.legend(loc="best", fontsize=9)
    save(figure, path)
