"""Decks of the thick cylinder and sphere: meshes as their scripts write them, and analytic values
that are those of the exact solution on the facets of the mesh."""

import importlib.util
import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from verification.solutions.ring_results import unit_pressure_forces  # noqa: E402
from verification.solutions.thick_ring import ThickRing  # noqa: E402

CASES = ROOT / "input" / "verification"
CYLINDER, SPHERE = CASES / "thick-cylinder", CASES / "thick-sphere"
DECKS = [deck for case in (CYLINDER, SPHERE) for deck in sorted(case.glob("*-fbar.inp"))]
MESH = {CYLINDER: "ring", SPHERE: "shell"}


def load(path):
    """A Python file of a case as a module."""
    spec = importlib.util.spec_from_file_location(f"{path.stem} of {path.parent.name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def blocks_of(path):
    """Data lines of an include file by keyword line."""
    blocks, current = {}, []
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            current = blocks.setdefault(line, [])
        else:
            current.append([float(field) for field in line.split(",")])
    return blocks


def set_of(blocks, name):
    return {int(node) for line in blocks[f"*NSET, NSET={name}"] for node in line}


def inner_facets_of(blocks):
    """Facets of the linear elements on the inner surface, by node numbers."""
    inner = set_of(blocks, "INNER")
    if "*ELEMENT, TYPE=CPE6, ELSET=WALL" in blocks:
        edges = [(0, 3), (3, 1), (1, 4), (4, 2), (2, 5), (5, 0)]
        elements = blocks["*ELEMENT, TYPE=CPE6, ELSET=WALL"]
        found = [[int(nodes[i + 1]) for i in edge] for nodes in elements for edge in edges]
    else:
        middle = {(0, 1): 4, (1, 2): 5, (0, 2): 6, (0, 3): 7, (1, 3): 8, (2, 3): 9}
        found = []
        for nodes in blocks["*ELEMENT, TYPE=C3D10, ELSET=WALL"]:
            node = [int(number) for number in nodes[1:]]
            for a, b, c in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
                ab, bc, ac = (node[middle[pair]] for pair in ((a, b), (b, c), (a, c)))
                a, b, c = node[a], node[b], node[c]  # noqa: PLW2901
                found += [[a, ab, ac], [ab, b, bc], [ac, bc, c], [ab, bc, ac]]
    return [facet for facet in found if inner.issuperset(facet)]


def pushed_force(case, n):
    """Sum over PUSHED of the x forces of a pressure of 1 at an inner radius of 1."""
    blocks = blocks_of(case / f"{MESH[case]}-{n}.inc")
    places = np.array([[*line, 0.0][:4] for line in blocks["*NODE"]])
    facets = np.array(inner_facets_of(blocks)) - 1
    assert (places[:, 0] == np.arange(1, len(places) + 1)).all()
    force = unit_pressure_forces(places[:, 1:], facets)
    return sum(force[node - 1, 0] for node in set_of(blocks, "PUSHED"))


def expected_values(deck):
    """{quantity: (time, analytic value)} of the *EXPECT of a deck."""
    pattern = r"\*EXPECT, QUANTITY=(\w+).*TIME=([\d.]+).*\nanalytic, ([-\d.e]+),"
    text = deck.read_text(encoding="utf-8")
    return {name: (float(time), float(value)) for name, time, value in re.findall(pattern, text)}


@pytest.mark.parametrize("case", [CYLINDER, SPHERE], ids=lambda case: case.name)
def test_meshes_are_what_the_script_writes(case, tmp_path, monkeypatch):
    script = tmp_path / "make_mesh.py"
    script.write_bytes((case / "make_mesh.py").read_bytes())
    monkeypatch.setattr(sys, "argv", ["make_mesh.py"])
    load(script).main()
    written = sorted(path.name for path in tmp_path.glob("*.inc"))
    assert len(written) == 6
    for name in written:
        new, old = blocks_of(tmp_path / name), blocks_of(case / name)
        assert list(new) == list(old)
        for keyword in new:  # to rounding: sine and cosine differ from system to system
            assert len(new[keyword]) == len(old[keyword])
            for line, before in zip(new[keyword], old[keyword]):
                assert line == pytest.approx(before, abs=1e-13)


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: f"{deck.parent.name}/{deck.stem}")
def test_analytic_values_are_exact(deck):
    case = deck.parent
    body = load(case / "measures.py").CASE
    kind, n, _ = deck.stem.split("-")
    material = body.materials[kind]
    ring = ThickRing(
        body.m, 1.0, 2.0, material.shear_modulus, material.strength, material.hardening
    )
    expected = expected_values(deck)
    a = 1.0 + expected["RF"][0]
    force = ring.pressure(a) * pushed_force(case, n) * a ** (body.m - 1)
    assert expected["RF"][1] == pytest.approx(force, rel=1e-8)
    if "U" in expected:
        assert expected["U"][1] == pytest.approx(ring.outer_radius(a) - 2.0, rel=1e-8)
    assert expected["CHECKERBOARD"][1] == 0.0


@pytest.mark.parametrize("deck", DECKS, ids=lambda deck: f"{deck.parent.name}/{deck.stem}")
def test_materials_of_measures_are_those_of_decks(deck):
    case, kind = deck.parent, deck.stem.partition("-")[0]
    material = load(case / "measures.py").CASE.materials[kind]
    blocks = blocks_of(case / f"{kind}.inc")
    assert f'INPUT="{kind}.inc"' in deck.read_text(encoding="utf-8")
    assert blocks["*ELASTIC"] == [[material.young, material.poisson]]
    plastic = blocks.get("*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL", [[math.inf]])
    assert plastic[0][0] == material.strength
    slopes = [(last - plastic[0][0]) / strain for last, strain in plastic[1:]]
    assert slopes == ([material.hardening] if material.hardening else [])
