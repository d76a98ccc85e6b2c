"""Result files of every kind: whole, cut, damaged, of others, and still being written."""

import shutil
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest
from post_runs import bar_deck
from raw_results import raw_outputs
from tessera_post.errors import PostError
from tessera_post.job import Job, open_job
from tessera_post.series import Series, open_hdf5

pytest_plugins = ["lost_point_runs"]


def read_everything(path):
    """Everything that commands read of a job; the number of outputs."""
    job = Job(path)
    try:
        _ = job.history, job.iterations, job.ledger, job.deck, job.deck_name, job.heading
        _ = job.notes, job.label, job.units, job.increments
        for step in range(job.points.n_steps):
            _ = job.points.points(step), job.points.cells(step), job.points.cell_type
            _ = [job.points.field(name, step) for name in job.points.field_names]
        return job.points.n_steps
    finally:
        job.close()


def problem_of(path):
    """The message about a file, empty if all of it can be read; other exceptions go on."""
    try:
        read_everything(path)
    except PostError as problem:
        return str(problem)
    return ""


def one_line_of(path):
    """The message about a file that cannot be used."""
    message = problem_of(path)
    assert str(path) in message
    assert "\n" not in message
    return message


@pytest.fixture
def twin(bar, tmp_path):
    """A copy of the points of the bar, to be spoilt."""
    return shutil.copy(f"{bar}.vtkhdf", tmp_path / "twin.vtkhdf")


# --- whole files ---------------------------------------------------------------------------------


def test_series_gives_what_is_in_the_file(bar):
    series = Series(bar.with_suffix(".vtkhdf"))
    assert (series.n_steps, series.note) == (5, "")
    np.testing.assert_array_equal(series.times, [0.0, 0.25, 0.5, 0.75, 1.0])
    for step, output in enumerate(raw_outputs(series.path)):
        np.testing.assert_array_equal(series.points(step), output.points)
        for name, values in output.fields.items():
            np.testing.assert_array_equal(series.field(name, step), values)


def test_missing_field_names_those_there_are(bar):
    with pytest.raises(PostError) as raised:
        Series(bar.with_suffix(".vtkhdf")).field("WATER", 0)
    assert str(raised.value) == (
        "'bar.vtkhdf' has no field 'WATER': there are ELEMENT, F, ID, J, JBAR, LE, MAT, PATCH,"
        " PEEQ, S, TAU, U, VOL"
    )


def test_output_without_points_has_no_cells(emptied):
    series = Series(emptied.with_suffix(".vtkhdf"))
    assert series.n_points(1) == 0
    assert series.cells(1).shape == (0, 1)
    assert series.field("S", 1).shape == (0, 6)


# --- files of others -----------------------------------------------------------------------------


def test_file_that_is_not_there_or_no_hdf5_is_named(tmp_path):
    path = tmp_path / "job.vtkhdf"
    with pytest.raises(PostError, match=f"there is no file '{path}'"):
        open_hdf5(path)
    with pytest.raises(PostError, match=f"'{tmp_path}' is a folder: expected a result file"):
        open_hdf5(tmp_path)
    for data in (b"", b"text\n" * 100, b"\x89HDF", bytes(4096)):
        path.write_bytes(data)
        with pytest.raises(PostError, match="is no HDF5 file: expected a "):
            open_hdf5(path)


def make_image(file):
    grid = file.create_group("VTKHDF")
    grid.attrs["Type"] = b"ImageData"
    grid["PointData/S"] = np.zeros((2, 2, 2))


def make_still_grid(file):
    grid = file.create_group("VTKHDF")
    for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds", "Connectivity"):
        grid[name] = np.ones(1, dtype=int)
    grid["Points"] = np.zeros((1, 3))
    grid["Types"] = np.ones(1, dtype=np.uint8)


OTHERS = {
    "nothing": lambda file: None,
    "numbers": lambda file: file.create_dataset("x", data=np.arange(3)),
    "numbers in place of the grid": lambda file: file.create_dataset("VTKHDF", data=np.arange(3)),
    "an image": make_image,
    "a grid without times": make_still_grid,
}


@pytest.mark.parametrize("name", OTHERS)
def test_hdf5_of_others_is_no_result(name, tmp_path):
    path = tmp_path / "other.vtkhdf"
    with h5py.File(path, "w") as file:
        OTHERS[name](file)
    assert one_line_of(path).startswith(f"'{path}' is no result of Tessera, or was never finished")


def objects_of(path):
    """Names of all groups and datasets."""
    names = []
    with h5py.File(path) as file:
        file.visit(names.append)
    return names


def test_result_without_any_of_its_parts_is_an_error_or_still_of_use(bar, twin):
    unusable = []
    for name in objects_of(twin):
        shutil.copy(f"{bar}.vtkhdf", twin)
        with h5py.File(twin, "r+") as file:
            del file[name]
        if problem_of(twin):
            assert one_line_of(twin)
            unusable.append(name)
    assert {"VTKHDF", "VTKHDF/Points", "VTKHDF/Steps/Values", "tessera", "tessera/deck"} <= set(
        unusable
    )
    assert "VTKHDF/Offsets" not in unusable


def test_result_with_other_things_in_place_of_its_parts_is_an_error_or_still_of_use(bar, twin):
    for name in objects_of(twin):
        shutil.copy(f"{bar}.vtkhdf", twin)
        with h5py.File(twin, "r+") as file:
            del file[name]
            file[name] = np.arange(3.0)
        assert "\n" not in problem_of(twin), name


def test_points_in_a_mesh_file_are_no_job(bar):
    message = one_line_of(bar.with_name("bar_mesh.vtkhdf"))
    assert message.endswith("is no result of Tessera: it has no group /tessera")


# --- cut and damaged files -----------------------------------------------------------------------


def test_truncated_copies_are_an_error_or_of_use(bar, twin):
    data = bar.with_suffix(".vtkhdf").read_bytes()
    lengths = [*range(0, 600, 37), *range(600, len(data), len(data) // 60), len(data) - 1]
    for length in lengths:
        twin.write_bytes(data[:length])
        assert "HDF5" in one_line_of(twin) or "cannot read" in one_line_of(twin)
    twin.write_bytes(data)
    assert read_everything(twin) == 5


def test_copies_with_an_empty_end_are_an_error_or_of_use(bar, twin):
    data = bar.with_suffix(".vtkhdf").read_bytes()
    messages = []
    for length in range(600, len(data), len(data) // 60):
        twin.write_bytes(data[:length] + bytes(len(data) - length))
        messages.append(problem_of(twin))
    assert not any("\n" in message for message in messages)
    assert sum(message != "" for message in messages) > 30


@pytest.mark.parametrize("dataset", ["PointData/S", "Points", "Steps/Values", "Steps/PartOffsets"])
def test_outputs_without_all_their_rows_are_dropped_with_a_note(twin, dataset):
    with h5py.File(twin, "r+") as file:
        values = file["VTKHDF"][dataset]
        rows = len(values) // 5
        values.resize(3 * rows + rows // 2, axis=0)
    series = Series(twin)
    assert series.n_steps == 3
    np.testing.assert_array_equal(series.times, [0.0, 0.25, 0.5])
    assert series.note == "'twin.vtkhdf': the last 2 outputs are incomplete"
    series.close()
    assert "'twin.vtkhdf': the last 2 outputs are incomplete" in Job(twin).notes


def test_file_without_a_whole_output_is_an_error(twin):
    with h5py.File(twin, "r+") as file:
        file["VTKHDF/Points"].resize(95, axis=0)
    assert one_line_of(twin) == f"'{twin}' holds no output yet"
    with h5py.File(twin, "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = 0
    assert one_line_of(twin) == f"'{twin}' holds no output yet"


def test_tables_are_cut_to_the_rows_of_all_columns(twin):
    with h5py.File(twin, "r+") as file:
        file["tessera/history/RF1[X1]"].resize(3, axis=0)
    history = Job(twin).history
    assert {len(column) for column in history.values()} == {3}


def test_locked_file_is_read_after_a_while(twin):
    holder = (
        "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('open', flush=True); input()"
    )
    command = [sys.executable, "-c", holder, str(twin)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        assert process.stdout.readline() == "open\n"
        assert Series(twin).n_steps == 5
        process.communicate("\n")


# --- a run that is going on ----------------------------------------------------------------------


def test_job_that_is_still_running_can_be_read(tessera_release, tmp_path):
    (tmp_path / "bar.inp").write_text(bar_deck(inc=2000, size=5e-4), encoding="utf-8")
    status = tmp_path / "bar.sta"
    command = [str(tessera_release), "-q", "--publish", "0", "bar.inp"]
    with subprocess.Popen(command, cwd=tmp_path) as process:
        try:
            while not status.exists() or status.read_text().count("\n") < 8:
                assert process.poll() is None
                time.sleep(0.01)
            job = open_job(str(tmp_path / "bar"))
            assert process.poll() is None
            assert job.is_unfinished
            last = job.output_of()
            assert last >= 5
            assert np.isfinite(job.points.field("S", last)).all()
            assert np.isfinite(job.need_mesh().field("U", job.need_mesh().n_steps - 1)).all()
        finally:
            process.kill()


# --- about the deck ------------------------------------------------------------------------------


def test_heading_is_the_first_line_that_is_no_comment(run_deck, tmp_path):
    deck = bar_deck(heading="** a comment\nPlastic bar").replace("*HEADING", "*heading ** text")
    assert open_job(str(run_deck(tmp_path, deck))).heading == "Plastic bar"
