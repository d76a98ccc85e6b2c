"""Attempts at increments for the report: residuals, cost and outcome of each."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tessera_post.job import Job

PARTS = ("kinematics", "stress", "assembly", "factorisation", "solve")
ROUNDOFF = 1e-13  # relative residuals below it do not fall any further
ASYMPTOTIC = 0.1  # residuals above it say nothing about the order

Key = tuple[int, int, int]


@dataclass(frozen=True)
class Trial:
    """An attempt at an increment."""

    step: int
    increment: int
    attempt: int
    number: int  # of the increment, counted over all steps
    residuals: np.ndarray  # (n_iterations + 1) relative, iteration 0 is before the first correction
    seconds: dict[str, float]  # CPU time by part
    size: float | None  # of the increment, None without the log
    outcome: str
    accepted: bool

    @property
    def n_iterations(self) -> int:
        """Corrections that were made."""
        return max(len(self.residuals) - 1, 0)

    @property
    def verdict(self) -> str:
        """The outcome without the number of iterations, which has a column of its own."""
        return re.sub(r" after \d+ iterations", "", self.outcome)

    @property
    def name(self) -> str:
        """For labels."""
        attempt = f", attempt {self.attempt}" if self.attempt > 1 or not self.accepted else ""
        return f"step {self.step}, increment {self.increment}{attempt}"


def collect_trials(job: Job) -> list[Trial]:
    """All attempts of a run in their order, from the table of iterations and the log."""
    table = job.iterations
    keys: dict[Key, list[int]] = {}
    for row, key in enumerate(zip(table["step"], table["increment"], table["attempt"])):
        keys.setdefault((int(key[0]), int(key[1]), int(key[2])), []).append(row)
    logged = {(a.step, a.increment, a.attempt): a for a in job.log.attempts} if job.log else {}
    every = sorted({*keys, *logged})
    last = {key[:2]: key for key in every}
    accepted = accepted_increments(job)
    order = {pair: number for number, pair in enumerate(sorted(last), start=1)}
    trials = []
    for key in every:
        rows = keys.get(key, [])
        entry = logged.get(key)
        done = entry.converged if entry else key[:2] in accepted and last[key[:2]] == key
        trials.append(
            Trial(
                *key,
                number=order[key[:2]],
                residuals=np.asarray(table["residual"][rows], dtype=float),
                seconds={part: float(table[part][rows].sum()) for part in PARTS},
                size=entry.size if entry else None,
                outcome=entry.outcome if entry else "accepted" if done else "not accepted",
                accepted=done,
            )
        )
    return trials


def accepted_increments(job: Job) -> set[tuple[int, int]]:
    """Step and increment of every row of the history but the first, the state before loading."""
    history = job.history
    return {(int(s), int(i)) for s, i in zip(history["step"][1:], history["increment"][1:])}


def sums(trials: Sequence[Trial]) -> dict[str, float]:
    """CPU seconds by part, over all attempts."""
    return {part: sum(trial.seconds[part] for trial in trials) for part in PARTS}


def cut_backs(trials: Sequence[Trial]) -> list[Trial]:
    """Attempts that did not converge."""
    return [trial for trial in trials if not trial.accepted]


@dataclass(frozen=True)
class Reference:
    """Convergence of order 2: r -> constant * r**2, through the residual of one iteration."""

    constant: float
    iteration: float
    residual: float

    def at(self, iteration: np.ndarray) -> np.ndarray:
        """Residuals of the sequence, between its iterations as well."""
        exponent = 2.0 ** (iteration - self.iteration)
        return np.exp(exponent * np.log(self.constant * self.residual)) / self.constant


def find_reference(trials: Sequence[Trial]) -> Reference | None:
    """Order 2 through the attempt that is the median of all. When no attempt has two residuals
    between round-off and the region where Newton's method contracts, the constant is 1 and the
    sequence begins with the first residual that is below 1; None without one."""
    found = []
    for trial in trials:
        r = trial.residuals
        usable = [
            k for k in range(1, len(r) - 1) if ROUNDOFF < r[k + 1] < r[k] <= ASYMPTOTIC
        ]  # fmt: skip
        if trial.accepted and usable:
            k = usable[-1]
            found.append(Reference(float(r[k + 1] / r[k] ** 2), float(k), float(r[k])))
    found = [one for one in found if one.constant * one.residual < 1.0]
    found.sort(key=lambda one: one.constant)
    if found:
        return found[len(found) // 2]
    first = [float(r) for trial in trials for r in trial.residuals[1:2] if 0.0 < r < 1.0]
    return Reference(1.0, 1.0, first[0]) if first else None
