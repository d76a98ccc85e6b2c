"""Restart files changed: damaged, cut, and damaged in a way that their seal does not tell."""

import contextlib
import os
import subprocess
import zlib
from pathlib import Path
from random import Random

import h5py
import numpy as np

from fuzzing import deck_mutation, words
from fuzzing.driver import ENVIRONMENT

SEAL = 512  # bytes of text in front
DECK = """\
*GENERATE, TYPE=BOX, DIMENSION=2
X, 0, 1, 2
Y, 0, 1, 2
*FORMULATION, TYPE=STANDARD
*MATERIAL, NAME=CLAY
*ELASTIC
100, 0.3
*PLASTIC, LAW=VON MISES, STRENGTH=UNIAXIAL
1.0, 0.0
*MATERIAL POINTS, ELSET=ALL, MATERIAL=CLAY, PER ELEMENT=1
*STEP, INC=20
*STATIC, DIRECT
0.25, 1
*BOUNDARY
X0, 1, 1
Y0, 2, 2
Y1, 2, 2, -0.01
*RESTART, WRITE, FREQUENCY=1
*OUTPUT, FIELD, FREQUENCY=1
S, PEEQ
*END STEP
"""
INTEGERS = (0, -1, 1, 2, 1000, 2**30, 2**31 - 1, -(2**31))
REALS = (0.0, -1.0, 1.0, 1e308, -1e308, 1e-308, np.nan, np.inf, -np.inf, 0.5)


class RestartMutator:
    """Makes restart files from one that the program wrote."""

    def __init__(self, program: Path, folder: Path) -> None:
        deck = folder / "restart.inp"
        deck.write_text(DECK)
        command = [program, "-q", "-f", deck.name]
        environment = {**os.environ, **ENVIRONMENT}
        subprocess.run(command, cwd=folder, check=True, timeout=300, env=environment)
        self.good = (folder / "restart.restart.h5").read_bytes()
        self.scratch = folder / "edited.h5"

    def make(self, random: Random) -> bytes:
        """A restart file."""
        kind = random.random()
        if kind < 0.3:
            change = random.choice((
                deck_mutation.flip_byte, deck_mutation.truncate, deck_mutation.insert_bytes,
                deck_mutation.delete_bytes, deck_mutation.repeat_bytes,
            ))  # fmt: skip
            return change(random, self.good)
        if kind < 0.5:
            return self.other_seal(random)
        return self.edited(random)

    def other_seal(self, random: Random) -> bytes:
        """Another text in front."""
        lines = self.good[:SEAL].rstrip(b"\0 ").split(b"\n")
        i = random.randrange(len(lines))
        name = lines[i].split(b" ")[0]
        value = words.number(random).encode()
        lines[i] = random.choice((b"", name, name + b" " + value, name + b" " + value * 40, value))
        if random.random() < 0.2:
            random.shuffle(lines)
        return b"\n".join(lines)[:SEAL].ljust(SEAL, random.choice((b" ", b"\0"))) + self.good[SEAL:]

    def edited(self, random: Random) -> bytes:
        """Other values or shapes, with a seal that fits."""
        self.scratch.write_bytes(self.good)
        with h5py.File(self.scratch, "r+") as file:
            names: list[str] = []
            file.visititems(
                lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None
            )
            for _ in range(random.choice((1, 1, 1, 2, 5))):
                # What h5py cannot write stays as it is, or is gone.
                with contextlib.suppress(TypeError, ValueError, OSError):
                    change_dataset(random, file, random.choice(names))
        return sealed(self.scratch.read_bytes())


def change_dataset(random: Random, file: h5py.File, name: str) -> None:
    """One value, the shape, the type, or all of a dataset."""
    if not isinstance(file.get(name), h5py.Dataset):
        return
    old = file[name][()]
    if isinstance(old, bytes):
        old = np.bytes_(old)
    value = np.array(old)
    kind = random.randrange(5)
    if kind < 2 and value.size > 0 and value.dtype.kind in "iuf" and value.ndim > 0:
        place = tuple(random.randrange(n) for n in value.shape)
        new = np.array(random.choice(REALS if value.dtype.kind == "f" else INTEGERS))
        with np.errstate(all="ignore"):
            value[place] = new.astype(value.dtype)  # wraps: bytes of texts, too
        file[name][...] = value
        return
    del file[name]
    if kind == 2:
        shape = tuple(random.choice((0, 1, 2, 3, 7, n)) for n in value.shape) or (
            random.randrange(3),
        )
        file[name] = np.zeros(shape, value.dtype)
    elif kind == 3:
        other = random.choice((np.int8(1), np.float32(1), np.bytes_(b"x" * 300), "text", 2**62))
        file[name] = random.choice((other, [other] * max(value.size, 1)))
    elif kind == 4:
        what = random.randrange(3)
        if what == 0:
            file.create_group(name)
        elif what == 1:
            file[name] = h5py.ExternalLink("/dev/zero", "/" + name)


def sealed(data: bytes) -> bytes:
    """The same with length and checksum of what is behind the seal."""
    lines = data[:SEAL].rstrip(b"\0 ").split(b"\n")
    for i, line in enumerate(lines):
        if line.startswith(b"length "):
            lines[i] = b"length %d" % (len(data) - SEAL)
        if line.startswith(b"checksum "):
            lines[i] = b"checksum %08X" % zlib.crc32(data[SEAL:])
    return b"\n".join(lines).ljust(SEAL)[:SEAL] + data[SEAL:]
