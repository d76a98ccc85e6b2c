"""The log of a run: what is told, and logs that end anywhere."""

import pytest
from post_runs import bar_deck
from tessera_post.log import Attempt, Verdict, parse_log, read_log

EXPECT = """\
*EXPECT, QUANTITY=RF, SET=X1, COMPONENT=1, TIME=0.6
analytic, 55.0, 0.01
frozen, 20.0, 10.0
*EXPECT, QUANTITY=PEEQ, STATISTIC=MAX
frozen, 0.1, 10.0"""


def log_of(job):
    return read_log(job.parent / f"{job.name}.log")


@pytest.fixture(scope="session")
def missed(run_deck, tmp_path_factory):
    """The bar with expectations, one of which it misses."""
    folder = tmp_path_factory.mktemp("missed")
    return run_deck(folder, bar_deck(expect=EXPECT), code=7)


@pytest.fixture(scope="session")
def lost(run_deck, tmp_path_factory):
    """The bar, pushed until points are lost before any expectation is reached."""
    folder = tmp_path_factory.mktemp("lost")
    return run_deck(folder, bar_deck(expect=EXPECT).replace(", 0.4\n", ", -4.9\n"), code=6)


@pytest.fixture(scope="session")
def stuck(run_deck, tmp_path_factory):
    """The bar, with too few iterations to converge."""
    deck = bar_deck().replace("*BOUNDARY", "*CONTROLS, MAX ITERATIONS=2\n*BOUNDARY", 1)
    deck = deck.replace("0.25, 1.0", "0.25, 1.0, 0.1")
    return run_deck(tmp_path_factory.mktemp("stuck"), deck, code=4)


def test_settings_model_and_sets_are_told(bar):
    log = log_of(bar)
    assert log.settings[0] == "formulation: F-bar patch"
    assert "mesh: moving, driver 3 nodes, fixed 3 nodes, direction 1 0 0" in log.settings
    assert any("Newton: tolerance 1e-9" in line for line in log.settings)
    assert log.model[0] == "mesh: 27 nodes, 32 linear elements, volume 4"
    assert log.model[1] == "points: 96, volume 4, mass 0"
    assert not any("PLASTIC" in line for line in log.model)
    assert "nodes X1: 3" in log.sets
    assert "elements BAR: 32, volume 4" in log.sets
    assert log.warnings == ""


def test_attempts_have_their_times_and_outcomes(bar):
    log = log_of(bar)
    assert [(a.step, a.increment, a.attempt, a.time, a.size) for a in log.attempts] == [
        (1, i, 1, i / 4, 0.25) for i in (1, 2, 3, 4)
    ]
    assert all(a.converged for a in log.attempts)
    assert log.attempts[0].outcome.startswith("converged after ")
    assert (log.messages, log.exit_code) == ([], 0)


def test_failed_attempts_and_the_message_at_the_end_are_told(stuck):
    log = log_of(stuck)
    assert len(log.attempts) >= 2
    first = log.attempts[0]
    assert isinstance(first, Attempt)
    assert (first.attempt, first.converged) == (1, False)
    assert first.outcome.startswith("too many iterations after 2 iterations, worst node ")
    assert log.attempts[1].attempt == 2
    assert log.attempts[1].size < first.size
    assert len(log.messages) == 1
    told = log.messages[0].splitlines()
    assert told[0].startswith("error: no convergence at the smallest increment 0.1: ")
    assert told[1].startswith("  worst place: node ")
    assert any(line.startswith("  likely cause: MAX ITERATIONS=2 ") for line in told)
    assert told[-1].startswith("  last attempt: ")
    assert log.exit_code == 4


def test_warnings_are_told_with_their_lines(run_deck, tmp_path):
    deck = bar_deck().replace("*STEP,", "*NSET, NSET=IDLE\n1\n*NSET, NSET=LAZY\n1\n*STEP,")
    log = log_of(run_deck(tmp_path, deck, "--lax"))
    line = deck.splitlines().index("*NSET, NSET=IDLE") + 1
    assert log.warnings.splitlines()[:3] == [
        f"bar.inp:{line}:1: warning: nothing uses node set 'IDLE'",
        f"   {line} | *NSET, NSET=IDLE",
        "      | ^~~~~",
    ]
    assert "nothing uses node set 'LAZY'" in log.warnings
    assert log.settings[0] == "formulation: F-bar patch"


def test_verdicts_are_met_or_failed(missed):
    log = log_of(missed)
    line = bar_deck(expect=EXPECT).splitlines().index("analytic, 55.0, 0.01") + 1
    first = log.verdicts[0]
    assert first == Verdict(
        place=f"bar.inp:{line}",
        what="SUM RF1[X1]",
        time="0.6",
        kind="analytic",
        value="55",
        tolerance="0.55",
        found=first.found,
        met=False,
    )
    assert 15.0 < float(first.found) < 25.0
    assert [(v.kind, v.what, v.met) for v in log.verdicts[1:]] == [
        ("frozen", "SUM RF1[X1]", True),
        ("frozen", "MAX PEEQ", True),
    ]
    assert log.exit_code == 7
    assert "expectations: 3, failed 1" in log.summary
    assert not any(line.startswith("EXPECT") for line in log.summary)


def test_verdict_of_a_time_that_was_not_reached_has_failed(lost):
    log = log_of(lost)
    assert [(v.found, v.met) for v in log.verdicts] == [("time not reached", False)] * 3
    assert len(log.messages) == 1
    assert log.messages[0].startswith("error: ")
    assert "material points left the mesh" in log.messages[0]
    assert log.exit_code == 6


def test_summary_is_told(bar):
    log = log_of(bar)
    assert log.summary[0].startswith("reaction of X0: ")
    assert any(line.startswith("CPU seconds: kinematics ") for line in log.summary)
    assert "exit code: 0" not in log.summary


def test_log_of_a_killed_run_has_no_exit_code(killed):
    log = log_of(killed)
    assert log.exit_code is None
    assert len(log.attempts) >= 10
    assert (log.summary, log.verdicts) == ([], [])


@pytest.mark.parametrize("name", ["missed", "lost", "stuck"])
def test_every_beginning_of_a_log_is_read(name, request):
    job = request.getfixturevalue(name)
    text = (job.parent / f"{job.name}.log").read_text()
    whole = parse_log(text)
    for length in range(len(text)):
        log = parse_log(text[:length])
        assert log.exit_code is None
        n_attempts, n_verdicts = len(log.attempts), len(log.verdicts)
        assert log.attempts == whole.attempts[:n_attempts]
        assert log.verdicts == whole.verdicts[:n_verdicts]
        assert "\n".join(whole.messages).startswith("\n".join(log.messages))
        assert log.settings == whole.settings[: len(log.settings)]
        assert log.model == whole.model[: len(log.model)]
        assert log.sets == whole.sets[: len(log.sets)]
    assert whole.exit_code is not None


def test_log_of_a_restarted_run_tells_each_increment_once(bar):
    text = (bar.parent / f"{bar.name}.log").read_text()
    whole = parse_log(text)
    heads = [line for line in text.splitlines() if line.startswith("step 1 increment")]
    interrupted = text[: text.index(heads[3])] + "interrupted\n\nsummary\nexit code: 130\n"
    again = text[text.index(heads[2]) :]
    found = parse_log(f"{interrupted}\nrestarted today from bar.restart.h5\n{again}")
    assert found.attempts == whole.attempts
    assert found.messages == ["interrupted"]
    assert (found.summary, found.exit_code) == (whole.summary, 0)
    assert (found.settings, found.model) == (whole.settings, whole.model)
    unfinished = parse_log(f"{interrupted}\nrestarted today from bar.restart.h5\n")
    assert unfinished.exit_code is None
    assert unfinished.attempts == whole.attempts[:3]


def test_words_of_the_log_in_a_deck_do_not_mislead(run_deck, tmp_path):
    heading = "A bar\nend of deck\n\nsummary\nexit code: 5\nwarnings"
    log = log_of(run_deck(tmp_path, bar_deck(heading=heading)))
    assert log.exit_code == 0
    assert log.warnings == ""
    assert len(log.attempts) == 4


def test_file_without_a_log_and_other_text(tmp_path):
    assert read_log(tmp_path / "no.log") is None
    assert read_log(tmp_path) is None
    (tmp_path / "other.log").write_bytes(b"\xff\xfe\n\nexit code: 0\n")
    assert read_log(tmp_path / "other.log").exit_code is None
