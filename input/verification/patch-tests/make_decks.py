"""Makes the decks of this case, their meshes and motions, exact.json and case.toml.

Everything follows from the numbers in this file: run it again after a change (needs numpy).
"""

import json
import math
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from closed_forms import flowing_shear, prove_all
from meshes import Mesh
from reference import Body, Material

HERE = Path(__file__).parent
RTOL = 1e-11  # of a component
ATOL = 1e-11  # of a component that is 0, over the largest stress of the run
ELASTIC = Material(100.0, 0.3)
PERFECT = Material(100.0, 0.3, 2.0)
HARDENING = Material(100.0, 0.3, 2.0, 5.0)
SOFT = Material(100.0, 0.3, 20.0)  # flows at large elastic strains
STRETCH = 3.0
SHEAR = 2.0
ORDERS = {"standard": "linear", "fbar-quadratic": "quadratic", "fbar-metis": "linear"}
PER_ELEMENT = {2: 3, 3: 4}


@dataclass(frozen=True)
class Leg:
    """A step of a deck: so many equal increments x = A x + d; when the mesh goes with the
    body, equal increments of the displacement up to x = A X."""

    name: str
    a: np.ndarray  # (3, 3)
    n: int = 1  # increments
    d: np.ndarray = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Family:
    """Decks of one motion."""

    name: str
    title: str
    centre: tuple[float, float, float]  # of the ellipsoid that the body fills
    radii: tuple[float, float, float]
    materials: dict[str, Material]  # by a word in the name of the deck
    formulations: tuple[str, ...]
    holds_all: bool = True  # False: only nodes on the surface of the body are prescribed
    dimensions: tuple[int, ...] = (2, 3)
    plane_radii: tuple[float, ...] = ()  # in 2-D, if not the same
    carries_mesh: bool = False  # one step; True: the mesh goes with the body

    def body(self, mesh: Mesh) -> list[int]:
        """Elements that are filled."""
        radii = self.plane_radii if mesh.n_dim == 2 and self.plane_radii else self.radii
        return mesh.inside(self.centre, radii)


def diagonal(*values: float) -> np.ndarray:
    return np.diag(np.array(values))


def embedded(matrix: list[list[float]]) -> np.ndarray:
    """A matrix of 2 or 3 rows as the deformation gradient of a 3-D body."""
    a = np.eye(3)
    a[: len(matrix), : len(matrix)] = matrix
    return a


def root(a: np.ndarray, n: int) -> np.ndarray:
    """The n-th root of a symmetric positive definite matrix."""
    values, axes = np.linalg.eigh(a)
    return axes @ np.diag(values ** (1.0 / n)) @ axes.T


def rotation(n_dim: int, degrees: float) -> np.ndarray:
    """About z in the plane, about (1, 2, 2) in space."""
    axis = np.array([0.0, 0.0, 1.0]) if n_dim == 2 else np.array([1.0, 2.0, 2.0]) / 3.0
    spin = np.cross(np.eye(3), axis).T  # spin v = axis x v
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * spin + (1.0 - math.cos(angle)) * spin @ spin


def tension(n_dim: int, stretch: float, material: Material, is_first: bool) -> np.ndarray:
    """Isochoric plastic flow along x: plane strain, or the contraction of a bar under tension."""
    if n_dim == 2:
        return diagonal(stretch, 1.0 / stretch, 1.0)
    elastic = material.strength / material.young if is_first else 0.0
    side = -material.poisson * elastic - (math.log(stretch) - elastic) / 2.0
    return diagonal(stretch, math.exp(side), math.exp(side))


def legs_of(name: str, n_dim: int, material: Material) -> list[Leg]:
    """The motion of a family."""
    solid = n_dim == 3
    if name in ("affine", "carried"):
        plane = [[1.25, 0.35], [-0.2, 0.7]]
        space = [[0.8, 0.25, 0.1], [-0.2, 0.75, 0.15], [0.1, -0.25, 0.75]]
        legs = [Leg("PULL", embedded(space if solid else plane), 1 if name == "affine" else 8)]
    elif name == "crossing":
        plane = [[1.3, 0.1], [0.1, 0.85]]
        space = [[1.25, 0.1, 0.0], [0.1, 0.9, 0.05], [0.0, 0.05, 0.85]]
        a = root(embedded(space if solid else plane), 16)
        legs = [Leg("WANDER", a, 16, np.array([0.14, 0.01, 0.02 if solid else 0.0]))]
    elif name == "rotation":
        plane = [[1.03, 0.02], [-0.01, 0.98]]
        space = [[1.03, 0.02, 0.01], [-0.01, 0.98, 0.015], [0.0, -0.01, 1.01]]
        turns = (("TURN30", 30.0, 1), ("TURN90", 90.0, 1), ("TURN60", 10.0, 6))
        legs = [Leg("STRETCH", embedded(space if solid else plane), 4)]
        legs += [Leg(step, rotation(n_dim, angle), n) for step, angle, n in turns]
    elif name == "tension":
        half = tension(n_dim, STRETCH / 2.0, material, True)
        legs = [Leg("ONE", half), Leg("MANY", tension(n_dim, 2.0**0.05, material, False), 20)]
    elif name == "stretch":
        one, many = diagonal(STRETCH, 1.0, 1.0), diagonal(STRETCH**0.05, 1.0, 1.0)
        legs = [Leg("ONE", one), Leg("BACK", np.linalg.inv(one)), Leg("MANY", many, 20)]
    elif name == "shear":
        legs = [Leg("ONE", sheared(SHEAR)), Leg("BACK", sheared(-SHEAR)), shear_leg(20)]
    else:
        legs = [shear_leg(int(name.removeprefix("turning-")))]
    return legs


def sheared(gamma: float) -> np.ndarray:
    return embedded([[1.0, gamma], [0.0, 1.0]])


def shear_leg(n: int) -> Leg:
    return Leg("MANY", sheared(SHEAR / n), n)


ALL = tuple(ORDERS)
TWO = ("standard", "fbar-quadratic")
BLOCK = {"centre": (0.0, 0.0, 0.0), "radii": (1.0, 0.8, 1.0)}
FAMILIES = [
    Family(
        "affine",
        "Affine displacement of the surface, nodes inside free",
        (0.0, 0.0, 0.0),
        (2.2, 2.2, 2.2),
        {"elastic": ELASTIC, "plastic": PERFECT},
        ALL,
        holds_all=False,
        plane_radii=(2.1, 1.4),
    ),
    Family(
        "crossing",
        "Shift and stretch through the mesh",
        (-1.4, 0.0, 0.0),
        (1.0, 0.9, 1.0),
        {"plastic": HARDENING},
        ALL,
    ),
    Family(
        "rotation",
        "Plastic stretch, then rotations",
        (0.0, 0.0, 0.0),
        (1.0, 1.0, 1.0),
        {"plastic": HARDENING},
        ALL,
    ),
    Family("stretch", "Stretch without contraction", **BLOCK, materials={"elastic": ELASTIC},
           formulations=TWO),
    Family("tension", "Tension", **BLOCK, materials={"plastic": PERFECT}, formulations=TWO),
    Family("shear", "Simple shear", **BLOCK, materials={"elastic": ELASTIC, "plastic": PERFECT},
           formulations=TWO),
]  # fmt: skip
FAMILIES.append(
    replace(
        FAMILIES[0],
        name="carried",
        title="The same in 8 increments, the mesh goes with the body",
        radii=(9.0, 9.0, 9.0),  # everything
        plane_radii=(),
        materials={"plastic": PERFECT},
        carries_mesh=True,
    )
)
TURNING_STEPS = (10, 20, 40, 80)
TURNING = [
    Family(f"turning-{n}", f"Simple shear in {n} increments, soft material", **BLOCK,
           materials={"plastic": SOFT}, formulations=("standard",), dimensions=(2,))
    for n in TURNING_STEPS
]  # fmt: skip


def increments(leg: Leg, carries_mesh: bool) -> list[np.ndarray]:
    """The deformation gradients of the increments of a step."""
    if not carries_mesh:
        return [leg.a] * leg.n
    parts = [np.eye(3) + i / leg.n * (leg.a - np.eye(3)) for i in range(leg.n + 1)]
    return [after @ np.linalg.inv(before) for before, after in pairwise(parts)]


def exact_states(
    legs: list[Leg], material: Material, carries_mesh: bool
) -> dict[str, dict[str, list[float]]]:
    """The fields at the end of every step, by total time."""
    body = Body(material)
    states = {}
    for i, leg in enumerate(legs):
        for a in increments(leg, carries_mesh):
            body.move(a, leg.d)
        states[f"{i + 1}"] = body.fields()
    return states


def motion_text(directions: list[int], nodes: list[int], totals: np.ndarray) -> str:
    """*BOUNDARY: the displacements of nodes at the end of a step."""
    lines = ["*BOUNDARY"]
    for direction in directions:
        for node in nodes:
            value = float(totals[node, direction])
            lines.append(f"{node + 1}, {direction + 1}, {direction + 1}, {value!r}")
    return "\n".join(lines) + "\n"


def resting(mesh: Mesh, legs: list[Leg]) -> list[int]:
    """Directions, from 0, in which no node ever moves."""
    moves = sum(np.abs(leg.a - np.eye(3)).sum(axis=1) + np.abs(leg.d) for leg in legs)
    return [i for i in range(mesh.n_dim) if moves[i] == 0.0]


def write_motions(family: Family, mesh: Mesh, nodes: list[int], legs: list[Leg]) -> list[str]:
    """The files of the prescribed displacements, one per step. Both meshes have the same nodes."""
    names = []
    order = "" if family.holds_all else f"-{mesh.order}"
    moving = [i for i in range(mesh.n_dim) if i not in resting(mesh, legs)]
    x = np.zeros((len(mesh.x), 3))
    x[:, : mesh.n_dim] = mesh.x
    totals = np.zeros_like(x)
    for leg in legs:
        n = 1 if family.carries_mesh else leg.n
        totals = totals + n * (x @ (leg.a - np.eye(3)).T + leg.d)
        names.append(f"{family.name}-{mesh.n_dim}d{order}-{leg.name.lower()}.inc")
        (HERE / names[-1]).write_text(motion_text(moving, nodes, totals))
    return names


def model_text(family: Family, mesh: Mesh, formulation: str, material: Material) -> str:
    """The model part of a deck."""
    body = family.body(mesh)
    text = f'*INCLUDE, INPUT="nodes-{mesh.n_dim}d.inc"\n'
    text += f'*INCLUDE, INPUT="elements-{mesh.n_dim}d-{mesh.order}.inc"\n'
    text += "*ELSET, ELSET=BODY\n"
    for i in range(0, len(body), 12):
        text += ", ".join(str(e + 1) for e in body[i : i + 12]) + "\n"
    kind = "STANDARD" if formulation == "standard" else "FBAR PATCH"
    source = {"standard": "NONE", "fbar-quadratic": "QUADRATIC"}.get(
        formulation, f"METIS, SIZE={4 if mesh.n_dim == 2 else 8}"
    )
    text += f"*FORMULATION, TYPE={kind}\n*PATCH, SOURCE={source}\n" + material.card()
    if family.carries_mesh:
        text += "*MOVING MESH, TYPE=LAGRANGIAN\n"
    text += "*MATERIAL POINTS, ELSET=BODY, MATERIAL=BLOCK, PER ELEMENT="
    return text + f"{PER_ELEMENT[mesh.n_dim]}\n"


def support_text(mesh: Mesh, legs: list[Leg]) -> str:
    """Holds all nodes in the directions in which none ever moves."""
    directions = resting(mesh, legs)
    if not directions:
        return ""
    text = f"*NSET, NSET=NODES, GENERATE\n1, {len(mesh.x)}, 1\n*BOUNDARY\n"
    return text + "".join(f"NODES, {i + 1}, {i + 1}\n" for i in directions)


def expectations(fields: dict[str, list[float]], scale: float) -> str:
    """The smallest and the largest of some components over all points are the exact value."""
    wanted = [("S", 1), ("S", 2), ("S", 4)]
    lines = []
    for name, component in wanted:
        for statistic in ("MIN", "MAX"):
            lines.append(
                f"*EXPECT, QUANTITY={name}, COMPONENT={component}, STATISTIC={statistic}\n"
                f"analytic, {fields[name][component - 1]!r}, {RTOL!r}, {ATOL * scale!r}\n"
            )
    for statistic in ("MIN", "MAX") if fields["PEEQ"][0] > 0.0 else ():
        lines.append(f"*EXPECT, QUANTITY=PEEQ, STATISTIC={statistic}\n")
        lines.append(f"analytic, {fields['PEEQ'][0]!r}, {RTOL!r}\n")
    return "".join(lines)


def step_text(leg: Leg, motion: str, expected: str) -> str:
    """One step of a deck."""
    return (
        f"*STEP, NAME={leg.name}, INC={leg.n}\n*STATIC, DIRECT\n{1.0 / leg.n!r}, 1.0\n"
        f'*INCLUDE, INPUT="{motion}"\n*OUTPUT, FIELD, FREQUENCY=0\nS, TAU, LE, F, PEEQ, JBAR, U\n'
        f"{expected}*END STEP\n"
    )


def write_decks(family: Family, n_dim: int, exact: dict) -> None:
    """The decks of a family in 2-D or 3-D, and what they must give."""
    for formulation in family.formulations:
        mesh = Mesh(n_dim, ORDERS[formulation])
        body = family.body(mesh)
        nodes = list(range(len(mesh.x))) if family.holds_all else sorted(mesh.faces(body))
        for word, material in family.materials.items():
            legs = legs_of(family.name, n_dim, material)
            motions = write_motions(family, mesh, nodes, legs)
            states = exact_states(legs, material, family.carries_mesh)
            scale = max(abs(v) for fields in states.values() for v in fields["TAU"])
            job = f"{family.name}-{n_dim}d-{formulation}-{word}"
            exact[job] = states
            turns = [np.linalg.matrix_power(leg.a, leg.n) for leg in legs[1:]]
            prove_all(job, states, material, turns, (STRETCH, SHEAR))
            text = f"** Made by make_decks.py.\n*HEADING\n{family.title}, {n_dim}-D, "
            text += f"{formulation}, {word}\n" + model_text(family, mesh, formulation, material)
            text += support_text(mesh, legs)
            for i, leg in enumerate(legs):
                is_last = i + 1 == len(legs)
                expected = expectations(states[f"{i + 1}"], scale) if is_last else ""
                if is_last:
                    expected += "*EXPECT, QUANTITY=BALANCE\nanalytic, 0.0, 0.0, 1E-8\n"
                if family in TURNING:
                    expected = "*HISTORY, POINT=0,0\nS\n" + expected
                text += step_text(leg, motions[i], expected)
            (HERE / f"{job}.inp").write_text(text)


CASE = """\
# Made by make_decks.py.
title = "Patch tests: homogeneous motions"
summary = "Homogeneous motions are exact on every mesh, whatever the patches and the points do."
"""
MEASURES = {"stress": "stress_error", "strain": "strain_error", "motion": "motion_error"}
FIGURE = """
[[figure]]
file = "patch-tests-shear.png"
caption = "Stress in simple shear of a soft, perfectly plastic material, 2-D: increments and limit."
function = "draw_shear"
"""
LIMIT = 1e-11  # of the measures


def case_text(exact: dict, limit: float) -> str:
    """case.toml; limit: TAU11 of flowing shear at its end."""
    jobs = list(exact)
    files = "".join(f'    "{job}.inp",\n' for job in jobs)
    turning = [f"turning-{n}-2d-standard-plastic.inp" for n in TURNING_STEPS]
    text = CASE
    for job in jobs:
        text += f'\n[[deck]]\nfile = "{job}.inp"\nlabel = "quick"\n'
    for word, function in MEASURES.items():
        text += f'\n[[measure]]\nname = "largest error of the {word}"\nfunction = "{function}"\n'
        text += f"decks = [\n{files}]\nexact = 0.0\natol = {LIMIT!r}\n"
    decks = "".join(f'    "{file}",\n' for file in turning)
    text += '\n[[measure]]\nname = "stress against continuous flow"\nfunction = "flow_error"\n'
    errors = [exact[file[:-4]]["1"]["TAU"][0] / limit - 1.0 for file in turning]  # per increment
    frozen = ", ".join(f'"{file}" = {abs(error):.12g}' for file, error in zip(turning, errors))
    text += f"decks = [\n{decks}]\nfrozen = {{{frozen}}}\n"
    text += '\n[[study]]\nname = "stress in simple shear, size of the increments"\n'
    text += f'measure = "stress against continuous flow"\ndecks = [\n{decks}]\n'
    return text + f"h = {[SHEAR / n for n in TURNING_STEPS]}\norder = 0.95\n" + FIGURE


def main() -> None:
    exact: dict = {}
    for old in [*HERE.glob("*.inp"), *HERE.glob("*.inc")]:
        old.unlink()
    for n_dim in (2, 3):
        for order in ("linear", "quadratic"):
            mesh = Mesh(n_dim, order)
            (HERE / f"nodes-{n_dim}d.inc").write_text(mesh.node_text())
            (HERE / f"elements-{n_dim}d-{order}.inc").write_text(mesh.element_text())
    for family in [*FAMILIES, *TURNING]:
        for n_dim in family.dimensions:
            write_decks(family, n_dim, exact)
    gammas = [SHEAR * i / 100.0 for i in range(101)]
    flow = [flowing_shear(gamma, SOFT) for gamma in gammas]
    curve = {"gamma": gammas, "TAU11": [float(t[0, 0]) for t in flow]}
    curve["TAU12"] = [float(t[0, 1]) for t in flow]
    content = {"states": exact, "flowing_shear": curve}
    (HERE / "exact.json").write_text(json.dumps(content, indent=1) + "\n")
    (HERE / "case.toml").write_text(case_text(exact, curve["TAU11"][-1]))


if __name__ == "__main__":
    main()
