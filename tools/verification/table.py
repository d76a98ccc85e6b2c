"""The results of a case as a table for the terminal."""

from collections.abc import Sequence

from verification.judging import CaseResult, Row, StudyResult
from verification.texts import balance_text, error_text, number_text, order_text

HEAD = ("deck", "quantity", "exact", "found", "error", "tolerance", "", "frozen")


def case_text(result: CaseResult) -> str:
    """Title, rows, studies, what went wrong."""
    lines = [f"{result.case.name}: {result.case.title}"]
    if result.table_rows:
        lines += aligned([HEAD, *(cells_of(row) for row in result.table_rows)])
    if result.balances:
        lines.append(f"  {balance_text([row.found for row in result.balances])}")
    lines += [f"  {study_text(study)}" for study in result.studies]
    lines += [f"  FAILED: {problem}" for problem in result.problems]
    lines += [f"  warning: {warning}" for warning in result.warnings]
    return "\n".join(lines)


def cells_of(row: Row) -> tuple[str, ...]:
    """The cells of a row."""
    is_relative = bool(row.exact)
    return (
        row.deck,
        row.quantity,
        number_text(row.exact),
        number_text(row.found),
        error_text(row.error, is_relative),
        error_text(row.error_limit, is_relative),
        {None: "", True: "met", False: "FAILED"}[row.met],
        {None: "-", True: "same", False: f"FAILED: {row.frozen!r}"}[row.frozen_met],
    )


def study_text(result: StudyResult) -> str:
    """A study in one line."""
    errors = ", ".join(
        error_text(error, result.study.expect is not None) for error in result.errors
    )
    verdict = "FAILED" if result.failed else "met"
    return (
        f"order of {result.study.name}: {order_text(result.order)}, at least"
        f" {result.study.order:g}: {verdict} (errors {errors})"
    )


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines, columns below each other."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row[:2], widths[:2])]
        cells += [cell.rjust(width) for cell, width in zip(row[2:-1], widths[2:-1])]
        lines.append("  " + "  ".join([*cells, row[-1]]).rstrip())
    return lines
