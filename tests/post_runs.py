"""What the tests of tessera-post share: results of small runs and of the examples."""

import os
import subprocess
import sys

import pytest
from conftest import ROOT
from tessera_post.cli import main
from test_examples import METHODS, run_once

BAR_DECK = """\
*HEADING
{heading}
*UNITS, LENGTH=m, FORCE=kN
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC, ELSET=BAR
X, 0, 4, 4
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=STEEL
*ELASTIC
1000.0, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
{strength}
*MATERIAL POINTS, ELSET=BAR, MATERIAL=STEEL, PER ELEMENT=3
*MOVING MESH, DRIVER=X1, DIRECTION=1,0,0, FIXED=X0
*STEP, NAME=PULL, INC={inc}
*STATIC, DIRECT
{size}, 1.0
*BOUNDARY
X0, 1, 1
Y0, 2, 2
X1, 1, 1, 0.4
*HISTORY, NSET=X1
RF, U
*OUTPUT, FIELD, FREQUENCY={every}
{fields}
{expect}
*END STEP
"""
ALL_FIELDS = "S, TAU, LE, PEEQ, F, J, JBAR, U, VOL, MAT, PATCH, ELEMENT, ID"


def bar_deck(heading="Plastic bar", strength="20.0", inc=50, size=0.25, every=1, expect=None):
    """A bar of 4 x 1 in plane strain, pulled by 0.4."""
    text = BAR_DECK.format(
        heading=heading,
        strength=strength,
        inc=inc,
        size=size,
        every=every,
        fields=ALL_FIELDS,
        expect=expect or "",
    )
    return "\n".join(line for line in text.splitlines() if line) + "\n"


@pytest.fixture(scope="session")
def run_deck(tessera_release):
    """run_deck(folder, deck, *options, name="bar"): runs a deck; the path of the job."""

    def run(folder, deck, *options, name="bar", code=0):
        (folder / f"{name}.inp").write_text(deck, encoding="utf-8")
        command = [str(tessera_release), "-q", "-f", *options, f"{name}.inp"]
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        assert result.returncode == code, result.stderr
        return folder / name

    return run


@pytest.fixture(scope="session")
def bar(run_deck, tmp_path_factory):
    """The bar: 4 increments, 2-D, all fields."""
    return run_deck(tmp_path_factory.mktemp("bar"), bar_deck())


@pytest.fixture(scope="session")
def single(run_deck, tmp_path_factory):
    """The bar in a single increment."""
    return run_deck(tmp_path_factory.mktemp("single"), bar_deck(size=1.0))


def run_and_kill(program, folder, after):
    """Kills the bar, which has 2,000 increments, after some; the path of the job."""
    (folder / "bar.inp").write_text(bar_deck(inc=2000, size=5e-4), encoding="utf-8")
    kill_after(program, folder, after)
    return folder / "bar"


def kill_after(program, folder, after):
    """Runs the bar and kills it after some increments."""
    status = folder / "bar.sta"
    status.unlink(missing_ok=True)
    command = [str(program), "-q", "--publish", "0", "-f", "bar.inp"]
    with subprocess.Popen(command, cwd=folder) as process:
        while not status.exists() or status.read_text().count("\n") < after:
            assert process.poll() is None
        process.kill()


@pytest.fixture(scope="session")
def killed(tessera_release, tmp_path_factory):
    """The bar, killed after some increments of 2,000."""
    return run_and_kill(tessera_release, tmp_path_factory.mktemp("killed"), after=12)


@pytest.fixture(scope="session")
def example(tessera_release, tmp_path_factory):
    """example(name, method): path of the job of a shipped example; the runs are shared."""

    def job(name, method):
        base = tmp_path_factory.getbasetemp()
        if "PYTEST_XDIST_WORKER" in os.environ:
            base = base.parent
        assert method in METHODS
        assert run_once(name, tessera_release, base / name) == ""
        return base / name / f"{name}_{method}"

    return job


@pytest.fixture(autouse=True)
def close_figures():
    """Frees the figures that a test has looked at."""
    yield
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


@pytest.fixture
def post(capsys):
    """post(*arguments): runs tessera-post in this process; exit code, stdout, stderr."""

    def run(*arguments):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as end:  # argparse
            code = end.code
        captured = capsys.readouterr()
        return code, captured.out, captured.err

    return run


def deck_of(name):
    """Path of the deck of a shipped example."""
    return ROOT / "input" / name / f"{name}.inp"
