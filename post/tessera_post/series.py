"""A VTKHDF file with time steps: the one place that knows how it is laid out."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np

from tessera_post.errors import PostError, one_of

VTK_TRIANGLE = 5
MOST_TRIES = 50  # to open a file that is locked, or to read one that changes all the time
PAUSE = 0.02  # between them [s]
Loaded = TypeVar("Loaded")

# What h5py raises where a file is damaged, or holds something else than we look for.
UNREADABLE = (
    AttributeError,
    IndexError,
    KeyError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
)


def open_hdf5(path: Path) -> h5py.File:
    """An HDF5 file for reading, also while a run is going on: the run leaves it alone as long as it
    is open, and locks it for a moment only before it was opened."""
    if not path.exists():
        raise PostError(f"there is no file '{path}'")
    if path.is_dir():
        raise PostError(f"'{path}' is a folder: expected a result file")
    try:
        if not h5py.is_hdf5(path):
            raise PostError(f"'{path}' is no HDF5 file: expected a .vtkhdf file of Tessera")
        for _ in range(MOST_TRIES):
            try:
                return h5py.File(path, "r")
            except BlockingIOError:
                time.sleep(PAUSE)
        return h5py.File(path, "r", locking=False)
    except OSError as problem:
        raise PostError(f"cannot read '{path}': {first_line(problem)}") from problem


def stamp_of(path: Path) -> tuple[int, int]:
    """Changes when the file is written to."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size


def first_line(problem: BaseException) -> str:
    """The first line of a library's message."""
    return (str(problem).splitlines() or [type(problem).__name__])[0]


class Series:
    """Points, cells and fields of every output; only what is asked for is read.

    times    (n_steps) total times of the outputs
    note     text, empty if the file is complete
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._stamp = stamp_of(path)
        self.file = open_hdf5(path)
        self.note = ""
        try:
            stated = self.read(
                lambda file: self._survey(file["VTKHDF"]),
                f"'{path}' is no result of Tessera, or was never finished",
            )
        except PostError:
            self.file.close()
            raise
        self.times = self.times[: self.n_steps]
        if self.n_steps < stated:
            self.note = f"'{path.name}': the last {stated - self.n_steps} outputs are incomplete"
        if self.n_steps == 0:
            self.file.close()
            raise PostError(f"'{path}' holds no output yet")

    def _survey(self, grid: h5py.Group) -> int:
        """Reads how the file is laid out; the number of outputs that it states."""
        steps = grid["Steps"]
        stated = int(steps.attrs["NSteps"])
        self._part = steps["PartOffsets"][:stated]
        self._first_point = steps["PointOffsets"][:stated]
        self._first_cell = steps["CellOffsets"][:stated, 0]
        self._first_id = steps["ConnectivityIdOffsets"][:stated, 0]
        self._n_points = grid["NumberOfPoints"][()]
        self._n_cells = grid["NumberOfCells"][()]
        self._n_ids = grid["NumberOfConnectivityIds"][()]
        self._offset = {
            name: offsets[:stated]
            for kind in ("PointDataOffsets", "CellDataOffsets")
            for name, offsets in steps[kind].items()
        }
        self.point_fields = list(grid["PointData"])
        self.cell_fields = list(grid["CellData"])
        self.cell_type = int(grid["Types"][0]) if len(grid["Types"]) else 0
        self.times = steps["Values"][:stated]
        self.n_steps = self._complete_steps(grid, stated)
        return stated

    def _complete_steps(self, grid: h5py.Group, stated: int) -> int:
        """Steps of which every dataset holds all rows: a kill may cut the last one."""
        columns = [self.times, self._part, self._first_point, self._first_cell, self._first_id]
        n = min(stated, *(len(column) for column in (*columns, *self._offset.values())))
        while n > 0 and not self._is_complete(grid, n - 1):
            n -= 1
        return n

    def _is_complete(self, grid: h5py.Group, step: int) -> bool:
        part = self._part[step]
        if part >= min(len(self._n_points), len(self._n_cells), len(self._n_ids)):
            return False
        if self._first_point[step] + self._n_points[part] > len(grid["Points"]):
            return False
        if self._first_id[step] + self._n_ids[part] > len(grid["Connectivity"]):
            return False
        return all(
            self._offset[name][step] + self._rows(name, step) <= len(grid[self._where(name)])
            for name in (*self.point_fields, *self.cell_fields)
        )

    def _rows(self, name: str, step: int) -> int:
        count = self._n_points if name in self.point_fields else self._n_cells
        return int(count[self._part[step]])

    def _where(self, name: str) -> str:
        return f"{'PointData' if name in self.point_fields else 'CellData'}/{name}"

    @property
    def field_names(self) -> list[str]:
        """Names of all fields, those of points first."""
        return [*self.point_fields, *self.cell_fields]

    def n_points(self, step: int) -> int:
        """Number of points of an output."""
        return int(self._n_points[self._part[step]])

    def points(self, step: int) -> np.ndarray:
        """(n_points, 3) positions at an output [length]."""
        first = int(self._first_point[step])
        return self._read("Points", first, self.n_points(step))

    def field(self, name: str, step: int) -> np.ndarray:
        """(rows) or (rows, components) of a field at an output."""
        if name not in self._offset:
            raise PostError(
                f"'{self.path.name}' has no field '{name}': there are {one_of(self.field_names)}"
            )
        first = int(self._offset[name][step])
        return self._read(self._where(name), first, self._rows(name, step))

    def cells(self, step: int = 0) -> np.ndarray:
        """(n_cells, nodes per cell) point numbers of the cells, from 0; all cells are alike."""
        part = self._part[step]
        n_cells, n_ids = int(self._n_cells[part]), int(self._n_ids[part])
        ids = self._read("Connectivity", int(self._first_id[step]), n_ids)
        n_corners = max(n_ids // max(n_cells, 1), 1)
        if n_corners * n_cells != n_ids:
            raise PostError(f"'{self.path}' has cells of several types: expected one type")
        return ids.reshape(n_cells, n_corners)

    def _read(self, name: str, first: int, count: int) -> np.ndarray:
        return self.read(lambda file: file["VTKHDF"][name][first : first + count])

    def read(self, load: Callable[[h5py.File], Loaded], failure: str = "") -> Loaded:
        """What `load` takes from the file. A run that is still writing moves things about: when
        the file has changed since it was opened, it is opened again."""
        for _ in range(MOST_TRIES):
            try:
                return load(self.file)
            except UNREADABLE as problem:
                cause = problem
            time.sleep(PAUSE)
            stamp = stamp_of(self.path)
            if stamp == self._stamp:
                break
            self.file.close()
            self._stamp = stamp
            self.file = open_hdf5(self.path)
        failure = failure or f"cannot read '{self.path}'"
        raise PostError(f"{failure}: {first_line(cause)}")

    def close(self) -> None:
        """Closes the file."""
        self.file.close()
