"""--estimate and --max-memory: what is predicted, what is found, and what is refused."""

import os
import re
import subprocess
import sys

import h5py
import pytest
from conftest import ROOT

FOOTING = ROOT / "input" / "footing"

# A block of one column of elements slides half a width into the next: twice the elements then.
SLIDE = """\
*HEADING
Block that slides into the next column of elements
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=LINEAR, ELSET=ALL
X, 0, 3, 3
Y, 0, 1000, 1000
*ELSET, ELSET=BLOCK, BOX
0.0, 1.0, 0.0, 1000.0
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=STEEL
*ELASTIC
1000.0, 0.3
*MATERIAL POINTS, ELSET=BLOCK, MATERIAL=STEEL, PER ELEMENT=3
*STEP, NAME=SLIDE, INC=10
*STATIC, DIRECT
0.5, 1.0
*BOUNDARY
X0, 1, 1, 0.6
Y0, 2, 2
*END STEP
"""

# Runs a command and tells its peak memory, in kB as Linux counts it.
PEAK = """\
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)
"""


def value_of(text, name):
    """The first number of a row of the table."""
    return float(re.search(rf"^ +{name} +(?:about |at most )?([0-9.e-]+)", text, re.M).group(1))


def megabytes_of(text, name):
    """The first amount of memory of a row of the table, in MB."""
    amount, unit = re.search(rf"^ +{name} +([0-9.e-]+) ([MG]B)", text, re.M).groups()
    return float(amount) * (1000.0 if unit == "GB" else 1.0)


def limit_below(tessera, run_program):
    """A limit [GB] that the points alone keep, and the equations do not."""
    table = run_program(tessera, "--lax", "--estimate", "job.inp").stdout
    return round((megabytes_of(table, "memory of the run") - 0.5) * 1e-3, 5)


def footing_of_one_increment(folder):
    """The example with its first increment alone; its mesh stays where it is."""
    deck = (FOOTING / "footing.inp").read_text(encoding="utf-8")
    deck = deck.replace("footing.msh", str(FOOTING / "footing.msh")).replace(
        "0.05, 1.0", "1.0, 1.0"
    )
    deck = deck.replace("3, 3, -0.002", "3, 3, -0.0001")
    path = folder / "footing.inp"
    path.write_text(deck[: deck.index("** Limit analysis")] + "*END STEP\n", encoding="utf-8")
    return path


def test_estimate_writes_nothing(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(SLIDE, encoding="utf-8")
    run = run_program(tessera, "--lax", "--estimate", "-o", "results", "job.inp")
    assert run.code == 0
    assert run.stdout.startswith("job (standard): estimate, nothing was solved\n")
    assert [path.name for path in tmp_path.iterdir()] == ["job.inp"]


def test_estimate_of_both_formulations_is_told(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(
        SLIDE.replace("TYPE=STANDARD", "TYPE=FBAR PATCH\n*PATCH, SOURCE=METIS, SIZE=8"),
        encoding="utf-8",
    )
    run = run_program(tessera, "--lax", "--estimate", "--compare", "standard,fbar", "job.inp")
    assert run.code == 0
    standard, fbar = run.stdout.split("job_fbar (fbar)")
    assert standard.startswith("job_standard (standard)")
    assert value_of(fbar, "nonzeros of the tangent") > value_of(standard, "nonzeros of the tangent")


def test_predicted_memory_is_that_of_the_run(tessera_release, run_program, tmp_path):
    deck = footing_of_one_increment(tmp_path)
    table = run_program(tessera_release, "--estimate", deck).stdout
    assert value_of(table, "unknowns") == 2481
    assert value_of(table, "material points") == 45936
    result = subprocess.run(
        [sys.executable, "-c", PEAK, str(tessera_release), "-q", str(deck)],
        capture_output=True,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        check=True,
    )
    found = float(result.stdout) * 1024e-6
    assert megabytes_of(table, "memory of the run") == pytest.approx(found, rel=0.25)


def test_predicted_results_are_those_of_the_run(tessera_release, run_program, tmp_path):
    deck = footing_of_one_increment(tmp_path)
    table = run_program(tessera_release, "--estimate", deck).stdout
    assert value_of(table, "outputs of fields") == 2
    assert run_program(tessera_release, "-q", deck).code == 0
    stored = []

    def count(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            stored.append(item.size * item.dtype.itemsize)

    for name in ("footing.vtkhdf", "footing_mesh.vtkhdf"):
        with h5py.File(tmp_path / name) as file:
            file.visititems(count)
    predicted = float(re.search(r"on disk .*at most ([0-9.]+) MB", table).group(1))
    assert predicted == pytest.approx(sum(stored) * 1e-6, rel=0.02)


def test_too_large_run_is_refused_before_it_begins(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(SLIDE, encoding="utf-8")
    limit = limit_below(tessera, run_program)
    run = run_program(tessera, "--lax", "--max-memory", limit, "-o", "results", "job.inp")
    assert run.code == 5
    assert re.fullmatch(
        r"error: the run with 6000 material points and 3001 equations needs about [0-9.]+ MB, and "
        r"--max-memory allows [0-9.]+ MB: expected a higher limit, a coarser mesh, fewer points "
        r"per element or smaller patches\n",
        run.stderr,
    )
    assert not (tmp_path / "results").exists()


def test_points_that_do_not_fit_are_refused_at_once(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(SLIDE, encoding="utf-8")
    run = run_program(tessera, "--lax", "--max-memory", "0.031", "--estimate", "job.inp")
    assert (run.code, run.stdout) == (5, "")
    assert "6000 material points and 6000 elements, without its equations, needs" in run.stderr


def test_estimate_above_the_limit_is_told_and_refused(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(SLIDE, encoding="utf-8")
    limit = limit_below(tessera, run_program)
    run = run_program(tessera, "--lax", "--max-memory", limit, "--estimate", "job.inp")
    assert run.code == 5
    assert megabytes_of(run.stdout, "memory of the run") > 1000.0 * limit
    assert "and --max-memory allows" in run.stderr


def test_run_that_grows_beyond_the_limit_can_go_on(tessera, run_program, tmp_path):
    (tmp_path / "job.inp").write_text(SLIDE, encoding="utf-8")
    table = run_program(tessera, "--lax", "--estimate", "job.inp").stdout
    limit = (megabytes_of(table, "memory of the run") + 1.0) * 1e-3
    run = run_program(tessera, "--lax", "-q", "--max-memory", limit, "job.inp")
    assert run.code == 5
    assert "--max-memory allows" in run.stderr
    assert "(step 'SLIDE', increment 2, attempt 1, step time 0.5)" in run.stderr
    again = run_program(tessera, "--lax", "-q", "--restart", "job.restart.h5", "job.inp")
    assert again.code == 0
    assert "2 accepted" in again.read("job.log")
