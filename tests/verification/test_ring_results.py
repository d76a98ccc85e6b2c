"""How the pressure on a widened ring is taken from the results of a run."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from verification.solutions.ring_results import (  # noqa: E402
    inner_facets,
    inner_pressures,
    outer_ratio,
    unit_pressure_forces,
)
from verification.solutions.thick_ring import CYLINDER, ThickRing  # noqa: E402


def test_forces_on_a_quarter_circle():
    """A pressure of 1 on a chain from axis to axis: the radius in each direction."""
    angle = np.linspace(0.0, 0.5 * math.pi, 8)
    x = 1.5 * np.array([np.cos(angle), np.sin(angle), 0.0 * angle]).T
    facets = np.array([[i + 1, i] if i % 2 else [i, i + 1] for i in range(7)])
    force = unit_pressure_forces(x, facets)
    assert force.sum(axis=0) == pytest.approx([1.5, 1.5, 0.0], abs=1e-14)


def test_forces_are_the_derivative_of_an_area():
    """A pentagon around the origin."""
    angle = np.array([0.1, 1.3, 2.7, 4.0, 5.2])
    x = np.array([np.cos(angle), 1.3 * np.sin(angle), 0.0 * angle]).T
    facets = np.array([[0, 1], [2, 1], [2, 3], [4, 3], [4, 0]])

    def area(x):
        a, b = x[facets[:, 0]], x[facets[:, 1]]
        return np.abs(0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])).sum()

    check_derivative(area, x, facets, n_dim=2)


def test_forces_are_the_derivative_of_a_volume():
    """An octahedron around the origin, faces in any order of nodes."""
    x = np.array(
        [[1, 0.1, 0], [-1.2, 0, 0], [0, 1.1, 0.2], [0.1, -1, 0], [0, 0, 0.9], [0, 0.1, -1]]
    )
    facets = np.array([[a, b, c] for a in (0, 1) for b in (2, 3) for c in (4, 5)])

    def volume(x):
        return np.abs(np.linalg.det(x[facets])).sum() / 6.0

    check_derivative(volume, x, facets, n_dim=3)


def check_derivative(measure, x, facets, n_dim):
    force = unit_pressure_forces(x, facets)
    for node in range(len(x)):
        for i in range(n_dim):
            step = np.zeros_like(x)
            step[node, i] = 1e-6
            slope = (measure(x + step) - measure(x - step)) / 2e-6
            assert force[node, i] == pytest.approx(slope, abs=1e-8)


def test_inner_facets_of_triangles():
    """Edges between two inner nodes; a triangle with one inner node has none."""
    cells = np.array([[0, 1, 2], [1, 2, 3], [4, 0, 1]])
    on_inner = np.array([True, True, False, False, False])
    assert inner_facets(cells, on_inner, 2).tolist() == [[0, 1], [0, 1]]


def test_inner_facets_of_tetrahedra():
    cells = np.array([[0, 1, 2, 3], [3, 1, 2, 4]])
    on_inner = np.array([True, True, True, False, False])
    assert inner_facets(cells, on_inner, 3).tolist() == [[0, 1, 2]]


# A run whose reactions are those of a pressure of 3, plus what planes of symmetry add.


class FakeMesh:
    """A quarter of a ring, two outputs: the second one widened by half."""

    n_steps = 2
    start = np.array([[1, 0, 0], [0.6, 0.8, 0], [0, 1, 0], [2, 0, 0], [1.2, 1.6, 0], [0, 2.0, 0]])
    triangles = np.array([[0, 3, 1], [3, 4, 1], [1, 4, 2], [4, 5, 2]])

    def points(self, step):
        return self.start * (1.0 + 0.5 * step)

    def cells(self, step):
        return self.triangles

    def field(self, name, step):
        assert name == "RF"
        force = 3.0 * unit_pressure_forces(self.points(step), np.array([[0, 1], [1, 2]]))[:, :2]
        force[3:] = 0.0
        force[0, 1] += 7.0  # the roller on y = 0
        force[2, 0] -= 5.0  # the roller on x = 0
        force[3, 1] += 4.0
        return force


class FakeJob:
    n_dim = 2

    def need_mesh(self):
        return FakeMesh()


def test_pressure_does_the_work_of_the_reactions():
    radii, pressures = inner_pressures(FakeJob(), 1.0)
    assert radii == pytest.approx([1.0, 1.5], rel=1e-15)
    assert pressures == pytest.approx([3.0, 3.0], rel=1e-14)


def test_outer_displacement_is_compared_with_the_exact_one():
    """2 m become 3 m, exactly they would become sqrt(4 + 1.25) m."""
    ring = ThickRing(CYLINDER, 1.0, 2.0, 1.0)
    assert outer_ratio(FakeJob(), ring) == pytest.approx(1.0 / (math.sqrt(5.25) - 2.0), rel=1e-14)
