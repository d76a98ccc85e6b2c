"""Bits that do not depend on the number of threads nor on the moment: one checksum.

At full length: tools/soak determinism.
"""

import os
import re
import shutil

import h5py
import numpy as np
import pytest
from conftest import ROOT
from soaking.checksum import TIMES, checksum
from soaking.determinism import Settings, run_once

VERIFICATION = ROOT / "input" / "verification"
# The first increments of decks with a moving mesh; a mesh that stays and the ghost penalty;
# surface points and rotated axes.
DECKS = {
    "footing": (ROOT / "input" / "footing" / "footing.inp", 2, 2),
    "cantilever": (VERIFICATION / "cantilever" / "fbar-on-06-08.inp", 3, 1),
    "roller": (VERIFICATION / "inclined-roller" / "plane-fbar-inclined.inp", None, 1),
    "tractions": (VERIFICATION / "traction-patch" / "crossing-2d-points-fbar-064.inp", 3, 1),
}


def shortened(text, n):
    """A deck that ends after some increments; what it expects later is left out."""
    text = re.sub(r"\*EXPECT.*\n(?:(?:analytic|frozen|\*\*).*\n)+", "", text)
    step = re.search(r"(\*STATIC.*\n)([^,\n]+),\s*[^,\n]+", text)
    size = float(step[2])
    return text[: step.start()] + f"{step[1]}{size!r}, {n * size!r}" + text[step.end() :]


@pytest.fixture
def short_deck(request, tmp_path):
    """A short deck in a copy of its folder, and how often it is run."""
    deck, n, repeats = DECKS[request.param]
    folder = tmp_path / "deck"
    shutil.copytree(deck.parent, folder)
    for path in folder.glob("*.in[cp]"):
        text = path.read_text(encoding="utf-8")
        if n and "*STATIC" in text:
            path.write_text(shortened(text, n), encoding="utf-8")
        elif n:
            path.write_text(re.sub(r"\*EXPECT.*\n(?:(?:analytic|frozen).*\n)+", "", text))
    return folder / deck.name, repeats


@pytest.mark.parametrize("short_deck", DECKS, indirect=True)
def test_any_number_of_threads_gives_one_checksum(short_deck, tessera_release, tmp_path):
    deck, repeats = short_deck
    settings = Settings(tessera_release, deck, tmp_path / "results")
    found = [run_once(settings, threads) for _ in range(repeats) for threads in (1, 2, 4)]
    assert len(set(found)) == 1, found


# --- the checksum --------------------------------------------------------------------------------

BAR = """\
*GENERATE, TYPE=BOX, DIMENSION=2, ORDER=LINEAR, ELSET=BAR
X, 0, 2, 2
Y, 0, 1, 1
*MATERIAL, NAME=RUBBER
*ELASTIC
1000.0, 0.3
*MATERIAL POINTS, ELSET=BAR, MATERIAL=RUBBER, PER ELEMENT=3
*FORMULATION, TYPE=STANDARD
*STEP
*STATIC, DIRECT
0.5, 1.0
*BOUNDARY
X0, 1, 1
Y0, 2, 2
X1, 1, 1, 0.1
*HISTORY, NSET=X1
RF
*END STEP
"""


@pytest.fixture
def bar(run_tessera):
    """The folder of a finished run, and its checksum."""
    run = run_tessera(BAR)
    assert run.code == 0, run.stderr
    return run.folder, checksum(run.folder, "job")


def test_times_are_left_out(bar):
    folder, before = bar
    with h5py.File(folder / "job.vtkhdf", "r+") as file:
        for name in TIMES:
            file[name][...] += 1.0
        file["tessera"].attrs["started"] = b"2000-01-01T00:00:00+00:00"
        file["tessera"].attrs["threads"] = np.int64(7)
        file["tessera"].attrs["run"] = b"20000101T000000.000+0000-7"
    with h5py.File(folder / "job_mesh.vtkhdf", "r+") as file:
        file["VTKHDF"].attrs["run"] = b"20000101T000000.000+0000-7"
    os.utime(folder / "job.vtkhdf", (0, 0))
    assert checksum(folder, "job") == before


CHANGES = {
    "field": ("job.vtkhdf", "VTKHDF/PointData/S"),
    "mesh": ("job_mesh.vtkhdf", "VTKHDF/PointData/RF"),
    "residual": ("job.vtkhdf", "tessera/iterations/residual"),
    "count": ("job.vtkhdf", "tessera/ledger/count"),
    "history": ("job.vtkhdf", "tessera/history/RF1[X1]"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_one_bit_makes_a_difference(change, bar):
    folder, before = bar
    name, path = CHANGES[change]
    with h5py.File(folder / name, "r+") as file:
        values = file[path][()]
        bits = values.view(np.uint8)
        bits.flat[-values.itemsize] ^= 1
        file[path][...] = values
    assert checksum(folder, "job") != before


def test_history_and_attributes_make_a_difference(bar):
    folder, before = bar
    with h5py.File(folder / "job.vtkhdf", "r+") as file:
        file["tessera"].attrs["formulation"] = b"fbar"
    other = checksum(folder, "job")
    assert other != before
    text = (folder / "job_history.csv").read_text()
    (folder / "job_history.csv").write_text(text.replace("time 0", "time 1"))
    rows = text.splitlines()
    (folder / "job_history.csv").write_text("\n".join(rows[:-1]) + "\n")
    assert checksum(folder, "job") != other
