"""The log of a run, as far as `docs/results.md` describes it."""

import re
from dataclasses import dataclass, field
from pathlib import Path

ATTEMPT = re.compile(
    r"step (?P<step>\d+) increment (?P<increment>\d+) attempt (?P<attempt>\d+),"
    r" time (?P<time>\S+), size (?P<size>\S+)"
)
DETAIL = re.compile(r"  (worst place|likely cause|last attempt): ")  # below a message
VERDICT = re.compile(
    r"EXPECT (?P<place>.+?:\d+) (?P<what>.+?) at (?P<time>\S+): (?P<kind>analytic|frozen)"
    r" (?P<value>\S+) \+- (?P<tolerance>\S+), (?P<found>.*): (?P<verdict>met|FAILED)"
)


@dataclass(frozen=True)
class Verdict:
    """One line of an *EXPECT and what came out."""

    place: str
    what: str
    time: str
    kind: str  # analytic or frozen
    value: str
    tolerance: str
    found: str
    met: bool


@dataclass(frozen=True)
class Attempt:
    """An attempt at an increment."""

    step: int
    increment: int
    attempt: int
    time: float
    size: float
    outcome: str  # such as `converged after 6 iterations`

    @property
    def converged(self) -> bool:
        """Whether the increment was accepted."""
        return self.outcome.startswith("converged")


@dataclass
class Log:
    """What the log tells beside the tables of the results."""

    warnings: str = ""
    settings: list[str] = field(default_factory=list)
    model: list[str] = field(default_factory=list)
    sets: list[str] = field(default_factory=list)
    attempts: list[Attempt] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    summary: list[str] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    exit_code: int | None = None  # None: the run has not ended


def read_log(path: Path) -> Log | None:
    """The log of a job; None without one."""
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    return parse_log(text)


def parse_log(text: str) -> Log:
    """Parses a log that may end anywhere, a last line without its end left out."""
    log = Log()
    text = text[: text.rfind("\n") + 1]
    _, deck_ended, body = text.rpartition("\nend of deck\n")
    if not deck_ended:
        return log
    first, *later = re.split(r"\n(?=restarted )", body)
    body, _, summary = first.partition("\nsummary\n")
    for block in re.split(r"\n\s*\n", body):
        parse_block(log, block.strip("\n").splitlines())
    log.attempts, log.messages = parse_attempts(body.splitlines())
    for part in later:
        body, _, summary = part.partition("\nsummary\n")
        go_on(log, *parse_attempts(body.splitlines()[1:]))
    for line in summary.splitlines():
        found = VERDICT.fullmatch(line.strip())
        if found:
            values = found.groupdict()
            met = values.pop("verdict") == "met"
            values["found"] = values["found"].removeprefix("found ")
            log.verdicts.append(Verdict(**values, met=met))
        elif re.fullmatch(r"exit code: \d+", line):
            log.exit_code = int(line.split()[-1])
        elif line.strip():
            log.summary.append(line.strip())
    return log


def go_on(log: Log, attempts: list[Attempt], messages: list[str]) -> None:
    """What a run did after a restart takes the place of what it did from there on before."""
    if attempts:
        start = (attempts[0].step, attempts[0].increment)
        log.attempts = [a for a in log.attempts if (a.step, a.increment) < start]
    log.attempts += attempts
    log.messages += messages


def parse_block(log: Log, lines: list[str]) -> None:
    """One block between blank lines, before the first attempt."""
    if not lines:
        return
    if lines[0] == "warnings":
        log.warnings = "\n".join(lines[1:])
        return
    target = log.model
    for line in lines:
        if ATTEMPT.match(line):
            return
        if line == "settings in force, from the deck or by default":
            target = log.settings
        elif line == "sets":
            target = log.sets
        elif target is not log.model and not line.startswith(" "):
            target = log.model
            target.append(line)
        else:
            target.append(line if target is log.model else line[2:])


def parse_attempts(lines: list[str]) -> tuple[list[Attempt], list[str]]:
    """Attempts with their outcomes, and the messages between and behind them."""
    attempts: list[Attempt] = []
    messages: list[str] = []
    head: re.Match[str] | None = None
    for line in lines:
        found = ATTEMPT.match(line)
        if found:
            head = found
        elif head is None and attempts and line.strip() and not line.startswith(" "):
            messages.append(line)
        elif head is None and messages and DETAIL.match(line):
            messages[-1] += f"\n{line}"
        elif head is not None and line.startswith("  ") and " iteration " not in f" {line.strip()}":
            attempts.append(make_attempt(head, line.strip()))
            head = None
    return attempts, messages


def make_attempt(head: re.Match[str], outcome: str) -> Attempt:
    """An attempt from its first and its last line."""
    step, increment, attempt = (int(head[name]) for name in ("step", "increment", "attempt"))
    return Attempt(step, increment, attempt, float(head["time"]), float(head["size"]), outcome)
