"""Deflection of the cantilever against beam theory, and what it shows about the penalty."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save

LENGTH, DEPTH = 10.0, 1.0  # m
YOUNG, POISSON = 12000.0, 0.2  # kPa
LOAD = 100.0  # kN per m


@dataclass(frozen=True)
class Beam:
    """A straight beam clamped at one end; compliances are zero for the elastica."""

    length: float
    bending: float  # stiffness EI
    stretch: float = 0.0  # 1/EA
    shear: float = 0.0  # 1/kGA


def plane_strain_beam(length: float) -> Beam:
    """Beam of this material and depth: E' = E/(1 - nu^2), Cowper's shear coefficient."""
    young = YOUNG / (1 - POISSON**2)
    shear_modulus = YOUNG / (2 * (1 + POISSON))
    k = 10 * (1 + POISSON) / (12 + 11 * POISSON)
    return Beam(length, young * DEPTH**3 / 12, 1 / (young * DEPTH), 1 / (k * shear_modulus * DEPTH))


def slope(beam: Beam, load: float, state: np.ndarray) -> np.ndarray:
    """d(x, y, angle, curvature)/ds under a dead load downwards: equation (a) of the README."""
    _, _, angle, curvature = state
    stretch = 1 - load * np.sin(angle) * beam.stretch
    shear = -load * np.cos(angle) * beam.shear
    x = stretch * np.cos(angle) - shear * np.sin(angle)
    y = stretch * np.sin(angle) + shear * np.cos(angle)
    return np.array([x, y, curvature, load * x / beam.bending])


def end_of(beam: Beam, load: float, curvature: float, n_steps: int = 400) -> np.ndarray:
    """State at the loaded end for a curvature at the clamp, by Runge and Kutta."""
    state = np.array([0.0, 0.0, 0.0, curvature])
    for _ in range(n_steps):
        state = end_of_step(beam, load, state, beam.length / n_steps)
    return state


def end_of_step(beam: Beam, load: float, state: np.ndarray, h: float) -> np.ndarray:
    """State a length h further."""
    k1 = slope(beam, load, state)
    k2 = slope(beam, load, state + h / 2 * k1)
    k3 = slope(beam, load, state + h / 2 * k2)
    k4 = slope(beam, load, state + h * k3)
    return state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


@cache
def curvature_at_clamp(beam: Beam, load: float) -> float:
    """The curvature that leaves no moment at the loaded end, by bisection."""
    low, high = -load * 2 * beam.length / beam.bending, 0.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (low, middle) if end_of(beam, load, middle)[3] > 0.0 else (middle, high)
    return (low + high) / 2


def deflection(beam: Beam, load: float) -> tuple[float, float]:
    """How far the loaded end moves back and down."""
    end = end_of(beam, load, curvature_at_clamp(beam, load))
    return beam.length - end[0], -end[1]


def tip_displacement(job: Job) -> np.ndarray:
    """Mean displacement, back and down, of the points that carry the load."""
    points, end = job.points, job.points.n_steps - 1
    moved = points.field("U", end)[:, :2]
    start = points.points(end)[:, :2] - moved
    cell = cell_size(job)
    carries = (start[:, 0] > LENGTH - cell) & (np.abs(start[:, 1]) < cell)
    return -moved[carries].mean(axis=0)


def cell_size(job: Job) -> float:
    """Two linear elements, from the number over the depth in the name of the job."""
    return 2 * DEPTH / int(job.name.rsplit("-", 1)[1])


def over_beam(job: Job, direction: str) -> float:
    """Displacement of the load, back or down, over that of a shear-flexible beam."""
    beam = plane_strain_beam(LENGTH - cell_size(job) / 2)
    i = ["back", "down"].index(direction)
    return tip_displacement(job)[i] / deflection(beam, LOAD)[i]


def accepted_increments(job: Job) -> float:
    """Increments from start to end of the run."""
    return float(len(job.ledger["time"]) - 1)


def centre_line(beam: Beam, load: float, n_steps: int = 400) -> np.ndarray:
    """(n_steps + 1, 2) deflected centre line, curved by the load on its end."""
    state = np.array([0.0, 0.0, 0.0, curvature_at_clamp(beam, load)])
    line = [state[:2]]
    for _ in range(n_steps):
        state = end_of_step(beam, load, state, beam.length / n_steps)
        line.append(state[:2])
    return np.array(line)


def draw_beams(jobs: dict[str, Job], path: Path) -> None:
    """All material points at the full load, and the centre line of the shear-flexible beam."""
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 5.2), sharex=True, sharey=True)
    names = {"standard-on-16-08": "standard MPM", "fbar-on-16-08": "F-bar patch"}
    for i, (panel, (name, title)) in enumerate(zip(axes, names.items(), strict=True)):
        job = jobs[name]
        points = job.points.points(job.points.n_steps - 1)
        panel.plot(points[:, 0], points[:, 1], ".", markersize=1, color=COLORS[i])
        line = centre_line(plane_strain_beam(LENGTH - cell_size(job) / 2), LOAD)
        panel.plot(line[:, 0], line[:, 1], color="black", label="shear-flexible beam")
        panel.set(title=title, xlabel="x [m]", aspect="equal")
    axes[0].set_ylabel("y [m]")
    axes[0].legend(loc="lower left", fontsize=9)
    save(figure, path)


def draw_shares(jobs: dict[str, Job], path: Path) -> None:
    """Share of the load that the penalty carries, increment by increment."""
    figure, axes = plt.subplots(figsize=(7.0, 4.2))
    names = [name for name in sorted(jobs) if "-on-" in name]
    for i, name in enumerate(names):
        ledger = jobs[name].ledger
        load, share = LOAD * ledger["time"][1:], 100 * ledger["ghost_share"][1:]
        look = {"color": COLORS[i % len(COLORS)], "marker": MARKERS[i % len(MARKERS)]}
        formulation, _, points, elements = name.split("-")
        method = "F-bar patch" if formulation == "fbar" else "standard"
        label = f"{method}, {int(points)} points, {int(elements)} elements over the depth"
        axes.plot(load, share, markersize=3, label=label, **look)
    axes.set(xlabel="tip load [kN]", ylabel="share of the penalty [%]", ylim=(0, 1))
    axes.legend(loc="best", fontsize=8)
    save(figure, path)
