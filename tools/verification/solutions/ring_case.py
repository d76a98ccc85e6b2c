"""The measures and figures that the cases of the thick cylinder and the thick sphere share."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tessera_post.job import Job
from tessera_post.style import COLOR_OF, COLORS, MARKERS, plt, save

from verification.solutions.radial_model import Material, compressible_pressure
from verification.solutions.ring_results import (
    inner_pressures,
    mean_stress_error,
    mean_stresses,
    outer_ratio,
)
from verification.solutions.thick_ring import ThickRing


@dataclass(frozen=True)
class RingCase:
    """Jobs of one shape.

    m              2 for the cylinder, 3 for the sphere
    inner, outer   radii before loading [length]
    materials      by the first word of the name of a job
    """

    m: int
    inner: float
    outer: float
    materials: dict[str, Material]

    def material(self, job: Job) -> Material:
        """The material of a job."""
        return self.materials[job.name.partition("-")[0]]

    def ring(self, job: Job) -> ThickRing:
        """The incompressible body that a job is compared with."""
        material = self.material(job)
        return ThickRing(
            self.m,
            self.inner,
            self.outer,
            material.shear_modulus,
            material.strength,
            material.hardening,
        )

    def pressure(self, job: Job) -> float:
        """Inner pressure at the end over the exact one."""
        radii, pressures = inner_pressures(job, self.inner)
        return pressures[-1] / self.ring(job).pressure(radii[-1])

    def pressure_to_model(self, job: Job) -> float:
        """Inner pressure at the end over that of the compressible model along the radius."""
        radii, pressures = inner_pressures(job, self.inner)
        reference = compressible_pressure(
            self.m, (self.inner, self.outer, radii[-1]), self.material(job)
        )
        return pressures[-1] / reference

    def outer_displacement(self, job: Job) -> float:
        """Mean displacement of the outer surface at the end over the exact one."""
        return outer_ratio(job, self.ring(job))

    def mean_stress_error(self, job: Job) -> float:
        """Norm of the error of the mean stress at the end over the norm of the mean stress."""
        return mean_stress_error(job, self.ring(job))

    def draw_pressure(self, jobs: Sequence[tuple[str, Job]], path: Path) -> None:
        """Inner pressure over inner radius: exact lines, and labelled marks of the runs."""
        figure, axes = plt.subplots(figsize=(7.0, 4.6))
        drawn = set()
        for i, (label, job) in enumerate(jobs):
            ring = self.ring(job)
            radii, pressures = inner_pressures(job, self.inner)
            axes.plot(radii, pressures, MARKERS[i], color=COLORS[i], fillstyle="none", label=label)
            if (ring, radii[-1]) not in drawn:
                a = np.linspace(self.inner, radii[-1], 400)
                exact = [ring.pressure(value) for value in a]
                axes.plot(a, exact, color="0.2", zorder=1, label=None if drawn else "exact")
                drawn.add((ring, radii[-1]))
        axes.set(xlabel="inner radius [m]", ylabel="inner pressure [MPa]")
        axes.legend(loc="best")
        save(figure, path)

    def draw_mean_stress(self, jobs: Sequence[Job], path: Path) -> None:
        """Mean stress of the material points over the radius, one panel for each job."""
        figure, panels = plt.subplots(1, len(jobs), figsize=(9.5, 4.2), squeeze=False)
        for axes, job in zip(panels[0], jobs):
            r, found, exact = mean_stresses(job, self.ring(job))
            order = np.argsort(r)
            color = COLOR_OF[job.formulation]
            axes.plot(r, found, ".", color=color, markersize=3, label=job.formulation)
            axes.plot(r[order], exact[order], color="0.0", label="exact")
            axes.set(xlabel="radius [m]", ylabel="mean stress [MPa]")
            axes.legend(loc="best")
        save(figure, path)
