"""Restart: a run that was interrupted goes on and gives the same numbers to the last bit."""

import os
import re
import shutil
import signal
import subprocess
import time
import zlib

import h5py
import pytest
from conftest import ROOT
from restart_runs import CUBE, PLATE, STRIP, assert_same_run, datasets, recycled

STRETCH = (ROOT / "input" / "stretch" / "stretch.inp").read_text(encoding="utf-8")
GO_ON = "job.restart.h5"


@pytest.mark.parametrize(
    ("deck", "at_least"),
    [
        (PLATE, 12),
        (CUBE, 5),
        (STRETCH, 16),
        (STRIP, 4),
        (recycled(PLATE), 9),
        (recycled(CUBE), 5),
        (recycled(STRIP), 4),
    ],
    ids=["plate", "cube", "stretch", "strip", "plate-recycled", "cube-recycled", "strip-recycled"],
)
def test_every_increment_can_be_gone_on_from(run_tessera, tmp_path, deck, at_least):
    """The run is stopped after each increment; every second part has two threads."""
    whole = run_tessera(deck, "-q", "-o", "whole")
    assert (whole.code, whole.stderr) == (0, "")
    (tmp_path / "parts").mkdir()
    arguments = ["-q", "-o", "parts"]
    for part in range(100):
        (tmp_path / "parts" / "job.stop").touch()
        run = run_tessera(deck, *arguments, threads=1 + part % 2)
        if run.code != 130:
            break
        assert run.stderr.startswith("stopped by parts/job.stop at step ")
        assert not (tmp_path / "parts" / "job.stop").exists()
        arguments = ["-q", "-o", "parts", "--restart", f"parts/{GO_ON}"]
    assert (run.code, run.stderr) == (0, "")
    assert part >= at_least
    assert_same_run(tmp_path / "parts", tmp_path / "whole")


def test_plate_has_all_that_a_restart_must_bring_back(run_tessera, tmp_path):
    """The deck of the test above does what it is there for."""
    run = run_tessera(PLATE)
    assert run.code == 0
    status = run.read("job.sta")
    assert "too many iterations" in status
    assert len({line.split()[8] for line in status.splitlines()[1:]}) > 2  # active elements
    log = run.read("job.log")
    assert "share of the load" in log
    assert "checkerboard" in log
    mesh = datasets(tmp_path / "job_mesh.vtkhdf")["VTKHDF/Points"]
    assert (mesh[: len(mesh) // 2] != mesh[-(len(mesh) // 2) :]).any()


def test_strip_begins_with_the_last_increment(run_tessera):
    run = run_tessera(STRIP)
    assert run.code == 0
    assert run.read("job.log").count("started from the last increment") > 3


def test_recycled_factors_outlive_increments(run_tessera, tmp_path):
    """The decks of the test above do what they are there for: increments without new factors."""
    for deck in (PLATE, STRIP):
        run = run_tessera(recycled(deck), "-f")
        assert run.code == 0
        table = datasets(tmp_path / "job.vtkhdf")
        increments = {}
        for i, attempt in enumerate(table["tessera/iterations/attempt"]):
            place = (table["tessera/iterations/step"][i], table["tessera/iterations/increment"][i])
            increments.setdefault((*place, attempt), []).append(
                (table["tessera/iterations/gmres"][i], table["tessera/iterations/new_factors"][i])
            )
        assert any(sum(new for _, new in rows) == 0 for rows in increments.values())
        assert any(gmres > 0 for rows in increments.values() for gmres, _ in rows)


def test_cube_loses_points_on_its_way(run_tessera, tmp_path):
    run = run_tessera(CUBE)
    assert run.code == 0
    assert datasets(tmp_path / "job.vtkhdf")["tessera/ledger/lost"][-1] > 0


def test_older_restart_file_goes_on_as_well(run_tessera, tmp_path):
    deck = PLATE.replace("*OUTPUT,", "*RESTART, WRITE, FREQUENCY=3\n*OUTPUT,")
    assert run_tessera(deck, "-q", "-o", "whole").code == 0
    log = (tmp_path / "whole" / "job.log").read_text()
    assert len(re.findall(r"restart file whole/job.restart.h5 written at step", log)) == 5
    shutil.copytree(tmp_path / "whole", tmp_path / "again")
    (tmp_path / "again" / GO_ON).unlink()
    run = run_tessera(deck, "-q", "-o", "again", "--restart", "whole/job.restart.1.h5")
    assert (run.code, run.stderr) == (0, "")
    assert_same_run(tmp_path / "again", tmp_path / "whole")


def test_results_in_another_folder_begin_at_the_restart(run_tessera, tmp_path):
    deck = PLATE.replace("*OUTPUT,", "*RESTART, WRITE, FREQUENCY=3\n*OUTPUT,")
    run_tessera(deck, "-q", "-o", "whole")
    run = run_tessera(deck, "-q", "-o", "other", "--restart", "whole/job.restart.1.h5")
    assert (run.code, run.stderr) == (0, "")
    whole, other = (
        (tmp_path / f / "job_history.csv").read_text().splitlines() for f in ("whole", "other")
    )
    rows = [line for line in other if line[0].isdigit()]
    assert 1 < len(rows) < 10
    assert rows == whole[-len(rows) :]
    ledgers = [datasets(tmp_path / f / "job.vtkhdf") for f in ("whole", "other")]
    for name in ("count", "unknowns", "nonzeros"):
        whole, other = (table[f"tessera/ledger/{name}"] for table in ledgers)
        assert list(other) == list(whole[-len(rows) :]), name


def test_restart_request_is_obeyed(run_tessera, tmp_path):
    (tmp_path / "job.restart").touch()
    run = run_tessera(CUBE)
    assert run.code == 0
    assert not (tmp_path / "job.restart").exists()
    assert "job.restart.h5 written at step 1, increment 1, total time 1" in run.read("job.log")
    assert run.read("job.log").count("restart file") == 1


def running(program, folder, deck, *arguments):
    """A run in the background, in its second increment at least."""
    (folder / "job.inp").write_text(deck)
    # In the background of a shell the tests would ignore them, and so would the run.
    heed = ["env", "--default-signal=INT,TERM,HUP"]
    process = subprocess.Popen(
        [*heed, str(program), "job.inp", "-v", *arguments],
        cwd=folder,
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    head = ""
    while "increment 2" not in head:
        line = process.stderr.readline()
        assert line, head
        head += line
    return process


LONG = STRETCH.replace("INC=17", "INC=17000").replace("1.0, 17.0", "0.001, 17.0")
LONG = LONG[: LONG.index("*EXPECT")] + "*END STEP\n"


@pytest.mark.parametrize(
    ("number", "code", "word"),
    [
        (signal.SIGINT, 130, "interrupted"),
        (signal.SIGTERM, 143, "terminated"),
        (signal.SIGHUP, 143, "terminated"),
    ],
)
def test_signal_ends_with_a_restart_file(tessera, run_tessera, tmp_path, number, code, word):
    process = running(tessera, tmp_path, LONG)
    process.send_signal(number)
    _, stderr = process.communicate(timeout=120)
    assert process.returncode == code
    last = stderr.splitlines()[-1]
    assert last.startswith(f"{word} at step 1, increment ")
    assert last.endswith("go on with tessera --restart job.restart.h5 and the deck")
    increment = int(re.search(r"increment (\d+)", last).group(1))
    assert increment >= 1
    history = (tmp_path / "job_history.csv").read_text().splitlines()
    assert history[-1].startswith(f"1,{increment},")
    assert f"exit code: {code}" in (tmp_path / "job.log").read_text()
    # It goes on: one increment more, and the rows are those of one run.
    (tmp_path / "job.stop").touch()
    run = run_tessera(LONG, "--restart", GO_ON)
    assert run.code == 130
    rows = [line for line in run.read("job_history.csv").splitlines() if line[0].isdigit()]
    assert [int(row.split(",")[1]) for row in rows] == list(range(increment + 2))


def test_second_signal_ends_at_once(tessera, tmp_path):
    process = running(tessera, tmp_path, LONG)
    os.kill(process.pid, signal.SIGSTOP)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    os.kill(process.pid, signal.SIGCONT)
    process.communicate(timeout=120)
    assert process.returncode in (130, 143)
    assert not (tmp_path / GO_ON).exists()
    assert "exit code" not in (tmp_path / "job.log").read_text()


def test_ignored_interrupt_stays_ignored(tessera, tmp_path):
    """As for work that a shell has put into the background."""
    command = f"trap '' INT; exec {tessera} job.inp -q"
    (tmp_path / "job.inp").write_text(LONG)
    process = subprocess.Popen(["sh", "-c", command], cwd=tmp_path, stderr=subprocess.PIPE)
    while not (tmp_path / "job.sta").exists() or len((tmp_path / "job.sta").read_text()) < 400:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=120)
    assert process.returncode == 143


def test_failed_run_goes_on_with_other_controls(run_tessera, tmp_path):
    """Too few increments, too few iterations: the deck may be mended and the run goes on."""
    deck = CUBE.replace("*STEP, NAME=PUSH", "*STEP, NAME=PUSH, INC=10")
    assert run_tessera(deck, "-q", "-o", "whole").code == 0
    short = deck.replace("*STATIC, DIRECT\n1.0, 6.0", "*STATIC, DIRECT\n1.0, 6.0, 1.0")
    hard = short.replace("*BOUNDARY", "*CONTROLS, MAX ITERATIONS=1\n*BOUNDARY")
    run = run_tessera(hard, "-q", "-o", "parts")
    assert run.code == 4
    run = run_tessera(deck, "-q", "-o", "parts", "--restart", f"parts/{GO_ON}")
    assert (run.code, run.stderr) == (0, "")
    assert_same_run(tmp_path / "parts", tmp_path / "whole")


def test_more_increments_and_a_further_step(run_tessera, tmp_path):
    """A run that used up INC goes on, and a finished run goes on with one step more."""
    deck = CUBE.replace("*STATIC, DIRECT\n1.0, 6.0", "*STATIC\n1.0, 6.0, 1E-3, 1.0")
    further = (
        "*STEP, NAME=BACK, INC=3\n*STATIC, DIRECT\n1, 2\n*BOUNDARY\nZ1, 3, 3, -0.2\n*END STEP\n"
    )
    assert run_tessera(deck + further, "-q", "-o", "whole").code == 0
    run = run_tessera(deck.replace("PUSH", "PUSH, INC=3"), "-q", "-o", "parts")
    assert run.code == 4
    assert "INC" in run.stderr
    run = run_tessera(
        deck.replace("*OUTPUT", "*RESTART, WRITE\n*OUTPUT"),
        "-q",
        "-o",
        "parts",
        "--restart",
        f"parts/{GO_ON}",
    )
    assert run.code == 0, run.stderr
    (tmp_path / "parts" / "job.restart").touch()
    deck = deck + further
    again = tmp_path / "parts" / GO_ON
    run = run_tessera(deck, "-q", "-o", "parts", "--restart", str(again))
    assert run.code == 0, run.stderr
    assert_same_run(tmp_path / "parts", tmp_path / "whole")


REFUSALS = {
    "other material": (
        "1000, 0.4",
        "1000, 0.3",
        2,
        r"job.inp:24:1: error: \*ELASTIC is not as it was",
    ),
    "other mesh": (
        "Y, 0, 3, 3",
        "Y, 0, 3.1, 3",
        2,
        r"job.inp:1:1: error: \*GENERATE is not as it ",
    ),
    "other set": ("2.4, 2.6, 0.9", "2.4, 2.6, -0.1", 3, "the conditions of step 2 of the model"),
    "other load": (
        "PLATE, 2, 2, -0.4",
        "PLATE, 2, 2, -0.5",
        2,
        r"job.inp:\d+:1: error: \*BOUNDARY",
    ),
    "early expectation": (
        "TIME=1.5",
        "TIME=1.25",
        2,
        r"job.inp:\d+: error: an \*EXPECT at time 1.25",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_only_safe_changes_are_accepted(run_tessera, tmp_path, case):
    old, new, code, message = REFUSALS[case]
    deck = PLATE.replace("*CONTROLS, MAX", "*RESTART, WRITE, FREQUENCY=3\n*CONTROLS, MAX")
    assert run_tessera(deck, "-q").code == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert old in deck
    run = run_tessera(deck.replace(old, new), "-q", "--restart", "job.restart.1.h5")
    assert run.code == code
    assert re.search(message, run.stderr), run.stderr
    for name in ("job.vtkhdf", "job_mesh.vtkhdf", "job_history.csv", "job.sta", GO_ON):
        assert (tmp_path / name).read_bytes() == before[name]


def test_other_formulation_is_refused(run_tessera):
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    assert run_tessera(deck, "-q").code == 0
    run = run_tessera(deck, "-q", "--compare", "fbar", "--restart", GO_ON)
    assert run.code == 2
    assert "is of a run with formulation standard" in run.stderr


def test_one_formulation_of_a_comparison_goes_on(run_tessera, tmp_path):
    assert run_tessera(CUBE, "-q", "--compare", "fbar", "-o", "whole").code == 0
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "job_fbar.stop").touch()
    assert run_tessera(CUBE, "-q", "--compare", "fbar", "-o", "parts").code == 130
    run = run_tessera(
        CUBE, "-q", "--compare", "fbar", "-o", "parts", "--restart", "parts/job_fbar.restart.h5"
    )
    assert (run.code, run.stderr) == (0, "")
    assert_same_run(tmp_path / "parts", tmp_path / "whole", "job_fbar")


def test_check_compares_and_writes_nothing(run_tessera, tmp_path):
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    run_tessera(deck, "-q")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    run = run_tessera(deck, "--check", "--restart", "job.restart.1.h5")
    assert run.code == 0
    assert "job.restart.1.h5 belongs to this deck, step 1, increment 5" in run.stdout
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_damaged_files_are_refused(run_tessera, tmp_path):
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    run_tessera(deck, "-q", "-o", "out")
    data = (tmp_path / "out" / GO_ON).read_bytes()
    bad = tmp_path / "bad.h5"
    cases = {
        b"": "is no restart file",
        data[:-1]: "is cut short",
        data[: len(data) // 2]: "is cut short",
        data[:-9] + bytes([data[-9] ^ 4]) + data[-8:]: "is damaged",
        data.replace(b"format 3", b"format 9", 1): "has format '9'",
        b"*HEADING\n": "is no restart file",
    }
    for content, message in cases.items():
        bad.write_bytes(content)
        run = run_tessera(deck, "-q", "--restart", "bad.h5", "-o", "new")
        assert run.code == 8, run.stderr
        assert message in run.stderr
        assert not (tmp_path / "new" / "job.vtkhdf").exists()
    run = run_tessera(deck, "-q", "--restart", "missing.h5")
    assert run.code == 8
    assert "restart file 'missing.h5' cannot be opened" in run.stderr
    run = run_tessera(deck, "-q", "--restart", ".")
    assert run.code == 8


def sealed(path):
    """Makes the seal of a restart file right again."""
    data = path.read_bytes()[512:]
    seal = "Tessera restart file\nformat 3\n"
    seal += f"length {len(data)}\nchecksum {zlib.crc32(data):08X}\n"
    path.write_bytes(seal.encode().ljust(512) + data)


@pytest.mark.parametrize("kind", ["link", "external", "filter"])
def test_values_in_other_files_are_not_followed(run_tessera, tmp_path, kind):
    """A file made by hand with a right seal: it may name a pipe that is never written to."""
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    run_tessera(deck, "-q", "-o", "out")
    path = tmp_path / "bad.h5"
    shutil.copy(tmp_path / "out" / GO_ON, path)
    os.mkfifo(tmp_path / "pipe")
    with h5py.File(path, "r+") as file:
        value = file["point_x"][()]
        del file["point_x"]
        if kind == "link":
            file["point_x"] = h5py.ExternalLink(str(tmp_path / "pipe"), "/point_x")
        elif kind == "external":
            storage = [(str(tmp_path / "pipe"), 0, value.nbytes)]
            file.create_dataset("point_x", value.shape, value.dtype, external=storage)
        else:
            file.create_dataset("point_x", data=value, compression="gzip")
    sealed(path)
    run = run_tessera(deck, "-q", "--restart", "bad.h5", "-o", "new", timeout=30)
    assert run.code == 8
    assert "bad.h5' does not fit: point_x: expected " in run.stderr


def test_texts_of_a_restart_file_are_printable(run_tessera, tmp_path):
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    run_tessera(deck, "-q", "-o", "out")
    path = tmp_path / "bad.h5"
    shutil.copy(tmp_path / "out" / GO_ON, path)
    with h5py.File(path, "r+") as file:
        file["formulation"][0:5] = list(b"\x1b[31m")
    sealed(path)
    run = run_tessera(deck, "-q", "--restart", "bad.h5", "-o", "new")
    assert run.code == 2
    assert "\x1b" not in run.stderr


def test_used_up_increments_stay_used_up(run_tessera):
    deck = CUBE.replace("*STEP, NAME=PUSH", "*STEP, NAME=PUSH, INC=7").replace(
        "1.0, 6.0", "0.5, 3.0"
    )
    deck = deck.replace("*STATIC, DIRECT", "*STATIC").replace("INC=7", "INC=2")
    assert run_tessera(deck, "-q").code == 4
    run = run_tessera(deck, "-q", "--restart", GO_ON)
    assert run.code == 4
    assert "2 increments done" in run.stderr
    assert "increment 2," in run.stderr


def test_force_overwrites_nothing_on_a_restart(run_tessera, tmp_path):
    deck = CUBE.replace("*HISTORY", "*RESTART, WRITE\n*HISTORY")
    run_tessera(deck, "-q")
    history = (tmp_path / "job_history.csv").read_bytes()
    (tmp_path / "job.sta").unlink()
    run = run_tessera(deck, "-q", "--restart", "job.restart.1.h5", "--force")
    assert run.code == 8
    assert (tmp_path / "job_history.csv").read_bytes() == history
