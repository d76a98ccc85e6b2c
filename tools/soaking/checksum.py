"""One number for everything that a run wrote and that is no time."""

import hashlib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

SECONDS = ("kinematics", "stress", "assembly", "factorisation", "solve")  # of tessera/iterations
TIMES = {f"tessera/iterations/{name}" for name in SECONDS}
TIMES |= {f"tessera/ledger/{name}" for name in ("location", "output", "point_loop")}
OF_THE_MOMENT = {"started", "threads", "run"}  # of these groups, as attributes
GROUPS = {"tessera", "VTKHDF"}


def checksum(folder: Path, job: str) -> str:
    """SHA-256 of the history, and of all objects in both field files but wall and CPU times, the
    date, the number of threads and the name of the run. The log and the status file tell times in
    every line: all that is no time in them stands in the tables of the field file."""
    digest = hashlib.sha256()
    digest.update((folder / f"{job}_history.csv").read_bytes())
    for name in (f"{job}.vtkhdf", f"{job}_mesh.vtkhdf"):
        with h5py.File(folder / name) as file:
            for part in parts_of(file):
                digest.update(part)
    return digest.hexdigest()


def parts_of(file: h5py.File) -> Iterator[bytes]:
    """Names, attributes and values of all objects, in the order of their names."""
    names: list[str] = []
    file.visit(names.append)
    for name in sorted(names):
        if name in TIMES:
            continue
        thing = file[name]
        yield f"{name}\n".encode()
        for key in sorted(thing.attrs):
            if not (name in GROUPS and key in OF_THE_MOMENT):
                yield f"{key}\n".encode()
                yield from bytes_of(np.asarray(thing.attrs[key]))
        if isinstance(thing, h5py.Dataset):
            yield from bytes_of(np.asarray(thing[()]))


def bytes_of(values: np.ndarray) -> Iterator[bytes]:
    """Type, shape and bits of an array."""
    yield f"{values.dtype.str} {values.shape}\n".encode()
    yield repr(values.tolist()).encode() if values.dtype.hasobject else values.tobytes()
