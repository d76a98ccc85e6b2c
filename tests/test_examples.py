"""The three examples with both formulations: the numbers that must hold."""

import itertools
import os
import shutil
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import ROOT

METHODS = ("standard", "fbar")
LIMIT_OF_STRIP = (2.0 + np.pi) * 1.0 * 0.5  # (2 + pi) c B [kN/m]


class Results:
    """What a run of one formulation wrote."""

    def __init__(self, folder, job):
        with h5py.File(folder / f"{job}.vtkhdf") as file:
            tessera = file["tessera"]
            self.history = {name: column[()] for name, column in tessera["history"].items()}
            self.iterations = {name: column[()] for name, column in tessera["iterations"].items()}
            self.ledger = {name: column[()] for name, column in tessera["ledger"].items()}
        self.points = folder / f"{job}.vtkhdf"
        self.log = (folder / f"{job}.log").read_text(encoding="utf-8")

    def reaction(self, label, displacement):
        """Reaction at a displacement that is the end of an increment."""
        axis = label[2]
        moved = np.abs(self.history["U" + label[2:]])
        row = np.argmin(np.abs(moved - displacement))
        assert moved[row] == pytest.approx(displacement, rel=1e-9), f"no increment, axis {axis}"
        return abs(self.history[label][row])

    def field(self, name, when):
        """Values of a point field at a total time."""
        with h5py.File(self.points) as file:
            grid = file["VTKHDF"]
            times = grid["Steps/Values"][()]
            step = np.argmin(np.abs(times - when))
            assert times[step] == pytest.approx(when, abs=1e-9)
            first = grid[f"Steps/PointDataOffsets/{name}"][step]
            count = grid["NumberOfPoints"][grid["Steps/PartOffsets"][step]]
            return grid["PointData"][name][first : first + count]

    def newton(self):
        """Residuals of every attempt, one array per attempt, in order."""
        keys = np.stack([self.iterations[name] for name in ("step", "increment", "attempt")])
        starts = np.flatnonzero(np.any(np.diff(keys, axis=1) != 0, axis=0)) + 1
        return np.split(self.iterations["residual"], starts)


def run_once(example, program, folder):
    """Runs an example with both formulations; parallel test workers share one run."""
    try:
        folder.mkdir()
    except FileExistsError:
        while not (folder / "finished").exists():
            time.sleep(0.2)
        return (folder / "finished").read_text()
    message = "the run was interrupted"
    try:
        command = [program, "--compare", "standard,fbar", "-q", "-o", folder, f"{example}.inp"]
        run = subprocess.run(
            list(map(str, command)),
            cwd=ROOT / "input" / example,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            timeout=1800,
            check=False,
        )
        message = "" if run.returncode == 0 else f"exit code {run.returncode}\n{run.stderr}"
    finally:
        (folder / "finished").write_text(message)
    return message


def results_of(example, program, tmp_path_factory):
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent
    message = run_once(example, program, base / example)
    assert message == ""
    return {method: Results(base / example, f"{example}_{method}") for method in METHODS}


@pytest.fixture(scope="module")
def footing(tessera_release, tmp_path_factory):
    return results_of("footing", tessera_release, tmp_path_factory)


@pytest.fixture(scope="module")
def stretch(tessera_release, tmp_path_factory):
    return results_of("stretch", tessera_release, tmp_path_factory)


@pytest.fixture(scope="module")
def strip(tessera_release, tmp_path_factory):
    return results_of("strip-footing", tessera_release, tmp_path_factory)


def checkerboard(results, when):
    """Rms of an element's mean pressure about the mean of its patch."""
    pressure = -results.field("S", when)[:, :3].mean(axis=1)
    element = results.field("ELEMENT", when)
    patch = results.field("PATCH", when)
    elements, group = np.unique(element, return_inverse=True)
    count = np.bincount(group)
    of_element = np.bincount(group, pressure) / count
    patch_of = np.zeros(len(elements), dtype=int)
    patch_of[group] = patch
    n_elements = np.bincount(patch_of)
    with np.errstate(invalid="ignore"):
        of_patch = np.bincount(patch_of, of_element) / n_elements
    return np.sqrt(np.mean((of_element - of_patch[patch_of]) ** 2))


@pytest.mark.parametrize("example", ["footing", "stretch"])
def test_two_threads_give_the_same_bits(example, request, tessera_release, tmp_path):
    one = request.getfixturevalue(example)
    command = [tessera_release, "--compare", "standard,fbar", "-q", "-t", "2", "-o", tmp_path]
    run = subprocess.run(
        [*map(str, command), f"{example}.inp"], cwd=ROOT / "input" / example, check=False
    )
    assert run.returncode == 0
    for method in METHODS:
        two = Results(tmp_path, f"{example}_{method}")
        for name, column in one[method].history.items():
            np.testing.assert_array_equal(two.history[name], column, err_msg=name)
        for name in ("step", "increment", "attempt", "iteration", "residual"):
            np.testing.assert_array_equal(two.iterations[name], one[method].iterations[name])
        last = one[method].history["time"][-1]
        for name in ("S", "TAU", "LE", "PEEQ"):
            np.testing.assert_array_equal(two.field(name, last), one[method].field(name, last))


# --- footing -------------------------------------------------------------------------------------


def test_footing_reaches_limit_load_with_fbar(footing):
    at_1, at_2 = (footing["fbar"].reaction("RF3[FOOTING]", mm * 1e-3) for mm in (1.0, 2.0))
    assert at_2 < 1.03 * at_1
    assert 0.65 < at_2 < 0.80


def test_footing_locks_with_standard_method(footing):
    at_1, at_2 = (footing["standard"].reaction("RF3[FOOTING]", mm * 1e-3) for mm in (1.0, 2.0))
    assert at_2 > 1.25 * at_1
    assert at_2 > 2.0 * footing["fbar"].reaction("RF3[FOOTING]", 2e-3)


@pytest.mark.parametrize("method", METHODS)
def test_footing_is_in_equilibrium_with_base(footing, method):
    history = footing[method].history
    np.testing.assert_allclose(
        history["RF3[BASE]"], -history["RF3[FOOTING]"], rtol=1e-8, atol=1e-12
    )


def test_footing_pressure_is_no_checkerboard_with_fbar(footing):
    assert checkerboard(footing["standard"], 1.0) > 50.0 * checkerboard(footing["fbar"], 1.0)


def test_footing_takes_20_increments_of_few_iterations(footing):
    """At first from rest, then from the last increment, which spares about half of them."""
    attempts = footing["fbar"].newton()
    assert len(attempts) == 20
    assert (footing["fbar"].iterations["attempt"] == 1).all()
    corrections = [residual.size - 1 for residual in attempts]
    assert corrections[0] >= 5
    assert max(corrections) <= 8
    assert sum(corrections[10:]) <= 40


def test_footing_keeps_all_points(footing):
    for method in METHODS:
        ledger = footing[method].ledger
        assert (ledger["count"] == 522 * 8 * 11).all()
        assert (ledger["lost"] == 0).all()


def test_newton_is_quadratic_in_every_increment_of_footing(footing):
    pairs = []
    for residual in footing["fbar"].newton():
        # The first correction from rest carries the prescribed displacement.
        pairs += [(a, b) for a, b in itertools.pairwise(residual[1:]) if 1e-5 < a < 1e-3]
    assert len(pairs) >= 20
    for before, after in pairs:
        assert after < 100.0 * before**2, (before, after)


# --- stretch -------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_stretch_takes_17_increments_without_cut(stretch, method):
    assert len(stretch[method].newton()) == 17
    assert stretch[method].history["U3[Z1]"][-1] == pytest.approx(6.8, rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_stretch_begins_with_yield_stress_everywhere(stretch, method):
    np.testing.assert_allclose(stretch[method].field("TAU", 1.0)[:, 2], 400.0, rtol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_stretch_keeps_mean_of_yield_stress(stretch, method):
    means = [stretch[method].field("TAU", t)[:, 2].mean() for t in range(1, 12)]
    np.testing.assert_allclose(means, 400.0, rtol=0.005)


def test_stretch_scatters_little_with_fbar(stretch):
    scatter = [stretch["fbar"].field("TAU", t)[:, 2].std() for t in range(1, 12)]
    assert max(scatter) < 0.02 * 400.0
    assert scatter[-1] < 0.5 * stretch["standard"].field("TAU", 11.0)[:, 2].std()


# --- strip footing -------------------------------------------------------------------------------


def test_strip_footing_reaches_prandtls_load_with_fbar(strip):
    reaction = abs(strip["fbar"].history["RF2[FOOTING]"])
    assert reaction[-1] == pytest.approx(LIMIT_OF_STRIP, rel=0.025)
    assert reaction[-1] < 1.005 * strip["fbar"].reaction("RF2[FOOTING]", 2e-3)


def test_strip_footing_is_too_strong_with_standard_method(strip):
    assert abs(strip["standard"].history["RF2[FOOTING]"][-1]) > 1.1 * LIMIT_OF_STRIP


# --- the decks as such ---------------------------------------------------------------------------


@pytest.mark.parametrize("example", ["footing", "stretch", "strip-footing"])
def test_decks_pass_check_and_tell_analytic_from_frozen(example, tessera, run_program, tmp_path):
    folder = tmp_path / example
    shutil.copytree(ROOT / "input" / example, folder)
    run = run_program(tessera, "--check", folder / f"{example}.inp")
    assert (run.code, "error" in run.stderr) == (0, False), run.stderr
    deck = Path(folder / f"{example}.inp").read_text()
    assert "\nanalytic," in deck
    assert "\nfrozen," in deck


@pytest.mark.parametrize("example", ["footing", "stretch", "strip-footing"])
def test_tangents_of_examples_agree_with_differences(
    example, tessera_release, run_program, tmp_path
):
    deck = ROOT / "input" / example / f"{example}.inp"
    run = run_program(tessera_release, "--check-tangent", "-o", tmp_path, deck)
    assert run.code == 0, run.stderr


def test_deck_of_the_readme_runs(tessera, run_program, tmp_path):
    readme = (ROOT / "README.md").read_text()
    deck = readme[readme.index("*HEADING") : readme.index("*END STEP")] + "*END STEP\n"
    (tmp_path / "bar.inp").write_text(deck)
    run = run_program(tessera, "-q", "bar.inp")
    assert (run.code, run.stderr) == (0, "")
