"""tools/verify: reading of cases, judging, freezing, the page, and the whole of it."""

import dataclasses
import math
import re
import subprocess
import sys

import pytest
from conftest import ROOT
from small_cases import CASE, make_case
from tessera_post.log import Log, Verdict
from verification import judging
from verification.__main__ import main
from verification.case import Deck, Measure, Study, load_case, load_cases
from verification.figures import draw_figures
from verification.freezing import freeze
from verification.judging import Row, judge, judge_study, order_of, row_of_measure
from verification.measuring import Found, measure_all
from verification.page import page_text
from verification.running import DeckRun, Settings, is_checked, run_deck
from verification.table import case_text
from verification.texts import error_text
from verification.toml_table import CaseError


def verdict(kind="analytic", value="2", found="2.1", met=True, **options):
    values = {"place": "bar.inp:30", "what": "SUM RF1[X1]", "time": "1", "tolerance": "0.2"}
    return Verdict(kind=kind, value=value, found=found, met=met, **{**values, **options})


def finished(folder, *verdicts, code=0, seconds=1.0, deck="bar.inp", wanted=0):
    log = Log(verdicts=list(verdicts), exit_code=code)
    return DeckRun(Deck(deck, "quick", wanted), code, seconds, folder, log, "it broke")


@pytest.fixture
def case(tmp_path):
    return load_case(make_case(tmp_path))


# --- case.toml -----------------------------------------------------------------------------------


def test_case_is_read(case):
    assert (case.name, case.title) == ("bar", "Plastic bar")
    assert [deck.job for deck in case.decks_to_run(with_slow=False)] == ["bar"]
    assert [deck.job for deck in case.decks_to_run(with_slow=True)] == ["bar", "long"]
    assert case.measures[0].frozen == {"bar.inp": 0.2, "long.inp": 0.3}
    assert case.studies[0].h == (1.0, 0.5)
    assert case.figures[0].command == ("curve", "bar")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("title =", "titel =", "there is no 'title': expected a text"),
        ("summary = ", 'extra = 1\nsummary = "', "case.toml: "),
        ('label = "quick"', 'label = "fast"', "deck 1: 'label' is 'fast': expected quick or slow"),
        ('"bar.inp"\nlabel', '"foo.inp"\nlabel', "deck 1: 'file' is 'foo.inp': expected a deck"),
        ('label = "slow"', 'label = "slow"\nexit = "7"', "deck 2: 'exit' is '7': expected an int"),
        ('label = "slow"', 'label = "slow"\nexti = 7', "deck 2: unknown key 'exti': expected file"),
        ('"long.inp"\nlabel', '"bar.inp"\nlabel', "deck 'bar.inp' is there twice"),
        ("exact = 0.2\n", "", "measure 1: expected 'exact' together with 'rtol' or 'atol'"),
        ("atol = 0.05\n", "", "measure 1: expected 'exact' together with 'rtol' or 'atol'"),
        ("atol = 0.05", 'atol = {"bar.inp" = 1}', "'atol' of 'plastic strain': expected one for"),
        ("atol = 0.05", 'atol = {"bar.inp" = "a"}', "'atol' of 'bar.inp' is 'a': expected a num"),
        ("{factor = 2.0}", "2.0", "measure 1: 'arguments' is 2.0: expected a table"),
        ('"bar.inp" = 0.2', '"foo.inp" = 0.2', "there is no deck 'foo.inp': there are bar.inp"),
        ('"bar.inp" = 0.2', '"bar.inp" = "a"', "'frozen' of 'bar.inp' is 'a': expected a number"),
        ("h = [1.0, 0.5]", "h = [1.0]", "study 1: expected two decks or more and as many 'h'"),
        ("h = [1.0, 0.5]", "h = [1.0, -0.5]", "study 1: 'h': expected sizes above 0"),
        ("h = [1.0, 0.5]", "h = [1.0, true]", "expected a list of numbers"),
        ('measure = "plastic', 'measure = "elastic', "there is no measure 'elastic strain'"),
        ('measure = "p', 'expect = "RF"\nmeasure = "p', "expected one of measure, expect, found 2"),
        ("order = 1.0", "order = true", "study 1: 'order' is True: expected a number"),
        ('"bar.png"', '"a/b.png"', "figure 1: 'file' is 'a/b.png': expected the name of a PNG"),
        ("command =", "studies =", "figure 'bar.png': there is no study 'curve'"),
        ("[[deck]]", "[deck]", "case.toml: "),
    ],
)
def test_wrong_case_is_refused(old, new, message, tmp_path):
    assert old in CASE
    folder = make_case(tmp_path, CASE.replace(old, new, 1))
    with pytest.raises(CaseError) as problem:
        load_case(folder)
    assert str(folder / "case.toml") in str(problem.value)
    assert message in str(problem.value)


def test_misspelt_key_gets_a_suggestion(tmp_path):
    folder = make_case(tmp_path, CASE.replace("caption", "captoin"))
    with pytest.raises(CaseError, match="there is no 'caption'"):
        load_case(folder)
    (folder / "case.toml").write_text(CASE.replace("atol", "exct = 1\natol"))
    with pytest.raises(CaseError, match=r"unknown key 'exct'.*did you mean 'exact'"):
        load_case(folder)


def test_case_without_readme_or_decks_is_refused(tmp_path):
    folder = make_case(tmp_path, 'title = "A"\nsummary = "B"\n')
    with pytest.raises(CaseError, match=r"there is no \[\[deck\]\]"):
        load_case(folder)
    (folder / "case.toml").write_text(CASE)
    (folder / "README.md").unlink()
    with pytest.raises(CaseError, match=r"there is no README\.md"):
        load_case(folder)


def test_deck_that_is_not_listed_is_refused(tmp_path):
    folder = make_case(tmp_path)
    (folder / "lost.inp").write_text("*HEADING\n")
    with pytest.raises(CaseError, match=r"no \[\[deck\]\] is 'lost.inp': expected all decks"):
        load_case(folder)


def test_cases_are_found_by_name(tmp_path):
    make_case(tmp_path)
    make_case(tmp_path, CASE.replace("bar.png", "rod.png"), name="rod")
    assert [case.name for case in load_cases(tmp_path, [])] == ["bar", "rod"]
    assert [case.name for case in load_cases(tmp_path, ["rod"])] == ["rod"]
    with pytest.raises(CaseError, match=r"there is no case 'foo' .* there are bar, rod"):
        load_cases(tmp_path, ["foo"])


def test_figures_of_two_cases_have_two_names(tmp_path):
    make_case(tmp_path)
    make_case(tmp_path, name="rod")
    with pytest.raises(CaseError, match=r"figure 'bar.png' is there twice, also in case 'bar'"):
        load_cases(tmp_path, [])


# --- judging -------------------------------------------------------------------------------------


def test_analytic_and_frozen_value_share_a_row(case, tmp_path):
    frozen = verdict("frozen", "2.10000001", place="bar.inp:31")
    result = judge(case, [finished(tmp_path, verdict(), frozen)], [])
    assert len(result.rows) == 1
    row = result.rows[0]
    assert (row.quantity, row.exact, row.met) == ("SUM RF1[X1] at 1", 2.0, True)
    assert (row.frozen, row.frozen_met, row.place) == (2.10000001, True, "bar.inp:31")
    assert row.error == pytest.approx(0.05)
    assert row.error_limit == pytest.approx(0.1)
    assert result.n_failed == 0


def test_misses_are_failures(case, tmp_path):
    missed = [verdict(met=False), verdict("frozen", what="MAX S1", met=False)]
    result = judge(case, [finished(tmp_path, *missed, code=7)], [])
    assert [row.failed for row in result.rows] == [True, True]
    assert (result.n_failed, result.problems) == (2, [])


def test_time_that_was_not_reached_fails(case, tmp_path):
    lost = verdict(found="time not reached", met=False)
    result = judge(case, [finished(tmp_path, lost, code=4, wanted=4)], [])
    assert math.isnan(result.rows[0].found)
    assert result.n_failed == 1


def test_exit_code_must_be_the_expected_one(case, tmp_path):
    wrong = judge(case, [finished(tmp_path, code=4)], [])
    assert wrong.problems == ["bar.inp ended with exit code 4, expected 0: it broke"]
    assert judge(case, [finished(tmp_path, code=4, wanted=4)], []).n_failed == 0
    assert judge(case, [finished(tmp_path, code=0, wanted=4)], []).n_failed == 1
    assert judge(case, [finished(tmp_path, code=7)], []).n_failed == 1


def test_failed_expectation_must_be_among_the_rows(case, tmp_path):
    result = judge(case, [finished(tmp_path, verdict(), code=7)], [])
    assert result.problems == ["bar.inp ended with exit code 7, expected 0: it broke"]
    result = judge(case, [finished(tmp_path, verdict(), verdict(met=False), code=7)], [])
    assert (result.problems, result.n_failed) == ([], 1)


def test_run_that_states_nothing_is_a_problem(case, tmp_path):
    object.__setattr__(case, "studies", ())
    message = "bar.inp states nothing: expected *EXPECT or a measure with exact or frozen value"
    assert judge(case, [finished(tmp_path)], []).problems == [message]
    assert judge(case, [finished(tmp_path, verdict())], []).problems == []
    found = [Found("plastic strain", "bar.inp", 0.2)]
    assert judge(case, [finished(tmp_path)], found).problems == []
    free = Measure("m", "f", {}, ("bar.inp",), None, 0.0, 0.0, None)
    object.__setattr__(case, "measures", (free,))
    result = judge(case, [finished(tmp_path)], [Found("m", "bar.inp", 0.2)])
    assert result.problems == [message]
    assert judge(case, [finished(tmp_path, code=4, wanted=4)], []).problems == []


def test_quick_deck_that_is_slow_is_reported(case, tmp_path):
    runs = [finished(tmp_path, seconds=12.0)]
    assert judge(case, runs, [], timed=True).warnings == [
        "bar.inp took 12.0 s: a quick deck takes less than 10 s"
    ]
    assert judge(case, runs, [], timed=False).warnings == []


def test_measure_is_compared_with_exact_and_frozen_value():
    measure = Measure("m", "f", {}, ("bar.inp",), 2.0, 0.1, 0.05, {"bar.inp": 2.2})
    row = row_of_measure(measure, Found("m", "bar.inp", 2.2))
    assert (row.tolerance, row.met, row.frozen_met) == (0.25, True, True)
    row = row_of_measure(measure, Found("m", "bar.inp", 2.2 * (1.0 + 2e-6)))
    assert (row.met, row.frozen_met) == (True, False)
    row = row_of_measure(measure, Found("m", "bar.inp", 2.26))
    assert (row.met, row.frozen_met) == (False, False)


def test_tolerance_may_be_given_by_deck(tmp_path):
    by_deck = 'atol = {"bar.inp" = 0.01, "long.inp" = 0.1}'
    (measure,) = load_case(make_case(tmp_path, CASE.replace("atol = 0.05", by_deck))).measures
    assert row_of_measure(measure, Found(measure.name, "long.inp", 0.25)).met is True
    assert row_of_measure(measure, Found(measure.name, "bar.inp", 0.25)).met is False


@pytest.mark.parametrize("field", ["exact", "frozen"])
def test_measure_that_is_no_number_fails(field):
    values = {"exact": 0.0} if field == "exact" else {"frozen": {"bar.inp": 0.0}, "exact": None}
    measure = Measure(
        "m", "f", {}, ("bar.inp",), **{"rtol": 0.0, "atol": 1.0, "frozen": None} | values
    )
    assert row_of_measure(measure, Found("m", "bar.inp", math.nan)).failed


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_measure_without_claim_fails_when_it_is_no_number(value, case, tmp_path):
    measure = Measure("m", "f", {}, ("bar.inp",), None, 0.0, 0.0, None)  # such as that of a study
    object.__setattr__(case, "measures", (measure,))
    result = judge(case, [finished(tmp_path, verdict())], [Found("m", "bar.inp", value)])
    assert result.problems == [f"'m' of bar.inp is {value}: expected a finite number"]
    result = judge(case, [finished(tmp_path, verdict())], [Found("m", "bar.inp", 0.0)])
    assert result.n_failed == 0


@pytest.mark.parametrize("kind", ["analytic", "frozen"])
def test_verdict_that_is_no_number_fails(kind, case, tmp_path):
    result = judge(case, [finished(tmp_path, verdict(kind, found="NaN", met=True))], [])
    assert [row.failed for row in result.rows] == [True]


def test_order_is_the_slope_of_log_error():
    assert order_of([1.0, 0.5, 0.25], [0.3, 0.075, 0.01875]) == pytest.approx(2.0)
    assert math.isnan(order_of([1.0, 0.5], [0.1, 0.0]))
    assert math.isnan(order_of([1.0, 0.5], [0.1, math.nan]))


def rows_with_errors(**errors):
    return [
        Row(f"{deck}.inp", "SUM RF1[X1] at 1", 2.0 * (1.0 - error), 2.0, 1.0, True)
        for deck, error in errors.items()
    ]


@pytest.mark.parametrize(("order", "failed"), [(0.99, False), (1.01, True)])
def test_study_fails_below_its_least_order(order, failed):
    study = Study("s", None, "SUM RF1[X1]", ("a.inp", "b.inp"), (0.2, 0.1), order)
    result = judge_study(study, rows_with_errors(a=0.2, b=0.1))
    assert result.errors == pytest.approx((0.2, 0.1))
    assert (result.order, result.failed) == (pytest.approx(1.0), failed)


def test_study_of_unknown_or_ambiguous_quantity_fails():
    study = Study("s", None, "SUM RF2[X1]", ("a.inp", "b.inp"), (0.2, 0.1), 0.0)
    assert judge_study(study, rows_with_errors(a=0.2, b=0.1)).failed
    study = Study("s", None, "SUM RF1[X1]", ("a.inp", "b.inp"), (0.2, 0.1), 0.0)
    rows = rows_with_errors(a=0.2, b=0.1)
    later = Row("a.inp", "SUM RF1[X1] at 2", 1.0, 2.0, 1.0, True)
    assert judge_study(study, [*rows, later]).failed
    study = Study("s", None, "SUM RF1[X1] at 1", ("a.inp", "b.inp"), (0.2, 0.1), 0.0)
    assert not judge_study(study, [*rows, later]).failed


def test_study_waits_for_all_its_decks(case, tmp_path):
    found = [Found("plastic strain", "bar.inp", 0.22)]
    assert judge(case, [finished(tmp_path)], found).studies == []


# --- numbers -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("error", "is_relative", "text"),
    [
        (None, True, "-"),
        (0.0, True, "0"),
        (3e-14, True, "< 1e-10"),
        (2e-9, True, "2e-09"),
        (-0.012345, True, "-1.23 %"),
        (0.012345, False, "0.012"),
        (math.nan, True, "none"),
    ],
)
def test_errors_are_short(error, is_relative, text):
    assert error_text(error, is_relative) == text


# --- runs ----------------------------------------------------------------------------------------


def test_build_with_checks_is_known(tessera, tessera_release):
    assert is_checked(tessera)
    assert not is_checked(tessera_release)


@pytest.mark.parametrize(("program", "n_warnings"), [("tessera", 0), ("tessera_release", 1)])
def test_labels_are_checked_for_any_release(
    program, n_warnings, request, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(judging, "MOST_SECONDS", 0.0)
    make_case(tmp_path / "cases")
    path = request.getfixturevalue(program)
    main(["--exe", str(path), "--cases", str(tmp_path / "cases"), "-o", str(tmp_path / "out")])
    assert capsys.readouterr().out.count("a quick deck takes less than") == n_warnings


@pytest.fixture
def results(case, tessera_release, tmp_path):
    """The case with both decks run and judged."""
    settings = Settings(tessera_release, tmp_path / "results", 1, 1)
    runs = [run_deck(case, deck, settings) for deck in case.decks]
    return judge(case, runs, measure_all(case, runs))


def test_runs_are_judged(results):
    assert results.problems == []
    assert [row.met for row in results.rows] == [True, None, True, None, True, True]
    assert [row.frozen_met for row in results.rows] == [None, False] * 2 + [False, False]
    assert [run.exit_code for run in results.runs] == [7, 7]
    assert all(run.cpu_seconds > 0.0 for run in results.runs)
    text = case_text(results)
    assert "bar: Plastic bar" in text
    assert "FAILED: 20.0" in text
    assert "order of strain:" in text


def test_broken_measures_are_problems(case, results):
    runs = results.runs[:1]
    measure = case.measures[0]
    for arguments, function, message in (
        ({}, "mean_strain", "missing 1 required positional argument: 'factor'"),
        ({}, "text", "could not convert string to float"),
    ):
        broken = Measure("m", function, arguments, measure.decks, None, 0.0, 0.0, None)
        changed = load_case(case.folder)
        object.__setattr__(changed, "measures", (broken,))
        result = judge(changed, runs, measure_all(changed, runs))
        assert message in result.problems[0]


def test_freezing_writes_what_was_found(case, results):
    changed = freeze(results)
    assert sorted(path.name for path in changed) == ["bar.inp", "case.toml", "long.inp"]
    force = next(row.found for row in results.rows if row.deck == "bar.inp" and row.place)
    assert f"\nfrozen, {force:.12g}, 1e-6 ** of an" in (case.folder / "bar.inp").read_text()
    again = load_case(case.folder)
    strains = [row.found for row in results.rows if row.quantity == "plastic strain"]
    assert list(again.measures[0].frozen.values()) == pytest.approx(strains, rel=1e-11)
    rest = (case.folder / "case.toml").read_text().splitlines()
    assert [line for line in rest if not line.startswith("frozen")] == [
        line for line in CASE.splitlines() if not line.startswith("frozen")
    ]
    assert freeze(judge(again, results.runs, measure_all(again, results.runs))) == []


def test_freezing_keeps_values_of_decks_that_did_not_run(case, results):
    runs = results.runs[:1]
    freeze(judge(case, runs, measure_all(case, runs)))
    assert load_case(case.folder).measures[0].frozen["long.inp"] == 0.3


def test_frozen_line_of_an_include_cannot_have_two_values(case, tmp_path):
    runs = [
        finished(tmp_path, verdict("frozen", found=found, place="part.inc:3"), deck=deck)
        for deck, found in (("bar.inp", "2.1"), ("long.inp", "2.2"))
    ]
    with pytest.raises(CaseError, match="expected frozen lines in the decks themselves"):
        freeze(judge(case, runs, []))


def test_balances_that_hold_are_one_sentence(case, tmp_path):
    def judged(second, met):
        options = {"what": "BALANCE", "value": "0", "tolerance": "1e-8"}
        runs = [
            finished(tmp_path, verdict(), verdict(found="3e-12", **options)),
            finished(tmp_path, verdict(found=second, met=met, **options), deck="long.inp"),
        ]
        return judge(dataclasses.replace(case, studies=()), runs, [])

    result = judged("2e-10", True)
    text = "2 decks: at most 2e-10 of all forces is out of balance in any increment"
    assert f"  {text}" in case_text(result).splitlines()
    assert f"\nForces, {text}.\n" in page_text([result])
    assert "BALANCE" not in case_text(result) + page_text([result])
    # It does not say that the answer is right.
    claims = "long.inp states nothing: expected *EXPECT or a measure with exact or frozen value"
    assert claims in result.problems
    result = judged("2e-7", False)
    assert "one deck: less than 1e-10 of all forces is out of" in case_text(result)
    assert re.search(r"long.inp +BALANCE at 1 .*2e-07 .*FAILED", case_text(result))
    assert "| `long` | BALANCE at 1 | 0 | 2e-07 | **2e-07** | 1e-08 |" in page_text([result])


def test_page_shows_every_quantity_and_figure(results, tmp_path):
    text = page_text([results])
    assert text == page_text([results])
    assert "| [Plastic bar](#plastic-bar) | 2 | 6 |" in text
    assert "(../input/verification/bar/README.md)" in text
    assert "| `bar` | MEAN U1[X1] at 1 | 0.4 | 0.4 |" in text
    assert "![Force of the bar](figures/verification/bar.png)" in text
    draw_figures(results, tmp_path / "figures")
    assert (tmp_path / "figures" / "bar.png").stat().st_size > 1000


@pytest.mark.parametrize("line", ['function = "draw"', 'studies = ["strain"]'])
def test_figures_are_drawn_by_function_or_of_studies(line, results, tmp_path):
    folder = results.case.folder
    (folder / "case.toml").write_text(CASE.replace('command = ["curve", "bar"]', line))
    results.case = load_case(folder)
    draw_figures(results, tmp_path / "figures")
    picture = (tmp_path / "figures" / "bar.png").read_bytes()
    assert picture.startswith(b"bar long" if "draw" in line else b"\x89PNG")


def test_figure_that_cannot_be_drawn_is_an_error(results, tmp_path):
    folder = results.case.folder
    (folder / "case.toml").write_text(CASE.replace('["curve", "bar"]', '["curve", "foo"]'))
    results.case = load_case(folder)
    with pytest.raises(CaseError, match=r"figure 'bar.png' of bar: there are no results of 'foo'"):
        draw_figures(results, tmp_path)


def verify(*arguments):
    command = [sys.executable, ROOT / "tools" / "verification", *arguments]
    run = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    return run.returncode, run.stdout, run.stderr


def test_verify_fails_then_freezes_then_passes(tessera_release, tmp_path):
    case = CASE.replace("exact = 0.2", "exact = 0.15").replace("order = 1.0", "order = -9.0")
    make_case(tmp_path / "cases", case)
    options = ["--exe", tessera_release, "--cases", tmp_path / "cases", "-o", tmp_path / "out"]
    code, out, err = verify("--all", *options)
    assert (code, err) == (1, "")
    assert out.splitlines()[-1].startswith("verify: 1 cases, 2 decks, 7 quantities and orders, 4 f")
    code, out, _ = verify("--all", "--freeze", *options)
    assert code == 1
    assert out.count("froze ") == 3
    code, out, _ = verify("--all", *options)
    assert (code, "FAILED" in out) == (0, False), out
    code, out, _ = verify(*options)
    assert (code, out.count("long.inp")) == (0, 0)


def test_verify_lists_and_refuses(tmp_path):
    make_case(tmp_path)
    code, out, _ = verify("--list", "--cases", tmp_path)
    assert (code, out) == (0, "bar: Plastic bar\n  bar.inp  quick\n  long.inp  slow\n")
    code, _, err = verify("rod", "--cases", tmp_path)
    assert code == 2
    assert err.startswith("verify: error: there is no case 'rod'")
    assert verify("--exe", tmp_path / "none", "--cases", tmp_path)[0] == 2
    assert verify("--page")[0] == 2
    assert verify("--jobs", "0")[0] == 2
