"""Files of a run as others read them: PyVista, h5py, line by line, and after accidents."""

import csv
import os
import pty
import re
import resource
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
import pyvista as pv
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline

VTK_VERTEX, VTK_TRIANGLE, VTK_TETRA = 1, 5, 10

# A bar of 4 x 1 that is pulled by 0.4 in 4 increments; elastic, no lateral strain: nu = 0.
BAR = """\
*HEADING
Elastic bar
*UNITS, LENGTH=m, FORCE=kN
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC, ELSET=BAR
X, 0, 4, 4
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=RUBBER
*DENSITY
2.0
*ELASTIC
1000.0, 0.0
*MATERIAL POINTS, ELSET=BAR, MATERIAL=RUBBER, PER ELEMENT=3
{method}
*STEP, NAME=PULL, INC={inc}
*STATIC, DIRECT
{size}, 1.0
*BOUNDARY
X0, 1, 1
Y0, 2, 2
X1, 1, 1, {pull}
*HISTORY, NSET=X1
RF, U
*OUTPUT, FIELD, FREQUENCY=1
S, TAU, LE, PEEQ, F, J, JBAR, U, VOL, MAT, PATCH, ELEMENT, ID
{expect}
*END STEP
"""
MOVING = "*MOVING MESH, DRIVER=X1, DIRECTION=1,0,0, FIXED=X0"


def bar(method=MOVING, inc=10, size=0.25, pull=0.4, expect=""):
    text = BAR.format(method=method, inc=inc, size=size, pull=pull, expect=expect)
    return "\n".join(line for line in text.splitlines() if line) + "\n"


class Series:
    """A VTKHDF file with time steps, read as ParaView reads it."""

    def __init__(self, path):
        self.reader = pv.get_reader(str(path)).reader
        self.reader.UpdateInformation()
        information = self.reader.GetOutputInformation(0)
        self.times = information.Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())

    def at(self, when):
        self.reader.UpdateTimeStep(when)
        return pv.wrap(self.reader.GetOutputDataObject(0)).copy()


@pytest.fixture
def bar_run(run_tessera):
    run = run_tessera(bar())
    assert (run.code, run.stderr.count("error")) == (0, 0), run.stderr
    return run


def test_points_open_in_pyvista_with_their_times(bar_run):
    series = Series(bar_run.folder / "job.vtkhdf")
    np.testing.assert_allclose(series.times, [0.0, 0.25, 0.5, 0.75, 1.0], rtol=1e-12)
    first, last = series.at(0.0), series.at(1.0)
    assert set(last.celltypes) == {VTK_VERTEX}
    assert first.n_points == last.n_points == last.n_cells
    stretch = 4.4 / 4.0
    np.testing.assert_allclose(last.points[:, 0], stretch * first.points[:, 0], rtol=1e-9)
    np.testing.assert_allclose(last.points[:, 1], first.points[:, 1], rtol=1e-9)
    np.testing.assert_array_equal(last.points[:, 2], 0.0)
    np.testing.assert_allclose(last["U"][:, 0], last.points[:, 0] - first.points[:, 0], atol=1e-12)


def test_fields_of_points_are_the_exact_solution(bar_run):
    last = Series(bar_run.folder / "job.vtkhdf").at(1.0)
    strain, stretch = np.log(1.1), 1.1
    zero = np.zeros(5)
    for name, first in (("LE", strain), ("TAU", 1000 * strain), ("S", 1000 * strain / stretch)):
        assert last[name].shape == (last.n_points, 6)
        expected = np.broadcast_to([first, *zero], last[name].shape)
        np.testing.assert_allclose(last[name], expected, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(last["J"], stretch, rtol=1e-9)
    np.testing.assert_allclose(last["JBAR"], stretch, rtol=1e-9)
    np.testing.assert_allclose(last["VOL"].sum(), 4.4, rtol=1e-9)
    expected = np.broadcast_to(np.diag([stretch, 1.0, 1.0]).ravel(), last["F"].shape)
    np.testing.assert_allclose(last["F"], expected, atol=1e-9)
    np.testing.assert_array_equal(last["ID"], np.arange(1, last.n_points + 1))
    np.testing.assert_array_equal(last["MAT"], 1)
    np.testing.assert_array_equal(last["PEEQ"], 0.0)
    assert last["ELEMENT"].min() >= 1


def test_fields_that_repeat_are_compressed(bar_run):
    with h5py.File(bar_run.folder / "job.vtkhdf") as file:
        data = file["VTKHDF/PointData"]
        assert {data[name].compression for name in data if name != "U"} == {"gzip"}
        # Digits that never repeat cost the most time and would hardly get shorter.
        assert data["U"].compression is None
        assert file["VTKHDF/Points"].compression is None


def test_single_precision_rounds_fields_of_points(run_tessera, bar_run):
    deck = bar().replace("*OUTPUT, FIELD", "*OUTPUT, PRECISION=SINGLE, FIELD")
    assert run_tessera(deck, "-q", "-o", "single").code == 0
    paths = [bar_run.folder / "job.vtkhdf", bar_run.folder / "single" / "job.vtkhdf"]
    with h5py.File(paths[0]) as double, h5py.File(paths[1]) as single:
        for name in ("Points", *(f"PointData/{name}" for name in double["VTKHDF/PointData"])):
            exact, rounded = (file[f"VTKHDF/{name}"] for file in (double, single))
            if exact.dtype == np.float64:
                assert rounded.dtype == np.float32
            np.testing.assert_array_equal(rounded, exact[()].astype(rounded.dtype))
        for name in ("VTKHDF/Steps/Values", "tessera/history/RF1[X1]", "tessera/ledger/volume"):
            np.testing.assert_array_equal(single[name], double[name])
    last = Series(paths[1]).at(1.0)
    np.testing.assert_allclose(last["S"][:, 0], 1000 * np.log(1.1) / 1.1, rtol=1e-6)


def test_mesh_moves_and_knows_its_points(bar_run):
    series = Series(bar_run.folder / "job_mesh.vtkhdf")
    points = Series(bar_run.folder / "job.vtkhdf").at(1.0)
    first, last = series.at(0.0), series.at(1.0)
    assert set(last.celltypes) == {VTK_TRIANGLE}
    np.testing.assert_array_equal(first.cells, last.cells)
    np.testing.assert_allclose(last.points[:, 0], 1.1 * first.points[:, 0], rtol=1e-9)
    np.testing.assert_allclose(last["U"][:, 0], 0.1 * first.points[:, 0], atol=1e-9)
    np.testing.assert_allclose(last["U_INC"][:, 0].max(), 0.1, rtol=1e-9)
    np.testing.assert_allclose(last["J"], 4.4 / 4.3, rtol=1e-9)
    np.testing.assert_allclose(last["JPATCH"], 4.4 / 4.3, rtol=1e-9)
    np.testing.assert_allclose(last["RF"].sum(axis=0), 0.0, atol=1e-7)
    assert last["NPOINTS"].sum() == points.n_points
    np.testing.assert_array_equal(last["ACTIVE"], last["NPOINTS"] > 0)
    host = points["ELEMENT"] - 1
    np.testing.assert_array_equal(points["PATCH"], last["PATCH"][host])
    corners = last.points[last.cells.reshape(-1, 4)[host, 1:]]
    assert np.all(points.points >= corners.min(axis=1) - 1e-9)
    assert np.all(points.points <= corners.max(axis=1) + 1e-9)


def test_solid_mesh_is_made_of_tetrahedra(run_tessera):
    deck = bar(method="").replace("DIMENSION=2, ORDER=QUADRATIC", "DIMENSION=3, CELL=6")
    deck = deck.replace("Y, 0, 1, 1\n", "Y, 0, 1, 1\nZ, 0, 1, 1\n").replace("QUADRATIC", "NONE")
    deck = deck.replace("Y0, 2, 2\n", "Y0, 2, 2\nZ0, 3, 3\n").replace("ELEMENT=3", "ELEMENT=4")
    deck = deck.replace("FBAR PATCH", "STANDARD")
    run = run_tessera(deck, "--check")
    assert run.code == 0, run.stderr
    mesh = Series(run.folder / "job_mesh.vtkhdf").at(0.0)
    assert set(mesh.celltypes) == {VTK_TETRA}
    assert mesh.compute_cell_sizes()["Volume"].sum() == pytest.approx(4.0)


def test_removed_points_leave_the_series(run_tessera):
    run = run_tessera(bar(method="*LOST POINTS, ACTION=REMOVE"))
    assert run.code == 0, run.stderr
    series = Series(run.folder / "job.vtkhdf")
    steps = [series.at(when) for when in series.times]
    counts = [step.n_points for step in steps]
    assert counts[0] == 96
    assert counts[-1] < counts[0]
    for step in steps:
        assert step.n_cells == step.n_points == len(set(step["ID"]))
        start = steps[0].points[step["ID"] - 1]
        np.testing.assert_allclose(step.points - start, step["U"], atol=1e-12)
    with h5py.File(run.folder / "job.vtkhdf") as file:
        ledger = file["tessera/ledger"]
        np.testing.assert_array_equal(ledger["count"][()], counts)
        np.testing.assert_array_equal(ledger["lost"][()], counts[0] - np.array(counts))


def test_group_tessera_tells_about_the_run(bar_run):
    with h5py.File(bar_run.folder / "job.vtkhdf") as file:
        assert file["VTKHDF"].attrs["Type"] == b"UnstructuredGrid"
        tessera = file["tessera"]
        assert tessera["deck"][()].decode().strip() == bar().strip()
        assert tessera["deck_name"][()] == b"job.inp"
        assert tessera.attrs["units"] == b"length m force kN"
        assert tessera.attrs["threads"] == 1
        for name in ("version", "git", "compiler", "libraries", "started"):
            assert len(tessera.attrs[name]) > 3
        iterations = {name: column[()] for name, column in tessera["iterations"].items()}
        ledger = {name: column[()] for name, column in tessera["ledger"].items()}
        run = tessera.attrs["run"]
    with h5py.File(bar_run.folder / "job_mesh.vtkhdf") as file:
        assert file["VTKHDF"].attrs["run"] == run
    assert re.fullmatch(rb"\d{8}T\d{6}\.\d{3}[+-]\d{4}-\d+", run)
    assert set(iterations["increment"]) == {1, 2, 3, 4}
    last = np.append(np.diff(iterations["iteration"]) < 0, True)
    assert np.all(iterations["residual"][last] <= 1e-9)
    for work in ("kinematics", "stress", "assembly", "factorisation", "solve"):
        assert np.all(iterations[work] >= 0.0)
    for work in ("location", "output", "point_loop"):
        assert ledger[work].shape == (5,)
        assert np.all(ledger[work] >= 0.0)
    assert np.sum(ledger["output"]) > 0.0
    assert np.all(ledger["point_loop"][1:] > 0.0)
    assert list(ledger["unknowns"]) == [0, *[ledger["unknowns"][1]] * 4]
    assert np.all(ledger["nonzeros"][1:] > ledger["unknowns"][1:])
    assert np.all(ledger["factor_memory"][1:] > 8 * ledger["nonzeros"][1:])
    np.testing.assert_allclose(ledger["mass"], 8.0, rtol=1e-12)
    np.testing.assert_allclose(ledger["volume"], [4.0, 4.1, 4.2, 4.3, 4.4], rtol=1e-9)
    np.testing.assert_allclose(ledger["centre"][-1], [2.2, 0.5, 0.0], rtol=1e-9)


def test_history_is_the_same_in_both_files(bar_run):
    lines = bar_run.read("job_history.csv").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert comments[0].startswith("# job job, deck job.inp")
    assert "# units: length m force kN" in comments
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert list(rows[0]) == "step,increment,time,RF1[X1],RF2[X1],U1[X1],U2[X1]".split(",")
    with h5py.File(bar_run.folder / "job.vtkhdf") as file:
        for name in rows[0]:
            stored = file["tessera/history"][name][()]
            np.testing.assert_array_equal([float(row[name]) for row in rows], stored)
    assert float(rows[0]["RF1[X1]"]) == float(rows[0]["U1[X1]"]) == 0.0
    # The height stays 1 in plane strain without lateral strain: force = Cauchy stress x 1.
    assert float(rows[-1]["RF1[X1]"]) == pytest.approx(1000 * np.log(1.1) / 1.1, rel=1e-8)
    assert float(rows[-1]["U1[X1]"]) == pytest.approx(0.4, rel=1e-12)


def test_status_file_has_a_line_per_attempt(bar_run):
    lines = bar_run.read("job.sta").splitlines()
    assert lines[0].startswith("# step")
    fields = [line.split() for line in lines[1:]]
    assert [field[:3] for field in fields] == [["1", str(i), "1"] for i in (1, 2, 3, 4)]
    assert float(fields[-1][6]) == pytest.approx(1000 * np.log(1.1) / 1.1, rel=1e-6)
    assert all(line.endswith("converged") for line in lines[1:])


def test_formulation_of_the_run_stands_in_the_file(run_tessera):
    run = run_tessera(bar(), "--compare", "standard,fbar", "-q")
    assert run.code == 0, run.stderr
    for method in ("standard", "fbar"):
        with h5py.File(run.folder / f"job_{method}.vtkhdf") as file:
            assert file["tessera"].attrs["formulation"] == method.encode()


def test_deck_is_stored_byte_for_byte(run_tessera):
    deck = ("** tab\tand umlaut \u00e4  \n\n" + bar()).rstrip("\n").encode()
    run = run_tessera(deck, "--check")
    assert run.code == 0, run.stderr
    with h5py.File(run.folder / "job.vtkhdf") as file:
        assert file["tessera/deck"][()] == deck


def test_log_echoes_warnings(run_tessera):
    deck = bar().replace("*STEP,", "*NSET, NSET=IDLE\n1\n*STEP,")
    run = run_tessera(deck, "--lax", "--check")
    assert run.code == 0, run.stderr
    assert "warning: nothing uses" in run.stderr
    assert run.stderr.strip() in run.read("job.log")


def test_log_echoes_deck_settings_and_summary(bar_run):
    log = bar_run.read("job.log")
    assert bar().strip() in log
    for text in (
        "formulation: F-bar patch",
        "mesh: moving, driver",
        "Newton: tolerance 1e-9, at most",
        "patches: 8, elements per patch: 4 to 4, mean 4",
        "with one constraint per active element",
        "step 1 increment 4 attempt 1",
        "reaction of X1: ",
        "expectations: 0, failed 0",
        "CPU seconds: kinematics ",
        "exit code: 0",
    ):
        assert text in log


EXPECT = """\
*EXPECT, QUANTITY=RF, SET=X1, COMPONENT=1, TIME=0.6
analytic, 55.0, 0.01
frozen, 1.0, 0.01"""


def test_missed_expectation_ends_with_code_7(run_tessera):
    run = run_tessera(bar(expect=EXPECT))
    assert run.code == 7
    exact = 1000 * np.log(1.06) / 1.06
    log = run.read("job.log")
    line = bar(expect=EXPECT).splitlines().index("frozen, 1.0, 0.01") + 1
    verdict = f"EXPECT job.inp:{line} SUM RF1[X1] at 0.6: frozen 1 +- 0.01, found "
    found, end = log.split(verdict)[1].splitlines()[0].split(": ")
    assert float(found) == pytest.approx(exact, rel=1e-9)
    assert end == "FAILED"
    assert f"EXPECT job.inp:{line - 1} SUM RF1[X1] at 0.6: analytic 55 +- 0.55" in log
    assert "expectations: 2, failed 1" in log
    times = Series(run.folder / "job.vtkhdf").times
    assert np.min(np.abs(np.array(times) - 0.6)) < 1e-12


def test_earlier_results_are_kept_without_force(run_tessera, bar_run):
    before = bar_run.read("job.log")
    again = run_tessera(bar())
    assert again.code == 8
    assert (
        "job.log' exists already: earlier results are only overwritten with --force" in again.stderr
    )
    assert again.read("job.log") == before
    assert run_tessera(bar(), "--force").code == 0


def test_progress_is_plain_lines_in_a_file(run_tessera):
    run = run_tessera(bar())
    lines = run.stderr.splitlines()
    assert [line.split(" time")[0] for line in lines] == [
        f"step 1 increment {i}" for i in (1, 2, 3, 4)
    ]
    assert "\r" not in run.stderr
    assert run_tessera(bar(), "--force", "--quiet").stderr == ""


def test_progress_is_one_line_on_a_terminal(tessera, tmp_path):
    (tmp_path / "job.inp").write_text(bar(), encoding="utf-8")
    terminal, end = pty.openpty()
    with subprocess.Popen([str(tessera), "job.inp"], cwd=tmp_path, stderr=end) as process:
        process.wait(timeout=60)
    os.close(end)
    text = os.read(terminal, 65536).decode()
    os.close(terminal)
    assert process.returncode == 0
    parts = text.split("\r")
    assert sum(part.startswith("step 1 increment") for part in parts) == 4
    assert text.count("\n") == 1


def test_killed_run_leaves_readable_files(tessera, tmp_path):
    (tmp_path / "job.inp").write_text(bar(inc=20000, size=5e-5), encoding="utf-8")
    command = [str(tessera), "-q", "--publish", "0", "job.inp"]
    with subprocess.Popen(command, cwd=tmp_path) as process:
        status, deadline = tmp_path / "job.sta", time.monotonic() + 60
        while not status.exists() or status.read_text().count("\n") < 12:
            assert process.poll() is None
            assert time.monotonic() < deadline
            time.sleep(0.01)
        process.kill()
    assert process.returncode == -signal.SIGKILL
    attempts = status.read_text().count("\n") - 1
    for name in ("job.vtkhdf", "job_mesh.vtkhdf"):
        series = Series(tmp_path / name)
        assert attempts - 1 <= len(series.times) <= attempts + 1
        grid = series.at(series.times[-1])
        assert np.all(np.isfinite(grid.points))
        moved = grid["U"][:, 0].max()
        assert moved == pytest.approx(0.4 * series.times[-1], rel=0.2)
    with h5py.File(tmp_path / "job.vtkhdf") as file:
        assert len(file["tessera/history/time"]) >= attempts - 1


@pytest.mark.parametrize("limit", [1_000, 100_000, 400_000])
def test_full_disk_is_a_file_error(tessera, tmp_path, limit):
    """A limit of the file size stands for the disk: the system refuses to write on."""

    def no_more_than_the_limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    (tmp_path / "job.inp").write_text(bar(inc=2000, size=1e-3), encoding="utf-8")
    result = subprocess.run(
        [str(tessera), "-q", "job.inp"],
        cwd=tmp_path,
        preexec_fn=no_more_than_the_limit,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert result.returncode == 8, result.stderr
    assert result.stderr.startswith("error: cannot write 'job")
    assert result.stderr.rstrip().endswith("File too large")
    assert "HDF5-DIAG" not in result.stderr


def test_folder_in_the_place_of_a_file_is_a_file_error(run_tessera, tmp_path):
    (tmp_path / "job.vtkhdf").mkdir()
    run = run_tessera(bar(), "--force", "-q")
    assert run.code == 8
    assert run.stderr == "error: cannot write 'job.vtkhdf': Is a directory\n"
