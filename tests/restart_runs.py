"""Decks and comparisons for the tests of restarts."""

import h5py
import numpy as np

# Two steps: ground comes to rest under its weight, then a plate is pushed into it: cut-backs, empty
# elements with ghost penalty, a moving mesh, turned axes on nodes that were free before, an
# amplitude, a load that goes with the body, expectations before and after every restart.
PLATE = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 4, 4
Y, 0, 3, 3
*ELSET, ELSET=BODY, GENERATE
1, 16
*NSET, NSET=MIDDLE, BOX
2.4, 2.6, 0.9, 1.1
*NSET, NSET=PLATE, BOX
-0.1, 1.1, 1.9, 2.1
*SURFACE, NAME=ROOF
15, S2
*TRANSFORM, NSET=MIDDLE
1, 1, 0, -1, 1, 0
*AMPLITUDE, NAME=WAVE
0, 0
0.5, 1
1, 0.25
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*GHOST PENALTY, GAMMA=0.01
*MATERIAL, NAME=CLAY
*DENSITY
2.0
*ELASTIC
1000, 0.4
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
20, 0
40, 0.1
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=4
*MOVING MESH, DRIVER=PLATE, DIRECTION=0,1,0, FIXED=Y0
*LOCKING METER
*STEP, NAME=REST
*GEOSTATIC, UTOL=1
0.5, 1
*BOUNDARY
X0, 1, 1
X1, 1, 1
Y0, 2, 2
*DLOAD
BODY, GRAV, 1.0, 0, -1
*HISTORY, NSET=Y0
RF, U
*HISTORY, POINT=0.5,1.5
S, PEEQ
*OUTPUT, FIELD, FREQUENCY=2
S, LE, PEEQ, F, JBAR, VOL, U
*END STEP
*STEP, NAME=PUSH
*STATIC
1.0, 1.0
*CONTROLS, MAX ITERATIONS=5
*BOUNDARY
PLATE, 2, 2, -0.4
MIDDLE, 1, 1, 0.01
*DSLOAD, CARRIER=POINTS, AMPLITUDE=WAVE
ROOF, P, 3.0
*EXPECT, QUANTITY=PEEQ, TIME=1.5, STATISTIC=MAX
frozen, 0.17, 0.1
*EXPECT, QUANTITY=GHOST SHARE
analytic, 0, 0, 0.1
*END STEP
"""

# A cube pulled to twice its length, with points that leave the mesh and are frozen.
CUBE = """\
*GENERATE, TYPE=BOX, DIMENSION=3, ORDER=QUADRATIC, CELL=5
X, 0, 2, 1
Y, 0, 2, 1
Z, 0, 2, 1
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=METAL
*ELASTIC
1.0E4, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
400.0
*MATERIAL POINTS, ELSET=ALL, MATERIAL=METAL, PER ELEMENT=4
*LOST POINTS, ACTION=FREEZE, TOLERANCE=0.01
*STEP, NAME=PUSH
*STATIC, DIRECT
1.0, 6.0
*BOUNDARY
X0, 1, 1
Y0, 2, 2
Z0, 3, 3
Z1, 3, 3, -0.8
*HISTORY, NSET=Z1
RF, U
*END STEP
"""


# Ground under a plate that goes down evenly: every increment but the first begins with the last.
STRIP = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 4, 4
Y, 0, 2, 2
*NSET, NSET=PLATE, BOX
-0.1, 1.1, 1.9, 2.1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=CLAY
*ELASTIC
1000, 0.4
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
20
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=4
*MOVING MESH, DRIVER=PLATE, DIRECTION=0,1, FIXED=Y0
*STEP
*STATIC
0.1, 1.0, 0.001, 0.2
*BOUNDARY
X0, 1, 1
X1, 1, 1
Y0, 2, 2
PLATE, 2, 2, -0.05
*HISTORY, NSET=PLATE
RF, U
*END STEP
"""


def recycled(deck):
    """The deck with factors of the linear solver that outlive an increment."""
    first, rest = deck.split("*STEP", 1)
    line, rest = rest.split("\n", 1)
    return f"{first}*STEP{line}\n*CONTROLS, LINEAR SOLVER=RECYCLED\n{rest}"


def without_time(path):
    """All lines of a history or status file but those that name program and revision."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if not line.startswith("# job ")]


# What belongs to the machine and differs from run to run.
MACHINE = ("kinematics", "stress", "assembly", "factorisation", "solve", "location", "output")
MACHINE += ("point_loop", "factor_memory")


def datasets(path):
    """Every dataset of a results file but those of the machine and the text of the deck."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and name.rsplit("/", 1)[-1] not in (*MACHINE, "deck"):
            found[name] = item[()]

    with h5py.File(path) as file:
        file.visititems(visit)
        for name in ("VTKHDF/Steps",):
            found[name + "/NSteps"] = file[name].attrs["NSteps"]
    return found


def assert_same_run(folder, other, job="job"):
    """History, fields, iterations and ledger are equal to the last bit."""
    assert without_time(folder / f"{job}_history.csv") == without_time(other / f"{job}_history.csv")
    status, other_status = (
        [line.split()[:10] for line in without_time(f / f"{job}.sta")] for f in (folder, other)
    )
    assert status == other_status
    for name in (f"{job}.vtkhdf", f"{job}_mesh.vtkhdf"):
        here, there = datasets(folder / name), datasets(other / name)
        assert here.keys() == there.keys()
        for key, value in here.items():
            may_be_nan = np.asarray(value).dtype.kind == "f"
            assert np.array_equal(value, there[key], equal_nan=may_be_nan), (name, key)
