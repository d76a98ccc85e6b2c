"""A job: its files found by name, opened once, and what every command asks of them."""

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np

from tessera_post.errors import PostError, one_of
from tessera_post.fields import Quantity, find_quantity
from tessera_post.log import Log, read_log
from tessera_post.series import VTK_TRIANGLE, Series
from tessera_post.units import Units

FORMULATIONS = {"standard": "standard MPM", "fbar": "F-bar patch"}
SUFFIX = ".vtkhdf"
MESH_SUFFIX = "_mesh.vtkhdf"
FAIL_SUFFIX = "_fail.vtkhdf"
SAME_TIME = 1e-9  # relative to the length of the run


class Job:
    """What one run wrote, complete or not.

    name     of the job, such as footing_fbar
    points   series of the material points
    notes    what a reader of the results must know: unfinished, failed, files missing
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder = path.parent
        self.name = path.name.removesuffix(SUFFIX)
        self.points = Series(path)
        if "tessera" not in self.points.file:
            self.close()
            raise PostError(f"'{path}' is no result of Tessera: it has no group /tessera")
        if "message" in self.points.file["tessera"]:
            message = self.points.file["tessera/message"][()].decode(errors="replace")
            what = "holds the attempt that ended a run, for ParaView"
            self.close()
            raise PostError(f"'{path}' {what}: {message.splitlines()[0]}")

    def close(self) -> None:
        """Closes the files."""
        self.points.close()
        if self.__dict__.get("mesh") is not None:
            self.mesh.close()

    # --- tables ----------------------------------------------------------------------------------

    def _table(self, name: str) -> dict[str, np.ndarray]:
        """Columns of a table, cut to the rows that all of them have."""
        columns = self.points.read(
            lambda file: {key: column[()] for key, column in file["tessera"][name].items()},
            f"'{self.path}': cannot read /tessera/{name}",
        )
        n_rows = min((len(column) for column in columns.values()), default=0)
        return {key: column[:n_rows] for key, column in columns.items()}

    @cached_property
    def history(self) -> dict[str, np.ndarray]:
        """Columns of *HISTORY by name; row 0 is the state before loading."""
        history = self._table("history")
        if "time" not in history:
            raise PostError(f"'{self.path}': /tessera/history has no column 'time'")
        return history

    @cached_property
    def iterations(self) -> dict[str, np.ndarray]:
        """One row per iteration of every attempt."""
        return self._table("iterations")

    @cached_property
    def ledger(self) -> dict[str, np.ndarray]:
        """One row per accepted increment."""
        return self._table("ledger")

    def text(self, name: str) -> str:
        """An attribute of the run as text: version, git, compiler, libraries, started, ..."""
        value = self.points.read(lambda file: file["tessera"].attrs.get(name, b""))
        return value.decode(errors="replace") if isinstance(value, bytes) else str(value)

    @cached_property
    def deck(self) -> bytes:
        """The stored deck with its includes, byte for byte."""
        return self._scalar("deck")

    @cached_property
    def deck_name(self) -> str:
        """File name of the deck."""
        return self._scalar("deck_name").decode(errors="replace")

    def _scalar(self, name: str) -> bytes:
        def load(file: h5py.File) -> bytes:
            dataset = file["tessera"].get(name)
            if not isinstance(dataset, h5py.Dataset) or dataset.shape != ():
                raise PostError(f"'{self.path}': /tessera/{name} is no text")
            return bytes(dataset[()])

        return self.points.read(load)

    @cached_property
    def log(self) -> Log | None:
        """The log beside the results, None if it is not there."""
        return read_log(self.folder / f"{self.name}.log")

    # --- about the job ---------------------------------------------------------------------------

    @cached_property
    def mesh(self) -> Series | None:
        """Series of the background mesh, None if its file is not there or not readable."""
        path = self.folder / f"{self.name}{MESH_SUFFIX}"
        try:
            return Series(path)
        except PostError:
            return None

    @cached_property
    def n_dim(self) -> int:
        """2 in plane strain, else 3."""
        if self.mesh is not None:
            return 2 if self.mesh.cell_type == VTK_TRIANGLE else 3
        return 2 if not self.points.points(0)[:, 2].any() else 3

    @cached_property
    def units(self) -> Units:
        """Labels of *UNITS."""
        return Units.from_text(self.text("units"), self.n_dim)

    @property
    def heading(self) -> str:
        """Text of *HEADING, empty without one."""
        lines = self.deck.decode(errors="replace").splitlines()
        for i, line in enumerate(lines):
            if line.partition(" **")[0].strip().upper() == "*HEADING":
                rest = (text.strip() for text in lines[i + 1 :])
                return next((text for text in rest if text and not text.startswith("**")), "")
        return ""

    @property
    def formulation(self) -> str:
        """In words: standard MPM or F-bar patch; the name of the job if it is not stated."""
        return FORMULATIONS.get(self.text("formulation"), self.name)

    @property
    def label(self) -> str:
        """For legends: the formulation, marked when the run did not finish."""
        return self.formulation + (" (unfinished)" if self.is_unfinished else "")

    @property
    def is_unfinished(self) -> bool:
        """Whether the run was killed, is still going on, or gave up before its end."""
        if self.log is None:
            return False
        return self.log.exit_code not in (0, 7)

    @property
    def notes(self) -> list[str]:
        """What a reader of the results must know, a line each."""
        notes = [text for text in (self.points.note, self.mesh.note if self.mesh else "") if text]
        if self.mesh is None:
            notes.append(f"'{self.name}{MESH_SUFFIX}' cannot be read: drawn without the mesh")
        if self.log is None:
            notes.append(f"there is no '{self.name}.log': verdicts, warnings and settings unknown")
        elif self.log.exit_code is None:
            when = float(self.history["time"][-1]) if len(self.history["time"]) else 0.0
            notes.append(
                f"'{self.name}' has not finished (killed, or still running): shown up to increment"
                f" {self.n_increments}, time {when:g}"
            )
        elif self.is_unfinished:
            why = f": {self.log.messages[-1].splitlines()[0]}" if self.log.messages else ""
            notes.append(f"'{self.name}' ended early with exit code {self.log.exit_code}{why}")
        return notes

    # --- increments and outputs ------------------------------------------------------------------

    @property
    def n_increments(self) -> int:
        """Accepted increments, counted over all steps."""
        return max(len(self.history["time"]) - 1, 0)

    @cached_property
    def increments(self) -> np.ndarray:
        """(n_steps) the increment of each output, counted over all steps from 0, before loading."""
        if len(self.history["time"]) == 0:
            return np.arange(self.points.n_steps)
        return np.array([self.increment_at(time) for time in self.points.times])

    def increment_at(self, time: float) -> int:
        """The increment nearest to a total time, counted over all steps; 0 without a history."""
        times = self.history["time"]
        return int(np.abs(times - time).argmin()) if len(times) else 0

    def output_of(self, increment: int | None = None, time: float | None = None) -> int:
        """The output at an increment (negative: from the last one) or at a total time.

        Without either the last output. Raises PostError with those there are.
        """
        if increment is None and time is None:
            return self.points.n_steps - 1
        if time is not None:
            near = int(np.abs(self.points.times - time).argmin())
            span = max(float(np.abs(self.points.times).max()), 1e-300)
            if abs(self.points.times[near] - time) <= SAME_TIME * span:
                return near
            there = one_of([f"{value:g}" for value in self.points.times])
            raise PostError(f"'{self.name}' has no output at time {time:g}: there are {there}")
        assert increment is not None
        if -self.points.n_steps <= increment < 0:
            return self.points.n_steps + increment
        found = np.flatnonzero(self.increments == increment)
        if len(found) == 0:
            there = one_of([str(value) for value in self.increments])
            raise PostError(
                f"'{self.name}' has no output at increment {increment}: there are {there}"
            )
        return int(found[-1])

    def quantity(self, text: str) -> Quantity:
        """A quantity of the material points."""
        return find_quantity(text, self.points.point_fields, f"'{self.path.name}'")

    def mesh_quantity(self, text: str) -> Quantity:
        """A quantity of the nodes or elements of the mesh."""
        mesh = self.need_mesh()
        return find_quantity(text, mesh.field_names, f"'{mesh.path.name}'")

    def need_mesh(self) -> Series:
        """The mesh, or an error that names its file."""
        if self.mesh is None:
            raise PostError(f"'{self.folder / (self.name + MESH_SUFFIX)}' cannot be read")
        return self.mesh

    def values(self, quantity: Quantity, output: int) -> np.ndarray:
        """(n_points) a quantity of the material points at an output."""
        return quantity.evaluate(self.points.field(quantity.field, output))


def labels_of(jobs: Sequence[Job]) -> list[str]:
    """Labels that tell jobs apart: formulations, with names or even paths where they are alike."""
    labels = [job.label for job in jobs]
    paths = [job.path.resolve().with_suffix("") for job in jobs]
    for n_parts in (1, 2, 0):  # the name, with its folder, the whole path
        if len(set(labels)) == len(labels):
            break
        alike = {label for label in labels if labels.count(label) > 1}
        labels = [
            f"{'/'.join(path.parts[-n_parts:])}, {job.label}" if label in alike else label
            for job, label, path in zip(jobs, labels, paths)
        ]
    return labels


def check_units(jobs: Sequence[Job], dimensions: Sequence[str]) -> None:
    """Raises PostError when jobs that share an axis or a colour scale have other units."""
    for dimension in dimensions:
        units = [job.units.of(dimension) for job in jobs]
        for job, unit in zip(jobs, units):
            if unit != units[0]:
                raise PostError(
                    f"'{jobs[0].name}' is in {units[0]}, '{job.name}' in {unit}: expected jobs"
                    " with the same units"
                )


def find_results(name: str) -> list[Path]:
    """Result files that a user means by a name: a job, its deck, one of its files, or the two
    jobs of --compare. Raises PostError when there are none."""
    given = Path(name)
    if given.name.endswith(MESH_SUFFIX):
        given = given.with_name(given.name.removesuffix(MESH_SUFFIX) + SUFFIX)
    if given.suffix == SUFFIX or given.is_dir():
        return [given]
    if given.with_name(given.name + SUFFIX).name.endswith(MESH_SUFFIX) and not given.exists():
        of_points = given.with_name(given.name.removesuffix("_mesh") + SUFFIX)
        if of_points.exists():
            return [of_points]
    stem = given
    for ending in (".inp", ".log", ".sta", "_history.csv"):
        stem = stem.with_name(stem.name.removesuffix(ending))
    path = stem.with_name(stem.name + SUFFIX)
    if path.exists():
        return [path]
    pair = [stem.with_name(f"{stem.name}_{method}{SUFFIX}") for method in FORMULATIONS]
    found = [path for path in pair if path.exists()]
    if found:
        return found
    if given.is_file():
        return [given]
    raise PostError(f"there are no results of '{name}': no file '{path}'{nearby(path)}")


def nearby(path: Path) -> str:
    """The jobs in the folder of a file that is not there."""
    names = sorted(
        other.name.removesuffix(SUFFIX)
        for other in path.parent.glob(f"*{SUFFIX}")
        if not other.name.endswith((MESH_SUFFIX, FAIL_SUFFIX))
    )
    return f"; jobs there: {one_of(names)}" if names else ""


def open_jobs(names: list[str]) -> list[Job]:
    """The jobs of a command line, each once."""
    paths = [path for name in names for path in find_results(name)]
    return [Job(path) for path in dict.fromkeys(paths)]


def open_job(name: str) -> Job:
    """The one job of a command that draws one. Raises PostError when the name means two."""
    paths = find_results(name)
    if len(paths) > 1:
        names = " or ".join(f"'{path.with_suffix('')}'" for path in paths)
        raise PostError(f"'{name}' means more than one job: expected {names}")
    return Job(paths[0])
