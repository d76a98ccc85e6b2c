"""The same deck again and again, with several numbers of threads: one checksum."""

import os
import shutil
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import h5py

from soaking.checksum import checksum
from soaking.parts import Part, SoakError, scaled

THREADS = (1, 2, 4)
SURROUNDINGS = ("OMP_", "OPENBLAS_")  # variables
RUNS = 20  # at full length, of each number of threads


@dataclass(frozen=True)
class Settings:
    """What is run, and where."""

    program: Path
    deck: Path
    folder: Path  # of the results; emptied


def run_once(settings: Settings, threads: int) -> str:
    """The checksum of one run, whose results are deleted. SoakError when it does not end well."""
    folder = settings.folder / f"threads-{threads}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    job = settings.deck.stem
    command = [settings.program, "-q", "-t", threads, "-o", folder, settings.deck.name]
    # What the surroundings say about threads shall not decide anything.
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(SURROUNDINGS)
    }
    environment["OMP_WAIT_POLICY"] = "passive"  # more threads than cores do not spin
    run = subprocess.run(
        [str(part) for part in command],
        cwd=settings.deck.parent,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode != 0:
        raise SoakError(f"{settings.deck.name} ended with exit code {run.returncode}: {run.stderr}")
    with h5py.File(folder / f"{job}.vtkhdf") as file:
        used = int(file["tessera"].attrs["threads"])
    if used != threads:
        raise SoakError(f"{settings.deck.name} ran with {used} threads: expected {threads}")
    found = checksum(folder, job)
    shutil.rmtree(folder)
    return found


def check_determinism(settings: Settings, scale: float) -> Part:
    """Runs of all numbers of threads in turn, so that they meet different neighbours."""
    found: Counter[tuple[int, str]] = Counter()
    n = scaled(RUNS, scale)
    for i in range(n):
        for threads in THREADS:
            found[threads, run_once(settings, threads)] += 1
        n_checksums = len({text for _, text in found})
        print(f"determinism: round {i + 1} of {n}, checksums {n_checksums}", file=sys.stderr)
    return judge(settings.deck.stem, found)


def judge(job: str, found: Counter[tuple[int, str]]) -> Part:
    """What the checksums of all runs say; they are counted by threads and checksum."""
    checksums = sorted({text for _, text in found})
    of_threads = {n: sum(k for (m, _), k in found.items() if m == n) for n, _ in found}
    runs = ", ".join(f"{k} with {n} threads" for n, k in sorted(of_threads.items()))
    figures = [
        f"runs of {job}: {found.total()} ({runs})",
        f"checksums: {len(checksums)} ({', '.join(text[:16] for text in checksums)})",
    ]
    failed = []
    if len(checksums) != 1:
        table = ", ".join(
            f"{k} x {n} threads {text[:16]}" for (n, text), k in sorted(found.items())
        )
        failed = [f"expected one checksum, found {len(checksums)}: {table}"]
    return Part("determinism", figures, failed)
