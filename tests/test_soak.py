"""tools/soak: its parts, what it prints and how it ends."""

import subprocess
import sys
from collections import Counter

import pytest
from conftest import ROOT
from soaking.determinism import Settings, judge, run_once
from soaking.parts import SoakError, check_fuzz, check_kills, run_command, scaled
from test_determinism import BAR


def soak(*arguments):
    command = [sys.executable, ROOT / "tools" / "soaking", *arguments]
    run = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    return run.returncode, run.stdout, run.stderr


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "bar.inp"
    path.write_text(BAR)
    return path


def test_full_length_is_scaled_but_never_empty():
    assert [scaled(20, scale) for scale in (1.0, 0.5, 0.01)] == [20, 10, 1]


# --- determinism ---------------------------------------------------------------------------------


def test_soak_runs_a_deck_and_prints_the_figures(tessera, deck, tmp_path):
    options = ["--exe", tessera, "--deck", deck, "-o", tmp_path / "out"]
    code, out, err = soak("determinism", "--scale", "0.1", *options)
    assert code == 0, out + err
    assert err == "".join(f"determinism: round {i} of 2, checksums 1\n" for i in (1, 2))
    lines = out.splitlines()
    assert lines[0] == "determinism:"
    assert lines[1] == "  runs of bar: 6 (2 with 1 threads, 2 with 2 threads, 2 with 4 threads)"
    assert lines[2].startswith("  checksums: 1 (")
    assert lines[3].startswith("  passed (")
    assert lines[4].startswith("soak: 1 parts, scale 0.1, ")
    assert lines[4].endswith(": passed")


def test_two_checksums_fail():
    part = judge("bar", Counter({(1, "a" * 64): 20, (2, "a" * 64): 19, (2, "b" * 64): 1}))
    assert part.figures[0] == "runs of bar: 40 (20 with 1 threads, 20 with 2 threads)"
    assert part.failed == [
        "expected one checksum, found 2: 20 x 1 threads " + "a" * 16 + ", 19 x 2 threads "
        + "a" * 16 + ", 1 x 2 threads " + "b" * 16
    ]  # fmt: skip
    assert part.text().splitlines()[-1] == "  FAILED"


def test_deck_that_does_not_run_fails_the_part(tessera, deck, tmp_path):
    deck.write_text(BAR.replace("*ELASTIC", "*PLASTIK"))
    options = ["--exe", tessera, "--deck", deck, "-o", tmp_path / "out"]
    code, out, _ = soak("determinism", "--scale", "0.01", *options)
    assert code == 1
    assert "  FAILED: bar.inp ended with exit code 2: bar.inp:" in out
    assert out.splitlines()[-1].endswith(": FAILED: determinism")


def test_surroundings_do_not_decide_the_threads(tessera, deck, tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.setenv("OMP_THREAD_LIMIT", "1")
    settings = Settings(tessera, deck, tmp_path / "out")
    assert run_once(settings, 2) == run_once(settings, 1)


# --- parts that other programs carry out ---------------------------------------------------------

KILL_TEST = """\
import os


def test_kills():
    n = int(os.environ["TESSERA_KILLS"])
    print(f"kills tried {{n}}, survived {{n - {lost}}}")
    assert {good}
"""


@pytest.mark.parametrize(
    ("lost", "good", "n_failed"), [(0, True, 0), (1, True, 1), (0, False, 1), (1, False, 2)]
)
def test_kills_are_counted(lost, good, n_failed, tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "test_kill.py").write_text(KILL_TEST.format(lost=lost, good=good))
    part = check_kills(tmp_path, sys.executable, tmp_path, 0.01)
    assert part.figures == [f"kills tried 10, survived {10 - lost}"]
    assert len(part.failed) == n_failed, part.failed


def test_kill_test_that_is_not_there_fails(tmp_path):
    part = check_kills(tmp_path, sys.executable, tmp_path, 0.01)
    assert part.figures == ["kills tried 0, survived 0"]
    assert len(part.failed) == 2


@pytest.mark.parametrize("code", [0, 1])
def test_fuzz_is_asked_for_its_share(code, tmp_path):
    (tmp_path / "tools").mkdir()
    script = tmp_path / "tools" / "fuzz"
    script.write_text(f'#!/bin/sh\necho "arguments $*"\necho "no crash"\nexit {code}\n')
    script.chmod(0o755)
    part = check_fuzz(tmp_path, 7, 0.001)
    options = "--seed 7 --decks 1000 --meshes 100 --restarts 20"
    assert part.figures == [f"tools/fuzz {options}", f"arguments {options}", "no crash"]
    expected = [f"tools/fuzz ended with exit code {code}: no crash"] if code else []
    assert part.failed == expected


def test_program_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(SoakError, match=r"tools/none: No such file"):
        run_command(["tools/none"], tmp_path)


# --- the command line ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sleep"], "there is no part 'sleep': expected some of kills, fuzz, determinism"),
        (["--scale", "0"], "expected a number above 0, at most 1, found 0"),
        (["--scale", "2"], "expected a number above 0, at most 1, found 2"),
        (["--scale", "a"], "expected a number above 0, at most 1, found a"),
        (["--exe", "none"], "there is no program '"),
        (["--exe", sys.executable, "--deck", "none.inp"], "there is no deck 'none.inp'"),
    ],
)
def test_wrong_arguments_are_refused(arguments, message):
    code, out, err = soak(*arguments)
    assert (code, out) == (2, "")
    assert message in err
