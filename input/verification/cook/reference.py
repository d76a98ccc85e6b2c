#!/usr/bin/env python3
"""Tip deflection of Cook's membrane by another program and another element.

Six-node triangles with quadratic displacement (total Lagrangian, six Gauss points, no patches) on
the same meshes, plain (too stiff) or with one pressure each (too soft): the logarithm of the volume
ratio is averaged over the triangle in Hencky's energy. Tangents are differences of forces. Needs
scipy. Prints the deflection of each mesh.

    python reference.py plain 0.3 4 8 16 32
    python reference.py pressure 0.4999 4 8 16 32
"""

import sys
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

YOUNG, FORCE = 240.565, 6.25  # [MPa]
HAS_PRESSURE = sys.argv[1:2] == ["pressure"]
N_STEPS, TOLERANCE, STEP = 40, 1e-9, 1e-6  # load steps, residual over load, difference [mm]
A, B = 0.445948490915965, 0.091576213509771
WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)
POINTS = [(A, A), (1 - 2 * A, A), (A, 1 - 2 * A), (B, B), (1 - 2 * B, B), (B, 1 - 2 * B)]


def read_mesh(path):
    """Coordinates, triangles (6 nodes) and edges (3 nodes) of the right side."""
    section, rows = "", {"*NODE": [], "CPE6": [], "T3D3": []}
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            section = next((key for key in rows if key in line.split(", ELSET")[0]), "")
        elif section:
            rows[section].append([float(word) for word in line.split(",")][1:])
    nodes, triangles, edges = (np.array(rows[key]) for key in rows)
    return nodes, triangles.astype(int) - 1, edges.astype(int) - 1


def gradients(nodes, triangles):
    """(n_el, 6 points, 6 nodes, 2) shape gradients and (n_el) areas of straight triangles."""
    x = nodes[triangles[:, :3]]
    jacobian = np.stack([x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]], axis=1)
    inverse = np.linalg.inv(jacobian)  # d(local)/dx, columns are local
    local = []
    for r, s in POINTS:
        t = 1.0 - r - s
        local.append([[1 - 4 * t, 1 - 4 * t], [4 * r - 1, 0], [0, 4 * s - 1],
                      [4 * (t - r), -4 * r], [4 * s, 4 * r], [-4 * s, 4 * (t - s)]])  # fmt: skip
    return np.einsum("qai,eji->eqaj", np.array(local, float), inverse), 0.5 * np.linalg.det(
        jacobian
    )


def kirchhoff(left, nu):
    """In-plane Kirchhoff stress of left Cauchy-Green tensors (n_el, 6, 2, 2), plane strain."""
    bulk, shear = YOUNG / (3 * (1 - 2 * nu)), YOUNG / (2 * (1 + nu))
    values, vectors = np.linalg.eigh(left)
    strain = 0.5 * np.log(values)
    volume = strain.sum(axis=-1, keepdims=True)
    mean = volume
    if HAS_PRESSURE:
        mean = np.tensordot(volume, WEIGHTS, axes=(1, 0))[:, None]
    stress = bulk * mean + 2 * shear * (strain - volume / 3)
    return np.einsum("...ik,...k,...jk->...ij", vectors, stress, vectors)


def forces(u, gradient, area, nu):
    """(n_el, 12) internal forces of displacements (n_el, 6, 2)."""
    f = np.eye(2) + np.einsum("eai,eqaj->eqij", u, gradient)
    tau = kirchhoff(f @ np.swapaxes(f, -1, -2), nu)
    piola = np.einsum("eqij,eqkj->eqik", tau, np.linalg.inv(f))
    weighted = piola * (WEIGHTS[:, None, None] * area[:, None, None, None])
    return np.einsum("eqij,eqaj->eai", weighted, gradient).reshape(len(u), 12)


def tangents(u, gradient, area, nu):
    """(n_el, 12, 12) central differences of the forces."""
    columns = []
    for k in range(12):
        shift = np.zeros(12)
        shift[k] = STEP
        shift = shift.reshape(6, 2)
        plus, minus = (forces(u + sign * shift, gradient, area, nu) for sign in (1, -1))
        columns.append((plus - minus) / (2 * STEP))
    return np.stack(columns, axis=-1)


def tip(n, nu):
    """Deflection of the upper right corner [mm]."""
    nodes, triangles, edges = read_mesh(Path(__file__).with_name(f"panel-{n}.inc"))
    gradient, area = gradients(nodes, triangles)
    dof = (2 * triangles[:, :, None] + [0, 1]).reshape(len(triangles), 12)
    load = np.zeros(2 * len(nodes))
    for first, last, middle in edges:
        length = np.linalg.norm(nodes[last] - nodes[first])
        load[[2 * first + 1, 2 * last + 1, 2 * middle + 1]] += (
            FORCE * length * np.array([1, 1, 4]) / 6
        )
    free = np.flatnonzero(np.repeat(nodes[:, 0] > 0, 2))
    u = np.zeros(2 * len(nodes))
    rows, columns = np.repeat(dof, 12, axis=1).ravel(), np.tile(dof, 12).ravel()
    before = u.copy()
    for step in range(1, N_STEPS + 1):
        u, before = 2.0 * u - before, u.copy()  # the step goes on as the one before
        for _ in range(30):
            local = u[dof].reshape(-1, 6, 2)
            internal = np.bincount(dof.ravel(), forces(local, gradient, area, nu).ravel(), len(u))
            residual = (load * step / N_STEPS - internal)[free]
            if np.linalg.norm(residual) < TOLERANCE * np.linalg.norm(load):
                break
            blocks = tangents(local, gradient, area, nu)
            stiffness = coo_matrix((blocks.ravel(), (rows, columns))).tocsc()
            u[free] += spsolve(stiffness[free][:, free], residual)
        else:
            raise RuntimeError(f"no convergence in step {step}")
    return u[-1]


def main():
    """Command line: element, nu, then the meshes."""
    nu = float(sys.argv[2])
    for n in map(int, sys.argv[3:]):
        print(n, tip(n, nu), flush=True)


if __name__ == "__main__":
    main()
