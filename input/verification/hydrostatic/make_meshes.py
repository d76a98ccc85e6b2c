"""Writes the distorted meshes ground-2d.inc and ground-3d.inc: python make_meshes.py

Boxes 3 m wide and 5 m high of quadratic triangles or tetrahedra. Corners inside are moved at
random, those on a side, on the base, the top or the layer boundary at 3 m only along it; edges stay
straight.
"""

from itertools import combinations, permutations, product
from pathlib import Path

import numpy as np

WIDTH, HEIGHT, BOUNDARY = 3.0, 5.0, 3.0
SHIFT = 0.22  # of the size of a cell
ABAQUS = {2: [(0, 1), (1, 2), (2, 0)], 3: [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]}
TYPE = {2: "CPE6", 3: "C3D10"}


def corners(n_dim: int, n_cells: tuple[int, ...]) -> np.ndarray:
    """(n, n_dim) corners of the cells, moved."""
    random = np.random.default_rng(7)
    axes = [np.linspace(0.0, WIDTH, n + 1) for n in n_cells[:-1]]
    axes.append(np.linspace(0.0, HEIGHT, n_cells[-1] + 1))
    points = np.array(list(product(*axes)))
    held = (points == 0.0) | (points == WIDTH)
    held[:, -1] = np.isin(points[:, -1], [0.0, BOUNDARY, HEIGHT])
    size = [axis[1] for axis in axes]
    return points + np.where(held, 0.0, SHIFT * random.uniform(-1.0, 1.0, points.shape) * size)


def simplices(n_dim: int, n_cells: tuple[int, ...]) -> list[list[int]]:
    """Corners of the triangles or tetrahedra: every cell is cut along its paths."""
    counts = np.array([n + 1 for n in n_cells])
    stride = [int(np.prod(counts[i + 1 :])) for i in range(n_dim)]
    cells = product(*(range(n) for n in n_cells))
    paths = list(permutations(range(n_dim)))
    result = []
    for cell in cells:
        first = int(np.dot(cell, stride))
        for path in paths:
            result.append(list(np.cumsum([first, *(stride[axis] for axis in path)])))
    return result


def write_mesh(n_dim: int, n_cells: tuple[int, ...]) -> None:
    """The include file."""
    x = list(corners(n_dim, n_cells))
    middle: dict[tuple[int, int], int] = {}
    elements = []
    for corner in simplices(n_dim, n_cells):
        if np.linalg.det(np.array(x)[corner[1:]] - x[corner[0]]) < 0.0:
            corner[:2] = corner[1::-1]
        for pair in combinations(sorted(corner), 2):
            if pair not in middle:
                middle[pair] = len(x)
                x.append(0.5 * (x[pair[0]] + x[pair[1]]))
        edges = [middle[tuple(sorted((corner[a], corner[b])))] for a, b in ABAQUS[n_dim]]
        elements.append(corner + edges)
    x = np.array(x)
    lines = ["** made by make_meshes.py", "*NODE"]
    lines += [f"{i + 1}, " + ", ".join(f"{value:.15g}" for value in row) for i, row in enumerate(x)]
    for layer, above in (("LOWER", False), ("UPPER", True)):
        lines.append(f"*ELEMENT, TYPE={TYPE[n_dim]}, ELSET={layer}")
        for i, nodes in enumerate(elements):
            if (x[nodes, -1].mean() > BOUNDARY) == above:
                lines.append(", ".join(str(number + 1) for number in [i, *nodes]))
    for axis in range(n_dim):
        for side, value in enumerate([0.0, WIDTH] if axis < n_dim - 1 else [0.0]):
            lines.append(f"*NSET, NSET={'XYZ'[axis]}{side}")
            there = np.flatnonzero(np.abs(x[:, axis] - value) < 1e-12) + 1
            lines += [", ".join(map(str, there[i : i + 12])) for i in range(0, len(there), 12)]
    path = Path(__file__).parent / f"ground-{n_dim}d.inc"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{path.name}: {len(x)} nodes, {len(elements)} elements")


write_mesh(2, (3, 5))
write_mesh(3, (2, 2, 5))
