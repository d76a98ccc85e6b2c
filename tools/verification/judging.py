"""Judges the runs of a case: exit codes, *EXPECT verdicts, measures, orders."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from tessera_post.log import Verdict

from verification.case import MOST_SECONDS, Case, Measure, Study
from verification.measuring import Found
from verification.running import DeckRun

FROZEN_RTOL = 1e-6  # of the frozen value of a measure
EXPECTATION_FAILED = 7  # exit code


@dataclass(frozen=True)
class Row:
    """What was found in one run, beside what it should be."""

    deck: str
    quantity: str
    found: float  # NaN: there is no value
    exact: float | None = None
    tolerance: float | None = None  # of found - exact
    met: bool | None = None  # None: nothing exact
    frozen: float | None = None
    frozen_met: bool | None = None  # None: nothing frozen
    place: str = ""  # file:line of the frozen line, or empty

    @property
    def failed(self) -> bool:
        """Whether anything that was claimed is not so."""
        return self.met is False or self.frozen_met is False

    @property
    def is_balance(self) -> bool:
        """Whether it is the balance of forces, which every deck claims."""
        return self.quantity.startswith("BALANCE at ")

    @property
    def error(self) -> float | None:
        """Found less exact, over the exact value unless it is 0: positive when too large."""
        if self.exact is None:
            return None
        return (self.found - self.exact) / (self.exact or 1.0)

    @property
    def error_limit(self) -> float | None:
        """The tolerance, relative where the error is."""
        if self.exact is None or self.tolerance is None:
            return None
        return self.tolerance / (abs(self.exact) or 1.0)


@dataclass(frozen=True)
class StudyResult:
    """The order that a study found."""

    study: Study
    errors: tuple[float, ...]
    order: float

    @property
    def failed(self) -> bool:
        """Whether the error falls too slowly; NaN is too slow."""
        return not self.order >= self.study.order


@dataclass
class CaseResult:
    """All that is known about a case after its runs."""

    case: Case
    runs: list[DeckRun]
    rows: list[Row] = field(default_factory=list)
    studies: list[StudyResult] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)  # each a failure
    warnings: list[str] = field(default_factory=list)

    @property
    def n_failed(self) -> int:
        """Number of things that are not as they should be."""
        n_rows = sum(row.failed for row in self.rows)
        return n_rows + sum(study.failed for study in self.studies) + len(self.problems)

    @property
    def balances(self) -> list[Row]:
        """Balances of forces as they should be: one sentence tells them all."""
        return [row for row in self.rows if row.is_balance and not row.failed]

    @property
    def table_rows(self) -> list[Row]:
        """All other rows."""
        return [row for row in self.rows if not row.is_balance or row.failed]


def judge(
    case: Case, runs: list[DeckRun], found: Sequence[Found], timed: bool = False
) -> CaseResult:
    """Judges what the decks of a case and its measures gave; timed: checks the labels, too."""
    result = CaseResult(case, runs)
    for run in runs:
        result.problems += problems_of_run(run)
        if timed and run.deck.label == "quick" and run.cpu_seconds > MOST_SECONDS:
            result.warnings.append(
                f"{run.deck.file} took {run.cpu_seconds:.1f} s: a quick deck takes less than"
                f" {MOST_SECONDS:g} s"
            )
        verdicts = run.log.verdicts if run.log else []
        result.rows += rows_of_verdicts(run.deck.file, verdicts)
    for measure in case.measures:
        of_measure = [each for each in found if each.measure == measure.name]
        lost = [each for each in of_measure if each.problem or not math.isfinite(each.value)]
        result.rows += [row_of_measure(measure, each) for each in of_measure if each not in lost]
        result.problems += [problem_of_measure(each) for each in lost]
    result.problems += problems_without_claim(result)
    have_run = {run.deck.file for run in runs}
    for study in case.studies:
        if have_run.issuperset(study.decks):
            result.studies.append(judge_study(study, result.rows))
    return result


def problems_of_run(run: DeckRun) -> list[str]:
    """What is wrong with a run as such."""
    wanted = run.deck.exit_code
    verdicts = run.log.verdicts if run.log else []
    is_unmet = any(not verdict.met for verdict in verdicts)
    if run.exit_code == EXPECTATION_FAILED and wanted == 0 and is_unmet:
        return []  # the rows say which
    if run.exit_code != wanted:
        why = f": {run.message}" if run.message else ""
        return [f"{run.deck.file} ended with exit code {run.exit_code}, expected {wanted}{why}"]
    if run.log is None:
        return [f"{run.deck.file} left no log"]
    return []


def problems_without_claim(result: CaseResult) -> list[str]:
    """Runs that could give anything: no row states a value, no study looks at them. That forces
    balance says nothing about the answer."""
    claimed = {file for study in result.case.studies for file in study.decks}
    rows = [row for row in result.rows if not row.is_balance]
    claimed |= {row.deck for row in rows if (row.met, row.frozen_met) != (None, None)}
    return [
        f"{run.deck.file} states nothing: expected *EXPECT or a measure with exact or frozen value"
        for run in result.runs
        if run.exit_code == run.deck.exit_code == 0 and run.deck.file not in claimed
    ]


def rows_of_verdicts(deck: str, verdicts: Sequence[Verdict]) -> list[Row]:
    """One row per analytic value; a frozen value of the same quantity joins it."""
    rows: list[Row] = []
    for verdict in verdicts:
        quantity = f"{verdict.what} at {verdict.time}"
        value, found = float(verdict.value), number(verdict.found)
        met = verdict.met and math.isfinite(found)
        if verdict.kind == "analytic":
            tolerance = float(verdict.tolerance)
            exact = {"exact": value, "tolerance": tolerance, "met": met}
            rows.append(Row(deck, quantity, found, **exact))
            continue
        frozen = {"frozen": value, "frozen_met": met, "place": verdict.place}
        open_rows = (
            i for i, row in enumerate(rows) if row.quantity == quantity and row.frozen is None
        )
        i = next(open_rows, None)
        if i is None:
            rows.append(Row(deck, quantity, found, **frozen))
        else:
            rows[i] = replace(rows[i], **frozen)
    return rows


def number(text: str) -> float:
    """What a verdict found; NaN when it was not reached."""
    try:
        return float(text)
    except ValueError:
        return math.nan


def problem_of_measure(found: Found) -> str:
    """Why there is no value."""
    lost = f"'{found.measure}' of {found.deck} is {found.value}: expected a finite number"
    return found.problem or lost


def row_of_measure(measure: Measure, found: Found) -> Row:
    """A row with what a measure of a deck should be."""
    row = Row(found.deck, measure.name, found.value)
    if measure.exact is not None:
        tolerance = measure.tolerance_of(found.deck)
        met = abs(found.value - measure.exact) <= tolerance
        row = replace(row, exact=measure.exact, tolerance=tolerance, met=met)
    if measure.frozen is not None:
        frozen = measure.frozen.get(found.deck, math.nan)
        met = abs(found.value - frozen) <= FROZEN_RTOL * abs(frozen)
        row = replace(row, frozen=frozen, frozen_met=met)
    return row


def judge_study(study: Study, rows: Sequence[Row]) -> StudyResult:
    """The slope of log error over log h."""
    errors = tuple(error_of(study, deck, rows) for deck in study.decks)
    return StudyResult(study, errors, order_of(study.h, errors))


def error_of(study: Study, deck: str, rows: Sequence[Row]) -> float:
    """The error of one deck; NaN when it has not the quantity, or more than once."""
    if study.measure is not None:
        found = [row for row in rows if (row.deck, row.quantity) == (deck, study.measure)]
        errors = [abs(row.found - (row.exact or 0.0)) for row in found]
    else:
        found = [row for row in rows if row.deck == deck and row.exact is not None]
        errors = [abs(row.error or 0.0) for row in found if is_subject(row, study.expect or "")]
    return errors[0] if len(errors) == 1 else math.nan


def is_subject(row: Row, expect: str) -> bool:
    """Whether `SUM RF2[FOOTING]`, or this with ` at TIME` behind it, is the quantity of a row."""
    return expect in (row.quantity, row.quantity.rpartition(" at ")[0])


def order_of(h: Sequence[float], errors: Sequence[float]) -> float:
    """Least-squares slope; NaN when an error is 0 or not known."""
    if not all(error > 0.0 for error in errors):
        return math.nan
    return float(np.polyfit(np.log(h), np.log(errors), 1)[0])
