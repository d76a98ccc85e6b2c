"""Measures the footing, the location of points and tessera-post with the programs in build/bench.

    tools/bench [--runs N]

Times are CPU times of one thread: of the footing, over its plastic increments, per point and Newton
iteration; medians of N runs. Of tessera-post, wall time and memory. Prints ok or FAILED behind each
limit; exit code 1 when one is passed.
"""

import argparse
import os
import platform
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
from bench_post import bench_post

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "bench"
METHODS = ("standard", "fbar")
KERNELS = ("kinematics", "stress", "assembly")
PARTS = (*KERNELS, "factorisation", "solve")
MOST_MICROSECONDS = 3.0  # kinematics, stress and assembly together
MOST_OF_NAIVE = 0.054  # location over testing every element, in percent
EXPECTATION_FAILED = 7  # exit code of a run that is complete


def environment():
    return {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def run_footing(folder):
    command = [BUILD / "bin" / "tessera", "--compare", ",".join(METHODS), "-q", "-f", "-t", "1"]
    command += ["-o", folder, ROOT / "input" / "footing" / "footing.inp"]
    run = subprocess.run(command, env=environment(), stdout=subprocess.DEVNULL, check=False)
    if run.returncode not in (0, EXPECTATION_FAILED):
        sys.exit(f"bench: the footing ended with exit code {run.returncode}")


def plastic_increments(file):
    """Increments at whose end there is more plastic strain than at their beginning."""
    grid = file["VTKHDF"]
    first = grid["Steps/PointDataOffsets/PEEQ"][()]
    count = grid["NumberOfPoints"][()][grid["Steps/PartOffsets"][()]]
    peeq = grid["PointData/PEEQ"]
    total = np.array([peeq[a : a + n].sum() for a, n in zip(first, count)])
    if len(total) != len(file["tessera/ledger/increment"]):
        sys.exit("bench: the footing's deck must write PEEQ at every increment")
    return 1 + np.flatnonzero(np.diff(total) > 0.0)


def cost(path):
    """Microseconds per point and iteration of each part, and numbers of points and iterations."""
    with h5py.File(path) as file:
        plastic = plastic_increments(file)
        table = {name: column[()] for name, column in file["tessera/iterations"].items()}
        n_points = int(file["tessera/ledger/count"][0])
    rows = np.isin(table["increment"], plastic) & (table["iteration"] > 0)
    n_iterations = int(rows.sum())
    if n_iterations == 0:
        sys.exit(f"bench: no plastic increment in {path}")
    scale = 1e6 / (n_points * n_iterations)
    return {part: table[part][rows].sum() * scale for part in PARTS}, n_points, n_iterations


def verdict(ok):
    return "ok" if ok else "FAILED"


def bench_footing(n_runs):
    folder = BUILD / "footing"
    costs = {method: [] for method in METHODS}
    for i in range(n_runs):
        print(f"footing, run {i + 1} of {n_runs}", file=sys.stderr, flush=True)
        run_footing(folder)
        for method in METHODS:
            costs[method].append(cost(folder / f"footing_{method}.vtkhdf"))

    print("\nfooting: microseconds of CPU per point and Newton iteration, plastic increments")
    print(f"{'':10}" + "".join(f"{part:>14}" for part in (*KERNELS, "sum", *PARTS[3:])))
    ok = True
    for method in METHODS:
        runs = [dict(parts, sum=sum(parts[k] for k in KERNELS)) for parts, _, _ in costs[method]]
        median = {part: np.median([run[part] for run in runs]) for part in runs[0]}
        line = "".join(f"{median[part]:14.3f}" for part in (*KERNELS, "sum", *PARTS[3:]))
        within = median["sum"] <= MOST_MICROSECONDS
        ok = ok and within
        print(f"{method:10}{line}   sum <= {MOST_MICROSECONDS:g}: {verdict(within)}")
    for method in METHODS:
        _, n_points, n_iterations = costs[method][0]
        sums = [sum(parts[k] for k in KERNELS) for parts, _, _ in costs[method]]
        print(
            f"{method}: {n_points} points, {n_iterations} iterations in plastic increments,"
            f" sums from {min(sums):.3f} to {max(sums):.3f} in {n_runs} runs"
        )
    return ok


def bench_location(n_runs):
    runs = []
    for _ in range(n_runs):
        run = subprocess.run(
            [BUILD / "bin" / "bench_location"],
            env=environment(),
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        runs.append({name: float(value) for name, value in map(str.split, run.stdout.splitlines())})
    one = runs[0]
    tests = 100.0 * one["share_of_tests"]
    time = 100.0 * np.median([run["share_of_time"] for run in runs])
    n_tests = int(one["walk_tests"] + one["bin_tests"])
    n_naive = int(one["naive_points"])

    print(
        f"\nlocation: {one['points']:.0f} points, {one['elements']:.0f} tetrahedra, moved by"
        f" {one['mean_move_in_element_sizes']:.2f} element sizes in the mean,"
        f" {one['crossed']:.0f} changed element"
    )
    tests_ok, time_ok = tests <= MOST_OF_NAIVE, time <= MOST_OF_NAIVE
    print(
        f"{'element tests':15}{n_tests} ({n_tests / one['points']:.2f} per point), {tests:.4f} % of"
        f" testing every element   <= {MOST_OF_NAIVE} %: {verdict(tests_ok)}"
    )
    milliseconds = 1e3 * np.median([run["location_seconds"] for run in runs])
    seconds = np.median([run["naive_seconds_scaled"] for run in runs])
    print(
        f"{'CPU time':15}{milliseconds:.2f} ms, {time:.4f} % of the {seconds:.1f} s of testing"
        f" every element   <= {MOST_OF_NAIVE} %: {verdict(time_ok)}"
    )
    print(f"{'':15}(every element tested for {n_naive} of the points, time scaled to all of them)")
    agree = one["disagreements"] == 0 and one["lost"] == 0
    print(f"{'hosts':15}the same as from testing every element: {verdict(agree)}")
    return tests_ok and time_ok and agree


def processor():
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def main():
    parser = argparse.ArgumentParser(prog="tools/bench", description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=3, metavar="N", help="runs (default: 3)")
    n_runs = parser.parse_args().runs
    if n_runs < 1:
        parser.error("--runs: expected at least 1")
    print(f"processor: {processor()}, one thread")
    ok = [
        bench_footing(n_runs),
        bench_location(n_runs),
        bench_post(n_runs, BUILD / "bin" / "tessera", ROOT, environment()),
    ]
    return 0 if all(ok) else 1


if __name__ == "__main__":
    sys.exit(main())
