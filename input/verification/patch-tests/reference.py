"""The exact state of a body that deforms homogeneously: Hencky elasticity, von Mises plasticity.

Every increment is a deformation gradient A and a shift d: x = A x + d. The elastic left
Cauchy-Green tensor goes from b to A b A^T, its logarithm is returned to the yield surface in closed
form (docs/theory.md, sections 4.1 to 4.4). Tensors are 3x3, also in plane strain.
"""

import math
from dataclasses import dataclass

import numpy as np

VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


@dataclass(frozen=True)
class Material:
    """Young's modulus, Poisson's ratio, uniaxial strength, slope of its hardening."""

    young: float
    poisson: float
    strength: float = math.inf  # infinite: elastic
    slope: float = 0.0

    @property
    def shear(self) -> float:
        return self.young / (2.0 * (1.0 + self.poisson))

    @property
    def bulk(self) -> float:
        return self.young / (3.0 * (1.0 - 2.0 * self.poisson))

    def card(self) -> str:
        """The lines of a deck."""
        text = f"*MATERIAL, NAME=BLOCK\n*ELASTIC\n{self.young!r}, {self.poisson!r}\n"
        if math.isfinite(self.strength):
            text += f"*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL\n{self.strength!r}, 0.0\n"
            if self.slope != 0.0:
                text += f"{self.strength + 10.0 * self.slope!r}, 10.0\n"
        return text


class Body:
    """The state that all points share."""

    def __init__(self, material: Material) -> None:
        self.material = material
        self.gradient = np.eye(3)  # F
        self.shift = np.zeros(3)  # x = F X + shift
        self.b = np.eye(3)  # elastic left Cauchy-Green tensor
        self.strain = np.zeros((3, 3))  # elastic, logarithmic
        self.tau = np.zeros((3, 3))  # Kirchhoff stress
        self.peeq = 0.0  # accumulated plastic strain

    def move(self, a: np.ndarray, d: np.ndarray) -> None:
        """One increment."""
        self.gradient = a @ self.gradient
        self.shift = a @ self.shift + d
        b, axes = np.linalg.eigh(a @ self.b @ a.T)
        strain = self.returned(np.log(b) / 2.0)
        self.b = axes @ np.diag(np.exp(2.0 * strain)) @ axes.T
        self.strain = axes @ np.diag(strain) @ axes.T
        shear, bulk = self.material.shear, self.material.bulk
        pressure = bulk * strain.sum()
        tau = pressure + 2.0 * shear * (strain - strain.mean())
        self.tau = axes @ np.diag(tau) @ axes.T

    def returned(self, trial: np.ndarray) -> np.ndarray:
        """Principal strains after the radial return; counts the plastic strain."""
        shear, slope = self.material.shear, self.material.slope
        deviator = trial - trial.mean()
        q = math.sqrt(1.5) * 2.0 * shear * float(np.linalg.norm(deviator))
        excess = q - (self.material.strength + slope * self.peeq)
        if not excess > 1e-12 * q:
            return trial
        flow = excess / (3.0 * shear + slope)
        self.peeq += flow
        return trial.mean() + (1.0 - 3.0 * shear * flow / q) * deviator

    @property
    def jacobian(self) -> float:
        return float(np.linalg.det(self.gradient))

    def fields(self) -> dict[str, list[float]]:
        """Values of the fields in the results, each in the order of its components there."""
        voigt = {
            "S": self.tau / self.jacobian,
            "TAU": self.tau,
            "LE": self.strain,
        }
        values = {name: [float(t[i]) for i in VOIGT] for name, t in voigt.items()}
        values["F"] = [float(v) for v in self.gradient.ravel()]
        values["PEEQ"] = [self.peeq]
        values["JBAR"] = [self.jacobian]
        values["shift"] = [float(v) for v in self.shift]
        return values
