#!/usr/bin/env python3
"""Writes meshes and decks of the inclined roller: the level problem and the same one turned.

    make_decks.py                  writes them
    make_decks.py --values FOLDER  takes the values of the level jobs from their results first

Coordinates, directions and the expected values of the turned decks are those of the level ones
times the rotation of inclination.py, with all digits.
"""

import argparse
import itertools
import json
from pathlib import Path

import numpy as np
from inclination import SLOPE, turn
from tessera_post.job import open_job

FOLDER = Path(__file__).resolve().parent
DENSITY = 2.0
GRAVITY = 10.0
METHODS = {"standard": "STANDARD", "fbar": "FBAR PATCH"}
STORE = FOLDER / "level_values.json"  # what runs of the level decks gave

HEADING = """\
** written by make_decks.py
*HEADING
Block pushed {where}: {dimension}, {method}
"""
MODEL = """\
*MATERIAL, NAME=SOIL
*DENSITY
{density}
*ELASTIC
2.0E4, 0.4
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
60.0, 0.0
120.0, 0.2
*MATERIAL POINTS, ELSET=BODY, MATERIAL=SOIL, PER ELEMENT={points}
"""


# --- meshes --------------------------------------------------------------------------------------


def grid(planes):
    """Nodes (n, n_dim) of a grid, first axis fastest, and the number of a grid place."""
    nodes = np.array([p[::-1] for p in itertools.product(*planes[::-1])])
    sizes = [len(plane) for plane in planes]
    strides = np.cumprod([1, *sizes[:-1]])
    return nodes, lambda place: int(np.dot(place, strides))


def triangles(planes):
    """Nodes and six-node triangles: planes hold the lines of corners and of middles."""
    nodes, number = grid(planes)
    elements = []
    for j in range(0, len(planes[1]) - 1, 2):
        for i in range(0, len(planes[0]) - 1, 2):
            a, b, c, d = (i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)
            for corners in ((a, b, c), (a, c, d)):
                pairs = zip(corners, (*corners[1:], corners[0]))
                middles = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2) for p, q in pairs]
                elements.append([number(p) for p in (*corners, *middles)])
    return nodes, np.array(elements)


def tetrahedra(planes):
    """Nodes and four-node tetrahedra, six around the diagonal of every cell."""
    nodes, number = grid(planes)
    elements = []
    for cell in itertools.product(*(range(len(plane) - 1) for plane in planes[::-1])):
        for order in itertools.permutations(range(3)):
            place = list(cell[::-1])
            element = [number(place)]
            for axis in order:
                place[axis] += 1
                element.append(number(place))
            x = nodes[element]
            if np.linalg.det(x[1:] - x[0]) < 0.0:
                element[2], element[3] = element[3], element[2]
            elements.append(element)
    return nodes, np.array(elements)


# --- text ----------------------------------------------------------------------------------------


def numbers(values):
    """Reals with all digits."""
    return ", ".join(f"{float(value):.17g}" for value in values)


def rows(items):
    """Integers, 15 in a line."""
    items = [str(item) for item in items]
    return "".join(", ".join(items[i : i + 15]) + "\n" for i in range(0, len(items), 15))


def node_text(nodes):
    lines = [f"{i + 1}, {numbers(x)}\n" for i, x in enumerate(nodes)]
    return "*NODE\n" + "".join(lines)


def element_text(kind, elements, in_body):
    text = ""
    for name, mask in (("BODY", in_body), ("EMPTY", ~in_body)):
        lines = [f"{i + 1}, {', '.join(map(str, elements[i] + 1))}\n" for i in np.flatnonzero(mask)]
        text += f"*ELEMENT, TYPE={kind}, ELSET={name}\n" + "".join(lines)
    return text


def set_text(sets):
    return "".join(f"*NSET, NSET={name}\n{rows(ids + 1)}" for name, ids in sets.items())


def write(name, text):
    (FOLDER / name).write_text(text)


# --- decks ---------------------------------------------------------------------------------------


def expectations(values, statics, rotation, n_dim):
    """The *EXPECT of a job: reactions and displacements as vectors, what no turn changes as such.
    What a level job gave is frozen in its deck, and turned what theory says of the inclined one;
    of the level job theory knows the reactions that statics gives."""
    text = ""
    kind = ("frozen", 1e-6) if rotation is None else ("analytic", 1e-10)
    for key, value in values.items():
        quantity, place, statistic = key.split()
        head = f"*EXPECT, QUANTITY={quantity}, STATISTIC={statistic}"
        head += f", SET={place}" if place != "-" else ""
        if isinstance(value, list):
            vector = np.array([*value, 0.0][:3])
            vector = vector if rotation is None else rotation @ vector
            for i in range(n_dim):
                line = f"{kind[0]}, {vector[i]:.17g}, {kind[1]:g}"
                text += f"{head}, COMPONENT={i + 1}\n"
                if rotation is None and (key, i + 1) in statics:
                    text += f"analytic, {statics[key, i + 1]:.17g}, 1e-10\n"
                text += f"{line}\n"
        else:
            text += f"{head}\n{kind[0]}, {value:.17g}, {kind[1]:g}\n"
    return text


def deck(case, method, inclined, values):
    """One deck. Conditions are the same file in both: they mean the axes of the nodes."""
    n_dim = case["n_dim"]
    rotation = turn(n_dim) if inclined else None
    axes = np.eye(3) if rotation is None else rotation
    weight = -turn(n_dim)[n_dim - 1]  # down, along the axes of the plane
    down = (axes @ weight)[:n_dim]
    name = case["name"]
    where = "up a plane of 30 degrees" if inclined else "along a level plane, weight turned"
    text = HEADING.format(where=where, dimension=case["dimension"], method=METHODS[method].lower())
    text += f'*INCLUDE, INPUT="{name}-nodes{"-inclined" if inclined else ""}.inc"\n'
    text += f'*INCLUDE, INPUT="{name}-model.inc"\n'
    text += f"*FORMULATION, TYPE={METHODS[method]}\n*PATCH, SOURCE={case['patches']}\n"
    if inclined:
        text += "** up the plane is 1, off the plane (3-D: across it) is 2\n"
        text += f"*TRANSFORM, NSET=TURNED, TYPE=R\n{numbers(axes[:n_dim, :2].T.ravel())}\n"
    if case["moving"]:
        direction = numbers(axes[:n_dim, 0]).replace(" ", "")
        text += f"*MOVING MESH, DRIVER=PUSH, DIRECTION={direction}, FIXED=FAR\n"
    for i, step in enumerate(("WEIGHT", "PUSH")):
        text += f"*STEP, NAME={step}\n*STATIC, DIRECT\n{case['increments'][i]}, 1.0\n"
        text += f'*CONTROLS, TOLERANCE=1e-12\n*INCLUDE, INPUT="{name}-{step.lower()}.inc"\n'
        if step == "WEIGHT":
            text += f"*DLOAD\nBODY, GRAV, {GRAVITY}, {numbers(down)}\n"
        else:
            text += "*OUTPUT, FIELD, FREQUENCY=0\nS, LE, PEEQ, F, JBAR, U, VOL\n"
            for place in case["watched"]:
                text += f"*HISTORY, NSET={place}\nRF, U\n"
            text += expectations(
                values.get(f"{name}-{method}", {}), case["statics"], rotation, n_dim
            )
            text += "*EXPECT, QUANTITY=BALANCE\nanalytic, 0.0, 0.0, 1E-8\n"
        text += "*END STEP\n"
    write(f"{name}-{method}{'-inclined' if inclined else ''}.inp", text)


def case_files(values, case, nodes, elements, sets):
    """Meshes, model and conditions of a case, and its four decks."""
    name, n_dim = case["name"], case["n_dim"]
    turned = np.unique(np.concatenate([ids for key, ids in sets.items() if key != "FAR"]))
    centre = nodes[elements[:, : n_dim + 1]].mean(axis=1)
    in_body = (centre < np.array(case["body"])).all(axis=1)
    write(f"{name}-nodes.inc", node_text(nodes))
    nodes = (turn(n_dim)[:n_dim, :n_dim] @ nodes.T).T
    write(f"{name}-nodes-inclined.inc", node_text(nodes) + set_text({"TURNED": turned}))
    text = element_text(case["element"], elements, in_body) + set_text(sets)
    write(f"{name}-model.inc", text + MODEL.format(points=case["points"], density=DENSITY))
    write(f"{name}-weight.inc", case["weight"])
    write(f"{name}-push.inc", case["push"])
    for method in METHODS:
        for inclined in (False, True):
            deck(case, method, inclined, values)


def plane_case():
    """A block of 3 x 1 in a mesh of 4 x 1.5 that follows the pushed side."""
    nodes, elements = triangles([np.linspace(0.0, 4.0, 17), np.linspace(0.0, 1.5, 7)])
    x, y = nodes.T
    sets = {
        "BASE": np.flatnonzero(y == 0.0),
        "PUSH": np.flatnonzero(x == 0.0),
        "FAR": np.flatnonzero(x == 4.0),
        "FRONT": np.flatnonzero((x == 3.0) & (y <= 1.0)),
    }
    assert len(np.unique(elements)) == len(nodes)
    assert len(sets["FRONT"]) == 5
    weight, slope = DENSITY * GRAVITY * 3.0, np.radians(SLOPE)
    case = {
        "name": "plane",
        "dimension": "plane strain",
        "n_dim": 2,
        "element": "CPE6",
        "patches": "QUADRATIC",
        "points": 3,
        "moving": True,
        "watched": ("PUSH", "BASE", "FRONT"),
        "body": (3.0, 1.0),
        "increments": (0.5, 0.125),
        "weight": "*BOUNDARY\nBASE, 2, 2\nPUSH, 1, 1\n",
        "statics": {
            ("RF PUSH SUM", 1): weight * np.sin(slope) + 5 * 10.0,
            ("RF BASE SUM", 2): weight * np.cos(slope) + 5 * 2.0,
        },
        "push": "*BOUNDARY\nPUSH, 1, 1, 0.6\n*CLOAD\nFRONT, 1, -10.0\nFRONT, 2, -2.0\n",
    }
    return case, nodes, elements, sets


def solid_case():
    """A block of 2.5 x 1 x 1 in a mesh of 3 x 1.5 x 1.5 that stays."""
    planes = [np.linspace(0.0, 3.0, 7), np.linspace(0.0, 1.5, 4), np.linspace(0.0, 1.5, 4)]
    nodes, elements = tetrahedra(planes)
    x, y, z = nodes.T
    sets = {
        "BASE": np.flatnonzero(z == 0.0),
        "PUSH": np.flatnonzero(x == 0.0),
        "SIDE": np.flatnonzero(y == 0.0),
        "FRONT": np.flatnonzero((x == 2.5) & (y <= 1.0) & (z <= 1.0)),
    }
    assert len(sets["FRONT"]) == 9
    weight, slope = DENSITY * GRAVITY * 2.5, np.radians(SLOPE)
    case = {
        "name": "solid",
        "dimension": "solid",
        "n_dim": 3,
        "element": "C3D4",
        "patches": "METIS, SIZE=8",
        "points": 4,
        "moving": False,
        "watched": ("PUSH", "BASE", "SIDE", "FRONT"),
        "body": (2.5, 1.0, 1.0),
        "increments": (0.5, 0.125),
        "weight": "*BOUNDARY\nBASE, 3, 3\nSIDE, 2, 2\nPUSH, 1, 1\n",
        "statics": {
            ("RF PUSH SUM", 1): weight * np.sin(slope) + 9 * 4.0,
            ("RF BASE SUM", 3): weight * np.cos(slope),
            ("RF SIDE SUM", 2): -9 * 1.0,
        },
        "push": "*BOUNDARY\nPUSH, 1, 1, 0.3\n*CLOAD\nFRONT, 1, -4.0\nFRONT, 2, 1.0\n",
    }
    return case, nodes, elements, sets


# --- values --------------------------------------------------------------------------------------


def level_values(folder, case):
    """What the level jobs of a case gave at their end."""
    values = {}
    for method in METHODS:
        name = f"{case['name']}-{method}"
        job = open_job(str(folder / name))
        found = {}
        for place in case["watched"]:
            for quantity, statistic in (("RF", "SUM"), ("U", "MEAN")):
                if (quantity == "RF") == (place == "FRONT"):
                    continue
                columns = [f"{quantity}{i + 1}[{place}]" for i in range(case["n_dim"])]
                vector = [float(job.history[column][-1]) for column in columns]
                found[f"{quantity} {place} {statistic}"] = vector
        strain = job.points.field("PEEQ", job.output_of())
        found["PEEQ - MEAN"] = float(strain.mean())
        found["PEEQ - MAX"] = float(strain.max())
        found["VOL - SUM"] = float(job.points.field("VOL", job.output_of()).sum())
        values[name] = found
        job.close()
    return values


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--values", type=Path, metavar="FOLDER", help="results of the level jobs")
    folder = parser.parse_args().values
    cases = (plane_case(), solid_case())
    if folder is not None:
        found = {}
        for case, *_ in cases:
            found |= level_values(folder, case)
        STORE.write_text(json.dumps(found, indent=1) + "\n")
    values = json.loads(STORE.read_text()) if STORE.exists() else {}
    for files in cases:
        case_files(values, *files)


if __name__ == "__main__":
    main()
