"""Runs that finish: limit points, limit loads, stretches, predictions, and a penalty that grows."""

import re

import numpy as np
import pytest

# Half of a shallow arch, hinged at its foot; the crown moves up and down. It snaps through.
ARCH = """\
*HEADING
Shallow arch
*NODE
{nodes}
*ELEMENT, TYPE=CPE3, ELSET=ARCH
{elements}
*NSET, NSET=FOOT
1
*NSET, NSET=CROWN
{crown}
*FORMULATION, TYPE=STANDARD
*MOVING MESH, TYPE=LAGRANGIAN
*MATERIAL, NAME=RUBBER
*ELASTIC
1000, 0.3
*MATERIAL POINTS, ELSET=ARCH, MATERIAL=RUBBER, PER ELEMENT=3
*BOUNDARY
FOOT, 1, 2
CROWN, 1, 1
*STEP, INC=200
*STATIC
{static}
{conditions}
*HISTORY, NSET=CROWN
RF, U
*END STEP
"""

# A bar of perfect plasticity, pulled by a traction of twice its strength, or by a displacement.
BAR = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC, ELSET=BAR
X, 0, 4, 4
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=STEEL
*ELASTIC
1000, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
20
*MATERIAL POINTS, ELSET=BAR, MATERIAL=STEEL, PER ELEMENT=3
*MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0
*STEP, INC=400
*STATIC{direct}
{static}
{controls}
*BOUNDARY
X0, 1, 1
Y0, 2, 2
{conditions}
*HISTORY, NSET=X1
RF, U
*END STEP
"""

NOTE = re.compile(
    r"note: the loads of the step can hardly grow beyond (\S+) % of its time: a limit load under"
    r" load control; prescribe displacements to go past it"
)


def arch(static, conditions, n_along=20, n_through=2):
    """A strip of triangles that rises by 0.1 over 1, 0.05 thick."""

    def number(i, j):
        return i * (n_through + 1) + j + 1

    nodes, elements = [], []
    for i in range(n_along + 1):
        for j in range(n_through + 1):
            x, y = i / n_along, 0.1 * i / n_along + 0.05 * j / n_through
            nodes.append(f"{number(i, j)}, {x:.9g}, {y:.9g}")
    for i in range(n_along):
        for j in range(n_through):
            a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
            elements += [f"{a}, {b}, {c}", f"{a}, {c}, {d}"]
    return ARCH.format(
        nodes="\n".join(nodes),
        elements="\n".join(f"{k}, {text}" for k, text in enumerate(elements, start=1)),
        crown=", ".join(str(number(n_along, j)) for j in range(n_through + 1)),
        static=static,
        conditions=conditions,
    )


def bar(conditions, static="0.1, 1", direct="", controls=""):
    text = BAR.format(conditions=conditions, static=static, direct=direct, controls=controls)
    return "\n".join(line for line in text.splitlines() if line) + "\n"


def history(run):
    """Columns of the history by their names."""
    lines = [line for line in run.read("job_history.csv").splitlines() if line[0] != "#"]
    names = [name.strip() for name in lines[0].split(",")]
    values = np.array([[float(value) for value in line.split(",")] for line in lines[1:]])
    return dict(zip(names, values.T, strict=True))


def summary(run, name):
    """A number of the summary."""
    return float(re.search(rf"^{name}: (\S+)", run.read("job.log"), re.MULTILINE)[1])


def test_displacement_control_passes_the_limit_point(run_tessera):
    run = run_tessera(arch("0.02, 1, 1E-4, 0.04", "*BOUNDARY\nCROWN, 2, 2, -0.22"), "-q")
    assert run.code == 0, run.stderr
    load = -history(run)["RF2[CROWN]"]
    # A peak, then a load that falls below zero, then one that grows again: a snap-through.
    peak, valley = np.argmax(load[: len(load) // 2]), np.argmin(load[2:]) + 2
    assert 0.0243 < load[peak] < 0.0249
    assert 0 < peak < valley < len(load) - 1
    assert load[valley] < 0.0 < load[-1]
    assert summary(run, "cut-backs") == 0


def test_load_control_tells_the_limit_load_of_the_arch(run_tessera):
    """The limit is the peak under displacement control, 0.0246."""
    run = run_tessera(arch("0.1, 1", "*CLOAD\nCROWN, 2, -0.02"))
    assert run.code == 4
    notes = NOTE.findall(run.stderr)
    assert len(notes) == 1
    assert NOTE.findall(run.read("job.log")) == notes
    assert float(notes[0]) / 100 * 3 * 0.02 == pytest.approx(0.0246, rel=0.02)
    assert summary(run, "cut-backs") > 2
    assert "load control has met a limit load" in run.stderr


def test_load_control_tells_the_limit_load_of_a_bar(run_tessera):
    """Plane strain: 2/sqrt(3) times the strength, 57.7 % of a traction of 40."""
    run = run_tessera(
        bar("*DSLOAD\nX1, TRVEC, 40, 1, 0, 0").replace(
            "*MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0\n", ""
        ),
        "-q",
    )
    assert run.code == 4
    assert NOTE.findall(run.stderr) == []  # a quiet run is quiet
    assert "load control has met a limit load" in run.stderr  # but tells why it ends
    (limit,) = NOTE.findall(run.read("job.log"))
    assert float(limit) == pytest.approx(100 * 20 * 2 / np.sqrt(3) / 40, rel=0.03)


def test_slow_start_of_a_load_is_no_limit_load(run_tessera):
    """An amplitude that begins flat: its rate rises thousandfold in an elastic bar."""
    deck = bar("*DSLOAD, AMPLITUDE=RAMP\nX1, TRVEC, 10, 1, 0, 0", "0.01, 1", ", DIRECT")
    deck = deck.replace("*STEP", "*AMPLITUDE, NAME=RAMP\n0, 0\n0.1, 0.0001\n1, 1\n*STEP", 1)
    run = run_tessera(deck.replace("*MOVING MESH, DRIVER=X1, DIRECTION=1,0, FIXED=X0\n", ""))
    assert run.code == 0
    assert "note" not in run.stderr


@pytest.mark.parametrize(
    "deck",
    [
        # Prescribed displacements: the load does not matter.
        bar("X1, 1, 1, 0.4", "1, 1, 0.01", controls="*CONTROLS, MAX ITERATIONS=1"),
        # Too few iterations for a load that the body carries with ease.
        bar(
            "*DSLOAD\nX1, TRVEC, 20, 1, 0, 0",
            "1, 1, 0.01",
            controls="*CONTROLS, MAX ITERATIONS=1, MAX BACKTRACKS=0",
        ),
    ],
    ids=["prescribed", "iterations"],
)
def test_other_failures_are_no_limit_load(run_tessera, deck):
    run = run_tessera(deck)
    assert run.code == 4
    assert "no convergence at the smallest increment" in run.stderr
    assert "note" not in run.stderr
    assert "limit load" not in run.stderr
    assert "note" not in run.read("job.log")


def test_increments_stay_below_the_largest_stretch(run_tessera):
    """The bar is drawn to four times its length; its sides shrink as much."""
    pull = "X1, 1, 1, 12"
    run = run_tessera(bar(pull, "0.5, 1", controls="*CONTROLS, MAX STRETCH=0.2"), "-q")
    assert run.code == 0, run.stderr
    length = 4.0 + history(run)["U1[X1]"]
    assert np.log(length[1:] / length[:-1]).max() <= 0.2
    assert "an element was stretched beyond MAX STRETCH" in run.read("job.sta")
    assert len(length) < 30


def test_prediction_saves_iterations_and_changes_nothing(run_tessera):
    found = {}
    for switch in ("ON", "OFF"):
        deck = bar("X1, 1, 1, 0.4", "0.02, 1", ", DIRECT", f"*CONTROLS, PREDICTION={switch}")
        deck = deck.replace("\n20\n*MATERIAL P", "\n20, 0\n60, 0.2\n*MATERIAL P")
        run = run_tessera(deck, "-q", "-f")
        assert run.code == 0, run.stderr
        found[switch] = history(run)["RF1[X1]"], run.read("job.log")
    (load, log), (load_off, log_off) = found["ON"], found["OFF"]
    assert load == pytest.approx(load_off, rel=1e-7)
    assert "started from the last increment" in log
    assert "started from the last increment" not in log_off
    n_on, n_off = (int(re.search(r"attempts, (\d+) iter", text)[1]) for text in (log, log_off))
    assert n_on < 0.7 * n_off


def test_predicted_runs_do_not_depend_on_threads(run_tessera):
    deck = bar("X1, 1, 1, 0.4", "0.05, 1", ", DIRECT")
    text = {}
    for threads in (1, 2):
        run = run_tessera(deck, "-q", "-f", threads=threads)
        assert run.code == 0, run.stderr
        text[threads] = run.read("job_history.csv")
    assert text[1] == text[2]
