"""The quick decks of input/verification, and some of them in the debug build and with two threads.

All decks, slow ones too: tools/verify --all.
"""

import pytest
from conftest import ROOT
from verification.case import load_cases
from verification.judging import judge
from verification.measuring import measure_all
from verification.running import Settings, run_deck
from verification.table import case_text

CASES = load_cases(ROOT / "input" / "verification", [])
# Small decks that go through much of the program: frozen values must be the same in every build.
EVERYWHERE = {
    "strip-footing": ("standard-03-0250.inp",),
    "paper-stretch": ("fbar-1-y.inp", "fbar-2-z.inp"),
    "cook": ("fbar-04999-08.inp", "standard-03-08.inp"),
    "patches": ("cook-quadratic.inp", "cook-metis-04.inp"),
    "inclined-roller": (
        "plane-fbar.inp",
        "plane-fbar-inclined.inp",
        "solid-standard.inp",
        "solid-standard-inclined.inp",
    ),
    "traction-patch": ("crossing-2d-points-fbar-064.inp", "crossing-2d-mesh-standard-064.inp"),
    "hydrostatic": ("heave-fbar-08.inp", "heave-standard-08.inp"),
    "column": ("carried-fbar-016.inp", "carried-standard-3d-008.inp", "fixed-standard-032.inp"),
    "thick-cylinder": ("hardening-4-fbar.inp", "large-4-standard.inp"),
}


def verdict_of(case, decks, settings):
    """Runs decks of a case; the table of its results when anything misses, else nothing."""
    runs = [run_deck(case, deck, settings) for deck in decks]
    result = judge(case, runs, measure_all(case, runs))
    assert result.rows or result.problems
    return case_text(result) if result.n_failed else ""


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_quick_decks_give_what_they_should(case, tessera_release, tmp_path):
    decks = case.decks_to_run(with_slow=False)
    if not decks:
        pytest.skip("all decks of the case are slow")
    assert verdict_of(case, decks, Settings(tessera_release, tmp_path, 1, 1)) == ""


@pytest.mark.parametrize(("program", "threads"), [("tessera", 1), ("tessera_release", 2)])
@pytest.mark.parametrize("name", EVERYWHERE)
def test_frozen_values_hold_with_checks_and_threads(name, program, threads, request, tmp_path):
    case = next(case for case in CASES if case.name == name)
    decks = [deck for deck in case.decks if deck.file in EVERYWHERE[name]]
    assert len(decks) == len(EVERYWHERE[name])
    settings = Settings(request.getfixturevalue(program), tmp_path, 1, threads)
    assert verdict_of(case, decks, settings) == ""


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_case_has_frozen_values(case):
    decks = [(case.folder / deck.file).read_text() for deck in case.decks]
    assert any("\nfrozen," in deck for deck in decks) or any(m.frozen for m in case.measures)
