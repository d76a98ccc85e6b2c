"""Runs of decks, several at a time; each with its CPU time."""

import os
import subprocess
import tempfile
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tessera_post.log import Log, read_log

from verification.case import Case, Deck


@dataclass(frozen=True)
class Settings:
    """How decks are run."""

    program: Path
    results: Path  # one folder per case is made in it
    n_jobs: int
    n_threads: int


@dataclass(frozen=True)
class DeckRun:
    """A finished run."""

    deck: Deck
    exit_code: int
    cpu_seconds: float
    folder: Path  # of the results
    log: Log | None
    message: str  # last line on stderr

    @property
    def results(self) -> Path:
        """The file of the points."""
        return self.folder / f"{self.deck.job}.vtkhdf"


def is_checked(program: Path) -> bool:
    """Whether a program is a build with checks, which says nothing about CPU times."""
    command = [str(program), "--version"]
    answer = subprocess.run(command, capture_output=True, check=False).stdout
    return b", Debug)" in answer.partition(b"\n")[0]


def run_deck(case: Case, deck: Deck, settings: Settings) -> DeckRun:
    """Runs one deck to its end, in the folder of the case."""
    folder = settings.results / case.name
    folder.mkdir(parents=True, exist_ok=True)
    for old in (f"{deck.job}.vtkhdf", f"{deck.job}.log"):
        (folder / old).unlink(missing_ok=True)
    command = [settings.program, "-q", "-f", "-t", settings.n_threads, "-o", folder, deck.file]
    threads = str(settings.n_threads)
    environment = {**os.environ, "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": "1"}
    with tempfile.TemporaryFile() as stderr:
        process = subprocess.Popen(
            [str(part) for part in command],
            cwd=case.folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        stderr.seek(0)
        lines = stderr.read().decode(errors="replace").strip().splitlines()
    return DeckRun(
        deck,
        process.returncode,
        usage.ru_utime + usage.ru_stime,
        folder,
        read_log(folder / f"{deck.job}.log"),
        lines[-1] if lines else "",
    )


class Runner:
    """Starts the decks of all cases, slow ones first, and hands out the runs case by case."""

    def __init__(self, cases: list[Case], with_slow: bool, settings: Settings) -> None:
        self._pool = ThreadPoolExecutor(settings.n_jobs)
        self._future: dict[tuple[str, str], Future[DeckRun]] = {}
        tasks = [(case, deck) for case in cases for deck in case.decks_to_run(with_slow)]
        for case, deck in sorted(tasks, key=lambda task: task[1].label != "slow"):
            key = (case.name, deck.file)
            self._future[key] = self._pool.submit(run_deck, case, deck, settings)

    def runs_of(self, case: Case) -> list[DeckRun]:
        """Waits for the runs of a case; in the order of case.toml."""
        keys = [(case.name, deck.file) for deck in case.decks]
        return [self._future[key].result() for key in keys if key in self._future]

    def close(self) -> None:
        """Starts nothing more."""
        self._pool.shutdown(cancel_futures=True)
