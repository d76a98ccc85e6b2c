"""docs/verification.md, made from the results of all cases."""

from collections.abc import Sequence
from pathlib import Path

from verification.judging import CaseResult, Row, StudyResult
from verification.texts import balance_text, error_text, number_text, order_text

FIGURES = "figures/verification"  # below docs
HEAD = Path(__file__).with_name("page_head.md")


def page_text(results: Sequence[CaseResult]) -> str:
    """The whole page; the same results give the same text."""
    parts = [HEAD.read_text(encoding="utf-8"), "## Summary\n", summary_table(results)]
    parts += [section(result) for result in results]
    return "\n".join(parts)


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table with its head."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(cell or ' ' for cell in line)} |\n" for line in lines)


def summary_table(results: Sequence[CaseResult]) -> str:
    """One line per case."""
    head = ("case", "decks", "quantities", "worst error over tolerance", "orders", "verdict")
    return markdown_table(head, [summary_cells(result) for result in results])


def summary_cells(result: CaseResult) -> tuple[str, ...]:
    """The line of a case in the summary."""
    title = f"[{result.case.title}](#{anchor(result.case.title)})"
    orders = ", ".join(order_text(study.order) for study in result.studies)
    verdict = f"{result.n_failed} FAILED" if result.n_failed else "met"
    quantities = str(len(result.rows))
    return (title, str(len(result.runs)), quantities, worst_ratio(result.rows), orders, verdict)


def worst_ratio(rows: Sequence[Row]) -> str:
    """The largest error over its tolerance."""
    ratios = [
        abs(row.found - row.exact) / row.tolerance
        for row in rows
        if row.exact is not None and row.tolerance
    ]
    return f"{max(ratios):.2f}" if ratios else "-"


def anchor(title: str) -> str:
    """The name of a heading in a link."""
    kept = (c for c in title.lower() if c.isalnum() or c in " -_")
    return "".join(kept).replace(" ", "-")


def section(result: CaseResult) -> str:
    """Title, table, orders, figures of a case."""
    case = result.case
    text = f"\n## {case.title}\n\n{case.summary}\n[Folder, decks, details](../input/verification/"
    text += f"{case.name}/README.md).\n\n"
    head = ("deck", "quantity", "exact", "computed", "error", "tolerance", "frozen")
    text += markdown_table(head, [row_cells(row) for row in result.table_rows])
    if result.balances:
        text += f"\nForces, {balance_text([row.found for row in result.balances])}.\n"
    if result.studies:
        head = ("error of", "sizes", "errors", "order", "at least")
        text += "\n" + markdown_table(head, [study_cells(study) for study in result.studies])
    for problem in result.problems:
        text += f"\n**FAILED:** {problem}\n"
    for figure in case.figures:
        text += f"\n![{figure.caption}]({FIGURES}/{figure.file})\n*{figure.caption}*\n"
    return text


def row_cells(row: Row) -> tuple[str, ...]:
    """One quantity of one deck."""
    is_relative = bool(row.exact)
    error = error_text(row.error, is_relative)
    return (
        f"`{row.deck.removesuffix('.inp')}`",
        row.quantity,
        number_text(row.exact),
        number_text(row.found),
        f"**{error}**" if row.met is False else error,
        error_text(row.error_limit, is_relative),
        {None: "-", True: "same", False: "**FAILED**"}[row.frozen_met],
    )


def study_cells(result: StudyResult) -> tuple[str, ...]:
    """One study."""
    order = order_text(result.order)
    return (
        result.study.name,
        ", ".join(f"{h:g}" for h in result.study.h),
        ", ".join(error_text(e, result.study.expect is not None) for e in result.errors),
        f"**{order}**" if result.failed else order,
        f"{result.study.order:g}",
    )
