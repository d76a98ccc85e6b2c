"""Turns pFUnit sources (.pf) into Fortran: a small stand-in for pFUnit's own preprocessor.

    python3 pf_to_fortran.py suite INPUT.pf OUTPUT.f90
    python3 pf_to_fortran.py driver INPUT.pf... OUTPUT.f90

Understood are `@test`, `@before` and `@after` on a line of their own before a subroutine, and
`@assert...(...)` on one line. Anything else that begins with `@` is an error: a directive that was
skipped would be a test that cannot fail.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

ASSERTIONS = (
    "Equal NotEqual LessThan LessThanOrEqual GreaterThan GreaterThanOrEqual True False Fail"
).split()
SPELLING = {name.lower(): name for name in ASSERTIONS}
MAX_NAME = 44  # longer names break the code that pFUnit generates

MODULE = re.compile(r"\s*module\s+(\w+)\s*(!.*)?$", re.IGNORECASE)
SUBROUTINE = re.compile(r"\s*subroutine\s+(\w+)\s*(\(\s*\))?\s*(!.*)?$", re.IGNORECASE)
DIRECTIVE = re.compile(r"\s*@(\w+)\s*(.*?)\s*$")
ASSERT = re.compile(r"\s*@assert(\w+)\s*\((.*)\)\s*$", re.IGNORECASE)


class PfError(Exception):
    """A .pf file that cannot be translated, with file and line."""


@dataclass
class Suite:
    """What one .pf file holds."""

    path: Path
    module: str = ""
    tests: list = field(default_factory=list)
    before: str = ""
    after: str = ""
    lines: list = field(default_factory=list)


def translate(path):
    """The suite in a file, its lines turned into Fortran."""
    suite = Suite(Path(path))
    pending = ""  # the directive that waits for its subroutine
    for number, line in enumerate(suite.path.read_text(encoding="utf-8").splitlines(), start=1):
        try:
            pending = translate_line(suite, number, line, pending)
        except PfError as problem:
            raise PfError(f"{path}:{number}: {problem}") from None
    if pending:
        raise PfError(f"{path}: @{pending} at the end of the file")
    if suite.module.lower() != suite.path.stem.lower():
        raise PfError(f"{path}: the module must be named {suite.path.stem}, not '{suite.module}'")
    if not suite.tests:
        raise PfError(f"{path}: no @test in this file")
    return suite


def translate_line(suite, number, line, pending):
    """Adds one line to the suite; returns the directive that waits for its subroutine."""
    directive = DIRECTIVE.match(line)
    if directive:
        if pending:
            raise PfError(f"a subroutine without arguments must follow @{pending}")
        return translate_directive(suite, number, line, directive)

    suite.lines.append(line)
    if not suite.module and MODULE.match(line):
        suite.module = MODULE.match(line).group(1)
    if not pending or not line.strip() or line.lstrip().startswith("!"):
        return pending

    subroutine = SUBROUTINE.match(line)
    if not subroutine:
        raise PfError(f"a subroutine without arguments must follow @{pending}")
    register(suite, pending, subroutine.group(1))
    return ""


def translate_directive(suite, number, line, directive):
    word, rest = directive.group(1).lower(), directive.group(2)
    if word in ("test", "before", "after"):
        if rest:
            raise PfError(f"@{word} takes no options here, found '{rest}'")
        suite.lines.append("!" + line)
        return word

    call = ASSERT.match(line)
    if not call or call.group(1).lower() not in SPELLING:
        raise PfError(f"cannot translate '{line.strip()}' (one macro on one line)")
    suite.lines += [
        f"  call assert{SPELLING[call.group(1).lower()]}({call.group(2)}, &",
        f'    location=SourceLocation("{suite.path.name}", {number}))',
        "  if (anyExceptions()) return",
        f'# {number + 1} "{suite.path}"',
    ]
    return ""


def register(suite, role, name):
    if len(name) > MAX_NAME:
        raise PfError(f"the name {name} has {len(name)} characters, {MAX_NAME} at most")
    if role == "test":
        if name.lower() in (test.lower() for test in suite.tests):
            raise PfError(f"a second test named {name}")
        suite.tests.append(name)
    elif getattr(suite, role):
        raise PfError(f"a second @{role}")
    else:
        setattr(suite, role, name)


def suite_source(suite):
    """The translated file and, behind it, a subroutine that runs its tests."""
    names = suite.tests + [name for name in (suite.before, suite.after) if name]
    fixtures = f", before={suite.before}" if suite.before else ""
    fixtures += f", after={suite.after}" if suite.after else ""
    rows = [f'# 1 "{suite.path}"', *suite.lines, "", f"subroutine {suite.module}_suite()"]
    rows += ["  use pf_run, only: run_test"]
    rows += [f"  use {suite.module}, only: {name}" for name in names]
    rows += ["  implicit none"]
    rows += [
        f'  call run_test("{suite.module}_suite.{name}", &\n    {name}{fixtures})'
        for name in suite.tests
    ]
    rows += [f"end subroutine {suite.module}_suite", ""]
    return "\n".join(rows)


def driver_source(suites):
    """The program that runs all suites."""
    rows = ["program run_suites", "  use pf_run, only: finish, start", "  implicit none"]
    rows += ["  interface"]
    for suite in suites:
        rows += [f"    {word}subroutine {suite.module}_suite" for word in ("", "end ")]
    rows += ["  end interface", "  call start()"]
    rows += [f"  call {suite.module}_suite()" for suite in suites]
    rows += ["  call finish()", "end program run_suites", ""]
    return "\n".join(rows)


def main():
    mode, *inputs, output = sys.argv[1:]
    try:
        suites = [translate(path) for path in inputs]
    except (PfError, OSError, UnicodeError) as problem:
        sys.exit(f"error: {problem}")
    source = suite_source(suites[0]) if mode == "suite" else driver_source(suites)
    Path(output).write_text(source, encoding="utf-8")


if __name__ == "__main__":
    main()
