#!/usr/bin/env python3
"""Meshes of Cook's membrane: panel-N.inc with N x N cells for N = 2, 4, 8, 16, 32.

The panel has the corners (0, 0), (48, 44), (48, 60), (0, 44) mm. Each cell is cut by its shorter
diagonal into two six-node triangles with straight edges. Node sets LEFT and RIGHT, the node TIP
(the upper right corner), the surface RIGHT (edges of the elements), element set PANEL.
fringe-8.inc adds empty triangles below the lower edge of panel-8.inc: element set FRINGE.

    python make_meshes.py
"""

from pathlib import Path

SIZES = (2, 4, 8, 16, 32)
FRINGE, FRINGE_DEPTH = 8, 6.0  # cells of the panel that gets one, its depth [mm]
WIDTH, LEFT_HEIGHT, RIGHT_LOW, RIGHT_HIGH = 48.0, 44.0, 44.0, 60.0  # [mm]


def place(s, t):
    """The point at the fractions s of the width, t of the height there."""
    low = RIGHT_LOW * s
    high = LEFT_HEIGHT + (RIGHT_HIGH - LEFT_HEIGHT) * s
    return WIDTH * s, low + (high - low) * t


class Grid:
    """Corners and middles of n x n cells on a grid of 2n + 1 lines each way."""

    def __init__(self, n):
        self.n = n
        self.width = 2 * n + 1

    def number(self, i, j):
        """Number of the node on grid lines i, j."""
        return j * self.width + i + 1

    def coordinates(self, i, j):
        """Where it is; nodes inside the cells are on straight edges, too."""
        return place(i / (2 * self.n), j / (2 * self.n))

    def middle_of_diagonal(self, a, b):
        """The middle between two corners."""
        (xa, ya), (xb, yb) = self.coordinates(*a), self.coordinates(*b)
        return 0.5 * (xa + xb), 0.5 * (ya + yb)

    def cells(self):
        """Lower left grid lines of all cells."""
        return [(2 * i, 2 * j) for j in range(self.n) for i in range(self.n)]


def length_2(a, b):
    """Square of a distance."""
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def triangles_of(grid, i, j):
    """The corners of the two triangles of a cell, and the ends of its diagonal."""
    a, b, c, d = (i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)
    places = [grid.coordinates(*corner) for corner in (a, b, c, d)]
    if length_2(places[0], places[2]) < length_2(places[1], places[3]):
        return ((a, b, c), (a, c, d)), (a, c)
    return ((a, b, d), (b, c, d)), (b, d)


def mesh_text(n):
    """The file of a mesh."""
    grid = Grid(n)
    where = {(i, j): grid.coordinates(i, j) for j in range(grid.width) for i in range(grid.width)}
    elements = []
    for i, j in grid.cells():
        triangles, diagonal = triangles_of(grid, i, j)
        where[i + 1, j + 1] = grid.middle_of_diagonal(*diagonal)
        for p, q, r in triangles:
            middles = [
                ((a[0] + b[0]) // 2, (a[1] + b[1]) // 2) for a, b in ((p, q), (q, r), (r, p))
            ]
            elements.append([grid.number(*node) for node in (p, q, r, *middles)])
    lines = [f"** Cook's membrane, {n} x {n} cells; made by make_meshes.py.", "*NODE"]
    lines += [f"{grid.number(*ij)}, {x:.12g}, {y:.12g}" for ij, (x, y) in where.items()]
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=PANEL")
    lines += [", ".join(map(str, (k, *nodes))) for k, nodes in enumerate(elements, 1)]
    lines.append("*ELEMENT, TYPE=T3D3, ELSET=EDGE")
    for k in range(n):
        ends = [grid.number(2 * n, 2 * k + step) for step in (0, 2, 1)]
        lines.append(", ".join(map(str, (len(elements) + k + 1, *ends))))
    last = grid.width**2
    lines += ["*NSET, NSET=LEFT, GENERATE", f"1, {last - grid.width + 1}, {grid.width}"]
    lines += ["*NSET, NSET=TIP", str(last)]
    lines += ["*SURFACE, NAME=RIGHT, TYPE=ELEMENT", "EDGE"]
    return "\n".join(lines) + "\n"


def fringe_text(n):
    """Nodes and elements of a row of empty cells below the panel."""
    grid = Grid(n)
    rows = [[grid.number(i, 0) for i in range(grid.width)]]
    rows += [[(grid.width + j) * grid.width + i + 1 for i in range(grid.width)] for j in (1, 2)]
    lines = [f"** Empty cells below panel-{n}.inc; made by make_meshes.py.", "*NODE"]
    for j in (1, 2):
        for i, number in enumerate(rows[j]):
            x, y = grid.coordinates(i, 0)
            lines.append(f"{number}, {x:.12g}, {y - 0.5 * j * FRINGE_DEPTH:.12g}")
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=FRINGE")
    first = 2 * n**2 + n + 1
    for k in range(n):
        i = 2 * k
        # Corners from the lower left one on, and the middles between them.
        a, b, c, d = rows[2][i], rows[2][i + 2], rows[0][i + 2], rows[0][i]
        ab, bc, cd, da = rows[2][i + 1], rows[1][i + 2], rows[0][i + 1], rows[1][i]
        ca = rows[1][i + 1]
        lines.append(", ".join(map(str, (first + i, a, b, c, ab, bc, ca))))
        lines.append(", ".join(map(str, (first + i + 1, a, c, d, ca, cd, da))))
    return "\n".join(lines) + "\n"


def main():
    """Writes all meshes beside this file."""
    folder = Path(__file__).parent
    for n in SIZES:
        (folder / f"panel-{n}.inc").write_text(mesh_text(n))
    (folder / f"fringe-{FRINGE}.inc").write_text(fringe_text(FRINGE))


if __name__ == "__main__":
    main()
