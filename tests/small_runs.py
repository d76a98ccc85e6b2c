"""Small runs that are disturbed: a job of a few increments, faults of the file system, and what
must hold of the files that are left."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import ROOT

JOB = "disturbed"  # also what paths of its files contain
FILES = (f"{JOB}.vtkhdf", f"{JOB}_mesh.vtkhdf")
RESTARTS = (f"{JOB}.restart.h5", f"{JOB}.restart.1.h5")  # the last one, and the one before

# A bar of 4 x 1 with 96 points, pulled by 0.4, in eight increments unless others are asked for.
# Points that leave the mesh leave the file, so that their number changes.
DECK = """\
*HEADING
Bar
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=QUADRATIC, ELSET=BAR
X, 0, 4, 4
Y, 0, 1, 1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=STEEL
*DENSITY
2.0
*ELASTIC
1000.0, 0.3
*MATERIAL POINTS, ELSET=BAR, MATERIAL=STEEL, PER ELEMENT=3
*LOST POINTS, ACTION=REMOVE
*STEP, NAME=PULL, INC=2000
*STATIC, DIRECT
{size}, 1.0
*BOUNDARY
X0, 1, 1
Y0, 2, 2
X1, 1, 1, 0.4
*HISTORY, NSET=X1
RF, U
*OUTPUT, FIELD, FREQUENCY=1
S, PEEQ, U, ELEMENT
*RESTART, WRITE, FREQUENCY=2
*END STEP
"""
N_STEPS = 9  # outputs of eight increments
# What belongs to the machine and differs from run to run.
MACHINE = ("kinematics", "stress", "assembly", "factorisation", "solve", "location", "output")
MACHINE += ("point_loop", "factor_memory")


def deck_with(size=0.125):
    """The deck with increments of a size."""
    return DECK.format(size=size)


@dataclass
class Disturbance:
    """A fault of the file system, see tests/faults/io_faults.c."""

    do: str  # kill-before, kill-half, kill-after, short, or an errno
    at: int  # number of the call
    times: int = 1
    calls: str = ""  # calls that count, such as "write,rename"; empty: all
    path: str = JOB  # part of the paths that count


def build_faults(folder, name="io_faults"):
    """Compiles a library of faults."""
    library = folder / f"{name}.so"
    source = ROOT / "tests" / "faults" / f"{name}.c"
    command = ["cc", "-shared", "-fPIC", "-O1", "-o", str(library), str(source), "-ldl"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        pytest.fail(f"cannot compile {source}:\n{result.stderr}", pytrace=False)
    return library


def environment(library, fault=None, log=None):
    """Environment of a run with a fault; the run writes the number of calls into the log."""
    settings = {**os.environ, "OMP_NUM_THREADS": "1", "LD_PRELOAD": str(library), "FAULT_PATH": JOB}
    if log is not None:
        settings["FAULT_LOG"] = str(log)
    if fault is not None:
        settings.update(FAULT_DO=fault.do, FAULT_AT=str(fault.at), FAULT_TIMES=str(fault.times))
        settings["FAULT_PATH"] = fault.path
        if fault.calls:
            settings["FAULT_CALLS"] = f",{fault.calls},"
    return settings


class SmallRun:
    """Runs the job in a folder, with faults if asked for. Every increment appears at once unless
    seconds between publications are given; "" is the default of the program."""

    def __init__(
        self, program: Path, library: Path, folder: Path, size: float = 0.125, publish: str = "0"
    ) -> None:
        self.program, self.library, self.folder = program, library, folder
        folder.mkdir(exist_ok=True)
        (folder / f"{JOB}.inp").write_text(deck_with(size), encoding="utf-8")
        self.options = ["-q", *(["--publish", publish] if publish else [])]
        self.command = [str(program), *self.options, "-f", f"{JOB}.inp"]

    def run(self, fault=None):
        """Runs to the end or to the fault; the finished process."""
        return subprocess.run(
            self.command,
            cwd=self.folder,
            env=environment(self.library, fault, self.folder / "calls"),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    def go_on(self, fault=None):
        """Goes on from the last restart file that is there; None without one."""
        there = [name for name in RESTARTS if (self.folder / name).exists()]
        if not there:
            return None
        return subprocess.run(
            [str(self.program), *self.options, "--restart", there[0], f"{JOB}.inp"],
            cwd=self.folder,
            env=environment(self.library, fault, self.folder / "calls"),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    def start(self):
        """Starts the run without faults."""
        return subprocess.Popen(self.command, cwd=self.folder, env=environment(self.library))

    def clear(self):
        """Removes the results; what a kill has left under other names stays."""
        for name in (*FILES, *RESTARTS, f"{JOB}.log", f"{JOB}.sta", f"{JOB}_history.csv"):
            (self.folder / name).unlink(missing_ok=True)

    @property
    def n_calls(self):
        """Calls that count in the last run that came to its end."""
        return int((self.folder / "calls").read_text())

    @property
    def results(self):
        """What both result files hold."""
        return [contents(self.folder / name) for name in FILES]


def contents(path):
    """Every dataset and attribute of an HDF5 file by its name; None if there is no file."""
    if not path.exists():
        return None
    found = {}

    def note(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()]
        for key, value in item.attrs.items():
            found[f"{name}@{key}"] = value

    with h5py.File(path) as file:
        file.visititems(note)
    return found


def complete_lines(path):
    """Lines of a text file that have a line end."""
    text = path.read_text() if path.exists() else ""
    return text.splitlines()[: text.count("\n")]


def n_converged(folder):
    """Increments that the status file calls converged."""
    return sum(line.endswith("converged") for line in complete_lines(folder / f"{JOB}.sta"))


def check_part(found, whole, path):
    """Whether a file is what the file of an undisturbed run was at some moment."""
    assert found.keys() == whole.keys(), path
    n_steps = int(found["VTKHDF/Steps@NSteps"])
    assert len(found["VTKHDF/Steps/Values"]) == n_steps, path
    for name, values in found.items():
        if "@" in name or name.rpartition("/")[2] in MACHINE:
            continue
        if values.shape == ():
            assert values == whole[name], (path, name)
            continue
        assert len(values) <= len(whole[name]), (path, name)
        np.testing.assert_array_equal(values, whole[name][: len(values)], f"{path} {name}")
        if "Steps" in name:
            assert len(values) == n_steps, (path, name)
    for place, kind in (("PointData", "NumberOfPoints"), ("CellData", "NumberOfCells")):
        for name in [key for key in found if key.startswith(f"VTKHDF/{place}/") and "@" not in key]:
            rows = found[f"VTKHDF/{kind}"][found["VTKHDF/Steps/PartOffsets"]]
            offsets = found[f"VTKHDF/Steps/{place}Offsets/{name.rpartition('/')[2]}"]
            end = np.max(offsets + rows, initial=0)
            assert len(found[name]) == end, (path, name)
    return n_steps


def check_tables(found, path):
    """Whether the columns of every table have as many rows as each other; increments written."""
    for table in ("history", "iterations", "ledger"):
        rows = {len(found[key]) for key in found if key.startswith(f"tessera/{table}/")}
        assert len(rows) == 1, (path, table)
    assert len(found["tessera/ledger/time"]) == len(found["tessera/history/time"]), path
    return len(found["tessera/ledger/time"]) - 1


def check_whole(run, whole):
    """Whether a run has written what the undisturbed run has written."""
    for name, found, expected in zip(FILES, run.results, whole.results):
        assert check_part(found, expected, name) == N_STEPS
    assert check_tables(run.results[0], FILES[0]) == N_STEPS - 1
    history = f"{JOB}_history.csv"
    assert complete_lines(run.folder / history) == complete_lines(whole.folder / history)
    assert n_converged(run.folder) == N_STEPS - 1
    assert not list(run.folder.glob("*.former"))
