"""The command line of the program: what needs no deck."""

import re
import subprocess

import pytest
from conftest import ROOT


def revision():
    """The commit of the sources; "unknown", as the program says, without git or a repository."""
    command = ["git", "-c", f"safe.directory={ROOT}", "-C", ROOT, "rev-parse", "--short=12", "HEAD"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (FileNotFoundError, subprocess.CalledProcessError):
        return "unknown"


@pytest.mark.parametrize("option", ["--help", "-h"])
def test_help_goes_to_stdout(tessera, run_program, option):
    run = run_program(tessera, option)
    assert (run.code, run.stderr) == (0, "")
    assert run.stdout.startswith("usage: tessera [options] JOB.inp")


def test_version_names_program_and_revision(tessera, run_program):
    run = run_program(tessera, "--version")
    assert (run.code, run.stderr) == (0, "")
    version = re.search(
        r"project\(tessera\s+VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()
    )
    assert version.group(1) in run.stdout
    assert revision() in run.stdout


@pytest.mark.parametrize(
    "arguments", [(), ("--no-such-option",), ("a.inp", "b.inp"), ("a.inp", "-t", "none")]
)
def test_wrong_command_line_exits_1(tessera, run_program, arguments):
    run = run_program(tessera, *arguments)
    assert run.code == 1
    assert run.stdout == ""
    assert run.stderr != ""
    assert "Backtrace" not in run.stderr


def test_pages_hold_no_placeholders():
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]
    assert len(pages) > 8
    assert [page.name for page in pages if "@@" in page.read_text(encoding="utf-8")] == []
