"""Tractions that go with the body: decks through the program."""

import csv

import h5py
import numpy as np
import pytest

# A block of 2 x 2 cells at the lower left of a background that stays where it is. All nodes have
# the same displacement in x, so the block is in uniaxial strain in y while it travels.
DECK = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 8, 8
Y, 0, 3, 3
*NSET, NSET=EVERY, ELSET=ALL
*ELSET, ELSET=BODY
1, 2, 3, 4, 17, 18, 19, 20
*SURFACE, NAME=ROOF
18, S2
20, S2
*FORMULATION, TYPE={formulation}
*PATCH, SOURCE=METIS, SIZE=4
*MATERIAL, NAME=STUFF
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=STUFF, PER ELEMENT=16
*STEP, NAME=LOAD
*STATIC
1, 1
*CONTROLS, TOLERANCE=1e-11
*BOUNDARY
EVERY, 1, 1
Y0, 2, 2
*DSLOAD, CARRIER={carrier}
ROOF, {load}
*HISTORY, NSET=Y0
RF
*OUTPUT, FIELD, FREQUENCY=1
S
*END STEP
*STEP, NAME=TRAVEL
*STATIC, DIRECT
{size}, 4.0
*BOUNDARY
EVERY, 1, 1, 4.0
*END STEP
"""
CONSTRAINED_MODULUS = 1000 * 0.7 / (1.3 * 0.4)


def deck(carrier="POINTS", load="TRVEC, 1.0, 0, 1", size=2.0, formulation="STANDARD"):
    return DECK.format(carrier=carrier, load=load, size=size, formulation=formulation)


def outputs(run):
    """Positions and stresses of all outputs: (n, points, 3) and (n, points, 6)."""
    with h5py.File(run.folder / "job.vtkhdf") as file:
        n = len(file["VTKHDF/Steps/Values"])
        x, stress = (file[f"VTKHDF/{name}"][:] for name in ("Points", "PointData/S"))
    return x.reshape(n, -1, 3), stress.reshape(n, -1, 6)


def reactions(run):
    """Sum of the reactions in y on the ground, per accepted increment."""
    with open(run.folder / "job_history.csv", encoding="utf-8") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    column = next(i for i, name in enumerate(rows[0]) if "RF2" in name)
    return np.array([float(row[column]) for row in rows[2:]])


@pytest.mark.parametrize("formulation", ["STANDARD", "FBAR PATCH"])
def test_load_travels_with_the_body(formulation, run_tessera):
    run = run_tessera(deck(formulation=formulation), "-q")
    assert (run.code, run.stderr) == (0, "")
    x, stress = outputs(run)
    # Uniform under the first load; afterwards the body sticks out of its elements by the strain.
    assert np.allclose(stress[1][:, 1], 1.0, rtol=0, atol=1e-9)
    assert np.allclose(x[-1][:, 0] - x[0][:, 0], 4.0, rtol=0, atol=1e-12)
    strain = 1.0 / CONSTRAINED_MODULUS
    for later in stress[2:]:
        assert np.allclose(later[:, 1], 1.0, rtol=0, atol=3 * strain)
    assert np.allclose(reactions(run), -2.0, rtol=0, atol=1e-9)


def test_pressure_travels_with_the_body(run_tessera):
    run = run_tessera(deck(load="P, 1.0"), "-q")
    assert (run.code, run.stderr) == (0, "")
    strain = 1.0 / CONSTRAINED_MODULUS
    assert np.allclose(outputs(run)[1][-1][:, 1], -1.0, rtol=0, atol=3 * strain)
    assert np.allclose(reactions(run), 2.0, rtol=0, atol=1e-9)


def test_force_is_exact_in_cut_elements(run_tessera):
    """Between whole cells the stress scatters by a tenth, the resultant does not."""
    run = run_tessera(deck(size=0.4), "-q")
    assert (run.code, run.stderr) == (0, "")
    assert len(reactions(run)) == 11
    assert np.allclose(reactions(run), -2.0, rtol=0, atol=1e-9)
    stress = outputs(run)[1][-1][:, 1]
    assert abs(stress.mean() - 1.0) < 1e-4
    assert stress.std() < 0.1


def test_load_of_the_mesh_stays_behind(run_tessera):
    run = run_tessera(deck(carrier="MESH"), "-q")
    assert run.code == 3
    assert run.stderr.splitlines()[0] == (
        "error: node 19 carries a load but belongs to no element that holds material points: "
        "expected loads on the body only (step 'TRAVEL', increment 2, attempt 1, step time 2)"
    )


def test_carriers_agree_in_the_first_increment(run_tessera):
    first = []
    for carrier in ("MESH", "POINTS"):
        run = run_tessera(deck(carrier=carrier, load="TRVEC, 50.0, 0.3, 1"), "-f", "-q")
        first.append(outputs(run)[1][1])
    assert np.abs(first[0]).max() > 40
    assert np.allclose(*first, rtol=0, atol=1e-9)


def test_threads_do_not_change_the_result(run_tessera):
    stress = []
    for threads in (1, 2):
        run = run_tessera(deck(size=0.5), "-f", "-q", threads=threads)
        stress.append(outputs(run)[1])
    assert np.array_equal(*stress)


def test_surface_points_are_in_the_log(run_tessera):
    run = run_tessera(deck(), "--check", "-q")
    assert "surface points: 8, area 2\n" in run.read("job.log")


# One layer of cells that is stretched sixfold in one increment: no point is left near its top.
STRETCH = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 2, 2
Y, 0, 9, 9
*NSET, NSET=EVERY, ELSET=ALL
*NSET, NSET=ROW, GENERATE
4, 6
*ELSET, ELSET=BODY
1, 2, 3, 4
*SURFACE, NAME=ROOF
2, S2
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=STUFF
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=STUFF, PER ELEMENT=1
*STEP
*STATIC, DIRECT
0.5, 1
*BOUNDARY
EVERY, 1, 1
Y0, 2, 2
ROW, 2, 2, 10.0
*DSLOAD, CARRIER=POINTS
ROOF, P, 1.0
*END STEP
"""


def test_load_that_loses_the_body_is_an_error(run_tessera):
    run = run_tessera(STRETCH, "-q")
    assert run.code == 6
    assert run.stderr.splitlines()[0] == (
        "error: the loaded surface 'ROOF' lost the body at (0.788675, 6): expected an element with "
        "material points nearer than its own size (step 'STEP-1', increment 2, attempt 1, "
        "step time 0.5)"
    )
    assert "worst place" not in run.stderr
