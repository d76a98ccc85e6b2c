"""SIGKILL at any moment: every result file stays readable up to the last accepted increment, and
the run can go on from its restart file.

TESSERA_KILLS is the number of moments, 50 by default. The run prints how many it survived.
"""

import csv
import os
import random
import re
import time

import pytest
import pyvista
from small_runs import (
    FILES,
    JOB,
    Disturbance,
    SmallRun,
    build_faults,
    check_part,
    check_tables,
    check_whole,
    complete_lines,
    contents,
    n_converged,
)
from tessera_post.job import open_job

N_KILLS = int(os.environ.get("TESSERA_KILLS", "50"))
SIGKILLED = -9
SEED = 20260


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return build_faults(tmp_path_factory.mktemp("library"))


def check_texts(folder, whole):
    """Lines of the status file and the history are those of a whole run as far as they go."""
    lines = complete_lines(folder / f"{JOB}_history.csv")
    expected = complete_lines(whole / f"{JOB}_history.csv")
    assert lines == expected[: len(lines)]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert all(float(row["time"]) >= 0.0 for row in rows)
    for line in complete_lines(folder / f"{JOB}.sta")[1:]:
        assert len(line.split()) >= 13
    return len(rows) - 1


def check_remains(folder, whole, expected, draw):
    """Everything that must hold of the files after a kill."""
    found = [contents(folder / name) for name in FILES]
    converged = n_converged(folder)
    written = check_texts(folder, whole)
    if found[0] is None:
        assert converged == 0
        return
    n_steps = check_part(found[0], expected[0], FILES[0])
    n_increments = check_tables(found[0], FILES[0])
    assert converged - 1 <= n_increments <= converged
    assert n_increments <= written
    assert n_steps == n_increments + 1
    if found[1] is not None:
        assert n_steps - 1 <= check_part(found[1], expected[1], FILES[1]) <= n_steps
    else:
        assert n_increments == 0
    job = open_job(str(folder / JOB))
    assert job.n_increments == n_increments
    assert job.points.note == ""
    assert len(job.points.field("S", job.output_of())) == job.points.n_points(job.output_of())
    job.close()
    if draw:
        for name in [name for name, data in zip(FILES, found) if data]:
            reader = pyvista.get_reader(str(folder / name)).reader
            for step in range(reader.GetNumberOfSteps()):
                reader.SetStep(step)
                reader.Update()


def check_restart(killed, whole):
    """Goes on from the restart file if there is one: the results are those of a whole run."""
    process = killed.go_on()
    if process is None:
        assert n_converged(killed.folder) <= 2
        return False
    assert (process.returncode, process.stderr) == (0, "")
    check_whole(killed, whole)
    return True


def test_killed_run_leaves_whole_files(tessera, library, tmp_path):
    """Kills before, in the middle of and after calls that write, and a few at random times."""
    whole = SmallRun(tessera, library, tmp_path / "whole")
    start = time.monotonic()
    assert whole.run().returncode == 0
    duration = time.monotonic() - start
    expected = whole.results
    killed = SmallRun(tessera, library, tmp_path / "killed")
    moments = random.Random(SEED)
    survived = went_on = 0
    for i in range(N_KILLS):
        killed.clear()
        if i % 10 == 9:
            with killed.start() as process:
                time.sleep(moments.uniform(0.0, duration))
                process.kill()
            assert process.returncode in (SIGKILLED, 0)
        else:
            do = moments.choice(("kill-before", "kill-half", "kill-half", "kill-after"))
            fault = Disturbance(do, moments.randrange(1, whole.n_calls + 1))
            assert killed.run(fault).returncode == SIGKILLED, fault
        check_remains(killed.folder, whole.folder, expected, draw=i % 10 == 0)
        if i % 3 == 0:
            went_on += check_restart(killed, whole)
        survived += 1
    print(f"kills tried {N_KILLS}, survived {survived}, gone on from {went_on}")
    assert went_on > N_KILLS // 10
    killed.clear()
    assert killed.run().returncode == 0
    check_remains(killed.folder, whole.folder, expected, draw=False)
    assert not list(killed.folder.glob("*.next"))


def test_killed_restart_can_be_gone_on_from(tessera, library, tmp_path):
    """A run that goes on from a restart file is killed as well, mostly while it takes over the
    files of the first one, and goes on once more."""
    whole = SmallRun(tessera, library, tmp_path / "whole")
    assert whole.run().returncode == 0
    moments = random.Random(SEED)
    run = SmallRun(tessera, library, tmp_path / "run")
    for _ in range(8):
        run.clear()
        first = Disturbance(
            "kill-half", moments.randrange(whole.n_calls // 2, whole.n_calls * 9 // 10)
        )
        assert run.run(first).returncode == SIGKILLED, first
        for _ in range(2):
            do = moments.choice(("kill-before", "kill-half", "kill-after"))
            second = Disturbance(do, moments.randrange(1, 300))
            assert run.go_on(second).returncode == SIGKILLED, (first, second)
        assert check_restart(run, whole)


def check_lag(folder, whole, expected):
    """What must hold after a kill of results that are published from time to time: whole files
    with the first increments, all those that a restart file stands for; how many they lack."""
    found = [contents(folder / name) for name in FILES]
    converged = n_converged(folder)
    written = check_texts(folder, whole)
    log = "\n".join(complete_lines(folder / f"{JOB}.log"))
    needed = [int(n) for n in re.findall(r"restart file .* written at .* increment (\d+),", log)]
    if found[0] is None:
        assert converged == 0
        return 0
    n_steps = check_part(found[0], expected[0], FILES[0])
    n_increments = check_tables(found[0], FILES[0])
    assert n_steps == n_increments + 1
    assert max(needed, default=0) <= n_increments <= min(converged, written)
    if found[1] is not None:
        assert max(needed, default=0) + 1 <= check_part(found[1], expected[1], FILES[1]) <= n_steps
    job = open_job(str(folder / JOB))
    assert job.n_increments == n_increments
    job.close()
    return converged - n_increments


@pytest.mark.parametrize("publish", ["", "1000"])
def test_results_that_lag_are_whole_after_a_kill(tessera, library, tmp_path, publish):
    """With the default, and published before restart files and at the end only."""
    whole = SmallRun(tessera, library, tmp_path / "whole", publish=publish)
    assert whole.run().returncode == 0
    expected = whole.results
    killed = SmallRun(tessera, library, tmp_path / "killed", publish=publish)
    moments = random.Random(SEED)
    lags, went_on = [], 0
    for i in range(20):
        killed.clear()
        do = moments.choice(("kill-before", "kill-half", "kill-after"))
        # With a clock in the run not every run has the same calls.
        fault = Disturbance(do, moments.randrange(1, whole.n_calls + 1))
        assert killed.run(fault).returncode in (SIGKILLED, 0), fault
        lags.append(check_lag(killed.folder, whole.folder, expected))
        if i % 3 == 0:
            went_on += check_restart(killed, whole)
    assert went_on >= 3
    if publish:
        assert max(lags) >= 2


def test_long_increment_does_not_hide_the_last(tessera, library, tmp_path):
    """Two increments, of which only the second takes time: the first one, which is not due when it
    is accepted, appears between iterations, the second one at the end. Each publication exchanges
    two files, but for the very first."""
    clock = build_faults(tmp_path, "clock_faults")
    run = SmallRun(tessera, f"{clock}:{library}", tmp_path / "run", size=0.5, publish="")
    assert run.run(Disturbance("0", 0, calls="exchange")).returncode == 0
    assert check_tables(run.results[0], FILES[0]) == 2
    assert run.n_calls == 4


@pytest.mark.parametrize("calls", ["exchange", "exchange,link"])
def test_file_system_that_cannot_exchange_names(tessera, library, tmp_path, calls):
    """The old file gets a second name, or there is a new copy each time; kills spoil nothing."""
    whole = SmallRun(tessera, library, tmp_path / "whole")
    assert whole.run().returncode == 0
    other = SmallRun(tessera, library, tmp_path / "other")
    result = other.run(Disturbance("22", 1, 1_000_000, calls))
    assert result.returncode == 0, result.stderr
    check_whole(other, whole)
    left = sorted(path.name for path in other.folder.iterdir())
    assert not [name for name in left if name.endswith((".next", ".former"))]
