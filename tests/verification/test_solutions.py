"""The exact solutions that verification cases are judged by, against quadrature and each other."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from verification.solutions.radial_model import (  # noqa: E402
    Material,
    RadialModel,
    compressible_pressure,
)
from verification.solutions.thick_ring import (  # noqa: E402
    CYLINDER,
    SPHERE,
    ThickRing,
    dilogarithm,
)

BOTH = pytest.mark.parametrize("m", [CYLINDER, SPHERE])


def ring(m, strength=50.0):
    return ThickRing(m, 1.0, 2.0, 1000.0 / 3.0, strength)


def integral(f, start, end):
    """Gauss-Legendre quadrature with 60 points."""
    x, w = np.polynomial.legendre.leggauss(60)
    return 0.5 * (end - start) * np.sum(w * f(0.5 * (end - start) * x + 0.5 * (end + start)))


@pytest.mark.parametrize("x", [1e-4, 0.1, 0.5, 0.9])
def test_dilogarithm_is_its_integral(x):
    assert dilogarithm(x) == pytest.approx(integral(lambda t: -np.log1p(-t) / t, 0, x), rel=1e-11)


def test_dilogarithm_at_one():
    assert dilogarithm(1.0) == pytest.approx(math.pi**2 / 6, rel=1e-15)


@BOTH
@pytest.mark.parametrize("a", [1.02, 1.1, 1.5, 2.0])
@pytest.mark.parametrize("strength", [50.0, math.inf])
def test_pressure_is_the_integral_over_the_wall(m, a, strength):
    """From the strains of every radius, without the dilogarithm and the plastic radius."""
    wall = ring(m, strength)
    k = a**m - 1.0

    def integrand(r):
        reference = (r**m - k) ** (1.0 / m)
        hoop = np.log(r / reference)
        elastic = 2.0 * wall.shear_modulus * m * hoop
        limit = strength * (2.0 / math.sqrt(3.0) if m == CYLINDER else 1.0)
        return (m - 1) * np.minimum(elastic, limit) / r

    c = wall.plastic_radius(a)  # only where the quadrature is cut
    expected = integral(integrand, a, c) + integral(integrand, c, wall.outer_radius(a))
    assert wall.pressure(a) == pytest.approx(expected, rel=1e-12)


@BOTH
def test_stages_of_the_wall(m):
    """At 1.02 elastic, at 1.1 partly plastic, at 1.5 plastic throughout."""
    wall = ring(m)
    assert wall.plastic_radius(1.02) == 1.02
    assert 1.1 < wall.plastic_radius(1.1) < wall.outer_radius(1.1)
    assert wall.plastic_radius(1.5) == wall.outer_radius(1.5)


@BOTH
def test_yield_begins_at_the_plastic_radius(m):
    wall = ring(m)
    c = wall.plastic_radius(1.1)
    just_outside = wall.stress_difference(c * (1.0 + 1e-12), 1.1)
    assert just_outside == pytest.approx(wall.largest_difference, rel=1e-9)
    assert wall.stress_difference(1.01 * c, 1.1) < 0.99 * wall.largest_difference
    assert wall.stress_difference(0.99 * c, 1.1) == wall.largest_difference


@BOTH
@pytest.mark.parametrize("a", [1.02, 1.1, 2.0])
def test_stress_is_in_equilibrium(m, a):
    """d sigma_r / dr = (m - 1)(sigma_theta - sigma_r)/r, (23c), by central differences."""
    wall = ring(m)
    r = np.linspace(1.001 * a, 0.999 * wall.outer_radius(a), 37)
    r = r[np.abs(r - wall.plastic_radius(a)) > 1e-3]
    slope = (wall.radial_stress(r + 1e-5, a) - wall.radial_stress(r - 1e-5, a)) / 2e-5
    assert slope == pytest.approx((m - 1) * wall.stress_difference(r, a) / r, rel=1e-6)
    assert wall.radial_stress(wall.outer_radius(a), a) == pytest.approx(0.0, abs=1e-13)


@BOTH
def test_work_of_pressure_is_energy_of_an_elastic_wall(m):
    """dW/da = p a^(m-1), W = integral of G eps:eps R^(m-1) dR."""
    wall = ring(m, math.inf)

    def energy(a):
        def density(reference):
            r = (reference**m + wall.swelling(a)) ** (1.0 / m)
            strain = np.log(r / reference)
            squares = 2.0 * strain**2 if m == CYLINDER else 6.0 * strain**2
            return wall.shear_modulus * squares * reference ** (m - 1)

        return integral(density, 1.0, 2.0)

    slope = (energy(1.5 + 1e-4) - energy(1.5 - 1e-4)) / 2e-4
    assert wall.pressure(1.5) * 1.5 ** (m - 1) == pytest.approx(slope, rel=1e-7)


def test_limit_of_the_cylinder():
    """2 c ln(b/a) with c = sigma_y/sqrt(3)."""
    expected = 2.0 * 50.0 / math.sqrt(3.0) * math.log(2.0)
    assert ring(CYLINDER).limit_pressure() == pytest.approx(expected, rel=1e-15)


def test_limit_of_the_sphere():
    assert ring(SPHERE).limit_pressure() == pytest.approx(100.0 * math.log(2.0), rel=1e-15)


@BOTH
def test_stiff_walls_reach_the_limit_pressure(m):
    wall = ThickRing(m, 1.0, 2.0, 1e9, 1.0)
    assert wall.pressure(1.0 + 1e-6) == pytest.approx(wall.limit_pressure(), rel=5e-6)


@BOTH
def test_small_elastic_strain_gives_lame(m):
    """Lame's thick ring, incompressible: p = 2 G (m - 1) u/a (1 - (a/b)^m)."""
    wall = ring(m, math.inf)
    u = 1e-7
    expected = 2.0 * wall.shear_modulus * (m - 1) * u * (1.0 - 0.5**m)
    assert wall.pressure(1.0 + u) == pytest.approx(expected, rel=1e-6)


@BOTH
def test_small_strain_of_the_compressible_model_is_lame(m):
    """Radial displacement A r + B / r^(m-1), free outside."""
    material = Material(1000.0, 0.3)
    bulk, shear = material.bulk_modulus, material.shear_modulus
    if m == CYLINDER:  # sigma_r = 2 (K + G/3) A - 2 G B / r^2
        of_a, of_b = 2.0 * (bulk + shear / 3.0), -2.0 * shear
    else:  # sigma_r = 3 K A - 4 G B / r^3
        of_a, of_b = 3.0 * bulk, -4.0 * shear
    system = [[1.0, 1.0], [of_a, of_b / 2.0**m]]
    a, b = np.linalg.solve(system, [1e-7, 0.0])
    found = compressible_pressure(m, (1.0, 2.0, 1.0 + 1e-7), material, steps=1)
    assert found == pytest.approx(-(of_a * a + of_b * b), rel=2e-7)


@BOTH
@pytest.mark.parametrize(("strength", "rel"), [(50.0, 2e-6), (math.inf, 2e-6)])
def test_model_tends_to_the_exact_solution(m, strength, rel):
    """An almost incompressible wall; what is left falls with 1 - 2 nu."""
    found = {}
    for poisson in (0.4999, 0.49999):
        material = Material(1000.0, poisson, strength)
        exact = ThickRing(m, 1.0, 2.0, material.shear_modulus, strength).pressure(1.5)
        found[poisson] = compressible_pressure(m, (1.0, 2.0, 1.5), material, steps=50) / exact - 1.0
    assert found[0.49999] == pytest.approx(0.1 * found[0.4999], rel=0.1)
    assert abs(found[0.4999] - 10.0 * found[0.49999]) < rel


@BOTH
def test_tangent_of_the_model_is_its_derivative(m):
    model = RadialModel(m, 1.0, 2.0, Material(1000.0, 0.3, 50.0), 6)
    model.widen(1.1)
    u = model.u + 1e-3 * np.sin(np.arange(7.0))
    _, banded, _ = model._forces(u)
    dense = np.diag(banded[1]) + np.diag(banded[0, 1:], 1) + np.diag(banded[2, :-1], -1)
    step = 1e-7
    for i in range(7):
        change = step * (np.arange(7) == i)
        difference = model._forces(u + change)[0] - model._forces(u - change)[0]
        assert dense[:, i] == pytest.approx(difference / (2 * step), rel=1e-5, abs=1e-4)
