"""Words and tables of the report: status, verdicts, settings, ledger."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tessera_post.deck_lexer import n_expectations
from tessera_post.job import Job

MEANING = {  # of exit codes, as the manual has them
    2: "error in the deck",
    3: "error in mesh or model",
    4: "no convergence at the smallest increment",
    5: "linear solver or memory",
    6: "a material point was lost",
    8: "file or HDF5 error",
    130: "interrupted",
    143: "interrupted",
}
Pair = tuple[str, str]


@dataclass(frozen=True)
class Status:
    """How a run ended."""

    kind: str  # good, bad or open
    text: str


def status_of(job: Job) -> Status:
    """The badge of the page."""
    if job.log is None:
        return Status("open", "unknown: there is no log")
    code = job.log.exit_code
    if code is None:
        return Status("open", "unfinished")
    if code == 0:
        return Status("good", "finished")
    if code == 7:
        return Status("bad", "finished, an *EXPECT failed")
    meaning = f": {MEANING[code]}" if code in MEANING else ""
    return Status("bad", f"ended early with exit code {code}{meaning}")


def about(job: Job) -> list[Pair]:
    """What ran, when and for how long."""
    rows = [
        ("job", job.name),
        ("deck", job.deck_name),
        ("formulation", job.formulation),
        ("program", f"Tessera {job.text('version')}, revision {job.text('git')}"),
        ("compiler", job.text("compiler")),
        ("libraries", job.text("libraries")),
        ("started", job.text("started")),
        ("threads", job.text("threads")),
        ("increments", str(job.n_increments)),
        ("outputs", str(job.points.n_steps)),
    ]
    if job.log is not None:
        rows += [pair(line) for line in job.log.summary if line.startswith(("wall time", "CPU"))]
    return [(name, value) for name, value in rows if value]


def pair(line: str) -> Pair:
    """`name: value` of the log; the whole line is the value if it has no name."""
    name, colon, value = line.partition(": ")
    return (name.strip(), value.strip()) if colon else ("", line.strip())


def why_no_verdicts(job: Job) -> str:
    """The reason for a page without verdicts."""
    if job.log is None:
        return f"There is no '{job.name}.log' beside the results: the verdicts are not known."
    if n_expectations(job.deck) == 0:
        return "The deck has no *EXPECT."
    if job.log.exit_code is None:
        return "The run has not ended: *EXPECT is judged at its end."
    if job.log.exit_code not in (0, 7):
        return "The run ended before *EXPECT could be judged."
    return (
        f"The deck's *EXPECT belongs to the formulation that the deck names;"
        f" this run is {job.formulation}."
    )


@dataclass(frozen=True)
class Setting:
    """A line of the settings in force."""

    name: str
    value: str
    indented: bool


def settings_of(job: Job) -> list[Setting]:
    """Settings in force, from the log."""
    lines = job.log.settings if job.log else []
    return [Setting(*pair(line), indented=line.startswith(" ")) for line in lines]


def sizes_of(job: Job) -> list[Pair]:
    """Mesh, points, patches and unknowns: from the log, without it from the results."""
    if job.log is not None and job.log.model:
        return [pair(line) for line in job.log.model]
    rows = [("points", str(job.points.n_points(0)))]
    if job.mesh is not None:
        count = f"{job.mesh.n_points(0)} nodes, {len(job.mesh.cells(0))} linear elements"
        rows.insert(0, ("mesh", count))
    return rows


def sets_of(job: Job) -> list[tuple[str, str, str]]:
    """Kind, name and content of every set, from the log."""
    rows = []
    for line in job.log.sets if job.log else []:
        found = re.fullmatch(r"(\w+) (.*): (.*)", line.strip())
        rows.append((found[1], found[2], found[3]) if found else ("", "", line.strip()))
    return rows


def newton_tolerance(job: Job) -> float | None:
    """The tolerance of Newton's method, if all steps have the same."""
    text = "\n".join(job.log.settings) if job.log else ""
    found = {float(value) for value in re.findall(r"Newton: tolerance ([0-9.eE+-]+)", text)}
    return found.pop() if len(found) == 1 else None


@dataclass(frozen=True)
class Ledger:
    """The ledger of points as rows of text."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    change: Sequence[str]  # from the first to the last row


def ledger_of(job: Job) -> Ledger:
    """Count, mass and volume of the points over the increments."""
    table = job.ledger
    heads = ["step", "increment", "time [-]", "points", "mass"]
    heads += [f"volume [{job.units.of('volume')}]", "lost", "extrapolated"]
    names = ("step", "increment", "time", "count", "mass", "volume", "lost", "extrapolated")
    columns = [table[name] for name in names]
    rows = [[number(value) for value in row] for row in zip(*columns)]
    change = []
    if rows:
        change = [number(table[name][-1] - table[name][0]) for name in names[3:]]
        change[2] += relative(table["volume"])
    return Ledger(heads, rows, change)


def relative(values: np.ndarray) -> str:
    """The change of a quantity over its first value."""
    return f" (relative {values[-1] / values[0] - 1.0:.1e})" if values[0] != 0.0 else ""


def number(value: float | np.generic) -> str:
    """Whole numbers as they are, others with nine digits."""
    if isinstance(value, (int, np.integer)):
        return str(value)
    return f"{float(value):.9g}"
