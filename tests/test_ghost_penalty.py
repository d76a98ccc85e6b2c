"""The ghost penalty through the program: tangent, threads, loose parts, bodies without an edge."""

import h5py
import numpy as np
import pytest

# A block that fills a part of its box, pushed by a plate; its points leave it at the free side.
PLANE = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 2, 4
Y, 0, 1, 2
*ELSET, ELSET=BODY, GENERATE
1, 6
9, 14
"""
SOLID = """\
*GENERATE, TYPE=BOX, DIMENSION=3, ORDER=QUADRATIC
X, 0, 2, 2
Y, 0, 1, 1
Z, 0, 1, 1
*ELSET, ELSET=BODY, GENERATE
1, 6
"""
METHOD = """\
*FORMULATION, TYPE={formulation}
*PATCH, SOURCE=QUADRATIC
*GHOST PENALTY, GAMMA=0.01
*MATERIAL, NAME=CLAY
*ELASTIC
1000, 0.4
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
10, 0
20, 0.1
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=4
*STEP
*STATIC, DIRECT
0.25, 1
*BOUNDARY
X0, 1, 1
"""
PUSH = {2: "Y0, 2, 2\nY1, 2, 2, -0.2\n", 3: "Y0, 2, 2\nZ0, 3, 3\nZ1, 3, 3, -0.2\n"}
END = """\
*HISTORY, NSET=X0
RF
*EXPECT, QUANTITY=GHOST SHARE
analytic, 0, 0, 0.5
*END STEP
"""

# Two squares that meet in a node: the upper one would turn about it.
HINGE = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 3, 3
Y, 0, 3, 3
*ELSET, ELSET=BODY
1, 2, 9, 10
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*DENSITY
1.0
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=3
*STEP
*STATIC, DIRECT
1, 1, 1
*BOUNDARY
Y0, 1, 2
*DLOAD
BODY, GRAV, 0.01, 0, -1
*END STEP
"""


def deck(n_dim, formulation):
    mesh = PLANE if n_dim == 2 else SOLID
    return mesh + METHOD.format(formulation=formulation) + PUSH[n_dim] + END


def ledger(folder, column):
    with h5py.File(folder / "job.vtkhdf") as file:
        return file["tessera/ledger"][column][()]


@pytest.mark.parametrize("formulation", ["STANDARD", "FBAR PATCH"])
@pytest.mark.parametrize("n_dim", [2, 3])
def test_tangent_is_exact_at_an_edge(n_dim, formulation, run_tessera):
    run = run_tessera(deck(n_dim, formulation), "--check-tangent")
    assert run.code == 0, run.stdout + run.stderr


@pytest.mark.parametrize("n_dim", [2, 3])
def test_two_threads_give_the_same_bits(n_dim, run_tessera, tmp_path):
    found = []
    for threads in (1, 2):
        run = run_tessera(deck(n_dim, "FBAR PATCH"), "-f", threads=threads)
        assert run.code == 0, run.stdout + run.stderr
        rows = [line for line in run.read("job_history.csv").splitlines() if line[0] != "#"]
        found.append((rows, ledger(tmp_path, "ghost_share").tolist()))
    assert found[0] == found[1]


def test_share_is_told_and_judged(run_tessera, tmp_path):
    run = run_tessera(deck(2, "STANDARD"))
    assert run.code == 0, run.stdout + run.stderr
    share = ledger(tmp_path, "ghost_share")
    assert np.all(share[:2] == 0.0)  # the first increment is affine
    assert np.all(share[2:] > 0.0)
    log = run.read("job.log")
    assert f"ghost penalty: largest share of the load {share.max():.6g}"[:-2] in log
    assert "\n  ghost penalty: gamma 0.01\n" in log
    text = deck(2, "STANDARD").replace("0, 0, 0.5", f"{share.max():.17g}, 1e-12")
    assert run_tessera(text, "-f").code == 0
    text = deck(2, "STANDARD").replace("0, 0, 0.5", f"0, 0, {0.9 * share.max():.17g}")
    assert run_tessera(text, "-f").code == 7


def test_share_grows_with_gamma(run_tessera, tmp_path):
    """The first increment is affine and costs nothing; in the second one points have crossed."""
    shares = []
    for gamma in ("0.0001", "0.0002"):
        text = deck(2, "STANDARD").replace("GAMMA=0.01", f"GAMMA={gamma}")
        assert run_tessera(text, "-f").code == 0
        shares.append(ledger(tmp_path, "ghost_share")[1:3])
    assert shares[0][0] == 0.0
    assert shares[1][1] / shares[0][1] == pytest.approx(2.0, rel=0.05)


UNLOAD = {
    "pushed back": "*BOUNDARY\nY1, 2, 2, 0.0\n",
    "released": "*BOUNDARY, OP=NEW\nX0, 1, 1\nY0, 2, 2\n",
    "at rest": "",
}


@pytest.mark.parametrize("formulation", ["STANDARD", "FBAR PATCH"])
@pytest.mark.parametrize("how", UNLOAD)
def test_share_stays_small_without_load(how, formulation, run_tessera, tmp_path):
    """The plate goes back, lets go or rests, and a last step changes nothing: no load does work."""
    text = deck(2, formulation).replace("GAMMA=0.01", "GAMMA=5e-4").replace("0, 0, 0.5", "0, 0, 1")
    step = "*STEP\n*STATIC, DIRECT\n0.25, 1\n"
    run = run_tessera(text + step + UNLOAD[how] + "*END STEP\n" + step + "*END STEP\n")
    assert run.code == 0, run.stdout + run.stderr
    share = ledger(tmp_path, "ghost_share")
    assert share.size >= 13
    assert 1e-4 < share.max() < 0.04


def test_share_of_a_load_that_returns(run_tessera, tmp_path):
    """A small elastic shear goes up, down, to the other side and back: the mean force counts."""
    text = deck(2, "FBAR PATCH").split("*PLASTIC")[0].replace("GAMMA=0.01", "GAMMA=5e-4")
    text = "*AMPLITUDE, NAME=CYCLE\n0, 0, 0.25, 1, 0.5, 0, 0.75, -1, 1, 0\n" + text
    text += """\
*DENSITY
1.0
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=4
*STEP
*STATIC, DIRECT
0.25, 1
*BOUNDARY
Y0, 1, 2
*DLOAD, AMPLITUDE=CYCLE
BODY, GRAV, 0.01, 1, 0
*END STEP
"""
    run = run_tessera(text)
    assert run.code == 0, run.stdout + run.stderr
    share = ledger(tmp_path, "ghost_share")[1:]
    assert share.size == 4
    assert share[0] > 1e-6
    assert share == pytest.approx(share[0] * np.array([1, 2, 1, 2]), rel=0.05)


def test_full_mesh_feels_nothing(run_tessera):
    with_penalty = deck(2, "FBAR PATCH").replace("1, 6\n9, 14", "1, 16").replace("-0.2", "-0.001")
    without = with_penalty.replace("*GHOST PENALTY, GAMMA=0.01\n", "")
    without = without.replace("*EXPECT, QUANTITY=GHOST SHARE\nanalytic, 0, 0, 0.5\n", "")
    rows = []
    for text in (with_penalty, without):
        run = run_tessera(text, "-f")
        assert run.code == 0, run.stdout + run.stderr
        rows.append([line for line in run.read("job_history.csv").splitlines() if line[0] != "#"])
    assert rows[0] == rows[1]


def test_part_on_a_node_is_held(run_tessera):
    """Without the penalty the upper square turns about the node."""
    run = run_tessera(HINGE)
    assert run.code == 3
    assert "hangs by node" in run.stderr
    text = HINGE.replace("*MATERIAL, NAME", "*GHOST PENALTY, GAMMA=0.1\n*MATERIAL, NAME")
    run = run_tessera(text, "-f")
    assert run.code == 0, run.stdout + run.stderr


def test_eigenvalues_are_told(run_tessera, tmp_path):
    text = deck(2, "STANDARD").replace("*BOUNDARY", "*CONTROLS, EIGENVALUES\n*BOUNDARY", 1)
    run = run_tessera(text)
    assert run.code == 0, run.stdout + run.stderr
    assert run.read("job.log").count("eigenvalues of the tangent: smallest ") == 4
    smallest, largest = ledger(tmp_path, "eigen_min"), ledger(tmp_path, "eigen_max")
    assert smallest[0] == 0.0
    assert np.all(smallest[1:] > 0.0)
    assert np.all(largest[1:] > 10 * smallest[1:])
    assert np.all(largest[1:] < 1e5)
