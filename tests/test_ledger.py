"""The ledger: what becomes of points, mass and forces, increment by increment."""

import re

import h5py
import numpy as np
import pytest

# A bar of two materials, heavy and light, on a mesh that it leaves at its end.
BAR = """\
*HEADING
Bar of two materials, pulled beyond its mesh
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 4, 4
Y, 0, 1, 1
*ELSET, ELSET=HEAVY, BOX
0, 2, 0, 1
*ELSET, ELSET=LIGHT, BOX
2, 4, 0, 1
*PATCH, SOURCE=QUADRATIC
*FORMULATION, TYPE=FBAR PATCH
*MATERIAL, NAME=IRON
*DENSITY
8.0
*ELASTIC
1000.0, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
20.0, 0.0
100.0, 1.0
*MATERIAL, NAME=CORK
*DENSITY
0.5
*ELASTIC
500.0, 0.2
*MATERIAL POINTS, ELSET=HEAVY, MATERIAL=IRON, PER ELEMENT=3
*MATERIAL POINTS, ELSET=LIGHT, MATERIAL=CORK, PER ELEMENT=3
{method}
*STEP, NAME=PULL
*STATIC, DIRECT
0.2, 1.0
*CONTROLS, TOLERANCE={tolerance}
*BOUNDARY
X0, 1, 1
Y0, 2, 2
X1, 1, 1, {pull}
{loads}
*OUTPUT, FIELD, FREQUENCY=1
S, U, VOL, ELEMENT, PATCH, MAT
*EXPECT, QUANTITY=BALANCE
analytic, 0.0, 0.0, 1E-8
*END STEP
"""
GRAVITY = 10.0
WEIGHT = f"*DLOAD\nHEAVY, GRAV, {GRAVITY}, 0, -1\nLIGHT, GRAV, {GRAVITY}, 0, -1"
DENSITY = np.array([8.0, 0.5])
MASS = 2.0 * 8.0 + 2.0 * 0.5


def bar(method="", pull=0.4, loads=WEIGHT, tolerance=1e-9):
    """The deck; with weight unless told otherwise."""
    text = BAR.format(method=method, pull=pull, loads=loads, tolerance=tolerance)
    return "\n".join(line for line in text.splitlines() if line) + "\n"


class Files:
    """The ledger, and the fields of points and nodes at each output."""

    def __init__(self, folder):
        with h5py.File(folder / "job.vtkhdf") as file:
            self.ledger = {name: column[()] for name, column in file["tessera/ledger"].items()}
            self.points = steps_of(file)
        with h5py.File(folder / "job_mesh.vtkhdf") as file:
            self.mesh = steps_of(file)


def steps_of(file):
    """The fields on points of a VTKHDF file, one dictionary per time; X is the place."""
    grid, found = file["VTKHDF"], []
    steps = grid["Steps"]
    for i in range(steps.attrs["NSteps"]):
        n = grid["NumberOfPoints"][steps["PartOffsets"][i]]
        first = steps["PointOffsets"][i]
        fields = {"X": grid["Points"][first : first + n]}
        for name, column in grid["PointData"].items():
            first = steps[f"PointDataOffsets/{name}"][i]
            fields[name] = column[first : first + n]
        found.append(fields)
    return found


def masses(files):
    """The mass of each point by its ID, from volumes and materials at time 0."""
    first = files.points[0]
    return (first["VOL"] * DENSITY[first["MAT"] - 1])[np.argsort(first["ID"])]


# --- mass and its centre -------------------------------------------------------------------------


@pytest.mark.parametrize(
    "method", ["*LOST POINTS, ACTION=FREEZE", "*MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0"]
)
@pytest.mark.parametrize("loads", ["", WEIGHT])
def test_centre_of_mass_moves_with_the_points_only(method, loads, run_tessera, tmp_path):
    run = run_tessera(bar(method, loads=loads))
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    assert len(files.points) == files.ledger["mass"].size == 6
    mass, start = masses(files), files.points[0]["X"]
    assert mass.sum() == pytest.approx(MASS, rel=1e-12)
    np.testing.assert_allclose(files.ledger["mass"], MASS, rtol=1e-13)
    np.testing.assert_array_equal(files.ledger["count"], mass.size)
    for centre, step in zip(files.ledger["centre"], files.points):
        np.testing.assert_array_equal(step["ID"], files.points[0]["ID"])
        place = start + step["U"]
        np.testing.assert_allclose(step["X"], place, atol=1e-13)
        np.testing.assert_allclose(centre, mass @ place / MASS, rtol=1e-12, atol=1e-13)
    # It does move, and not as that of the volume.
    assert files.ledger["centre"][-1][0] > files.ledger["centre"][0][0] + 0.02
    volume = files.points[-1]["VOL"]
    of_volume = volume @ files.points[-1]["X"] / volume.sum()
    assert files.ledger["centre"][-1][0] < of_volume[0] - 0.5


def test_volume_is_that_of_the_points(run_tessera, tmp_path):
    assert run_tessera(bar("*LOST POINTS, ACTION=REMOVE")).code == 0
    files = Files(tmp_path)
    assert files.ledger["lost"][-1] > 0
    found = [step["VOL"].sum() for step in files.points]
    np.testing.assert_allclose(files.ledger["volume"], found, rtol=1e-13)
    assert found[1] != found[0]


# --- lost points ---------------------------------------------------------------------------------


def test_frozen_points_stay_in_files_and_sums(run_tessera, tmp_path):
    run = run_tessera(bar("*LOST POINTS, ACTION=FREEZE"))
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    lost = files.ledger["lost"]
    assert lost[1] == 0
    assert 0 < lost[2] < lost[-1]
    np.testing.assert_array_equal(files.ledger["count"], files.ledger["count"][0])
    np.testing.assert_allclose(files.ledger["mass"], MASS, rtol=1e-13)
    for i, step in enumerate(files.points):
        frozen = step["ELEMENT"] == 0
        assert frozen.sum() == lost[i]
        np.testing.assert_array_equal(step["PATCH"] == 0, frozen)
        assert step["ID"].size == files.ledger["count"][i]
        if i > 0:  # those of before are where they were
            before = files.points[i - 1]["ELEMENT"] == 0
            assert np.all(frozen[before])
            for name in ("X", "U", "S", "VOL"):
                np.testing.assert_array_equal(step[name][before], files.points[i - 1][name][before])
    assert f"lost points: {lost[-1]}, " in run.read("job.log")


def test_removed_points_leave_files_and_sums(run_tessera, tmp_path):
    run = run_tessera(bar("*LOST POINTS, ACTION=REMOVE"))
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    mass, n = masses(files), files.ledger["count"][0]
    lost = files.ledger["lost"]
    assert lost[1] == 0
    assert 0 < lost[2] < lost[-1]
    np.testing.assert_array_equal(files.ledger["count"] + lost, n)
    for i, step in enumerate(files.points):
        assert step["ID"].size == files.ledger["count"][i]
        assert np.all(step["ELEMENT"] > 0)
        kept = mass[step["ID"] - 1]
        assert kept.sum() == pytest.approx(files.ledger["mass"][i], rel=1e-12)
        np.testing.assert_allclose(files.ledger["centre"][i], kept @ step["X"] / kept.sum())
        if i > 0:
            assert set(step["ID"]) <= set(files.points[i - 1]["ID"])
    assert files.ledger["mass"][-1] < MASS - 0.1
    assert f"lost points: {lost[-1]}, " in run.read("job.log")


@pytest.mark.parametrize("method", ["", "*LOST POINTS, ACTION=ERROR"])
def test_lost_point_ends_the_run_with_everything_told(method, run_tessera, tmp_path):
    run = run_tessera(bar(method))
    assert run.code == 6, run.stdout + run.stderr
    found = re.search(r"error: (\d+) material points?.* point (\d+) at \(([^)]*)\)", run.stderr)
    assert found, run.stderr
    files = Files(tmp_path)
    # The second increment, which lost it, is there, and all points with it.
    last = files.points[-1]
    assert len(files.points) == files.ledger["count"].size == 3
    np.testing.assert_array_equal(files.ledger["count"], last["ID"].size)
    np.testing.assert_allclose(files.ledger["mass"], MASS, rtol=1e-13)
    place = [float(text) for text in found[3].split(",")]
    assert last["X"][last["ID"] == int(found[2])][0][:2] == pytest.approx(place, rel=1e-5)
    assert place[0] > 4.0
    assert f"lost points: {found[1]}, " in run.read("job.log")
    assert "exit code: 6" in run.read("job.log")


# --- balance of forces ---------------------------------------------------------------------------


def weight_carried(files, mass, i):
    """Weight, at the end of an increment, of the points that had a host at its start."""
    start = files.points[i - 1]
    return mass[start["ID"][start["ELEMENT"] > 0] - 1].sum() * GRAVITY * 0.2 * i


@pytest.mark.parametrize("action", ["FREEZE", "REMOVE"])
def test_forces_balance_when_points_are_lost(action, run_tessera, tmp_path):
    run = run_tessera(bar(f"*LOST POINTS, ACTION={action}"))
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    mass = masses(files)
    assert files.ledger["lost"][-1] > 0
    assert files.ledger["balance"][0] == 0.0
    assert np.all(files.ledger["balance"] < 1e-8)
    # The supports carry the weight of the points that took part: those that were there before.
    for i in range(1, len(files.points)):
        reaction = files.mesh[i]["RF"].sum(axis=0)
        assert reaction[1] == pytest.approx(weight_carried(files, mass, i), rel=1e-8)
        assert reaction[0] == pytest.approx(0.0, abs=1e-6)


def test_balance_is_that_of_reactions_and_loads(run_tessera, tmp_path):
    """Newton's method is stopped early: the residual of the free nodes is what is missing."""
    run = run_tessera(bar("*LOST POINTS, ACTION=FREEZE", tolerance=0.02))
    assert run.code == 7
    files = Files(tmp_path)
    expected = [0.0]
    for i in range(1, len(files.points)):
        weight = weight_carried(files, masses(files), i)  # of each node, it points down
        missing = np.linalg.norm(files.mesh[i]["RF"].sum(axis=0) - [0.0, weight, 0.0])
        reactions = np.linalg.norm(files.mesh[i]["RF"], axis=1).sum()
        expected.append(missing / (reactions + weight))
    np.testing.assert_allclose(files.ledger["balance"], expected, rtol=1e-6)
    worst = files.ledger["balance"].max()
    assert worst > 1e-6
    assert f"balance of forces: at most {worst:.2g}"[:-1] in run.read("job.log")
    assert re.search(r"EXPECT job.inp:\d+ BALANCE at 1: analytic 0 \+- 1e-8, found .*: FAILED",
                     run.read("job.log"))  # fmt: skip


def test_forces_balance_on_rotated_axes(run_tessera, tmp_path):
    """A roller on an inclined end: reactions along axes of their own."""
    text = bar("*TRANSFORM, NSET=X0, TYPE=R\n0.8, 0.6, -0.6, 0.8", loads=WEIGHT, pull=0.02)
    run = run_tessera(text.replace("X0, 1, 1\n", "X0, 1, 2\n"))
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    assert np.all(files.ledger["balance"] < 1e-8)
    reaction = files.mesh[-1]["RF"].sum(axis=0)
    assert reaction[:2] == pytest.approx([0.0, MASS * GRAVITY], rel=1e-8, abs=1e-6)


def test_body_that_moves_freely_is_in_balance(run_tessera, tmp_path):
    """It has no forces but rounding errors, which are not measured against themselves."""
    text = bar(pull=0.02, loads="").replace("X0, 1, 1\n", "X0, 1, 1, 0.02\n")
    run = run_tessera(text)
    assert run.code == 0, run.stdout + run.stderr
    files = Files(tmp_path)
    assert np.abs(files.mesh[-1]["RF"]).max() < 1e-9
    assert np.all(files.ledger["balance"] < 1e-8)
