"""The locking meter through the program: it counts in the increment that was solved."""

import re

import pytest

# A block that is carried along through its mesh: the set of active elements changes.
CARRIED = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 4, 4
Y, 0, 4, 4
*ELSET, ELSET=BODY, BOX
0, 1.9, 0, 2.9
*FORMULATION, TYPE={formulation}
*PATCH, SOURCE=QUADRATIC
*LOCKING METER
*MATERIAL, NAME=CLAY
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=4
*STEP
*STATIC, DIRECT
1, 1
*BOUNDARY
Y0, 2, 2
Y0, 1, 1, 0.3
*END STEP
"""


@pytest.mark.parametrize(
    ("formulation", "words", "least"),
    [("STANDARD", "active element", 1.0), ("FBAR PATCH", "active patch", 4.0)],
)
def test_meter_counts_in_the_solved_increment(formulation, words, least, run_tessera):
    """The first increment has the active set of time zero, whose ratio the log tells before it."""
    run = run_tessera(CARRIED.format(formulation=formulation))
    assert run.code == 0, run.stdout + run.stderr
    log = run.read("job.log")
    at_zero = re.search(rf"([0-9.]+) with one(?: constraint)? per {words}", log)
    meter = re.search(r"locking meter: ([0-9.]+) unknowns per constraint", log)
    assert float(meter[1]) == float(at_zero[1])
    assert float(meter[1]) > least
