"""Ground under its own weight: initial stress, the equilibrium step, and meshes that follow."""

import csv
from math import log

import h5py
import pytest

LEVEL = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 3, 3
Y, 0, 5, 4, 2
*FORMULATION, TYPE={formulation}
*MATERIAL, NAME=SOIL
*DENSITY
2
*ELASTIC
1e4, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=SOIL, PER ELEMENT=3
*INITIAL CONDITIONS, TYPE=STRESS, GEOSTATIC
ALL, 0, 5, -100, 0, 0.5, 0.4
*BOUNDARY
Y0, 2, 2
X0, 1, 1
X1, 1, 1
*STEP, NAME=REST
*{procedure}
1, 1
*DLOAD
ALL, GRAV, 10, 0, -1
*HISTORY, NSET=Y0
RF
*HISTORY, POINT=0,0
S, U
*END STEP
"""


def history(run):
    """Rows of the history as dictionaries of numbers."""
    lines = [line for line in run.read("job_history.csv").splitlines() if line[0] != "#"]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


@pytest.mark.parametrize("formulation", ["STANDARD", "FBAR PATCH"])
def test_ground_at_rest_stays_at_rest(formulation, run_tessera):
    run = run_tessera(LEVEL.format(formulation=formulation, procedure="GEOSTATIC, UTOL=1e-15"))
    assert run.code == 0
    start, end = history(run)
    depth = -start["S22[0 0]"] / 20
    assert 4.8 < depth < 5
    assert start["S11[0 0]"] == pytest.approx(-10 * depth, rel=1e-15)
    assert start["S33[0 0]"] == pytest.approx(-8 * depth, rel=1e-15)
    for i in (11, 22, 33):
        assert end[f"S{i}[0 0]"] == pytest.approx(start[f"S{i}[0 0]"], rel=1e-13)
    assert end["RF2[Y0]"] == pytest.approx(300, rel=1e-13)
    assert "step REST: largest displacement of a material point" in run.read("job.log")


def test_weight_that_grows_lifts_the_ground(run_tessera):
    deck = LEVEL.format(formulation="STANDARD", procedure="STATIC, DIRECT")
    run = run_tessera(deck.replace("\n1, 1\n*DLOAD", "\n0.5, 1\n*DLOAD"))
    assert run.code == 0
    _, half, _ = history(run)
    assert half["U2[0 0]"] > 1e-5
    assert "largest displacement" not in run.read("job.log")


COLUMN = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 1, 1
Y, 0, 8, 8
*FORMULATION, TYPE=STANDARD
*PATCH, SOURCE=NONE
*MATERIAL, NAME=SOIL
*DENSITY
1
*ELASTIC
10, 0
*MATERIAL POINTS, ELSET=ALL, MATERIAL=SOIL, PER ELEMENT=3
{motion}
*BOUNDARY
Y0, 1, 2
X0, 1, 1
X1, 1, 1
*STEP
*STATIC, DIRECT
0.25, 1
*DSLOAD
Y1, P, {pressure}
*HISTORY, NSET=Y1
U
*HISTORY, NSET=Y0
RF
*END STEP
"""


@pytest.mark.parametrize(
    "motion", ["TYPE=LAGRANGIAN", "DRIVER=Y1, DIRECTION=0,1, FIXED=Y0", None], ids=str
)
def test_mesh_follows_a_free_surface(motion, run_tessera):
    """Uniform compression to 0.6 of the height: with nu = 0 the stress is E ln(0.6)/0.6."""
    card = f"*MOVING MESH, {motion}" if motion else "** the mesh is reset"
    run = run_tessera(COLUMN.format(motion=card, pressure=-10 * log(0.6) / 0.6))
    if motion is None:  # the loaded surface leaves its elements behind
        assert run.code == 3
        assert "carries a load but belongs to no element" in run.stderr
        return
    assert run.code == 0
    end = history(run)[-1]
    assert end["U2[Y1]"] == pytest.approx(-3.2, rel=1e-9)
    assert end["RF2[Y0]"] == pytest.approx(-10 * log(0.6) / 0.6, rel=1e-9)
    reactions = [float(line.split()[6]) for line in run.read("job.sta").splitlines()[1:]]
    assert reactions == [0.0] * 4  # of a plane that nothing holds


def test_carried_mesh_is_stretched_too(run_tessera):
    """Uniform tension to 1.5 times the height."""
    pressure = -10 * log(1.5) / 1.5
    run = run_tessera(COLUMN.format(motion="*MOVING MESH, TYPE=LAGRANGIAN", pressure=pressure))
    assert run.code == 0
    assert history(run)[-1]["U2[Y1]"] == pytest.approx(4, rel=1e-9)


CARRIED_AWAY = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 4, 4
Y, 0, 4, 4
*ELSET, ELSET=BODY, BOX
0, 2, 0, 3
*NSET, NSET=BASE, BOX
0, 4, 0, 0
*FORMULATION, TYPE=FBAR PATCH
*MOVING MESH, TYPE=LAGRANGIAN
*MATERIAL, NAME=SOIL
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=SOIL, PER ELEMENT=4
*STEP, NAME=PUSH
*STATIC, DIRECT
0.25, 1
*BOUNDARY
BASE, 2
BASE, 1, 1, 1.2
*HISTORY, POINT=1,1
U
*OUTPUT, FIELD, FREQUENCY=1
U
*END STEP
"""


def test_mesh_that_would_invert_leaves_the_last_increment(run_tessera):
    """Nothing of the increment that the mesh cannot follow is in the results."""
    run = run_tessera(CARRIED_AWAY, "-q")
    assert run.code == 3
    assert "would turn element" in run.stderr
    assert "(step 'PUSH', increment " in run.stderr
    rows = history(run)
    with h5py.File(run.folder / "job.vtkhdf") as file:
        times = file["VTKHDF/Steps/Values"][()]
        moved = file["VTKHDF/PointData/U"][-len(file["VTKHDF/PointData/U"]) // len(times) :, 0]
    assert list(times) == [row["time"] for row in rows]
    assert moved.max() == pytest.approx(1.2 * rows[-1]["time"], rel=1e-6)
