"""Thick cylinder or sphere of a compressible material, solved along the radius alone.

The exact solution of thick_ring.py is that of an incompressible body; a body with Poisson's ratio
0.499 is not one. This model has the same law as the program (Hencky, von Mises) and shows by how
much the pressure differs. Source: docs/theory.md, section 18, (23i).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from verification.solutions.thick_ring import SPHERE

MOST_ITERATIONS = 25
TOLERANCE = 1e-10  # of a correction, over the largest displacement


@dataclass(frozen=True)
class Material:
    """Isotropic, linear in logarithmic strain; plastic by von Mises.

    young, poisson   Young's modulus [stress], Poisson's ratio [-]
    strength         uniaxial yield stress of the Kirchhoff stress [stress]
    hardening        its rise with the plastic strain [stress]
    """

    young: float
    poisson: float
    strength: float = np.inf
    hardening: float = 0.0

    @property
    def shear_modulus(self) -> float:
        """G [stress]."""
        return self.young / (2.0 * (1.0 + self.poisson))

    @property
    def bulk_modulus(self) -> float:
        """K [stress]."""
        return self.young / (3.0 * (1.0 - 2.0 * self.poisson))


@dataclass
class State:
    """What the shells remember: (3, n) elastic logarithmic, (n) plastic strain [-]."""

    elastic: np.ndarray
    plastic: np.ndarray


def update_stress(material: Material, state: State, step: np.ndarray):
    """Closed radial return in principal axes.

    step    (3, n) increment of the logarithmic strain [-]
    Answers (3, n) Kirchhoff stress [stress], (3, 3, n) its derivative, the state after the step.
    """
    twice_g, h = 2.0 * material.shear_modulus, material.hardening
    trial = state.elastic + step
    mean = trial.mean(axis=0)
    deviator = trial - mean
    size = np.maximum(np.sqrt(1.5) * np.linalg.norm(deviator, axis=0), 1e-300)
    beyond = np.maximum(twice_g * size - material.strength - h * state.plastic, 0.0)
    flow = beyond / (1.5 * twice_g + h)
    kept = 1.0 - 1.5 * flow / size
    normal = np.sqrt(1.5) * deviator / size
    turned = np.where(beyond > 0.0, kept - h / (1.5 * twice_g + h), 0.0)
    projector = (np.eye(3) - 1.0 / 3.0)[:, :, None]
    rate = material.bulk_modulus + twice_g * (
        kept * projector - turned * normal[:, None, :] * normal[None, :, :]
    )
    tau = 3.0 * material.bulk_modulus * mean + twice_g * kept * deviator
    return tau, rate, State(mean + kept * deviator, state.plastic + flow)


class RadialModel:
    """The wall of the ring, cut into shells with one sample each.

    m          2 for the cylinder (plane strain), 3 for the sphere
    material   of the wall
    radius     (n + 1) radii of the shells before loading [length]
    u          (n + 1) radial displacement now [length]
    pressure   on the inner surface now [stress]
    """

    def __init__(
        self, m: int, inner: float, outer: float, material: Material, n_shells: int
    ) -> None:
        self.m = m
        self.material = material
        self.radius = np.geomspace(inner, outer, n_shells + 1)
        self.u = np.zeros(n_shells + 1)
        self.state = State(np.zeros((3, n_shells)), np.zeros(n_shells))
        self.pressure = 0.0
        thickness = np.diff(self.radius)
        centre = 0.5 * (self.radius[1:] + self.radius[:-1])
        weight = centre ** (m - 1) * thickness
        self._share = np.array([weight, (m - 1) * weight])
        # d (radial, hoop stretch) / d (inner, outer displacement) of the shells
        self._slope = np.array([[-1.0 / thickness, 1.0 / thickness], [0.5 / centre] * 2])

    def _stretch_less_one(self, u: np.ndarray) -> np.ndarray:
        """(2, n) radial and hoop stretch of the shells, less 1."""
        return np.einsum("iae,ae->ie", self._slope, np.array([u[:-1], u[1:]]))

    def _forces(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, State]:
        """Internal forces (n + 1), banded tangent (3, n + 1), state of the shells at u."""
        before, now = self._stretch_less_one(self.u), self._stretch_less_one(u)
        radial, hoop = np.log1p((now - before) / (1.0 + before))
        third = hoop if self.m == SPHERE else np.zeros_like(hoop)
        step = np.array([radial, hoop, third])
        tau, rate, state = update_stress(self.material, self.state, step)
        if self.m == SPHERE:  # both hoop strains are one unknown
            rate[:, 1] += rate[:, 2]
        stretch = 1.0 + now
        nominal = self._share * tau[:2] / stretch
        modulus = rate[:2, :2] - np.eye(2)[:, :, None] * tau[:2, None, :]
        modulus = self._share[:, None, :] * modulus / (stretch[:, None, :] * stretch[None, :, :])
        force = np.einsum("ie,iae->ae", nominal, self._slope)
        block = np.einsum("iae,ije,jbe->abe", self._slope, modulus, self._slope)
        return (*self._assembled(force, block), state)

    def _assembled(self, force: np.ndarray, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sums over the shells: forces and banded tangent of the radii."""
        internal, tangent = np.zeros(len(self.u)), np.zeros((3, len(self.u)))
        internal[:-1] += force[0]
        internal[1:] += force[1]
        tangent[0, 1:] = block[0, 1]
        tangent[1, :-1] += block[0, 0]
        tangent[1, 1:] += block[1, 1]
        tangent[2, :-1] = block[1, 0]
        return internal, tangent

    def widen(self, a: float) -> float:
        """One increment to the inner radius a; answers the pressure on it [stress]."""
        r = self.radius + self.u
        u = self.u + isochoric_step(r, a, self.m)
        for _ in range(MOST_ITERATIONS):
            internal, tangent, state = self._forces(u)
            reaction = internal[0]
            tangent[1, 0], tangent[0, 1] = 1.0, 0.0
            internal[0] = 0.0
            correction = solve_banded((1, 1), tangent, internal)
            if np.abs(correction).max() <= TOLERANCE * np.abs(u).max():
                self.u, self.state = u, state
                self.pressure = reaction / a ** (self.m - 1)
                return self.pressure
            u = u - correction
        raise RuntimeError(f"no equilibrium at the inner radius {a:g}: correction {correction}")


def isochoric_step(r: np.ndarray, a: float, m: int) -> np.ndarray:
    """Displacements at the radii r that take the first one to a and keep the volume [length]."""
    swelling = a**m - r[0] ** m
    step = r * np.expm1(np.log1p(swelling / r**m) / m)
    step[0] = a - r[0]
    return step


def compressible_pressure(
    m: int, radii: tuple[float, float, float], material: Material, n_shells: int = 200, steps=400
) -> float:
    """Inner pressure of a compressible ring [stress].

    radii   inner and outer radius before loading, inner radius at the end [length]
    """
    inner, outer, final = radii
    found = []
    for n in (n_shells // 2, n_shells):
        model = RadialModel(m, inner, outer, material, n)
        for a in np.geomspace(inner, final, steps + 1)[1:]:
            model.widen(a)
        found.append(model.pressure)
    return (4.0 * found[1] - found[0]) / 3.0
