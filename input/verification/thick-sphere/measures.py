"""Measures and figures of the thick sphere; radii in m, stresses in MPa."""

from pathlib import Path

from tessera_post.job import Job
from verification.solutions.radial_model import Material
from verification.solutions.ring_case import RingCase
from verification.solutions.thick_ring import SPHERE

CASE = RingCase(
    SPHERE,
    inner=1.0,
    outer=2.0,
    materials={
        "elastic": Material(1000.0, 0.499),
        "perfect": Material(1000.0, 0.499, 50.0),
        "incompressible": Material(1000.0, 0.4999, 50.0),
        "limit": Material(1000.0, 0.499, 0.1),
    },
)

pressure = CASE.pressure
pressure_to_model = CASE.pressure_to_model
outer_displacement = CASE.outer_displacement
mean_stress_error = CASE.mean_stress_error


def draw_pressure(jobs: dict[str, Job], path: Path) -> None:
    """Pressure over radius, perfectly plastic."""
    chosen = {
        "F-bar patch, 9 divisions": "perfect-9-fbar",
        "F-bar patch, 6 divisions": "perfect-6-fbar",
        "standard, 9 divisions": "perfect-9-standard",
    }
    CASE.draw_pressure([(label, jobs[name]) for label, name in chosen.items()], path)


def draw_mean_stress(jobs: dict[str, Job], path: Path) -> None:
    """Mean stress through the wall, perfectly plastic."""
    CASE.draw_mean_stress([jobs["perfect-6-standard"], jobs["perfect-6-fbar"]], path)
