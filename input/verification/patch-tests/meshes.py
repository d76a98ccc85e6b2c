"""Distorted meshes of simplices on a lattice, linear and quadratic with the same nodes."""

import random
from itertools import permutations, product

import numpy as np

SEED = 20240607
SIZE = {2: 0.4, 3: 0.8}  # distance of neighbouring nodes before they are moved
CELLS = {2: (16, 8), 3: (6, 6, 6)}  # steps of the lattice, which has its middle at the origin
DISTORTION = 0.12  # largest displacement of an inner node in a direction, over SIZE
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # order of the mid-edge nodes
TYPES = {(2, "linear"): "CPE3", (2, "quadratic"): "CPE6"} | {
    (3, "linear"): "C3D4",
    (3, "quadratic"): "C3D10",
}


class Mesh:
    """Nodes and elements, numbered from 0; both orders have the same nodes."""

    def __init__(self, n_dim: int, order: str) -> None:
        self.n_dim, self.order = n_dim, order
        self.cells = CELLS[n_dim]
        lattice = list(product(*(range(n + 1) for n in self.cells)))
        self.number = {place: i for i, place in enumerate(lattice)}
        self.x = self.coordinates(lattice)
        self.elements = self.simplices(1 if order == "linear" else 2)

    def coordinates(self, lattice: list[tuple[int, ...]]) -> np.ndarray:
        """(n_nodes, n_dim) places; those on the boundary stay where the lattice has them."""
        chance = random.Random(SEED + self.n_dim)
        x = SIZE[self.n_dim] * (np.array(lattice, float) - np.array(self.cells) / 2.0)
        for i, place in enumerate(lattice):
            moves = [DISTORTION * chance.uniform(-1.0, 1.0) for _ in place]
            if all(0 < k < n for k, n in zip(place, self.cells)):
                x[i] += SIZE[self.n_dim] * np.array(moves)
        return x

    def simplices(self, step: int) -> list[list[int]]:
        """Each cell is cut along its diagonal; with step 2 the middles of the edges follow."""
        found = []
        for corner in product(*(range(0, n, step) for n in self.cells)):
            for order in permutations(range(self.n_dim)):
                places = [np.array(corner)]
                for axis in order:
                    places.append(places[-1] + step * np.eye(self.n_dim, dtype=int)[axis])
                if round(np.linalg.det(np.array(places[1:]) - places[0])) < 0:
                    places[-1], places[-2] = places[-2], places[-1]
                if step == 2:
                    n_edges = 3 if self.n_dim == 2 else 6
                    places += [(places[a] + places[b]) // 2 for a, b in EDGES[:n_edges]]
                found.append([self.number[tuple(int(k) for k in place)] for place in places])
        return found

    def inside(self, centre: tuple[float, ...], radii: tuple[float, ...]) -> list[int]:
        """Elements whose corners have their mean in an ellipsoid."""
        n = self.n_dim
        means = np.array([self.x[element[: n + 1]].mean(axis=0) for element in self.elements])
        distance = (((means - np.array(centre[:n])) / np.array(radii[:n])) ** 2).sum(axis=1)
        return [int(e) for e in np.flatnonzero(distance < 1.0)]

    def faces(self, elements: list[int]) -> set[int]:
        """Nodes on the surface of some elements, middles of edges included."""
        n = self.n_dim
        count: dict[tuple[int, ...], list[int]] = {}
        for e in elements:
            for opposite in range(n + 1):
                corners = [a for a in range(n + 1) if a != opposite]
                middles = [
                    n + 1 + i
                    for i, edge in enumerate(EDGES)
                    if set(edge) <= set(corners) and n + 1 + i < len(self.elements[e])
                ]
                key = tuple(sorted(self.elements[e][a] for a in corners))
                count.setdefault(key, []).extend(
                    [*key, *(self.elements[e][a] for a in middles), -1]
                )
        single = (nodes for nodes in count.values() if nodes.count(-1) == 1)
        return {node for nodes in single for node in nodes if node >= 0}

    def node_text(self) -> str:
        """*NODE with every digit; numbers start from 1."""
        lines = ["*NODE"]
        for i, place in enumerate(self.x):
            lines.append(", ".join([str(i + 1), *(repr(float(v)) for v in place)]))
        return "\n".join(lines) + "\n"

    def element_text(self) -> str:
        """*ELEMENT; numbers start from 1."""
        lines = [f"*ELEMENT, TYPE={TYPES[self.n_dim, self.order]}"]
        for e, nodes in enumerate(self.elements):
            lines.append(", ".join([str(e + 1), *(str(a + 1) for a in nodes)]))
        return "\n".join(lines) + "\n"
