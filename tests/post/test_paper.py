"""The figures of the documentation."""

import pytest
from post_runs import bar_deck
from tessera_post.paper import FIGURES, find_program
from test_picture import is_blank

# Small stand-ins for the examples: the same sets and fields, seconds of work less.
FOOTING = """\
*HEADING
Small footing
*UNITS, LENGTH=m, FORCE=kN
*GENERATE, TYPE=BOX, DIMENSION=3, ORDER=QUADRATIC, CELL=5, ELSET=SOIL
X, 0, 5, 2
Y, 0, 5, 2
Z, 0, 5, 2
*NSET, NSET=FOOTING
Z1
*FORMULATION, TYPE=FBAR PATCH
*PATCH, SOURCE=QUADRATIC
*MATERIAL, NAME=CLAY
*ELASTIC
1.0E4, 0.3
*MATERIAL POINTS, ELSET=SOIL, MATERIAL=CLAY, PER ELEMENT=4
*STEP, NAME=PUSH, INC=4
*STATIC, DIRECT
0.5, 1.0
*BOUNDARY
Z0, 3, 3
X0, 1, 1
Y0, 2, 2
FOOTING, 3, 3, -0.002
*HISTORY, NSET=FOOTING
RF, U
*OUTPUT, FIELD, FREQUENCY=1
S, ELEMENT
*END STEP
"""


def test_figures_are_drawn_from_finished_runs(post, example, tmp_path):
    results = example("footing", "fbar").parent.parent
    for name in ("stretch", "strip-footing"):
        example(name, "fbar")
    code, out, err = post("paper", "--results", results, "-o", tmp_path)
    assert (code, err) == (0, "")
    for figure in FIGURES:
        assert f"wrote {tmp_path / figure.name}" in out
        assert not is_blank(tmp_path / figure.name)
    assert len(list(tmp_path.iterdir())) == len(FIGURES) == 5


def test_examples_are_run_first(post, tessera_release, tmp_path):
    from conftest import ROOT

    decks = {
        "footing": FOOTING,
        "stretch": (ROOT / "input" / "stretch" / "stretch.inp").read_text(),
        "strip-footing": bar_deck().replace("X, 0, 4, 4\nY, 0, 1, 1", "X, 0, 4, 4\nY, 0, 5, 5"),
    }
    for name, deck in decks.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{name}.inp").write_text(deck)
    output = tmp_path / "figures"
    output.mkdir()
    options = ["--examples", tmp_path, "--tessera", tessera_release, "-o", output]
    code, out, err = post("paper", *options)
    assert (code, err) == (0, "")
    assert out.count("running ") == 3
    assert len(list(output.iterdir())) == len(FIGURES)
    assert not list((tmp_path / "stretch").glob("*.vtkhdf"))


def test_missing_run_is_told(post, tmp_path):
    code, _, err = post("paper", "--results", tmp_path, "-o", tmp_path)
    assert code == 2
    assert err.startswith("tessera-post: error: there is no 'footing_standard.vtkhdf' in ")


def test_run_that_fails_is_told(post, tessera_release, tmp_path):
    (tmp_path / "footing").mkdir()
    (tmp_path / "footing" / "footing.inp").write_text("*HEADING\nnothing\n")
    options = ["--examples", tmp_path, "--tessera", tessera_release, "-o", tmp_path]
    code, _, err = post("paper", *options)
    assert code == 2
    assert "footing.inp' ended with exit code 2: " in err
    assert err.count("\n") == 1


def test_program_is_looked_for(post, tmp_path, monkeypatch):
    code, _, err = post("paper", "--tessera", tmp_path, "--examples", tmp_path, "-o", tmp_path)
    assert code == 2
    assert err.startswith(f"tessera-post: error: '{tmp_path}' is no program: expected --tessera")
    program = tmp_path / "tessera"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("TESSERA_EXE", str(program))
    assert find_program(None) == program


def test_outside_of_a_checkout_folders_are_needed(post, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, _, err = post("paper")
    assert code == 2
    assert "this is no checkout of Tessera: expected --examples and -o, or --results" in err


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_figures_have_names_of_their_own(figure):
    assert figure.name.endswith(".png")
    assert figure.command in ("curve", "picture", "deformed", "scatter")
