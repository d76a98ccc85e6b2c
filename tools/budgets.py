"""Checks the budgets of the style guide: warns above a target, fails above a limit.

    python tools/budgets.py [--quiet]       --quiet: only what breaks a limit

Per file: lines, imports of the module. Per procedure: lines without the header and the declarations
of dummies, number of dummies, nesting. Overall: test lines per source line.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# name: (target, limit)
BUDGETS = {
    "lines of the file": (200, 400),
    "imports": (5, 8),
    "lines of the procedure": (30, 60),
    "dummies": (4, 7),
    "nesting": (3, 4),
}
TEST_RATIO = (1.0, 0.7)

HEADER = re.compile(
    r"(?!end)(?:[\w(),*=: ]+\s)?(subroutine|function)\s+(\w+)\s*(?:\(([^)]*)\))?", re.IGNORECASE
)
END = re.compile(r"end\s*(subroutine|function)\b", re.IGNORECASE)
INTERFACE = re.compile(r"(abstract\s+)?interface\b", re.IGNORECASE)
END_INTERFACE = re.compile(r"end\s*interface\b", re.IGNORECASE)
USE = re.compile(r"use\b\s*(?:,\s*(intrinsic)\s*)?(?:::)?\s*(\w+)", re.IGNORECASE)
DECLARATION = re.compile(r".*::\s*(.*)")
OPEN = re.compile(
    r"(\w+\s*:\s*)?(if\s*\(.*\)\s*then|do\b(?!\w)|select\s+(case|type)\b|associate\s*\(|block$"
    r"|where\s*\(.*\)$|critical\b)",
    re.IGNORECASE,
)
CLOSE = re.compile(r"end\s*(if|do|select|associate|block|where|critical)\b", re.IGNORECASE)


@dataclass
class Procedure:
    """A procedure while it is read."""

    name: str
    line: int
    dummies: list
    n_lines: int = 0
    depth: int = 0
    nesting: int = 0


@dataclass
class Findings:
    """What was measured above a target."""

    warnings: list = field(default_factory=list)
    errors: list = field(default_factory=list)

    def check(self, where, budget, value):
        target, limit = BUDGETS[budget]
        text = f"{where}: {budget} {value}, target {target}, limit {limit}"
        if value > limit:
            self.errors.append(text)
        elif value > target:
            self.warnings.append(text)


def without_comment(line):
    """The line up to a `!` that is not inside a string."""
    quote = ""
    for i, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "!":
            return line[:i].strip()
    return line.strip()


def statements(lines):
    """Joined statements with their first line and number of lines; blank and comment lines, too."""
    start, count, text = 1, 0, ""
    for number, line in enumerate(lines, start=1):
        code = without_comment(line)
        if not text:
            start = number
        count += 1
        text = (text + " " + code.removeprefix("&").strip()).strip()
        if text.endswith("&"):
            text = text[:-1].rstrip()
            continue
        yield start, count, text
        count, text = 0, ""


def declares_dummy(text, dummies):
    declaration = DECLARATION.match(text)
    if not declaration:
        return False
    first = re.match(r"\w+", declaration.group(1))
    return bool(first) and first.group(0).lower() in dummies


def count_statement(procedure, count, text):
    """Adds a statement to the procedure in which it stands."""
    if declares_dummy(text, procedure.dummies):
        return
    procedure.n_lines += count
    if CLOSE.match(text):
        procedure.depth -= 1
    elif OPEN.match(text):
        procedure.depth += 1
        procedure.nesting = max(procedure.nesting, procedure.depth)


def check_file(path, findings):
    """Measures one Fortran file; returns its number of lines."""
    name = path.relative_to(ROOT)
    lines = path.read_text(encoding="utf-8").splitlines()
    findings.check(name, "lines of the file", len(lines))

    imports, inside, in_interface = set(), [], False
    for line, count, text in statements(lines):
        if INTERFACE.match(text) or END_INTERFACE.match(text):
            in_interface = not END_INTERFACE.match(text)
        if in_interface:
            if inside:
                inside[-1].n_lines += count
            continue
        header, use = HEADER.match(text), USE.match(text)
        if use and not use.group(1):
            imports.add(use.group(2).lower())
        if header:
            dummies = re.findall(r"\w+", header.group(3) or "")
            inside.append(Procedure(header.group(2), line, [d.lower() for d in dummies]))
        elif END.match(text) and inside:
            finish_procedure(name, inside.pop(), findings)
        elif inside:
            count_statement(inside[-1], count, text)
    if path.name != "main.f90":
        findings.check(name, "imports", len(imports))
    return len(lines)


def finish_procedure(name, procedure, findings):
    where = f"{name}:{procedure.line}: {procedure.name}"
    findings.check(where, "lines of the procedure", procedure.n_lines)
    findings.check(where, "dummies", len(procedure.dummies))
    findings.check(where, "nesting", procedure.nesting)


def count_test_lines():
    """Lines of the tests; the stand-in for pFUnit in tests/pf does not count."""
    folder = ROOT / "tests"
    files = [path for suffix in ("pf", "py", "f90") for path in folder.rglob(f"*.{suffix}")]
    return sum(
        len(path.read_text(encoding="utf-8").splitlines())
        for path in files
        if path.parent != folder / "pf"
    )


def main():
    findings = Findings()
    n_source = sum(check_file(path, findings) for path in sorted((ROOT / "src").rglob("*.f90")))
    n_test = count_test_lines()
    ratio = n_test / n_source
    target, limit = TEST_RATIO
    text = f"{n_test} test lines for {n_source} source lines: {ratio:.2f}"
    text += f", target {target}, limit {limit}"
    if ratio < limit:
        findings.errors.append(text)

    if "--quiet" not in sys.argv[1:]:
        for warning in findings.warnings:
            print(f"warning: {warning}")
    for error in findings.errors:
        print(f"error: {error}")
    print(f"budgets: {text}")
    print(f"budgets: {len(findings.warnings)} above target, {len(findings.errors)} above limit")
    return 1 if findings.errors else 0


if __name__ == "__main__":
    sys.exit(main())
