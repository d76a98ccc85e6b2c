"""Writes the decks of the small cuts: a body that reaches into an empty element by a thin sliver.

    python make_decks.py        writes mesh-*.inc and the decks

2-D: a unit square under the edge AB, 3-D: a tetrahedron under the face ABC. The sliver between that
side and a node P, a depth t below it, is one element; above the side is an empty element with its
apex D, 0.8 above. A rigid translation lifts the points next to the side by 1e-6 beyond it.
"""

from pathlib import Path

HERE = Path(__file__).parent
DEPTHS = {"1e-2": 1e-2, "1e-3": 1e-3, "1e-4": 1e-4, "1e-5": 1e-5}
FBAR_DEPTHS = ("1e-4", "1e-5")
CROSSING = 1e-6  # of the size of the element, which is 1
FAR = {2: 1e-3, 3: 1e-3}  # the same in the decks *-far, of depth 1e-2

# Lattice rules of 4 points in a triangle and 8 in a tetrahedron: the points next to a side lie at
# 1/6 and 1/8 of the height, the next ones at 1/3 and 1/4.
NEAREST = {2: 1 / 6, 3: 1 / 8}
PER_ELEMENT = {2: 4, 3: 8}
CROSSED = {2: 1 / 4, 3: 1 / 12}  # volume of the points that cross over the depth: half a sliver

NODES = {
    2: [(0, 1), (1, 1), (0, 0), (1, 0), (0.5, None), (0.5, 1.8), (-0.5, 1.8), (1.5, 1.8)],
    3: [
        *[(0, 0, 1), (1, 0, 1), (0, 1, 1), (0.3, 0.3, 0), (0.3, 0.3, None), (0.3, 0.3, 1.8)],
        *[(-0.5, -0.5, 1.8), (1, 1, 1.8)],
    ],
}
# Sliver, body, apex, empty ones; right-handed.
ELEMENTS = {
    2: {
        "SLIVER": [(1, 5, 2)],
        "BULK": [(3, 4, 5), (4, 2, 5), (1, 3, 5)],
        "AIR": [(1, 2, 6), (1, 6, 7), (2, 8, 6)],
    },
    3: {
        "SLIVER": [(1, 2, 3, 5)],
        "BULK": [(1, 2, 5, 4), (2, 3, 5, 4), (3, 1, 5, 4)],
        "AIR": [(1, 2, 3, 6), (1, 2, 6, 7), (2, 3, 6, 8)],
    },
}
TYPE = {2: "CPE3", 3: "C3D4"}
# Held without force; the prescribed lift is that of the direction in the last place.
HELD = {
    2: ["3, 1, 1", "3, 2, 2, {lift}", "4, 2, 2, {lift}"],
    3: ["4, 1, 2", "1, 1, 2", "2, 2, 2", "4, 3, 3, {lift}"],
}
METHOD = {"standard": "*FORMULATION, TYPE=STANDARD", "fbar": "*FORMULATION, TYPE=FBAR PATCH"}
GHOST = {"off": "** No ghost penalty.", "on": "*GHOST PENALTY, GAMMA=5e-4"}


def volume(corners):
    """Signed volume of a simplex times n!."""
    origin = corners[0]
    edges = [[x - o for x, o in zip(c, origin, strict=True)] for c in corners[1:]]
    if len(edges) == 2:
        (a, b), (c, d) = edges
        return a * d - b * c
    (a, b, c), (d, e, f), (g, h, i) = edges
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def mesh_text(n_dim, depth):
    """Nodes and elements with the sliver of a depth."""
    nodes = [tuple(1.0 - depth if x is None else float(x) for x in node) for node in NODES[n_dim]]
    lines = ["** Made by make_decks.py.", "*NODE"]
    lines += [f"{i}, " + ", ".join(map(repr, node)) for i, node in enumerate(nodes, 1)]
    number = 0
    for name, elements in ELEMENTS[n_dim].items():
        lines.append(f"*ELEMENT, TYPE={TYPE[n_dim]}, ELSET={name}")
        for corners in elements:
            number += 1
            turned = volume([nodes[a - 1] for a in corners]) < 0
            element = (*corners[:-2], corners[-1], corners[-2]) if turned else corners
            lines.append(f"{number}, " + ", ".join(map(str, element)))
    return "\n".join(lines) + "\n"


def deck_text(n_dim, formulation, ghost, name, crossing=CROSSING):
    """One deck: lifted in its first increment, measured in the second one."""
    lift = NEAREST[n_dim] * DEPTHS[name] + crossing
    lines = [
        "** Made by make_decks.py.",
        "*HEADING",
        f"Small cut, {n_dim}-D, {formulation}, ghost penalty {ghost}, sliver of depth {name}",
        f'*INCLUDE, INPUT="mesh-{n_dim}d-{name}.inc"',
        METHOD[formulation],
        "*PATCH, SOURCE=METIS, SIZE=4",
        GHOST[ghost],
        '*INCLUDE, INPUT="material.inc"',
        f"*MATERIAL POINTS, ELSET=SLIVER, MATERIAL=SOLID, PER ELEMENT={PER_ELEMENT[n_dim]}",
        f"*MATERIAL POINTS, ELSET=BULK, MATERIAL=SOLID, PER ELEMENT={PER_ELEMENT[n_dim]}",
        "*STEP, NAME=LIFT",
        "*STATIC, DIRECT",
        "1, 1",
        "*BOUNDARY",
        *(line.format(lift=repr(lift)) for line in HELD[n_dim]),
        "*END STEP",
        "*STEP, NAME=MEASURE",
        "*STATIC, DIRECT",
        "1, 1",
        "*CONTROLS, EIGENVALUES",
        "*OUTPUT, FIELD, FREQUENCY=0",
        "VOL",
        f"*EXPECT, QUANTITY=U, COMPONENT={n_dim}, STATISTIC=MIN",
        f"analytic, {lift!r}, 1e-12",
        "*EXPECT, QUANTITY=VOL, SET=AIR, STATISTIC=SUM",
        f"analytic, {CROSSED[n_dim] * DEPTHS[name]!r}, 1e-9",
        "*EXPECT, QUANTITY=BALANCE",
        "analytic, 0.0, 0.0, 1E-8",
        "*END STEP",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for n_dim in (2, 3):
        for name, depth in DEPTHS.items():
            (HERE / f"mesh-{n_dim}d-{name}.inc").write_text(mesh_text(n_dim, depth))
            for formulation in METHOD:
                if formulation == "fbar" and name not in FBAR_DEPTHS:
                    continue
                for ghost in GHOST:
                    deck = HERE / f"{n_dim}d-{formulation}-{ghost}-{name}.inp"
                    deck.write_text(deck_text(n_dim, formulation, ghost, name))
        far = deck_text(n_dim, "standard", "off", "1e-2", FAR[n_dim])
        (HERE / f"{n_dim}d-standard-off-1e-2-far.inp").write_text(far)
