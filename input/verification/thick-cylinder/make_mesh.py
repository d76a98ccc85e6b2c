#!/usr/bin/env python3
"""Meshes of a quarter of a thick ring, radii 1 and 2: `ring-N.inc` and `push-N.inc`.

Six-node triangles in N rings; all nodes, those in the middle of edges too, lie on circles and
divide the quarter evenly. The rings grow with their radius. `push-N.inc` holds the displacement of
every node of the inner surface, away from the axis, of length 1.
"""

import argparse
import math
from pathlib import Path

INNER, OUTER = 1.0, 2.0  # radii [m]
SIZES = (4, 8, 16)  # rings; there are three times as many sectors
SECTORS = 3  # per ring


def point(i: int, j: int, n: int) -> tuple[float, float]:
    """Place of node i, j of the grid of corners and middles [m]."""
    r = INNER * (OUTER / INNER) ** (i / (2 * n))
    return r * cosine(j, n), r * cosine(2 * SECTORS * n - j, n)


def cosine(j: int, n: int) -> float:
    """Cosine of the angle of grid line j, exact on the axes."""
    last = 2 * SECTORS * n
    return 0.0 if j == last else math.cos(0.5 * math.pi * j / last)


def label(i: int, j: int, n: int) -> int:
    """Number of a node of the grid."""
    return 1 + i + j * (2 * n + 1)


def triangles(n: int) -> list[list[int]]:
    """Node numbers of the triangles: corners, then middles of edges."""
    found = []
    for j in range(0, 2 * SECTORS * n, 2):
        for i in range(0, 2 * n, 2):
            a, b, c, d = (i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)
            turned = (i + j) % 4 == 2
            for corner in ((a, b, d), (b, c, d)) if turned else ((a, b, c), (a, c, d)):
                middle = [
                    ((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)
                    for p, q in zip(corner, corner[1:] + corner[:1])
                ]
                found.append([label(*node, n) for node in (*corner, *middle)])
    return found


def numbers(values: list[int]) -> list[str]:
    """Data lines of a set."""
    return [", ".join(map(str, values[k : k + 12])) for k in range(0, len(values), 12)]


def mesh_lines(n: int) -> list[str]:
    """The mesh and its sets: X0 and Y0 are the planes of symmetry, INNER is the inner surface,
    PUSHED the same without its node on X0, EDGE the outer node on the x axis."""
    lines = [f"** Quarter ring of {n} rings, made by make_mesh.py.", "*NODE"]
    rows, columns = range(2 * SECTORS * n + 1), range(2 * n + 1)
    for j in rows:
        for i in columns:
            x, y = point(i, j, n)
            lines.append(f"{label(i, j, n)}, {x:.16g}, {y:.16g}")
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=WALL")
    for number, nodes in enumerate(triangles(n), 1):
        lines.append(", ".join(map(str, [number, *nodes])))
    sets = {
        "Y0": [label(i, 0, n) for i in columns],
        "X0": [label(i, rows[-1], n) for i in columns],
        "INNER": [label(0, j, n) for j in rows],
        "PUSHED": [label(0, j, n) for j in rows[:-1]],
        "EDGE": [label(columns[-1], 0, n)],
    }
    for name, nodes in sets.items():
        lines += [f"*NSET, NSET={name}", *numbers(nodes)]
    return lines


def push_lines(n: int) -> list[str]:
    """Displacement of the inner nodes; on the planes of symmetry only within the plane."""
    lines = [
        f"** Outward displacement of 1 of the inner nodes of ring-{n}.inc, made by make_mesh.py.",
        "*BOUNDARY, AMPLITUDE=WIDEN",
    ]
    for j in range(2 * SECTORS * n + 1):
        direction = (cosine(j, n), cosine(2 * SECTORS * n - j, n))
        for axis, value in enumerate(direction, 1):
            if value != 0.0:
                lines.append(f"{label(0, j, n)}, {axis}, {axis}, {value:.16g}")
    return lines


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    folder = Path(__file__).resolve().parent
    for n in SIZES:
        for name, lines in ((f"ring-{n}", mesh_lines(n)), (f"push-{n}", push_lines(n))):
            (folder / f"{name}.inc").write_text("\n".join(lines) + "\n", encoding="utf-8")
            print(f"{name}.inc")


if __name__ == "__main__":
    main()
