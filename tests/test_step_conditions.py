"""What carries over from step to step, and what a step takes back."""

import csv

import pytest

BLOCK = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 2, 2
Y, 0, 2, 2
*NSET, NSET=LEFT, BOX
0, 0, 2, 2
*NSET, NSET=RIGHT, BOX
2, 2, 2, 2
*FORMULATION, TYPE=STANDARD
{motion}
*MATERIAL, NAME=SOIL
*DENSITY
1
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=SOIL, PER ELEMENT=3
{model}*STEP
*STATIC
0.5, 1
*BOUNDARY
Y0, 1, 2
X0, 1
{first}*HISTORY, NSET=LEFT
U
*HISTORY, NSET=RIGHT
U
*END STEP
"""
STEP = "*STEP\n*STATIC\n0.5, 1\n{}*END STEP\n"
DRIVER = "*MOVING MESH, DRIVER=Y1, DIRECTION=0,1, FIXED=Y0"
WEIGHT = "*DLOAD\nALL, GRAV, 40, 0, -1\n"
PRESS = "*BOUNDARY\nY1, 2, 2, {}\n"


def block(first, *steps, motion=DRIVER, model=""):
    """A block on a rough base; the cards of its steps."""
    text = BLOCK.format(motion=motion, model=model, first=first)
    return text + "".join(STEP.format(cards) for cards in steps)


def settlements(run, time):
    """U2 of the upper corners at a total time."""
    assert run.code == 0, run.stderr
    lines = [line for line in run.read("job_history.csv").splitlines() if line[0] != "#"]
    row = next(row for row in csv.DictReader(lines) if float(row["time"]) == time)
    return [float(row[f"U2[{corner}]"]) for corner in ("LEFT", "RIGHT")]


@pytest.mark.parametrize("motion", [DRIVER, "*MOVING MESH, TYPE=LAGRANGIAN", "** reset"], ids=str)
def test_total_counts_from_where_free_nodes_stand(motion, run_tessera):
    run = run_tessera(block(WEIGHT, PRESS.format(-0.05), PRESS.format(-0.07), motion=motion))
    left, right = settlements(run, 1)
    assert left < -0.06
    assert abs(left - right) > 1e-3
    half = settlements(run, 1.5)
    assert half == pytest.approx([(left - 0.05) / 2, (right - 0.05) / 2], rel=1e-12)
    assert settlements(run, 2) == pytest.approx([-0.05, -0.05], rel=1e-12)
    assert settlements(run, 3) == pytest.approx([-0.07, -0.07], rel=1e-12)


def test_total_counts_from_where_released_nodes_stand(run_tessera):
    release = "*BOUNDARY, OP=NEW\nY0, 1, 2\nX0, 1\n"
    run = run_tessera(block(PRESS.format(-0.2), release, PRESS.format(-0.1)))
    assert settlements(run, 1) == pytest.approx([-0.2, -0.2], rel=1e-12)
    assert max(map(abs, settlements(run, 2))) < 2e-3  # not quite zero: points have moved
    assert settlements(run, 3) == pytest.approx([-0.1, -0.1], rel=1e-12)
