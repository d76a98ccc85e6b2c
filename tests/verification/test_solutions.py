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


# Uniaxial strength and hardening.
PERFECT, HARDENING, ELASTIC = (50.0, 0.0), (50.0, 200.0), (math.inf, 0.0)
ALL_LAWS = pytest.mark.parametrize("law", [PERFECT, HARDENING, ELASTIC])


def ring(m, law=PERFECT):
    return ThickRing(m, 1.0, 2.0, 1000.0 / 3.0, *law)


def integral(f, start, end):
    """Gauss-Legendre quadrature with 60 points."""
    x, w = np.polynomial.legendre.leggauss(60)
    return 0.5 * (end - start) * np.sum(w * f(0.5 * (end - start) * x + 0.5 * (end + start)))


@pytest.mark.parametrize("x", [1e-4, 0.1, 0.5, 0.9])
def test_dilogarithm_is_its_integral(x):
    assert dilogarithm(x) == pytest.approx(integral(lambda t: -np.log1p(-t) / t, 0, x), rel=1e-11)


def test_dilogarithm_at_one():
    assert dilogarithm(1.0) == pytest.approx(math.pi**2 / 6, rel=1e-15)


def difference_by_plastic_strain(wall, strain, m):
    """Hoop less radial stress from the plastic strain kappa that q = sigma_y + H kappa leaves."""
    equivalent = (2.0 / math.sqrt(3.0) if m == CYLINDER else 2.0) * strain
    excess = 3.0 * wall.shear_modulus * equivalent - wall.strength
    kappa = np.maximum(excess, 0.0) / (3.0 * wall.shear_modulus + wall.hardening)
    q = 3.0 * wall.shear_modulus * (equivalent - kappa)
    return q * (2.0 / math.sqrt(3.0) if m == CYLINDER else 1.0)


@BOTH
@ALL_LAWS
@pytest.mark.parametrize("a", [1.02, 1.1, 1.5, 2.0])
def test_pressure_is_the_integral_over_the_wall(m, law, a):
    """From the strain and plastic strain of every radius, without the dilogarithm."""
    wall = ring(m, law)
    k = a**m - 1.0

    def integrand(r):
        strain = np.log(r / (r**m - k) ** (1.0 / m))
        return (m - 1) * difference_by_plastic_strain(wall, strain, m) / r

    c = wall.plastic_radius(a)  # only where the quadrature is cut
    expected = integral(integrand, a, c) + integral(integrand, c, wall.outer_radius(a))
    assert wall.pressure(a) == pytest.approx(expected, rel=1e-11)


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
    assert just_outside == pytest.approx(wall.first_difference, rel=1e-9)
    assert wall.stress_difference(1.01 * c, 1.1) < 0.99 * wall.first_difference
    assert wall.stress_difference(0.99 * c, 1.1) == wall.first_difference


@BOTH
@ALL_LAWS
@pytest.mark.parametrize("a", [1.02, 1.1, 2.0])
def test_stress_is_in_equilibrium(m, law, a):
    """d sigma_r / dr = (m - 1)(sigma_theta - sigma_r)/r, (23c), by central differences."""
    wall = ring(m, law)
    r = np.linspace(1.001 * a, 0.999 * wall.outer_radius(a), 37)
    r = r[np.abs(r - wall.plastic_radius(a)) > 1e-3]
    slope = (wall.radial_stress(r + 1e-5, a) - wall.radial_stress(r - 1e-5, a)) / 2e-5
    assert slope == pytest.approx((m - 1) * wall.stress_difference(r, a) / r, rel=1e-6)
    assert wall.radial_stress(wall.outer_radius(a), a) == pytest.approx(0.0, abs=1e-13)


@BOTH
def test_work_of_pressure_is_energy_of_an_elastic_wall(m):
    """dW/da = p a^(m-1), W = integral of G eps:eps R^(m-1) dR."""
    wall = ring(m, ELASTIC)

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
    wall = ring(m, ELASTIC)
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
@ALL_LAWS
def test_model_tends_to_the_exact_solution(m, law):
    """An almost incompressible wall; what is left falls with 1 - 2 nu."""
    found = {}
    for poisson in (0.4999, 0.49999):
        material = Material(1000.0, poisson, *law)
        exact = ThickRing(m, 1.0, 2.0, material.shear_modulus, *law).pressure(1.5)
        found[poisson] = compressible_pressure(m, (1.0, 2.0, 1.5), material, steps=50) / exact - 1.0
    assert abs(found[0.4999]) < 1.3e-4
    assert found[0.49999] == pytest.approx(0.1 * found[0.4999], rel=0.1)


@BOTH
@ALL_LAWS
def test_mean_stress_is_that_of_the_model(m, law):
    material = Material(1000.0, 0.4999, *law)
    model = RadialModel(m, 1.0, 2.0, material, 200)
    for a in np.linspace(1.0, 1.2, 41)[1:]:
        model.widen(a)
    r = model.radius + model.u
    centre = 0.5 * (r[1:] + r[:-1])
    found = material.bulk_modulus * model.state.elastic.sum(axis=0)
    exact = ThickRing(m, 1.0, 2.0, material.shear_modulus, *law).mean_stress(centre, 1.2)
    assert found == pytest.approx(exact, abs=2e-3 * np.abs(exact).max())


@BOTH
def test_tangent_of_the_model_is_its_derivative(m):
    model = RadialModel(m, 1.0, 2.0, Material(1000.0, 0.3, *HARDENING), 6)
    model.widen(1.1)
    u = model.u + 1e-3 * np.sin(np.arange(7.0))
    _, banded, _ = model._forces(u)
    dense = np.diag(banded[1]) + np.diag(banded[0, 1:], 1) + np.diag(banded[2, :-1], -1)
    step = 1e-7
    for i in range(7):
        change = step * (np.arange(7) == i)
        difference = model._forces(u + change)[0] - model._forces(u - change)[0]
        assert dense[:, i] == pytest.approx(difference / (2 * step), rel=1e-5, abs=1e-4)
