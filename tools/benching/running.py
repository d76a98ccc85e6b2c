"""One run of the program: what it took as a whole, and what its results tell about it."""

import os
import re
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np

from benching.cases import BenchError

KERNELS = ("kinematics", "stress", "assembly")
LINEAR = ("factorisation", "solve")
LEDGER = ("location", "output", "point_loop")
PARTS = (*KERNELS, *LINEAR, "location", "output")
EXPECTATION_FAILED = 7  # exit code of a run that is complete


def environment(n_threads: int) -> dict[str, str]:
    """Threads of the program; OpenBLAS has one."""
    threads = {"OMP_NUM_THREADS": str(n_threads), "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **threads}


def run_deck(program: Path, deck: Path, n_threads: int) -> dict:
    """Runs a deck to its end; answers the figures of the run."""
    command = [program, "-q", "-f", "-t", str(n_threads), deck.name]
    start = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=deck.parent, env=environment(n_threads), stdout=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, EXPECTATION_FAILED):
        raise BenchError(f"{deck.name} ended with exit code {process.returncode}")
    return {
        "cpu": usage.ru_utime + usage.ru_stime,
        "wall": time.perf_counter() - start,
        "memory": 1024 * usage.ru_maxrss,
        **read_results(deck.with_suffix(".vtkhdf"), deck.with_suffix(".log")),
    }


def read_results(path: Path, log: Path) -> dict:
    """Sizes, seconds by part, and the same over plastic increments, per point and iteration."""
    with h5py.File(path) as file:
        table = {name: column[()] for name, column in file["tessera/iterations"].items()}
        ledger = {name: column[()] for name, column in file["tessera/ledger"].items()}
        n_outputs = int(file["VTKHDF/Steps"].attrs["NSteps"])
    corrections = table["iteration"] > 0
    increments = sorted(set(table["increment"][corrections].tolist()))
    plastic = np.isin(table["increment"], plastic_increments(log)) & corrections
    seconds = {part: float(table[part].sum()) for part in (*KERNELS, *LINEAR)}
    seconds |= {part: float(ledger[part].sum()) for part in LEDGER}
    seconds["output"] = max(seconds["output"], output_of_log(log))
    n_points = int(ledger["count"][0])
    scale = 1e6 / (n_points * max(1, int(plastic.sum())))
    return {
        "points": n_points,
        "unknowns": int(ledger["unknowns"].max()),
        "nonzeros": int(ledger["nonzeros"].max()),
        "factor_memory": float(ledger["factor_memory"].max()),
        "increments": len(ledger["increment"]) - 1,
        "outputs": n_outputs,
        "iterations": int(corrections.sum()),
        "plastic_iterations": int(plastic.sum()),
        "seconds": seconds,
        "plastic": {part: float(table[part][plastic].sum()) * scale for part in KERNELS},
        "linear": [linear_of(table, corrections & (table["increment"] == i)) for i in increments],
    }


def linear_of(table: dict, rows: np.ndarray) -> dict:
    """Corrections and seconds of linear algebra in an increment."""
    return {
        "iterations": int(rows.sum()),
        "seconds": float(sum(table[k][rows].sum() for k in LINEAR)),
    }


def plastic_increments(log: Path) -> list[int]:
    """Increments at whose end points flow; of an increment the last attempt counts."""
    n_flowing: dict[int, int] = {}
    increment = 0
    for line in log.read_text(encoding="utf-8").splitlines():
        if found := re.match(r"step \d+ increment (\d+) attempt ", line):
            increment = int(found[1])
        elif found := re.match(r"  iteration .* plastic points (\d+)", line):
            n_flowing[increment] = int(found[1])
    return [number for number, n in n_flowing.items() if n > 0]


def output_of_log(log: Path) -> float:
    """CPU seconds of all output: the ledger does not know those of the last increment."""
    text = log.read_text(encoding="utf-8")
    found = re.search(r"^CPU seconds: .* output ([^,\s]+)", text, re.MULTILINE)
    if not found:
        raise BenchError(f"{log.name}: expected a line 'CPU seconds:' with output")
    return float(found[1])


def read_history(path: Path) -> dict[str, np.ndarray]:
    """The columns of *HISTORY."""
    with h5py.File(path) as file:
        columns = {name: column[()] for name, column in file["tessera/history"].items()}
    return {k: v for k, v in columns.items() if k not in ("step", "increment")}


def largest_difference(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    """Largest difference of two histories, relative to the largest value of its column, or to
    1e-4 of the largest one of its quantity where that is more: a column may hold nothing but
    rounding errors. Infinite when they have other increments."""
    if one.keys() != other.keys() or len(one["time"]) != len(other["time"]):
        return float("inf")
    largest = {name: np.max(np.abs(column)) for name, column in one.items()}
    worst = 0.0
    for name, column in one.items():
        kind = name.rstrip("]").split("[")[0].rstrip("0123456789")
        alike = [v for k, v in largest.items() if k.split("[")[0].rstrip("0123456789") == kind]
        scale = max(largest[name], 1e-4 * max(alike))
        if scale > 0.0:
            worst = max(worst, float(np.max(np.abs(column - other[name])) / scale))
    return worst
