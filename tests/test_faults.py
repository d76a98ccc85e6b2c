"""Numerical faults, each forced: exit code, message, causes and the file of the last attempt."""

import os
import shutil
import subprocess

import h5py
import numpy as np
import pytest
from conftest import ROOT

# A square pressed down by its upper edge.
SQUARE = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 1, 2
Y, 0, 1, 2
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=3
*STEP, NAME=PUSH{step}
*STATIC
{sizes}
{controls}*BOUNDARY
X0, 1, 1
Y0, 2, 2
Y1, 2, 2, {push}
*END STEP
"""
PLASTIC = "*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL\n1.0, 0.0\n"

# A block of 2 x 2 cells that its left edge pushes along a ground; the next increment finds it
# away from that edge.
AWAY = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 8, 8
Y, 0, 3, 3
*ELSET, ELSET=BODY
1, 2, 3, 4, 17, 18, 19, 20
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=STUFF
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=STUFF, PER ELEMENT=4
*STEP, NAME=LOAD
*STATIC
0.5, 1, 0.1
*BOUNDARY
X0, 1, 1, 4.0
Y0, 2, 2
*END STEP
"""

# Two squares that share a node, one of them held.
HINGE = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 4, 4
Y, 0, 4, 4
*ELSET, ELSET=BODY
1, 2, 11, 12
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=STUFF
*DENSITY
1.0
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=STUFF, PER ELEMENT=3
*STEP, NAME=LOAD
*STATIC
1, 1, 0.5
*BOUNDARY
X0, 1, 2
Y0, 1, 2
*DLOAD
ALL, GRAV, 10, 1, 0
*END STEP
"""

# A square that has moved a little along the diagonal: its corner reaches into one more cell.
CORNER = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 2, 2
Y, 0, 2, 2
*ELSET, ELSET=BODY
1, 2
*NSET, NSET=EVERY, ELSET=ALL
*NSET, NSET=PUSHED, BOX
1, 1, 1, 1
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=STUFF
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=BODY, MATERIAL=STUFF, PER ELEMENT=36
*STEP, NAME=MOVE
*STATIC
1, 1
*BOUNDARY
EVERY, 1, 2, 0.12
*END STEP
*STEP, NAME=PUSH
*STATIC
1, 1, 1
*CONTROLS, MAX ITERATIONS=1
*BOUNDARY, OP=NEW
X0, 1, 1, 0.12
Y0, 2, 2, 0.12
*CLOAD
PUSHED, 1, 100
PUSHED, 2, 100
*END STEP
"""

# A bar that is pushed out of its mesh.
LEAVING = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 2, 2
Y, 0, 1, 1
*FORMULATION, TYPE=STANDARD
*LOST POINTS, ACTION={action}
*MATERIAL, NAME=STUFF
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=STUFF, PER ELEMENT=4
*STEP, NAME=MOVE
*STATIC
0.5, 1
*BOUNDARY
X0, 1, 1, 1.4
Y0, 2, 2
*END STEP
"""


def square(sizes="1, 1, 0.1", push="-0.05", step="", controls="", plastic=False):
    text = SQUARE.format(step=step, sizes=sizes, push=push, controls=controls)
    return text.replace("100, 0.3\n", "100, 0.3\n" + PLASTIC) if plastic else text


def attempts(run):
    """(size, outcome) of every attempt."""
    rows = [line.split(maxsplit=12) for line in run.read("job.sta").splitlines()[1:]]
    return [(float(row[5]), row[12]) for row in rows]


def check_failure(run, code, start, *causes):
    """The failure is complete: message, log, and a file that shows the place; returns its facts."""
    assert run.code == code, run.stdout + run.stderr
    message = run.stderr.rstrip("\n")
    lines = message.splitlines()
    assert lines[0].startswith(start)
    assert lines[1].startswith("  worst place: node ")
    assert ", element " in lines[1]
    assert ", material point " in lines[1]
    assert lines[-1] == "  last attempt: job_fail.vtkhdf"
    told = [line for line in lines if line.startswith("  likely cause: ")]
    assert len(told) == len(causes)
    for line, cause in zip(told, causes):
        assert cause in line
    assert message in run.read("job.log")
    assert not list(run.folder.glob("*.tmp"))
    check_accepted(run)
    return check_fail_file(run.folder / "job_fail.vtkhdf", code, message)


def check_fail_file(path, code, message):
    """Place in the file: as in the message, and marked on the mesh."""
    with h5py.File(path) as file:
        facts, grid = file["tessera"], file["VTKHDF"]
        assert facts["message"][()].decode() == message
        assert facts.attrs["exit_code"] == code
        assert grid["Steps"].attrs["NSteps"] == 1
        found = {name: facts.attrs[name] for name in ("outcome", "step", "increment", "attempt")}
        found["time"] = grid["Steps/Values"][0]
        for kind in ("node", "element", "point"):
            place = facts[f"worst_{kind}"]
            found[kind] = (int(place.attrs["label"]), place[()])
            name = {"point": "material point"}.get(kind, kind)
            coordinates = ", ".join(f"{x:.6g}".replace("e+", "e") for x in place[()])
            assert f"{name} {place.attrs['label']} at ({coordinates})" in message
        x = grid["Points"][()]
        corners = grid["Connectivity"][()].reshape(grid["NumberOfCells"][0], -1)
        nodes, cells = grid["PointData"], grid["CellData"]
        found["fields"] = {name: cells[name][()] for name in cells}
        found["fields"].update(U_INC=nodes["U_INC"][()], RESIDUAL=nodes["RESIDUAL"][()])
        assert np.isfinite(nodes["RESIDUAL"][()]).all()
        n_dim = len(found["node"][1])
        (node,) = np.flatnonzero(nodes["WORST"][()])
        (element,) = np.flatnonzero(cells["WORST"][()])
        assert np.allclose(x[node, :n_dim], found["node"][1])
        assert np.allclose(x[corners[element], :n_dim].mean(axis=0), found["element"][1])
        assert np.array_equal(cells["ACTIVE"][()] == 1, cells["NPOINTS"][()] > 0)
        assert np.array_equal(cells["ACTIVE"][()] == 1, cells["FILL"][()] > 0)
    return found


def check_accepted(run):
    """Nothing that is not a finite number stands in the results of the accepted increments."""

    def check(name, item):
        unknown = name.endswith("ledger/checkerboard")  # not asked for
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f" and not unknown:
            assert np.isfinite(item[()]).all(), name

    for name in ("job.vtkhdf", "job_mesh.vtkhdf"):
        with h5py.File(run.folder / name) as file:
            file.visititems(check)


# --- something is not held ---------------------------------------------------------------------


def test_body_that_leaves_its_support_is_named(run_tessera):
    run = run_tessera(AWAY, "-q")
    cause = (
        "the body of element 5 is free to move (translation in x): expected *BOUNDARY conditions"
        " that hold it where it is now, such as Y0, 1, 1"
    )
    facts = check_failure(run, 3, "error: the tangent is singular", cause)
    assert (facts["step"], facts["increment"], facts["attempt"]) == (1, 2, 1)
    assert facts["outcome"] == b"the tangent is singular"
    assert facts["time"] == pytest.approx(1.0)
    assert [outcome for _, outcome in attempts(run)] == ["converged", "the tangent is singular"]


def test_advice_of_the_message_holds_the_body(run_tessera):
    """The body stays where it is then, and its own edge cannot push it any more."""
    run = run_tessera(AWAY.replace("Y0, 2, 2\n", "Y0, 2, 2\nY0, 1, 1, 4.0\n"), "-q")
    assert (run.code, run.stderr) == (0, "")


def test_part_that_hangs_by_a_node_is_named(run_tessera):
    """Newton's method finds an equilibrium 1e13 away, which is none."""
    run = run_tessera(HINGE, "-q")
    cause = "the part of element 11 hangs by node 7 only (rotation about z): expected *GHOST"
    facts = check_failure(run, 3, "error: the tangent is singular", cause)
    assert (facts["increment"], facts["attempt"]) == (1, 1)
    assert len(attempts(run)) == 1
    with h5py.File(run.folder / "job.vtkhdf") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] == 1  # increment 0 alone


def test_nearly_empty_element_is_a_cause(run_tessera):
    run = run_tessera(CORNER, "-q")
    facts = check_failure(
        run,
        4,
        "error: no convergence at the smallest increment 1: too many iterations",
        "the part of element 7 hangs by node 5 only",
        "element 7 is nearly empty, its points fill 2.77778 % of it: expected *GHOST PENALTY",
        "MAX ITERATIONS=1 of *CONTROLS are too few",
    )
    assert facts["node"][0] == 5
    assert facts["fields"]["FILL"][6] == pytest.approx(1 / 36)


# --- Newton's method does not converge ---------------------------------------------------------


def test_inverted_element_at_the_smallest_size(run_tessera):
    run = run_tessera(square(push="-12"), "-q")
    facts = check_failure(
        run,
        4,
        "error: no convergence at the smallest increment 0.1: an element turned inside out",
        "the increment is too large: an element turned inside out at size 0.1, and the smallest"
        " size allowed is 0.1: expected a smaller one in *STATIC",
    )
    assert [size for size, _ in attempts(run)] == [1.0, 0.25, 0.1]
    assert facts["attempt"] == 3
    assert facts["fields"]["J"].min() < 0
    assert facts["fields"]["J"][facts["fields"]["WORST"] == 1] < 0
    assert facts["fields"]["U_INC"][:, 1].min() == pytest.approx(-1.2)


def test_failed_stress_update(run_tessera):
    """Squeezed to a billionth of its volume: the elastic strain is beyond its representation."""
    deck = square("1, 1, 1", "-0.999999999").replace("X0, 1, 1\n", "X0, 1, 1\nX1, 1, 1\n")
    check_failure(
        run_tessera(deck, "-q"),
        4,
        "error: no convergence at the smallest increment 1: the stress update of a material point",
        "the increment is too large: a point was strained beyond what its material can follow",
    )


@pytest.mark.parametrize("most", [1, 2])
def test_exhausted_iterations(run_tessera, most):
    deck = square(push="-0.3", controls=f"*CONTROLS, MAX ITERATIONS={most}\n")
    run = run_tessera(deck, "-q")
    facts = check_failure(
        run,
        4,
        "error: no convergence at the smallest increment 0.1: too many iterations",
        f"MAX ITERATIONS={most} of *CONTROLS are too few: the residual was ",
    )
    assert [size for size, _ in attempts(run)] == [1.0, 0.25, 0.1]
    size = np.linalg.norm(facts["fields"]["RESIDUAL"], axis=1)
    assert size.argmax() + 1 == facts["node"][0]
    if most == 2:
        assert "it was still falling" in run.stderr


def test_exhausted_increments(run_tessera):
    deck = square("0.1, 1, 0.1", "-0.3", ", INC=2")
    start = "error: 2 increments done and the step is not finished: expected fewer, or a larger INC"
    cause = "the last one had size 0.2, and 0.7 of step time is left"
    facts = check_failure(run_tessera(deck, "-q"), 4, start, cause)
    assert (facts["increment"], facts["attempt"]) == (2, 0)
    assert facts["time"] == pytest.approx(0.3)


# --- points leave the mesh ---------------------------------------------------------------------


def test_lost_point_ends_the_run(run_tessera):
    run = run_tessera(LEAVING.format(action="ERROR"), "-q")
    facts = check_failure(run, 6, "error: 4 material points left the mesh, the first is point ")
    assert facts["point"][1][0] > 2.0
    assert f"the first is point {facts['point'][0]} at (" in run.stderr


@pytest.mark.parametrize(("action", "n_kept"), [("FREEZE", [16, 16, 16]), ("REMOVE", [16, 12, 6])])
def test_lost_points_are_counted(run_tessera, action, n_kept):
    run = run_tessera(LEAVING.format(action=action), "-q")
    assert (run.code, run.stderr) == (0, "")
    assert "lost points: 10, extrapolated 2" in run.read("job.log")
    assert not (run.folder / "job_fail.vtkhdf").exists()
    with h5py.File(run.folder / "job.vtkhdf") as file:
        assert list(file["tessera/ledger/lost"]) == [0, 4, 10]
        assert list(file["tessera/ledger/count"]) == n_kept
        assert file["VTKHDF/NumberOfPoints"][-1] == n_kept[-1]


# --- the linear solver -------------------------------------------------------------------------


@pytest.fixture(scope="session")
def faulty_libraries(tmp_path_factory):
    """A library that makes calls of UMFPACK and of malloc fail."""
    library = tmp_path_factory.mktemp("faults") / "library_faults.so"
    source = ROOT / "tests" / "faults" / "library_faults.c"
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler, "no C compiler: the build needs one too"
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    return library


@pytest.fixture
def run_with_faults(faulty_libraries, run_tessera, monkeypatch):
    """run_with_faults(deck, call, first, count): these calls of UMFPACK fail."""

    def run(deck, call, first, count):
        monkeypatch.setenv("LD_PRELOAD", os.fspath(faulty_libraries))
        monkeypatch.setenv("FAULT_CALL", call)
        monkeypatch.setenv("FAULT_FIRST", str(first))
        monkeypatch.setenv("FAULT_COUNT", str(count))
        return run_tessera(deck, "-q", "-f")

    return run


def test_no_memory_for_the_factors(run_with_faults):
    run = run_with_faults(square(plastic=True), "numeric", 2, 1)
    start = (
        "error: not enough memory for the factorisation of 9 equations with 53 entries, about 1 MB"
        " are needed: expected more memory, a coarser mesh or smaller patches (step 'PUSH'"
    )
    facts = check_failure(run, 5, start)
    assert facts["outcome"] == b"the linear solver ran out of memory"
    assert len(attempts(run)) == 1


@pytest.fixture
def by_mumps(run_tessera):
    """The square, solved by MUMPS, whose order METIS finds."""
    if "MUMPS" not in run_tessera("", "--version").stdout:
        pytest.skip("this program was built without MUMPS")
    return square(plastic=True).replace("*STATIC", "*CONTROLS, LINEAR SOLVER=MUMPS\n*STATIC")


def test_no_memory_for_the_order(run_with_faults, by_mumps):
    run = run_with_faults(by_mumps, "order", 1, 1)
    check_failure(
        run, 5, "error: not enough memory for the analysis of 9 equations with 53 entries"
    )
    assert attempts(run) == []


def test_signal_that_metis_catches_is_obeyed(run_with_faults, by_mumps):
    run = run_with_faults(by_mumps, "caught", 1, 1)
    assert run.code == 143
    assert (run.folder / "job.restart.h5").exists()
    assert not (run.folder / "job_fail.vtkhdf").exists()


def test_no_memory_for_the_analysis(run_with_faults):
    run = run_with_faults(square(plastic=True), "symbolic", 1, 1)
    start = "error: not enough memory for the analysis of 9 equations with 53 entries: expected"
    check_failure(run, 5, start)
    assert attempts(run) == []


def test_values_that_are_no_numbers_cost_an_attempt(run_with_faults):
    run = run_with_faults(square(plastic=True), "solve", 2, 1)
    assert (run.code, run.stderr) == (0, "")
    assert not (run.folder / "job_fail.vtkhdf").exists()
    assert [outcome for _, outcome in attempts(run)] == [
        "displacements or forces are not finite",
        *["converged"] * 4,
    ]
    check_accepted(run)


def test_only_values_that_are_no_numbers_end_the_run(run_with_faults):
    run = run_with_faults(square(plastic=True), "solve", 1, 10**6)
    start = "error: no convergence at the smallest increment 0.1: displacements or forces are not "
    check_failure(run, 4, start, "numbers beyond the range of the machine")
    assert [size for size, _ in attempts(run)] == [1.0, 0.25, 0.1]


def test_library_alone_changes_nothing(run_with_faults):
    run = run_with_faults(square(plastic=True), "none", 1, 1)
    assert (run.code, run.stderr) == (0, "")
    assert len(attempts(run)) == 1


# A square of 800 elements in one patch: its block of the tangent is large.
ONE_PATCH = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 2, 20
Y, 0, 2, 20
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=METIS, SIZE=800
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT={points}
*STEP, NAME=PUSH
*STATIC
1, 1
*BOUNDARY
X0, 1, 1
Y0, 2, 2
Y1, 2, 2, -0.01
*END STEP
"""


@pytest.fixture
def run_with_limit(faulty_libraries, run_tessera, monkeypatch):
    """run_with_limit(deck, limit): no block of memory of `limit` bytes or more is to be had."""

    def run(deck, limit):
        monkeypatch.setenv("LD_PRELOAD", os.fspath(faulty_libraries))
        monkeypatch.setenv("FAULT_MALLOC", str(limit))
        return run_tessera(deck, "-q", "-f")

    return run


def test_no_memory_for_the_pattern(run_with_limit):
    run = run_with_limit(ONE_PATCH.format(points=1), 5_000_000)  # of 5.4 MB
    start = (
        "error: not enough memory for the pattern of 819 equations with 670761 entries: expected"
    )
    check_failure(run, 5, start)
    assert attempts(run) == []


def test_no_memory_for_the_buffer_of_blas(run_with_limit):
    """OpenBLAS would wait for it for ever, in the middle of a factorisation."""
    run = run_with_limit(square(plastic=True), 130_000_000)
    check_failure(run, 5, "error: not enough memory for the analysis of 9 equations")


def test_no_memory_for_the_points(run_with_limit):
    run = run_with_limit(ONE_PATCH.format(points=16), 12_000_000)
    assert run.code == 5
    assert run.stderr.startswith(
        "job.inp:9:25: error: not enough memory for 12800 material points, about 13 MB are needed:"
        " expected fewer points per element"
    )


def test_no_memory_for_the_run(run_with_limit):
    run = run_with_limit(ONE_PATCH.format(points=16), 13_000_000)
    assert run.code == 5
    assert run.stderr == (
        "error: not enough memory for a run with 12800 material points and 800 elements, about 13"
        " MB more are needed: expected a coarser mesh or fewer points per element\n"
    )


# --- the file ----------------------------------------------------------------------------------


def test_stale_file_goes_with_the_next_run(run_tessera):
    assert run_tessera(square(push="-12"), "-q").code == 4
    stale = run_tessera(square(), "-q")
    assert stale.code == 8
    assert (stale.folder / "job_fail.vtkhdf").exists()
    for name in ("job.log", "job.sta", "job_history.csv", "job.vtkhdf", "job_mesh.vtkhdf"):
        (stale.folder / name).unlink()
    alone = run_tessera(square(), "-q")
    assert alone.code == 8
    assert alone.stderr.startswith("error: 'job_fail.vtkhdf' exists already")
    assert run_tessera(square(), "-q", "-f").code == 0
    assert not (stale.folder / "job_fail.vtkhdf").exists()


def test_file_that_cannot_be_written_is_told(run_tessera, tmp_path):
    (tmp_path / "job_fail.vtkhdf.next").mkdir()
    run = run_tessera(square(push="-12"), "-q")
    assert run.code == 4
    assert "last attempt: job_fail.vtkhdf was not written\nerror: cannot create" in run.stderr


def test_paraview_reads_the_file(run_tessera):
    pyvista = pytest.importorskip("pyvista")
    run = run_tessera(square(push="-12"), "-q")
    grid = pyvista.read(run.folder / "job_fail.vtkhdf")
    assert (grid.n_points, grid.n_cells) == (9, 8)
    assert {"U_INC", "RESIDUAL", "WORST"} <= set(grid.point_data)
    assert {"PATCH", "NPOINTS", "ACTIVE", "FILL", "J", "WORST"} <= set(grid.cell_data)


# --- what is left ------------------------------------------------------------------------------

FOLDED = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 1, 2
Y, 0, 3, 6
*AMPLITUDE, NAME=A
0, 0, 0.5, 0.01, 1, 10
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*DENSITY
2.0
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=3
*MOVING MESH, DRIVER=Y1, DIRECTION=0,1, FIXED=Y0
*STEP
*STATIC, DIRECT
0.25, 1
*BOUNDARY, AMPLITUDE=A
Y1, 2, 2, -1
*BOUNDARY
Y1, 1, 1
*DLOAD
ALL, GRAV, 1.0, 0, -1
*OUTPUT, FIELD, FREQUENCY={frequency}
*HISTORY, NSET=Y1
RF
*END STEP
"""


def test_last_output_is_of_the_last_increment(run_tessera, tmp_path):
    """An attempt in equilibrium whose mesh would fold is not accepted, and in no output."""
    last = []
    for frequency in (1, 10):
        run = run_tessera(FOLDED.format(frequency=frequency), "-q", "-f")
        assert run.code == 3
        assert "would turn element" in run.stderr
        with h5py.File(tmp_path / "job_mesh.vtkhdf") as file:
            n = int(file["VTKHDF/NumberOfPoints"][0])
            data = {name: values[-n:] for name, values in file["VTKHDF/PointData"].items()}
            last.append((file["VTKHDF/Steps/Values"][-1], data))
    assert last[0][0] == last[1][0] > 0.0
    for name, values in last[0][1].items():
        np.testing.assert_array_equal(values, last[1][1][name], name)
