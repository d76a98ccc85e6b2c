#!/usr/bin/env python3
"""Meshes of the cube: cube-ORIENTATION-DIAGONAL.inc, five ten-node tetrahedra each.

Orientation 1 or 2: which four of the eight corners the tetrahedron in the middle takes; with 2 a
tetrahedron stands in the corner of the three rollers. Diagonal x, y or z: the one along which the
octahedron in each ten-node tetrahedron is cut. In the middle tetrahedron it is parallel to this
axis, in the others it begins in the middle of the edge that is.

All three diagonals of a tetrahedron are equally long here, and of equal ones the program takes the
first, m01-m23: the order of the vertices decides.

    python make_meshes.py
"""

from itertools import combinations, permutations, product
from pathlib import Path

SIDE = 2.0  # [m]
AXES = "xyz"
EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # the order of Abaqus


def tetrahedra(orientation):
    """Four corners each; a corner is a tuple of three 0 or 1."""
    corners = list(product((0, 1), repeat=3))
    middle = [corner for corner in corners if sum(corner) % 2 != orientation % 2]
    others = [corner for corner in corners if corner not in middle]
    return [middle, *([other, *neighbours(other)] for other in others)]


def neighbours(corner):
    """The corners at the other ends of the three edges."""
    return [tuple(c ^ (i == axis) for i, c in enumerate(corner)) for axis in range(3)]


def volume(a, b, c, d):
    """Six times the volume, positive when the vertices are in order."""
    p, q, r = ([y - x for x, y in zip(a, other)] for other in (b, c, d))
    return (
        p[0] * (q[1] * r[2] - q[2] * r[1])
        - p[1] * (q[0] * r[2] - q[2] * r[0])
        + p[2] * (q[0] * r[1] - q[1] * r[0])
    )


def in_order(vertices, axis):
    """The vertices so that the volume is positive and m01-m23 the diagonal of an axis."""
    for a, b, c, d in permutations(vertices):
        if volume(a, b, c, d) > 0 and is_diagonal(middle_of(a, b), middle_of(c, d), axis, vertices):
            return a, b, c, d
    raise ValueError(f"{vertices} have no diagonal {AXES[axis]}")


def is_diagonal(start, end, axis, vertices):
    """Whether a diagonal is that of an axis."""
    difference = [abs(x - y) for x, y in zip(start, end)]
    if sum(difference) == 2:  # middle tetrahedron: parallel to an axis
        return difference[axis] == 2
    return any(edge_axis(pair) == axis for pair in combinations(vertices, 2)
               if middle_of(*pair) in (start, end))  # fmt: skip


def edge_axis(pair):
    """The axis that an edge is parallel to; None for a diagonal of a face."""
    different = [i for i, (x, y) in enumerate(zip(*pair)) if x != y]
    return different[0] if len(different) == 1 else None


def middle_of(a, b):
    """The middle of two corners, in halves of the side."""
    return tuple(x + y for x, y in zip(a, b))


def mesh_text(orientation, axis):
    """The file of a mesh."""
    elements = [in_order(vertices, axis) for vertices in tetrahedra(orientation)]
    places = {middle_of(e[i], e[j]) for e in elements for i, j in combinations(range(4), 2)}
    places |= {middle_of(corner, corner) for e in elements for corner in e}
    number = {place: i for i, place in enumerate(sorted(places, key=lambda p: p[::-1]), 1)}
    lines = [
        f"** Orientation {orientation}, diagonals {AXES[axis]}; made by make_meshes.py.",
        "*NODE",
    ]
    for place, i in number.items():
        lines.append(", ".join([str(i), *(f"{0.5 * SIDE * x:g}" for x in place)]))
    lines.append("*ELEMENT, TYPE=C3D10, ELSET=CUBE")
    for i, element in enumerate(elements, 1):
        nodes = [number[middle_of(corner, corner)] for corner in element]
        nodes += [number[middle_of(element[a], element[b])] for a, b in EDGES]
        lines.append(", ".join(map(str, (i, *nodes))))
    for name, direction, level in (("X0", 0, 0), ("Y0", 1, 0), ("Z0", 2, 0), ("Z1", 2, 2)):
        lines.append(f"*NSET, NSET={name}")
        lines.append(", ".join(str(i) for place, i in number.items() if place[direction] == level))
    return "\n".join(lines) + "\n"


def main():
    """Writes the six meshes beside this file."""
    for orientation, axis in product((1, 2), range(3)):
        name = f"cube-{orientation}-{AXES[axis]}.inc"
        (Path(__file__).parent / name).write_text(mesh_text(orientation, axis))


if __name__ == "__main__":
    main()
