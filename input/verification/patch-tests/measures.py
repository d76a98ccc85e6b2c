"""Largest differences from exact.json over all points and all outputs of a job."""

import json
from pathlib import Path

import numpy as np
from tessera_post.job import Job
from tessera_post.style import COLORS, MARKERS, plt, save

EXACT = json.loads(Path(__file__).with_name("exact.json").read_text(encoding="utf-8"))


def stress_error(job: Job) -> float:
    """Of Cauchy and Kirchhoff stress, over the largest one."""
    return largest_error(job, ("S", "TAU"))


def strain_error(job: Job) -> float:
    """Of the elastic logarithmic and the accumulated plastic strain, over the largest one."""
    return largest_error(job, ("LE", "PEEQ"))


def motion_error(job: Job) -> float:
    """Of deformation gradient and Jacobian, and of the places of the points over the body's."""
    errors = [largest_error(job, ("F",)), largest_error(job, ("JBAR",)), place_error(job)]
    return float(np.max(errors))  # NaN stays, the max of Python may lose it


def largest_error(job: Job, names: tuple[str, ...]) -> float:
    """Over the largest exact value of the fields in the run."""
    errors, sizes = [0.0], [0.0]
    for output, exact in outputs(job):
        for name in names:
            wanted = np.array(exact[name])
            found = job.points.field(name, output).reshape(-1, len(wanted))
            errors.append(float(np.abs(found - wanted).max()))
            sizes.append(float(np.abs(wanted).max()))
    return float(np.max(errors) / np.max(sizes))


def place_error(job: Job) -> float:
    """x = F X + shift, where X is where the point was before it had a displacement."""
    errors, sizes = [], []
    for output, exact in outputs(job):
        x = job.points.points(output)
        first = x - job.points.field("U", output)
        wanted = first @ np.array(exact["F"]).reshape(3, 3).T + np.array(exact["shift"])
        errors.append(float(np.abs(x - wanted).max()))
        sizes.append(float(np.abs(wanted).max()))
    return float(np.max(errors) / np.max(sizes))


def outputs(job: Job) -> list[tuple[int, dict[str, list[float]]]]:
    """The outputs at the ends of the steps, with the exact fields of each."""
    states = EXACT["states"][job.name]
    return [(job.output_of(time=float(time)), exact) for time, exact in states.items()]


def flow_error(job: Job) -> float:
    """Of the stress TAU11 in simple shear against the solution for infinitely many increments."""
    found = job.points.field("TAU", job.points.n_steps - 1)[:, 0]
    wanted = EXACT["flowing_shear"]["TAU11"][-1]
    return float(np.abs(found / wanted - 1.0).max())


def draw_shear(jobs: dict[str, Job], path: Path) -> None:
    """Stress of the middle of the body over the shear, with the limit of small increments."""
    exact = EXACT["flowing_shear"]
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, component in enumerate(("TAU11", "TAU12")):
        axes.plot(exact["gamma"], exact[component], color="0.4", linestyle=("-", "--")[i],
                  label=f"{component}, exact for small increments")  # fmt: skip
        for k, n in enumerate((10, 40)):
            job = jobs[f"turning-{n}-2d-standard-plastic"]
            gamma = exact["gamma"][-1] * job.history["time"]
            stress = job.history[f"S{component[3:]}[0 0]"]
            axes.plot(gamma, stress, linestyle="", marker=MARKERS[k], color=COLORS[k],
                      markersize=4, label=f"{n} increments" if i == 0 else None)  # fmt: skip
    axes.set(xlabel="shear", ylabel="Kirchhoff stress")
    axes.legend(loc="best")
    save(figure, path)
