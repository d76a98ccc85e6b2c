"""Thick cylinder (plane strain) or sphere that is widened from inside: exact solution.

Incompressible, elastic by Hencky's law, then plastic by von Mises with linear hardening or none.
The radius of every material point follows from the inner radius alone, so everything is known in
closed form. Source: docs/theory.md, section 18, (23) to (23h).
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import spence

CYLINDER, SPHERE = 2, 3


def dilogarithm(x):
    """Li2(x), the integral of -ln(1 - t)/t from 0 to x, for x <= 1."""
    return spence(1.0 - np.asarray(x, dtype=float))


@dataclass(frozen=True)
class ThickRing:
    """A thick cylinder or sphere, free outside.

    m              2 for the cylinder, 3 for the sphere
    inner, outer   radii a0 and b0 before loading [length]
    shear_modulus  G [stress]
    strength       uniaxial yield stress, math.inf for an elastic ring [stress]
    hardening      rise of the yield stress with the plastic strain [stress]
    """

    m: int
    inner: float
    outer: float
    shear_modulus: float
    strength: float = math.inf
    hardening: float = 0.0

    @property
    def first_difference(self) -> float:
        """Hoop less radial stress at first yield, Y of (23d) [stress]."""
        return self.strength * (2.0 / math.sqrt(3.0) if self.m == CYLINDER else 1.0)

    @property
    def plastic_share(self) -> float:
        """eta of (23d), the slope of the stress where it flows over the elastic one."""
        return self.hardening / (3.0 * self.shear_modulus + self.hardening)

    def swelling(self, a: float) -> float:
        """k = r^m - R^m of all points when the inner radius is a (23)."""
        return a**self.m - self.inner**self.m

    def outer_radius(self, a: float) -> float:
        """b, the outer radius when the inner one is a (23) [length]."""
        return (self.outer**self.m + self.swelling(a)) ** (1.0 / self.m)

    def plastic_radius(self, a: float) -> float:
        """c of (23e), within a and b: the material flows between a and c [length]."""
        elastic_limit = -math.expm1(-self.first_difference / (2.0 * self.shear_modulus))
        c = (self.swelling(a) / elastic_limit) ** (1.0 / self.m)
        return min(max(c, a), self.outer_radius(a))

    def stress_difference(self, r, a: float):
        """Hoop less radial stress at r (23b), (23d) [stress]."""
        elastic = -2.0 * self.shear_modulus * np.log1p(-self.swelling(a) / np.asarray(r) ** self.m)
        beyond = np.maximum(elastic - self.first_difference, 0.0)
        return np.minimum(elastic, self.first_difference) + self.plastic_share * beyond

    def radial_stress(self, r, a: float):
        """Radial stress at r (23f) [stress]."""
        c, k = self.plastic_radius(a), self.swelling(a)
        r = np.asarray(r, dtype=float)
        slope = 2.0 * self.shear_modulus / self.m
        at_r, at_c, at_b = (
            dilogarithm(k / radius**self.m)
            for radius in (r, np.maximum(r, c), self.outer_radius(a))
        )  # fmt: skip
        integral = slope * (at_c - at_b)
        if c > a:
            constant = (1.0 - self.plastic_share) * self.first_difference
            integral += constant * np.log(np.maximum(r, c) / r)
            integral += self.plastic_share * slope * (at_r - at_c)
        return -(self.m - 1) * integral

    def mean_stress(self, r, a: float):
        """A third of the trace of the stress at r (23g) [stress]."""
        share = 0.5 if self.m == CYLINDER else 2.0 / 3.0
        return self.radial_stress(r, a) + share * self.stress_difference(r, a)

    def pressure(self, a: float) -> float:
        """Pressure on the inner surface when its radius is a (23f) [stress]."""
        return -float(self.radial_stress(a, a))

    def limit_pressure(self) -> float:
        """Limit pressure at small strain without hardening (23h) [stress]."""
        return (self.m - 1) * self.first_difference * math.log(self.outer / self.inner)
