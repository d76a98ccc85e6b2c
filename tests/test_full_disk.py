"""Disks that are full, broken, read-only or gone: exit code 8, a message, and whole files."""

import errno
import os
import random
import re
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest
from small_runs import (
    FILES,
    JOB,
    Disturbance,
    SmallRun,
    build_faults,
    check_part,
    check_tables,
    check_whole,
    contents,
    deck_with,
    n_converged,
)

EXIT_FILE = 8
FOREVER = 1_000_000
CHANGING = "write,sync,truncate,rename,exchange,open"


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build_faults(tmp_path_factory.mktemp("library"))


@pytest.fixture(scope="module")
def whole(tessera, library, tmp_path_factory):
    """A run that nothing disturbs."""
    run = SmallRun(tessera, library, tmp_path_factory.mktemp("whole"))
    assert run.run(Disturbance("0", 0, calls=CHANGING)).returncode == 0
    return run


def check_error(process, reason):
    """Whether a run ended as it must: one message with path and reason."""
    assert process.returncode == EXIT_FILE, process.stderr
    assert process.stderr.count("\n") == 1, process.stderr
    assert process.stderr.startswith("error: cannot "), process.stderr
    assert f"{JOB}" in process.stderr
    assert process.stderr.endswith(f": {reason}\n"), process.stderr


def check_files(folder, whole):
    """Whether the result files are whole, as far as they go, and nothing else is left."""
    for name, expected in zip(FILES, whole.results):
        found = contents(folder / name)
        if found is None:
            assert n_converged(folder) == 0
            continue
        check_part(found, expected, name)
        if "tessera" in found or name == FILES[0]:
            n_increments = check_tables(found, name)
            assert n_converged(folder) - 1 <= n_increments <= n_converged(folder)
    assert not list(folder.glob("*.next"))


@pytest.mark.parametrize("reason", ["ENOSPC", "EDQUOT", "EIO", "EROFS"])
def test_refused_write_is_a_file_error(whole, tessera, library, tmp_path, reason):
    """From some call on every change is refused, as on a full disk. Near the end a run may not
    notice: what it writes last into the copies is not needed any more."""
    number = getattr(errno, reason)
    moments = random.Random(number)
    last = whole.n_calls * 19 // 20
    for at in [1, last, *moments.sample(range(2, last), 8)]:
        run = SmallRun(tessera, library, tmp_path / str(at))
        process = run.run(Disturbance(str(number), at, FOREVER, CHANGING))
        check_error(process, os.strerror(number))
        check_files(run.folder, whole)
        restarted = run.go_on()  # there is room again
        if restarted is None:
            assert n_converged(run.folder) <= 2
            continue
        assert (restarted.returncode, restarted.stderr) == (0, "")
        check_whole(run, whole)


def test_full_disk_is_a_message_in_the_log(whole, tessera, library, tmp_path):
    run = SmallRun(tessera, library, tmp_path / "run")
    for at in range(1, whole.n_calls, whole.n_calls // 10):
        process = run.run(Disturbance(str(errno.ENOSPC), at, 1, "write"))
        if process.returncode == EXIT_FILE and "vtkhdf" in process.stderr:
            assert process.stderr in (run.folder / f"{JOB}.log").read_text()
            return
    pytest.fail("no write of a result file was refused")


@pytest.mark.parametrize("do", ["short", str(errno.EINTR)])
def test_interrupted_write_changes_nothing(whole, tessera, library, tmp_path, do):
    """A write that was interrupted, or wrote a part, is gone on with."""
    run = SmallRun(tessera, library, tmp_path / "run")
    moments = random.Random(1)
    for at in moments.sample(range(1, whole.n_calls), 10):
        process = run.run(Disturbance(do, at, moments.choice((1, 5)), "write"))
        assert process.returncode == 0, process.stderr
        check_whole(run, whole)


@pytest.mark.parametrize("publish", ["", "1000"])
def test_results_that_lag_are_whole_on_a_full_disk(tessera, library, tmp_path, publish):
    """What was not published yet may be lost, and nothing else; the run goes on."""
    whole = SmallRun(tessera, library, tmp_path / "whole", publish=publish)
    assert whole.run(Disturbance("0", 0, calls=CHANGING)).returncode == 0
    moments = random.Random(2)
    for at in moments.sample(range(1, whole.n_calls * 9 // 10), 8):
        run = SmallRun(tessera, library, tmp_path / str(at), publish=publish)
        process = run.run(Disturbance(str(errno.ENOSPC), at, FOREVER, CHANGING))
        check_error(process, os.strerror(errno.ENOSPC))
        for name, found, expected in zip(FILES, run.results, whole.results):
            if found is not None:
                check_part(found, expected, name)
        if run.results[0] is not None:
            assert check_tables(run.results[0], FILES[0]) <= n_converged(run.folder)
        assert not list(run.folder.glob("*.next"))
        restarted = run.go_on()
        if restarted is not None:
            assert (restarted.returncode, restarted.stderr) == (0, "")
            check_whole(run, whole)


def test_other_file_that_fails_costs_no_results(whole, tessera, library, tmp_path):
    """A line of the status file is refused: all increments before it are there."""
    run = SmallRun(tessera, library, tmp_path / "run", publish="1000")
    process = run.run(Disturbance(str(errno.ENOSPC), 6, FOREVER, "write", path=".sta"))
    check_error(process, os.strerror(errno.ENOSPC))
    n_increments = check_tables(run.results[0], FILES[0])
    assert n_increments == n_converged(run.folder) >= 3
    for name, found, expected in zip(FILES, run.results, whole.results):
        assert check_part(found, expected, name) == n_increments + 1


def test_attempt_that_cannot_be_told_leaves_no_values(whole, tessera, library, tmp_path):
    """Converged, but its line of the status file is refused: not accepted, so in no output."""
    run = SmallRun(tessera, library, tmp_path / "run")
    deck = run.folder / f"{JOB}.inp"
    deck.write_text(deck_with().replace("FIELD, FREQUENCY=1", "FIELD, FREQUENCY=3"))
    process = run.run(Disturbance(str(errno.ENOSPC), 6, FOREVER, "write", path=".sta"))
    check_error(process, os.strerror(errno.ENOSPC))
    mesh, expected = run.results[1], whole.results[1]
    times = list(expected["VTKHDF/Steps/Values"])
    for step, when in enumerate(mesh["VTKHDF/Steps/Values"]):
        for name in ("U", "RF"):
            values = [
                data[f"VTKHDF/PointData/{name}"][data[f"VTKHDF/Steps/PointDataOffsets/{name}"][i] :]
                for data, i in ((mesh, step), (expected, times.index(when)))
            ]
            n = int(mesh["VTKHDF/NumberOfPoints"][0])
            np.testing.assert_array_equal(values[0][:n], values[1][:n], f"{name} at {when}")


# --- file systems --------------------------------------------------------------------------------


@pytest.fixture
def small_disk(tmp_path):
    """small_disk(kilobytes): a folder on a file system of its own, where one may be mounted."""
    mounted = []

    def make(kilobytes):
        folder = tmp_path / "disk"
        folder.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        if result.returncode != 0:
            pytest.skip(f"no file system can be mounted: {result.stderr.strip()}")
        mounted.append(folder)
        return folder

    yield make
    for folder in mounted:
        subprocess.run(["umount", "-l", str(folder)], check=False)


def run_into(program, folder, deck_folder):
    """Runs the job with its results in a folder."""
    deck = deck_folder / f"{JOB}.inp"
    deck.write_text(deck_with(), encoding="utf-8")
    return subprocess.run(
        [str(program), "-q", "--publish", "0", "-o", str(folder), str(deck)],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize("kilobytes", [4, 100, 200, 300, 400])
def test_full_file_system(whole, tessera, small_disk, tmp_path, kilobytes):
    folder = small_disk(kilobytes)
    check_error(run_into(tessera, folder, tmp_path), "No space left on device")
    check_files(folder, whole)


def test_read_only_file_system(tessera, small_disk, tmp_path):
    folder = small_disk(1000)
    subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
    check_error(run_into(tessera, folder, tmp_path), "Read-only file system")
    assert not list(folder.iterdir())


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_folder_without_permission(tessera, tmp_path):
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o500)
    check_error(run_into(tessera, folder, tmp_path), "Permission denied")


def test_folder_that_vanishes(tessera, library, tmp_path):
    """Somebody removes the folder while the run is going on."""
    run = SmallRun(tessera, library, tmp_path / "run")
    deck = tmp_path / f"{JOB}.inp"
    deck.write_text(deck_with(size=0.001), encoding="utf-8")
    command = [str(tessera), "-q", "-o", str(run.folder), str(deck)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while n_converged(run.folder) < 2:
            assert process.poll() is None
            time.sleep(0.01)
        # In one step, or the run could write into it in between.
        shutil.rmtree(run.folder.rename(tmp_path / "gone"))
        _, stderr = process.communicate(timeout=60)
    assert process.returncode == EXIT_FILE
    # Whichever file of the job comes next: points, mesh or restart.
    start = rf"error: cannot (write|read) '{re.escape(str(run.folder))}/{JOB}[^']*': "
    assert re.match(start, stderr), stderr
    assert "No such file or directory" in stderr


# --- readers of a run that is going on -----------------------------------------------------------

# Opens both files, and looks at all their bytes now and after a line of input.
HOLD = """
import hashlib, os, sys, h5py

def state():
    numbers = [file.id.get_vfd_handle() for file in files]
    data = [os.pread(number, os.fstat(number).st_size, 0) for number in numbers]
    return [hashlib.sha256(part).hexdigest() for part in data]

files = [h5py.File(name) for name in sys.argv[1:]]
before = state()
print("open", flush=True)
sys.stdin.readline()
n_steps = [int(file["VTKHDF/Steps"].attrs["NSteps"]) for file in files]
print("the same" if state() == before else "not same", *n_steps)
"""


def test_reader_keeps_the_file_that_it_opened(tessera, library, tmp_path):
    """The run goes on with a new copy and leaves the file that somebody has opened alone."""
    run = SmallRun(tessera, library, tmp_path / "run", size=0.005)
    paths = [str(run.folder / name) for name in FILES]
    with run.start() as process:
        while n_converged(run.folder) < 3:
            assert process.poll() is None
            time.sleep(0.01)
        with subprocess.Popen(
            [sys.executable, "-c", HOLD, *paths],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        ) as reader:
            assert reader.stdout.readline() == "open\n"
            assert process.wait(timeout=120) == 0
            out, _ = reader.communicate("\n", timeout=60)
    words = out.split()
    assert words[:2] == ["the", "same"]
    assert all(1 < int(n_steps) < 201 for n_steps in words[2:])
    for name, found in zip(FILES, run.results):
        assert check_part(found, found, name) == 201
    assert check_tables(run.results[0], FILES[0]) == 200
    assert not list(run.folder.glob("*.next"))
