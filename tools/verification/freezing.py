"""Writes what was found into the `frozen` lines of decks and the frozen tables of case.toml."""

import math
import re
from collections.abc import Sequence
from pathlib import Path

from verification.case import Case
from verification.judging import CaseResult, Row
from verification.toml_table import CaseError

FROZEN_LINE = re.compile(r"(\s*frozen\s*,\s*)([^,\s]+)(.*)", re.IGNORECASE | re.DOTALL)
FROZEN_KEY = re.compile(r"frozen\s*=\s*\{.*\}\s*")


def frozen_text(value: float) -> str:
    """Twelve digits."""
    return f"{value:.12g}"


def freeze(result: CaseResult) -> list[Path]:
    """Rewrites the files of a case; the files that were changed."""
    changed = freeze_decks(result.case, result.rows)
    if any(measure.frozen is not None for measure in result.case.measures):
        path = result.case.folder / "case.toml"
        old = path.read_text(encoding="utf-8")
        new = frozen_toml(old, result)
        if new != old:
            path.write_text(new, encoding="utf-8")
            changed.append(path)
    return changed


def freeze_decks(case: Case, rows: Sequence[Row]) -> list[Path]:
    """The frozen lines of *EXPECT."""
    wanted: dict[Path, dict[int, float]] = {}
    for row in rows:
        if not row.place or math.isnan(row.found):
            continue
        name, _, line = row.place.rpartition(":")
        of_file = wanted.setdefault(case.folder / name, {})
        before = of_file.setdefault(int(line), row.found)
        if before != row.found:
            raise CaseError(
                f"{row.place}: decks that include this line find {before!r} and {row.found!r}:"
                " expected frozen lines in the decks themselves"
            )
    changed = []
    for path, values in wanted.items():
        lines = path.read_bytes().decode("utf-8").splitlines(keepends=True)
        new = [*lines]
        for number, value in values.items():
            found = FROZEN_LINE.fullmatch(lines[number - 1])
            if found is None:
                raise CaseError(f"{path}:{number}: expected a frozen line")
            new[number - 1] = found[1] + frozen_text(value) + found[3]
        if new != lines:
            path.write_bytes("".join(new).encode())
            changed.append(path)
    return changed


def frozen_toml(text: str, result: CaseResult) -> str:
    """The text of case.toml with new values; those of decks that did not run stay."""
    lines = text.splitlines()
    starts = [i for i, line in enumerate(lines) if line.strip() == "[[measure]]"]
    for measure, start in zip(result.case.measures, starts, strict=True):
        if measure.frozen is None:
            continue
        values = dict(measure.frozen)
        for row in result.rows:
            if row.quantity == measure.name and row.deck in measure.decks:
                values[row.deck] = row.found
        table = ", ".join(
            f'"{deck}" = {frozen_text(values[deck])}' for deck in measure.decks if deck in values
        )
        lines[line_of_frozen(lines, start, measure.name)] = f"frozen = {{{table}}}"
    return "\n".join(lines) + "\n"


def line_of_frozen(lines: Sequence[str], start: int, measure: str) -> int:
    """Index of the frozen table of the [[measure]] that begins at a line."""
    for i in range(start + 1, len(lines)):
        if lines[i].startswith("["):
            break
        if FROZEN_KEY.fullmatch(lines[i]):
            return i
    raise CaseError(
        f"measure '{measure}': expected its frozen values in one line, frozen = {{...}}"
    )
