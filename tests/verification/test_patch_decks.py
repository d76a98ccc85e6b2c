"""The decks of the patch tests are what their script writes, and it proves its closed forms."""

import os
import re
import shutil
import subprocess
import sys

import pytest
from conftest import ROOT

CASE = ROOT / "input" / "verification" / "patch-tests"
NUMBER = re.compile(r"[-+]?\d+(?:\.\d*(?:e[-+]?\d+)?|e[-+]?\d+)")  # no integers
ROUNDING = 1e-12  # sines and eigenvectors differ from system to system; the decks ask for 1e-11


def write_decks(folder):
    """Runs the script of a folder; its exit code and what it says."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "make_decks.py"]
    run = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    return run.returncode, run.stderr


@pytest.fixture
def scripts(tmp_path):
    """A folder with the scripts of the case and nothing else."""
    folder = tmp_path / "patch-tests"
    folder.mkdir()
    for script in CASE.glob("*.py"):
        shutil.copy(script, folder)
    return folder


def test_files_are_what_the_script_writes(scripts):
    assert write_decks(scripts) == (0, "")
    names = sorted(path.name for path in scripts.iterdir())
    there = {path.name for path in CASE.iterdir() if path.is_file()}
    assert names == sorted(there - {"README.md"})
    for name in names:
        new, old = (scripts / name).read_text(), (CASE / name).read_text()
        if new == old:
            continue
        assert NUMBER.sub("#", new) == NUMBER.sub("#", old), name
        numbers = [float(number) for number in NUMBER.findall(new)]
        before = [float(number) for number in NUMBER.findall(old)]
        assert numbers == pytest.approx(before, rel=ROUNDING, abs=ROUNDING), name


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("math.sqrt(1.5) * 2.0", "math.sqrt(1.4) * 2.0"),  # yield surface
        ("a @ self.b @ a.T", "a.T @ self.b @ a"),  # left Cauchy-Green tensor
        ("self.tau / self.jacobian", "self.tau"),  # Cauchy stress
        ("self.peeq += flow", "self.peeq += 1.001 * flow"),  # plastic strain
    ],
)
def test_script_refuses_a_wrong_reference(right, wrong, scripts):
    path = scripts / "reference.py"
    text = path.read_text()
    assert text.count(right) == 1
    path.write_text(text.replace(right, wrong))
    code, message = write_decks(scripts)
    assert code == 1
    assert "AssertionError" in message
