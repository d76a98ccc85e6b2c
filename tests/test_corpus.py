"""Hostile input: what mutations found in the program once, and what no program should fall for."""

import os
import socket

import pytest
from bad_input_cases import PLANE, SOLID
from conftest import ROOT
from test_bad_input import assert_clean

CORPUS = ROOT / "tests" / "corpus"

# deck: exit code and a part of the message
FOUND = {
    "carrier-inside": (
        3,
        "surface carrier of nodes 2 3 of set LEFT: expected a face",
    ),
    "control-character-in-section": (3, "the file ends inside $Physical?Names"),
    "element-of-another-dimension": (3, "in an entity of dimension 1: expected elements of this"),
    "entities-beyond-counting": (3, "the file is too short for this count"),
    "large-coordinate": (2, "at most 1e30 in magnitude"),
    "heights-of-one-stress": (2, "both heights are 1e-300: expected two different ones"),
    "labels-far-apart": (0, ""),  # an overflow that only the sanitizers see
    "large-tags": (3, "'4611686018427387904' is too large: expected the number of node 4 of 4"),
    "long-name-of-group": (3, "as text in UTF-8, at most 80 characters"),
    "many-nodes-announced": (3, "the file is too short for this count"),
    "short-first-increment": (2, "the first increment 1e-300 is too short for the step"),
    "short-output-interval": (2, "TIME INTERVAL=1e-9 of *OUTPUT is too short for this step"),
    "vanishing-edges": (3, "zero volume"),
    "vanishing-elements": (3, "zero volume"),
}


@pytest.mark.parametrize("name", sorted(FOUND))
def test_finding_stays_mended(name, tessera, run_program, tmp_path):
    run = run_program(tessera, CORPUS / f"{name}.inp", "--check", "-q", "-o", tmp_path, timeout=60)
    code, part = FOUND[name]
    assert part in run.stderr
    assert run.code == code
    assert all(character.isprintable() or character == "\n" for character in run.stderr)


def test_corpus_is_complete():
    assert {path.stem for path in CORPUS.glob("*.inp")} == set(FOUND)


# --- files that are no files ----------------------------------------------------------------------


def special_file(folder, kind):
    """Makes it; the path to write into a deck."""
    path = folder / kind
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "loop":
        path.symlink_to(path)
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(os.path.relpath(path))
    else:
        return kind
    return path.name


KINDS = {
    "pipe": "it is a pipe or a device, no file",
    "folder": "Is a directory",
    "loop": "Too many levels of symbolic links",
    "socket": "No such device or address",
    "/proc/self/mem": "it is a pipe or a device, no file",
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("card", ["*INCLUDE, INPUT", "*MESH, FILE"])
def test_special_file_is_refused_at_once(kind, card, run_tessera, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = special_file(tmp_path, kind)
    deck = PLANE[PLANE.index("*FORMULATION") :]
    run = run_tessera(f'{card}="{path}"\n{deck}', "--check", timeout=30)
    assert KINDS[kind] in run.stderr
    assert run.code == (8 if "MESH" in card else 2)
    assert_clean(run.stderr)


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/full", "/dev/null"])
def test_device_without_end_is_an_empty_mesh(path, run_tessera):
    deck = PLANE[PLANE.index("*FORMULATION") :]
    run = run_tessera(f'*MESH, FILE="{path}"\n{deck}', "--check", timeout=30)
    assert "the file is empty: expected a gmsh mesh" in run.stderr
    assert run.code == 3


def test_pipe_is_no_deck_and_no_restart_file(tessera, run_program, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    run = run_program(tessera, "pipe", timeout=30)
    assert run.stderr == "pipe: error: cannot read the deck: it is a pipe or a device, no file\n"
    assert run.code == 2
    (tmp_path / "job.inp").write_text(PLANE)
    run = run_program(tessera, "job.inp", "--restart", "pipe", timeout=30)
    assert "restart file 'pipe' cannot be opened" in run.stderr
    assert run.code == 8


# --- too much of everything -----------------------------------------------------------------------

STEP = "*STEP\n*STATIC\n1, 1\n*END STEP\n"
TOO_MUCH = {
    "lines": (
        "*HEADING\n" + "x" * 10_000_000 + "\n",
        "line of 10000000 characters: expected",
    ),
    "keywords": ("*STATIC\n" * 100_000, "more than 5000 keywords: expected fewer"),
    "wrong keywords": ("*STATIK\n" * 5000, "more"),
    "wrong data": ("*NODE\n" + "1, 2, x\n" * 100_000, "y of *NODE is"),
    "wrong bytes": ("*NODE\n" + "\udcff\n" * 100_000, "byte that is not UTF-8"),
    "includes": ('*INCLUDE, INPUT="empty.inc"\n' * 5000, "more than 1000 files in a deck"),
    "fields": ("*STEP" + ",\nINC" * 20_000 + "\n", "more than 1000 fields in a keyword line"),
    "digits": (PLANE.replace("100, 0.3", "9" * 2000 + ", 0.3"), "E of *ELASTIC is"),
    "cells": (SOLID.replace("X, 0, 1, 1", "X, 0, 1, 1000000000"), "expected at most 10000"),
    "cells in all": (SOLID.replace(", 0, 1, 1\n", ", 0, 1, 9999\n"), "cells: expected at most 2e7"),
    "name": (PLANE.replace("CLAY", "N" * 81), "expected a name of at most 80 characters"),
}


@pytest.mark.parametrize("what", TOO_MUCH)
def test_too_much_is_refused_in_few_words(what, run_tessera, tmp_path):
    (tmp_path / "empty.inc").write_text("")
    deck, part = TOO_MUCH[what]
    run = run_tessera((deck + STEP).encode("utf-8", "surrogateescape"), "--check", timeout=60)
    assert part in run.stderr
    assert run.code == 2
    assert len(run.stderr) < 100_000
    assert_clean(run.stderr.replace("... and ", "job.inp: error: "))


def test_includes_end_at_ten_levels(run_tessera, tmp_path):
    for i in range(13):
        (tmp_path / f"deep{i}.inc").write_text(f'*INCLUDE, INPUT="deep{i + 1}.inc"\n')
    run = run_tessera('*INCLUDE, INPUT="deep0.inc"\n' + STEP)
    assert "more than 10 files include each other: expected fewer" in run.stderr
    assert run.code == 2


@pytest.mark.parametrize(
    "data", [b"\0" * 100_000, PLANE.encode("utf-16"), b"\xef\xbb\xbf", b"\r" * 9]
)
def test_what_is_no_text_is_refused(data, run_tessera):
    run = run_tessera(data, timeout=60)
    assert run.code == 2
    assert_clean(run.stderr)
