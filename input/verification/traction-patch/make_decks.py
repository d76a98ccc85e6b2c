"""Writes the meshes and the decks of this case: python make_decks.py"""

from dataclasses import dataclass
from itertools import permutations, product
from pathlib import Path

import numpy as np
from measures import LOADS, POISSON, VOIGT, YOUNG, exact_cauchy, exact_deformation, piola

HERE = Path(__file__).resolve().parent
SEED = 20240607
SHIFT = 0.2  # largest displacement of a node over the size of a cell
AXES = "XYZ"
CASES = ("pressure", "oblique")
CROSSING = {2: (4, 16, 64, 256), 3: (8, 27, 64, 125)}  # material points per element
GAMMA = 0.03  # of the ghost penalty, where a deck needs it
GHOST_SHARE = 0.04  # of the load, the most that the penalty may carry


@dataclass(frozen=True)
class Lattice:
    """The unit square or cube of n cells per direction, and empty cells around it."""

    n_dim: int
    n: int
    first: int  # place of the first plane of nodes, 0 where the body begins
    last: int
    far: float  # the outermost planes are moved out to 1 + far and -far; 0: they stay

    def places(self, end=1):
        """Places of all nodes; end = 0: of all cells."""
        span = range(self.first, self.last + end)
        return [place[::-1] for place in product(span, repeat=self.n_dim)]

    def holds(self, cell):
        """Whether a cell belongs to the body."""
        return all(0 <= k < self.n for k in cell)

    def nodes(self):
        """(n, n_dim) coordinates. Nodes on sides of the body or of the mesh stay on them."""
        places = self.places()
        x = np.array(places) / self.n
        random = np.random.default_rng(SEED)
        for i, place in enumerate(places):
            free = np.array([k not in (0, self.n, self.first, self.last) for k in place])
            move = SHIFT / self.n * random.uniform(-1, 1, self.n_dim) * free
            if self.far == 0 or all(0 <= k <= self.n for k in place):
                x[i] += move
        if self.far > 0:
            x[x < 0], x[x > 1] = -self.far, 1 + self.far
        return x


FIXED = {2: Lattice(2, 4, -1, 5, 1.0), 3: Lattice(3, 3, -1, 4, 1.0)}
CROSSED = {2: Lattice(2, 4, 0, 8, 0.0), 3: Lattice(3, 2, 0, 4, 0.0)}


def simplices(n_dim):
    """(m, n_dim + 1) places of the corners in the cell at the origin, positively oriented."""
    found = []
    for order in permutations(range(n_dim)):
        corners = [np.zeros(n_dim, dtype=int)]
        for axis in order:
            corners.append(corners[-1] + np.eye(n_dim, dtype=int)[axis])
        if np.linalg.det(np.array(corners[1:])) < 0:
            corners[-1], corners[-2] = corners[-2], corners[-1]
        found.append(corners)
    return np.array(found)


def sides_of(lattice, corners):
    """Names and faces by which a simplex of the body lies on sides of the body."""
    for left_out in range(lattice.n_dim + 1):
        face = np.delete(corners, left_out, axis=0)
        for axis, end in product(range(lattice.n_dim), (0, 1)):
            if (face[:, axis] == end * lattice.n).all():
                yield f"{AXES[axis]}{end}-SIDE", face


def mesh_text(lattice):
    """Nodes, elements of body and surroundings, sides of the body, nodes of the supports."""
    n_dim, n, places = lattice.n_dim, lattice.n, lattice.places()
    number = {place: i + 1 for i, place in enumerate(places)}
    lines = [f"** a distorted body within an empty background, seed {SEED}", "*NODE"]
    for i, x in enumerate(lattice.nodes()):
        lines.append(f"{i + 1}, " + ", ".join(repr(float(v)) for v in x))
    members = {"BODY": [], "AROUND": []}
    for cell in lattice.places(end=0):
        for corners in simplices(n_dim) + np.array(cell):
            inside = lattice.holds(cell)
            members["BODY" if inside else "AROUND"].append([number[tuple(c)] for c in corners])
            for name, face in sides_of(lattice, corners) if inside else ():
                members.setdefault(name, []).append([number[tuple(c)] for c in face])
    solid, carrier = ("CPE3", "T3D2") if n_dim == 2 else ("C3D4", "S3")
    count = 0
    for name, elements in members.items():
        kind = carrier if name.endswith("-SIDE") else solid
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for nodes in elements:
            count += 1
            lines.append(f"{count}, " + ", ".join(map(str, nodes)))
    named = {"ORIGIN": (0,) * n_dim, "FAR": (n,) * n_dim}
    for axis in range(n_dim - 1):
        named[f"ON-{AXES[axis]}"] = tuple(n if k == axis else 0 for k in range(n_dim))
    sets = {name: [place] for name, place in named.items()}
    if lattice.first == 0:
        sets = {f"{AXES[k]}0": [p for p in places if p[k] == 0] for k in range(n_dim)}
    for name, there in sets.items():
        lines.append(f"*NSET, NSET={name}")
        lines += [str(number[place]) for place in there]
    return "\n".join(lines) + "\n"


def support_text(n_dim):
    """The least that holds the body: F has no component below the diagonal."""
    lines = ["*BOUNDARY", f"ORIGIN, 1, {n_dim}", f"ON-X, 2, {n_dim}"]
    if n_dim == 3:
        lines.append("ON-Y, 3, 3")
    return "\n".join(lines)


def load_text(load, n_dim, carrier):
    """Dead tractions P N on all sides."""
    lines = [f"*DSLOAD, CARRIER={carrier.upper()}"]
    stress = piola(exact_deformation(load, n_dim))[:n_dim, :n_dim]
    for axis, end in product(range(n_dim), (0, 1)):
        side = f"{AXES[axis]}{end}-SIDE"
        if load == "pressure":
            lines.append(f"{side}, P, {-LOADS[load][axis][axis]!r}")
            continue
        traction = (2 * end - 1) * stress[:, axis]
        given = np.array(LOADS[load])[:n_dim, axis] * (2 * end - 1)
        traction[: axis + 1] = given[: axis + 1]
        size = float(np.linalg.norm(traction))
        lines.append(f"{side}, TRVEC, {size!r}, " + ", ".join(repr(float(v)) for v in traction))
    return "\n".join(lines)


def expectations(load, n_dim, rtol):
    """Uniform stress, exact displacement of the far corner, supports without force."""
    cauchy = exact_cauchy(load, n_dim)
    scale = float(np.abs(cauchy).max())
    lines = []
    for k in range(6):
        if max(VOIGT[k]) >= n_dim and k != 2:
            continue
        for statistic in ("MIN", "MAX"):
            lines.append(f"*EXPECT, QUANTITY=S, COMPONENT={k + 1}, STATISTIC={statistic}")
            lines.append(f"analytic, {float(cauchy[k])!r}, 0.0, {rtol * scale:.1e}")
    move = (exact_deformation(load, n_dim) - np.eye(3))[:n_dim, :n_dim].sum(axis=1)
    for k in range(n_dim):
        lines.append(f"*EXPECT, QUANTITY=U, SET=FAR, COMPONENT={k + 1}")
        lines.append(f"analytic, {float(move[k])!r}, {rtol:.1e}")
    for name, component in (("ORIGIN", 1), ("ON-X", 2), ("ON-Y", 3))[:n_dim]:
        lines.append(f"*EXPECT, QUANTITY=RF, SET={name}, COMPONENT={component}")
        lines.append(f"analytic, 0.0, 0.0, {rtol * scale:.1e}")
    return "\n".join(lines)


def model_text(title, mesh, formulation, n_dim, per_element, extra=()):
    """Heading, mesh, method, extra lines of the model, and material."""
    return "\n".join(
        [
            "*HEADING",
            title,
            f'*INCLUDE, INPUT="{mesh}"',
            f"*FORMULATION, TYPE={'STANDARD' if formulation == 'standard' else 'FBAR PATCH'}",
            f"*PATCH, SOURCE=METIS, SIZE={2**n_dim}",
            *extra,
            "*MATERIAL, NAME=RUBBER",
            "*ELASTIC",
            f"{YOUNG}, {POISSON}",
            f"*MATERIAL POINTS, ELSET=BODY, MATERIAL=RUBBER, PER ELEMENT={per_element}",
        ]
    )


def exact_deck(load, n_dim, carrier, formulation):
    """A deck that must reach the exact state: one increment, or a mesh that goes with the body."""
    increments = {"pressure": 1, "oblique": 5}[load]
    words = {"mesh": "on nodes of the mesh", "points": "on points of the body"}[carrier]
    return "\n".join(
        [
            model_text(
                f"Traction patch test: {load} load {words}, {n_dim}-D, {formulation}",
                f"mesh-{n_dim}d.inc",
                formulation,
                n_dim,
                4,
            ),
            *(["*MOVING MESH, TYPE=LAGRANGIAN"] if increments > 1 else []),
            "*STEP",
            "*STATIC, DIRECT",
            f"{1.0 / increments!r}, 1.0",
            "*CONTROLS, TOLERANCE=1e-11",
            support_text(n_dim),
            load_text(load, n_dim, carrier),
            "*OUTPUT, FIELD, FREQUENCY=0",
            "S, U, F, VOL",
            expectations(load, n_dim, 1e-9),
            "*EXPECT, QUANTITY=BALANCE",
            "analytic, 0.0, 0.0, 1E-8",
            "*END STEP\n",
        ]
    )


def crossing_deck(n_dim, carrier, formulation, per_element, with_ghost=False):
    """A deck whose points cross elements of a mesh that stays; with_ghost: small cuts are held."""
    words = {"mesh": "on nodes of the mesh", "points": "on points of the body"}[carrier]
    stress = LOADS["diagonal"]
    bound = f"analytic, 0.0, 0.0, {GHOST_SHARE}"
    return "\n".join(
        [
            model_text(
                f"Points crossing under tractions {words}, {n_dim}-D, {formulation}",
                f"crossing-{n_dim}d.inc",
                formulation,
                n_dim,
                per_element,
                [f"*GHOST PENALTY, GAMMA={GAMMA}"] if with_ghost else [],
            ),
            "*STEP",
            "*STATIC, DIRECT",
            "0.1, 1.0",
            "*CONTROLS, TOLERANCE=1e-11",
            "*BOUNDARY",
            *(f"{AXES[k]}0, {k + 1}, {k + 1}" for k in range(n_dim)),
            f"*DSLOAD, CARRIER={carrier.upper()}",
            *(
                f"{AXES[k]}1-SIDE, TRVEC, {stress[k][k]}, "
                + ", ".join("1" if i == k else "0" for i in range(n_dim))
                for k in range(n_dim)
            ),
            "*OUTPUT, FIELD, FREQUENCY=0",
            "S, U, VOL",
            *(["*EXPECT, QUANTITY=GHOST SHARE", bound] if with_ghost else []),
            "*EXPECT, QUANTITY=BALANCE",
            "analytic, 0.0, 0.0, 1E-8",
            "*END STEP\n",
        ]
    )


def main():
    for n_dim in (2, 3):
        (HERE / f"mesh-{n_dim}d.inc").write_text(mesh_text(FIXED[n_dim]))
        (HERE / f"crossing-{n_dim}d.inc").write_text(mesh_text(CROSSED[n_dim]))
        for formulation in ("standard", "fbar"):
            for carrier, load in product(("mesh", "points"), CASES):
                name = f"{load}-{n_dim}d-{carrier}-{formulation}.inp"
                (HERE / name).write_text(exact_deck(load, n_dim, carrier, formulation))
            if (n_dim, formulation) == (3, "fbar"):
                for n in CROSSING[n_dim]:  # small cuts end runs without penalty: see README.md
                    deck = crossing_deck(n_dim, "points", formulation, n, with_ghost=True)
                    (HERE / f"crossing-{n_dim}d-ghost-{formulation}-{n:03}.inp").write_text(deck)
                continue
            for n in CROSSING[n_dim]:
                name = f"crossing-{n_dim}d-points-{formulation}-{n:03}.inp"
                (HERE / name).write_text(crossing_deck(n_dim, "points", formulation, n))
            name = f"crossing-{n_dim}d-mesh-{formulation}-064.inp"
            (HERE / name).write_text(crossing_deck(n_dim, "mesh", formulation, 64))


if __name__ == "__main__":
    main()
