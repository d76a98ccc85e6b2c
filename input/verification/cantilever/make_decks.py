"""Writes meshes and decks of the cantilever: a box of cells with the sets that make the beam in it.

    python make_decks.py        writes mesh-*.inc and the decks

The beam is 10 m long and 1 m deep, clamped at the wall x = 0 about y = 0; it bends downwards into
the box.
Cells are squares of two quadratic triangles, so linear elements have half their size.
"""

from itertools import product
from pathlib import Path

LENGTH, DEPTH = 10, 1.0
LOAD = 100.0  # kN
RIGHT, BOTTOM, TOP = 11, -10.5, 1.5  # of the box; its left side is the wall


def cells(first, last, size):
    """Number of cells from one coordinate to another."""
    return round((last - first) / size)


def element_lines(columns, rows, n_x):
    """Lines first, last of *ELSET, GENERATE for the two triangles of each cell, row by row."""
    lines = []
    for row in rows:
        first = 2 * (row * n_x + columns.start) + 1
        lines.append(f"{first}, {first + 2 * len(columns) - 1}")
    return lines


def mesh_text(n_depth):
    """Mesh with n_depth linear elements over the depth of the beam."""
    size = 2.0 * DEPTH / n_depth
    n_x, n_y = cells(0, RIGHT, size), cells(BOTTOM, TOP, size)
    row = cells(BOTTOM, -DEPTH / 2, size)
    n_rows, n_columns = cells(0, DEPTH, size), cells(0, LENGTH, size)
    rows = range(row, row + n_rows)
    middle = range(row + n_rows // 2 - 1, row + n_rows // 2 + 1)
    columns = range(n_columns - 1, n_columns)
    beam = element_lines(range(n_columns), rows, n_x)
    tip = element_lines(columns, middle, n_x)
    return "\n".join(
        [
            f"** Made by make_decks.py: {n_depth} linear elements over the depth.",
            "*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC, ELSET=ALL",
            f"X, 0, {RIGHT}, {n_x}",
            f"Y, {BOTTOM}, {TOP}, {n_y}",
            "*ELSET, ELSET=BEAM, GENERATE",
            *beam,
            "*ELSET, ELSET=TIP, GENERATE",
            *tip,
            "",
        ]
    )


def deck_text(formulation, per_element, n_depth):
    """One deck; n_depth linear elements over the depth of the beam."""
    area = 2 * (2 * DEPTH / n_depth) ** 2  # of the two cells that carry the load
    lines = [
        "** Made by make_decks.py.",
        "*HEADING",
        f"Cantilever, {formulation}, ghost penalty on, {per_element} points per element,"
        f" {n_depth} elements over the depth",
        f'*INCLUDE, INPUT="mesh-{n_depth:02d}.inc"',
        '*INCLUDE, INPUT="beam.inc"',
        f"*MATERIAL POINTS, ELSET=BEAM, MATERIAL=RUBBER, PER ELEMENT={per_element}",
        f"*FORMULATION, TYPE={'STANDARD' if formulation == 'standard' else 'FBAR PATCH'}",
        "*GHOST PENALTY",
        '*INCLUDE, INPUT="bend.inc"',
        f"** {LOAD:g} kN over the mass of the tip.",
        "*DLOAD",
        f"TIP, GRAV, {LOAD / area!r}, 0, -1",
        "*EXPECT, QUANTITY=GHOST SHARE",
        "analytic, 0.0, 0.0, 0.01",
        "frozen, 0, 1E-6",
        "*EXPECT, QUANTITY=U, COMPONENT=2, STATISTIC=MIN",
        "frozen, 0, 1E-6",
        "*EXPECT, QUANTITY=BALANCE",
        "analytic, 0.0, 0.0, 1E-8",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


CASES = [
    *product(("standard", "fbar"), (6,), (8,)),
    *product(("standard", "fbar"), (16,), (8,)),
    *product(("standard", "fbar"), (6,), (16,)),
]

if __name__ == "__main__":
    here = Path(__file__).parent
    for n in (8, 16):
        (here / f"mesh-{n:02d}.inc").write_text(mesh_text(n))
    for formulation, per_element, n in CASES:
        deck = here / f"{formulation}-on-{per_element:02d}-{n:02d}.inp"
        deck.write_text(deck_text(formulation, per_element, n))
