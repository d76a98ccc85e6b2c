"""Measures and figures of the thick cylinder; radii in m, stresses in MPa."""

from pathlib import Path

from tessera_post.job import Job
from verification.solutions.radial_model import Material
from verification.solutions.ring_case import RingCase
from verification.solutions.thick_ring import CYLINDER

CASE = RingCase(
    CYLINDER,
    inner=1.0,
    outer=2.0,
    materials={
        "elastic": Material(1000.0, 0.499),
        "hardening": Material(1000.0, 0.499, 50.0, 200.0),
        "incompressible": Material(1000.0, 0.4999, 50.0, 200.0),
        "perfect": Material(1000.0, 0.499, 50.0),
        "large": Material(1000.0, 0.499, 50.0),
        "limit": Material(1000.0, 0.499, 0.1),
    },
)

pressure = CASE.pressure
pressure_to_model = CASE.pressure_to_model
outer_displacement = CASE.outer_displacement
mean_stress_error = CASE.mean_stress_error


def draw_pressure(jobs: dict[str, Job], path: Path) -> None:
    """Pressure over radius, with and without hardening."""
    chosen = {
        "hardening, F-bar patch": "hardening-8-fbar",
        "hardening, standard": "hardening-8-standard",
        "perfectly plastic, F-bar patch": "perfect-8-fbar",
        "perfectly plastic, standard": "large-8-standard",
    }
    CASE.draw_pressure([(label, jobs[name]) for label, name in chosen.items()], path)


def draw_mean_stress(jobs: dict[str, Job], path: Path) -> None:
    """Mean stress through the wall, hardening."""
    CASE.draw_mean_stress([jobs["hardening-8-standard"], jobs["hardening-8-fbar"]], path)
