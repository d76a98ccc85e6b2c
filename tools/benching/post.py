"""Measures tessera-post on a hundred outputs of the footing's 46,000 points.

Run by tools/bench. Wall time after the imports, and the largest memory of the process.
"""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from benching.cases import BenchError

MOST_MEGABYTES = 2048
LIMITS = {"picture": 5.0, "report": 60.0}  # seconds
ENDING = {"picture": ".png", "report": ".html"}
CHILD = """
import importlib, resource, sys, time
from tessera_post.cli import main
importlib.import_module(f"tessera_post.{sys.argv[1]}")
start = time.perf_counter()
code = main(sys.argv[1:])
seconds = time.perf_counter() - start
print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
sys.exit(code)
"""


def make_results(program, deck, folder, environment):
    """Runs the footing in 100 increments with F-bar patches; answers the job."""
    text = deck.read_text(encoding="utf-8")
    finer = text.replace("0.05, 1.0", "0.01, 1.0").replace(
        'FILE="footing.msh"', f'FILE="{deck.parent / "footing.msh"}"'
    )
    if finer.count("0.01, 1.0") != 1 or finer.count(str(deck.parent)) != 1:
        raise BenchError("the footing's deck has changed: expected increments of 0.05")
    finer = re.sub(r"\*EXPECT[^*]*", "", finer)  # of 20 increments
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "hundred.inp").write_text(finer, encoding="utf-8")
    print("footing in 100 increments", file=sys.stderr, flush=True)
    run = subprocess.run(
        [program, "-q", "-f", folder / "hundred.inp"], env=environment, check=False
    )
    if run.returncode not in (0, 7):
        raise BenchError(f"the footing ended with exit code {run.returncode}")
    return folder / "hundred"


def measure(command, job):
    """Seconds after the imports, and megabytes."""
    output = job.with_suffix(ENDING[command])
    run = subprocess.run(
        [sys.executable, "-c", CHILD, command, job, "-o", output],
        stdout=subprocess.PIPE,
        text=True,
        check=False,
    )
    if run.returncode != 0:
        raise BenchError(f"tessera-post {command} ended with exit code {run.returncode}")
    return [float(word) for word in run.stdout.splitlines()[-1].split()]


def bench_post(n_runs, program, root, environment):
    """Prints medians and verdicts; whether all limits are kept."""
    deck = Path(root) / "input" / "footing" / "footing.inp"
    job = make_results(program, deck, program.parent.parent / "post", environment)
    print(f"\ntessera-post: 101 outputs of 45,936 points, medians of {n_runs}")
    print(f"{'':10}{'seconds':>10}{'MiB':>10}")
    ok = True
    for command, most in LIMITS.items():
        seconds, megabytes = np.median([measure(command, job) for _ in range(n_runs)], axis=0)
        kept = bool(seconds <= most and megabytes <= MOST_MEGABYTES)
        ok = ok and kept
        print(
            f"{command:10}{seconds:10.2f}{megabytes:10.0f}   <= {most:g} s after import and"
            f" {MOST_MEGABYTES} MiB: {'ok' if kept else 'FAILED'}"
        )
    return ok
