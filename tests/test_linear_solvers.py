"""Linear solvers of *CONTROLS: one answer, and the refusal of the one that is not there."""

import re
import subprocess

import h5py
import numpy as np
import pytest
from restart_runs import CUBE, PLATE, STRIP, datasets

MECHANISM = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 2, 2
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=CLAY
*DENSITY
2.0
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=4
*STEP
*STATIC
1, 1
*CONTROLS, LINEAR SOLVER={solver}
*BOUNDARY
X0, 1, 1
*DLOAD
ALL, GRAV, 1.0, 0, -1
*END STEP
"""

HINGE = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 2, {cells}
Y, 0, 2, {cells}
*ELSET, ELSET=BODY
{elements}
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=CLAY
*DENSITY
2.0
*ELASTIC
1E5, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=CLAY, PER ELEMENT=4
*STEP
*STATIC, DIRECT
0.5, 1
*CONTROLS, LINEAR SOLVER={solver}
*BOUNDARY
X0, 1, 2
*DLOAD
BODY, GRAV, 1.0, 1, 1
*HISTORY, NSET=X0
RF
*END STEP
"""

LARGE = """\
*GENERATE, TYPE=BOX, DIMENSION=3
X, 0, 1, 15
Y, 0, 1, 15
Z, 0, 1, 15
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
1000, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
5.0
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1
*STEP
*STATIC, DIRECT
1, 1
*CONTROLS, LINEAR SOLVER={solver}
*BOUNDARY
Z0, 1, 3
Z1, 3, 3, -0.01
*END STEP
"""

BEAM = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC
X, 0, 300, 300
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=STEEL
*DENSITY
1.0
*ELASTIC
1E15, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=STEEL, PER ELEMENT=4
*STEP
*STATIC, DIRECT
0.5, 1
*BOUNDARY
X0, 1, 2
*DLOAD
ALL, GRAV, 1.0, 0, -1
*HISTORY, NSET=X1
U
*END STEP
"""


def solved_by(deck, solver):
    first, rest = deck.split("*STEP", 1)
    line, rest = rest.split("\n", 1)
    return f"{first}*STEP{line}\n*CONTROLS, LINEAR SOLVER={solver}\n{rest}"


@pytest.fixture
def mumps(run_tessera):
    """Whether the program was built with MUMPS."""
    return "MUMPS" in run_tessera("", "--version").stdout


def history_of(run_tessera, tmp_path, deck, solver):
    run = run_tessera(solved_by(deck, solver), "-q", "-o", solver)
    assert (run.code, run.stderr) == (0, "")
    log = (tmp_path / solver / "job.log").read_text()
    assert re.search(f"linear solver: {solver}(; factors .*)?\n", log)
    return datasets(tmp_path / solver / "job.vtkhdf"), log


def compare_histories(found, expected):
    names = [name for name in expected if name.startswith("tessera/history/")]
    assert len(names) > 2
    for name in names:
        limit = 1e-8 * max(np.abs(expected[name]).max(), 1e-30)
        assert np.abs(found[name] - expected[name]).max() <= limit, name


@pytest.mark.parametrize(
    ("deck", "solver"),
    [(CUBE, "RECYCLED"), (STRIP, "RECYCLED"), (PLATE, "MUMPS"), (STRIP, "MUMPS")],
    ids=["cube-recycled", "strip-recycled", "plate-mumps", "strip-mumps"],
)
def test_solvers_agree_in_every_value_of_the_history(run_tessera, tmp_path, mumps, deck, solver):
    if solver == "MUMPS" and not mumps:
        pytest.skip("this program was built without MUMPS")
    direct, log = history_of(run_tessera, tmp_path, deck, "DIRECT")
    assert "gmres" not in log
    other, log = history_of(run_tessera, tmp_path, deck, solver)
    assert ("gmres" in log) == (solver == "RECYCLED")
    compare_histories(other, direct)


def test_factors_that_are_kept_are_of_single_precision(run_tessera, tmp_path, mumps):
    table, log = history_of(run_tessera, tmp_path, STRIP, "RECYCLED")
    assert ("factors that are kept: single precision, by MUMPS" in log) == mumps
    new = table["tessera/iterations/new_factors"] == 1
    assert (table["tessera/iterations/gmres"][new] > 0).all() == mumps
    assert "double precision" not in log


def test_slender_bodies_need_double_precision(run_tessera, tmp_path, mumps):
    """Pivots of a beam 300 times as long as thick say nothing in single precision."""
    found, log = history_of(run_tessera, tmp_path, BEAM, "RECYCLED")
    assert log.count("are of double precision from now on") == (1 if mumps else 0)
    direct, _ = history_of(run_tessera, tmp_path, BEAM, "DIRECT")
    compare_histories(found, direct)


def test_log_of_a_restart_tells_the_precision(run_tessera, tmp_path, mumps):
    if not mumps:
        pytest.skip("this program was built without MUMPS")
    deck = solved_by(BEAM, "RECYCLED").replace("*END", "*RESTART, WRITE, FREQUENCY=1\n*END")
    assert run_tessera(deck, "-q").code == 0
    run = run_tessera(deck, "-q", "-o", "other", "--restart", "job.restart.1.h5")
    assert (run.code, run.stderr) == (0, "")
    log = (tmp_path / "other" / "job.log").read_text()
    assert "\nfactors that are kept are of double precision\n" in log
    assert "from now on" not in log


def test_limit_on_memory_holds_after_the_change(run_tessera, mumps):
    """UMFPACK's factors, which are taken from the first increment on, are above the limit."""
    if not mumps:
        pytest.skip("this program was built without MUMPS")
    deck = solved_by(BEAM, "RECYCLED")
    needs = [
        float(
            re.search(r"memory of the run +([0-9.]+) MB", run_tessera(text, "--estimate").stdout)[1]
        )
        for text in (deck, deck.replace("RECYCLED", "DIRECT"))
    ]
    assert needs[1] > needs[0] + 0.5
    run = run_tessera(deck, "-q", "--max-memory", str(sum(needs) / 2000.0))
    assert run.code == 5
    assert "and --max-memory allows" in run.stderr
    assert "increment 2" in run.stderr


def test_recycling_makes_few_factors(run_tessera, tmp_path):
    table, log = history_of(run_tessera, tmp_path, STRIP, "RECYCLED")
    new = table["tessera/iterations/new_factors"]
    corrections = table["tessera/iterations/iteration"] > 0
    assert new[~corrections].sum() == 0
    assert 1 <= new.sum() <= 0.5 * corrections.sum()
    assert log.count("new factors") == new.sum()
    assert (table["tessera/iterations/gmres"][new == 0][1:] > 0).sum() > 0


@pytest.mark.parametrize("solver", ["DIRECT", "RECYCLED", "MUMPS"])
def test_every_solver_refuses_a_mechanism(run_tessera, mumps, solver):
    if solver == "MUMPS" and not mumps:
        pytest.skip("this program was built without MUMPS")
    run = run_tessera(MECHANISM.format(solver=solver), "-q", "--lax")
    assert run.code == 3
    assert "free to move" in run.stderr


@pytest.mark.parametrize("solver", ["DIRECT", "RECYCLED", "MUMPS"])
@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_every_solver_refuses_a_hinge(run_tessera, mumps, solver, n):
    """Two blocks of n by n squares that hang together by a node: only pivots can tell."""
    if solver == "MUMPS" and not mumps:
        pytest.skip("this program was built without MUMPS")
    squares = [2 * n * j + i for j in range(2 * n) for i in range(2 * n) if (i < n) == (j < n)]
    elements = "\n".join(f"{2 * square + 1}, {2 * square + 2}" for square in squares)
    run = run_tessera(HINGE.format(cells=2 * n, elements=elements, solver=solver), "-q")
    assert run.code == 3
    assert "hangs by node" in run.stderr
    assert "the tangent is singular" in run.stderr


@pytest.mark.parametrize("solver", ["RECYCLED", "MUMPS"])
def test_orderings_of_large_models_are_the_same(tessera_release, tmp_path, mumps, solver):
    """More unknowns than the smallest ones, which are ordered in another way."""
    if solver == "MUMPS" and not mumps:
        pytest.skip("this program was built without MUMPS")
    deck = tmp_path / "job.inp"
    deck.write_text(LARGE.format(solver=solver))
    residuals = []
    for threads in ("1", "2", "1"):
        command = [tessera_release, "-q", "-f", "-t", threads, str(deck)]
        subprocess.run(command, cwd=tmp_path, check=True)
        with h5py.File(tmp_path / "job.vtkhdf") as file:
            assert file["tessera/ledger/unknowns"][-1] > 10000
            residuals.append(file["tessera/iterations/residual"][()].tobytes())
    assert residuals[0] == residuals[1] == residuals[2]


def test_mumps_is_refused_where_it_is_not(run_tessera, mumps):
    if mumps:
        pytest.skip("this program was built with MUMPS")
    run = run_tessera(solved_by(STRIP, "MUMPS"))
    assert run.code == 2
    assert "error: this program was built without MUMPS: expected DIRECT or RECYCLED" in run.stderr
    assert "*CONTROLS, LINEAR SOLVER=MUMPS" in run.stderr
