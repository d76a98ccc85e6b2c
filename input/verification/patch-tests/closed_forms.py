"""Closed solutions that the decks must meet, and proof that exact.json meets them.

make_decks.py calls prove_all on what it writes; README.md derives the formulas.
"""

import math
from typing import Any

import numpy as np
from reference import VOIGT, Material

States = dict[str, dict[str, list[float]]]  # fields by time
RTOL = 1e-12


def tensor(voigt: list[float]) -> np.ndarray:
    """Symmetric tensor from its six components."""
    t = np.zeros((3, 3))
    for value, (i, j) in zip(voigt, VOIGT):
        t[i, j] = t[j, i] = value
    return t


def prove(found: np.ndarray, wanted: np.ndarray, what: str) -> None:
    """Two tensors agree, relative to the larger one."""
    scale = max(float(np.abs(wanted).max()), float(np.abs(found).max()), 1e-300)
    assert float(np.abs(found - wanted).max()) <= RTOL * scale, (what, found, wanted)


def hencky(gradient: np.ndarray, material: Material) -> np.ndarray:
    """Kirchhoff stress of an elastic body from the polar decomposition F = V R."""
    axes, stretches, _ = np.linalg.svd(gradient)
    strain = axes @ np.diag(np.log(stretches)) @ axes.T
    lame = material.bulk - 2.0 * material.shear / 3.0
    return lame * np.trace(strain) * np.eye(3) + 2.0 * material.shear * strain


def sheared_stress(gamma: float, material: Material) -> np.ndarray:
    """Elastic simple shear: the principal strains are +-asinh(gamma/2)."""
    size = 2.0 * material.shear * math.asinh(gamma / 2.0) / math.hypot(2.0, gamma)
    return size * np.array([[gamma, 2.0, 0.0], [2.0, -gamma, 0.0], [0.0, 0.0, 0.0]])


def flowing_shear(gamma: float, material: Material) -> np.ndarray:
    """Simple shear with perfect plasticity in infinitely many increments: the principal axis of
    the stress turns towards tan(angle) = exp(-2 a)."""
    strength = material.strength / math.sqrt(3.0)
    a = strength / (2.0 * material.shear)  # largest principal strain when the body flows
    if gamma <= 2.0 * math.sinh(a):
        return sheared_stress(gamma, material)
    first, last = math.exp(-a), math.exp(-2.0 * a)  # tan of the angle
    pace = (gamma - 2.0 * math.sinh(a)) / (2.0 * math.sinh(2.0 * a))
    tangent = last / math.tanh(pace + math.atanh(last / first))
    angle = math.atan(tangent)
    s, c = strength * math.sin(2.0 * angle), strength * math.cos(2.0 * angle)
    return np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, 0.0]])


def prove_rotation(states: States, turns: list[np.ndarray]) -> None:
    """Rotations turn the stress and leave plastic strain and volume."""
    for time, turn in zip(range(2, 2 + len(turns)), turns):
        before, after = states[f"{time - 1}"], states[f"{time}"]
        prove(tensor(after["TAU"]), turn @ tensor(before["TAU"]) @ turn.T, "rotated stress")
        prove(tensor(after["LE"]), turn @ tensor(before["LE"]) @ turn.T, "rotated strain")
        for name in ("PEEQ", "JBAR"):
            prove(np.array(after[name]), np.array(before[name]), name)


def prove_tension(states: States, n_dim: int, stretch: float, material: Material) -> None:
    """Uniaxial stress in space, pure shear in plane strain, both at the strength."""
    strength, found = material.strength, states["2"]
    strain = math.log(stretch)
    if n_dim == 3:
        tau = np.diag([strength, 0.0, 0.0])
        peeq = strain - strength / material.young
    else:
        tau = np.diag([strength, -strength, 0.0]) / math.sqrt(3.0)
        peeq = 2.0 * strain / math.sqrt(3.0) - strength / (3.0 * material.shear)
    prove(tensor(found["TAU"]), tau, "tension")
    prove(np.array(found["PEEQ"]), np.array([peeq]), "plastic strain of tension")


def prove_all(job: str, states: States, material: Material, turns: Any, numbers: Any) -> None:
    """What is known in closed form about a deck; numbers: stretch and shear of the decks."""
    family = job.split("-", maxsplit=1)[0]
    elastic = not math.isfinite(material.strength)
    n_dim = 3 if "-3d-" in job else 2
    stretch, gamma = numbers
    for fields in states.values():
        jacobian = float(np.linalg.det(np.array(fields["F"]).reshape(3, 3)))
        prove(jacobian * tensor(fields["S"]), tensor(fields["TAU"]), "Cauchy stress")
    if elastic:
        for fields in states.values():
            gradient = np.array(fields["F"]).reshape(3, 3)
            if np.abs(gradient - np.eye(3)).max() > 1e-12:
                prove(tensor(fields["TAU"]), hencky(gradient, material), job)
    if family == "stretch":
        lame = material.bulk - 2.0 * material.shear / 3.0
        stress = math.log(stretch) * np.diag([lame + 2.0 * material.shear, lame, lame])
        prove(tensor(states["3"]["TAU"]), stress, job)
    if family == "shear" and elastic:
        prove(tensor(states["3"]["TAU"]), sheared_stress(gamma, material), job)
    if family == "tension":
        prove_tension(states, n_dim, stretch, material)
    if family == "rotation":
        prove_rotation(states, turns)
