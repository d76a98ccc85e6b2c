#!/usr/bin/env python3
"""Meshes of an eighth of a thick sphere, radii 1 and 2: `shell-N.inc` and `push-N.inc`.

Ten-node tetrahedra. The surface of the octant is divided into N x N triangles, the wall into
layers; each prism becomes three tetrahedra. All nodes, those in the middle of edges too, lie on
spheres. The layers grow with their radius. `push-N.inc` holds the displacement of every node of the
inner surface, away from the centre, of length 1.
"""

import argparse
import math
from pathlib import Path

INNER, OUTER = 1.0, 2.0  # radii [m]
LAYERS = {3: 2, 6: 4, 9: 6}  # divisions of an edge of the octant: layers of the wall
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # of a ten-node tetrahedron

Node = tuple[int, int, int]  # steps away from two corners of the octant, layer; middles included


class Octant:
    """The grid of corners and middles with n divisions of an edge."""

    def __init__(self, n: int) -> None:
        self.n = n
        self.steps = 2 * n
        self.n_layers = LAYERS[n]
        directions = [(i, j) for i in range(self.steps + 1) for j in range(self.steps + 1 - i)]
        self.nodes = [(i, j, k) for k in range(2 * self.n_layers + 1) for i, j in directions]
        self.label = {node: number for number, node in enumerate(self.nodes, 1)}

    def direction(self, node: Node) -> tuple[float, float, float]:
        """Unit vector to a node; even steps along the edges of the octant."""
        i, j, _ = node
        part = [math.sin(0.5 * math.pi * s / self.steps) for s in (i, j, self.steps - i - j)]
        size = math.sqrt(sum(value**2 for value in part))
        return part[0] / size, part[1] / size, part[2] / size

    def point(self, node: Node) -> tuple[float, float, float]:
        """Place of a node [m]."""
        r = INNER * (OUTER / INNER) ** (node[2] / (2 * self.n_layers))
        x, y, z = self.direction(node)
        return r * x, r * y, r * z

    def triangles(self) -> list[list[tuple[int, int]]]:
        """Corners of the triangles of the surface."""
        found = []
        for i in range(0, self.steps, 2):
            for j in range(0, self.steps - i, 2):
                found.append([(i, j), (i + 2, j), (i, j + 2)])
                if i + j + 4 <= self.steps:
                    found.append([(i + 2, j), (i + 2, j + 2), (i, j + 2)])
        return found

    def tetrahedra(self) -> list[list[int]]:
        """Node numbers: corners, then middles of edges. The diagonal of a face of a prism goes
        from the smaller corner below to the larger one above, the same for both neighbours."""
        found = []
        for layer in range(0, 2 * self.n_layers, 2):
            for triangle in self.triangles():
                a, b, c = ((i, j, layer) for i, j in sorted(triangle))
                above_a, above_b, above_c = ((i, j, layer + 2) for i, j, _ in (a, b, c))
                for corners in ((a, b, c, above_c), (a, b, above_b, above_c),
                                (a, above_a, above_b, above_c)):  # fmt: skip
                    found.append(self.numbered(corners))
        return found

    def numbered(self, corners: tuple[Node, Node, Node, Node]) -> list[int]:
        """Numbers of the ten nodes, turned so that the volume is positive."""
        if self.volume(corners) < 0.0:
            corners = (corners[1], corners[0], corners[2], corners[3])
        middles = [tuple((p + q) // 2 for p, q in zip(corners[a], corners[b])) for a, b in EDGES]
        return [self.label[node] for node in (*corners, *middles)]

    def volume(self, corners: tuple[Node, Node, Node, Node]) -> float:
        """Six times the volume between four nodes [m3]."""
        origin = self.point(corners[0])
        a, b, c = (
            [x - x0 for x, x0 in zip(self.point(node), origin)] for node in corners[1:]
        )  # fmt: skip
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1])
            - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    def sets(self) -> dict[str, list[int]]:
        """X0, Y0, Z0 are the planes of symmetry, INNER is the inner surface, PUSHED the same but
        for its nodes on X0."""
        chosen = {
            "X0": lambda i, j, k: i == 0,
            "Y0": lambda i, j, k: j == 0,
            "Z0": lambda i, j, k: i + j == self.steps,
            "INNER": lambda i, j, k: k == 0,
            "PUSHED": lambda i, j, k: k == 0 and i > 0,
        }
        return {
            name: [self.label[node] for node in self.nodes if belongs(*node)]
            for name, belongs in chosen.items()
        }


def mesh_lines(octant: Octant) -> list[str]:
    """The mesh and its sets."""
    lines = [
        f"** Eighth of a sphere, {octant.n} divisions of an edge, {octant.n_layers} layers,"
        " made by make_mesh.py.",
        "*NODE",
    ]
    for node in octant.nodes:
        x, y, z = octant.point(node)
        lines.append(f"{octant.label[node]}, {x:.16g}, {y:.16g}, {z:.16g}")
    lines.append("*ELEMENT, TYPE=C3D10, ELSET=WALL")
    for number, nodes in enumerate(octant.tetrahedra(), 1):
        lines.append(", ".join(map(str, [number, *nodes])))
    for name, nodes in octant.sets().items():
        lines.append(f"*NSET, NSET={name}")
        lines += [", ".join(map(str, nodes[k : k + 12])) for k in range(0, len(nodes), 12)]
    return lines


def push_lines(octant: Octant) -> list[str]:
    """Displacement of the inner nodes; on the planes of symmetry only within the plane."""
    lines = [
        f"** Outward displacement of 1 of the inner nodes of shell-{octant.n}.inc, made by"
        " make_mesh.py.",
        "*BOUNDARY, AMPLITUDE=WIDEN",
    ]
    for node in octant.nodes:
        if node[2] != 0:
            continue
        for axis, value in enumerate(octant.direction(node), 1):
            if value != 0.0:
                lines.append(f"{octant.label[node]}, {axis}, {axis}, {value:.16g}")
    return lines


def main() -> None:
    """Command line."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    folder = Path(__file__).resolve().parent
    for n in LAYERS:
        octant = Octant(n)
        for name, lines in ((f"shell-{n}", mesh_lines(octant)), (f"push-{n}", push_lines(octant))):
            (folder / f"{name}.inc").write_text("\n".join(lines) + "\n", encoding="utf-8")
            print(f"{name}.inc")


if __name__ == "__main__":
    main()
