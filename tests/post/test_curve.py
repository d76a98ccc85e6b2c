"""Curves: what is drawn is what the history holds."""

import csv

import numpy as np
import pytest
from post_runs import bar_deck
from tessera_post import curve


@pytest.fixture
def figure(monkeypatch):
    """The figures that curve saves."""
    figures = []
    monkeypatch.setattr(curve, "save", lambda made, path: figures.append((made, path)))
    return figures


def history(job):
    """The history as the program wrote it for people."""
    text = job.with_name(f"{job.name}_history.csv").read_text().splitlines()
    rows = list(csv.DictReader(line for line in text if not line.startswith("#")))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_curve_draws_the_history(post, figure, bar):
    code, out, err = post("curve", bar)
    assert (code, err) == (0, "")
    axes = figure[0][0].axes[0]
    line = axes.lines[0]
    expected = history(bar)
    np.testing.assert_array_equal(line.get_xdata(), expected["U1[X1]"])
    np.testing.assert_array_equal(line.get_ydata(), expected["RF1[X1]"])
    assert axes.get_xlabel() == "displacement 1 of X1 [m]"
    assert axes.get_ylabel() == "reaction 1 of X1 [kN/m]"
    assert axes.get_title() == "Plastic bar"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["F-bar patch"]
    assert figure[0][1] == bar.with_name("bar_curve.png")
    assert f"F-bar patch: {expected['RF1[X1]'][-1]:.4g} kN/m at 0.4 m, " in out


def test_columns_go_against_time_and_against_each_other(post, figure, bar):
    expected = history(bar)
    for x, name in (("time", "time"), ("increment", "increment"), ("u2", "U2[X1]")):
        assert post("curve", bar, "-x", x, "-y", "rf1")[0] == 0
        line = figure[-1][0].axes[0].lines[0]
        np.testing.assert_array_equal(line.get_xdata(), expected[name])
        np.testing.assert_array_equal(line.get_ydata(), expected["RF1[X1]"])


def test_footing_is_drawn_positive_in_millimetres(post, figure, example):
    jobs = [example("footing", method) for method in ("standard", "fbar")]
    options = ["-x", "U3", "-y", "RF3[FOOTING]", "--positive", "--x-unit", "mm", "--y-unit", "N"]
    code, out, _ = post("curve", *jobs, *options, "--line", "700", "upper bound")
    assert code == 0
    axes = figure[0][0].axes[0]
    for job, line in zip(jobs, axes.lines):
        expected = history(job)
        np.testing.assert_allclose(line.get_xdata(), -1e3 * expected["U3[FOOTING]"], rtol=1e-15)
        np.testing.assert_allclose(line.get_ydata(), -1e3 * expected["RF3[FOOTING]"], rtol=1e-15)
    assert list(axes.lines[2].get_ydata()) == [700.0, 700.0]
    assert axes.get_xlabel() == "\N{MINUS SIGN}displacement 3 of FOOTING [mm]"
    assert axes.get_ylabel() == "\N{MINUS SIGN}reaction 3 of FOOTING [N]"
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["standard MPM", "F-bar patch", "upper bound"]
    assert axes.get_title() == ""
    colors = [line.get_color() for line in axes.lines[:2]]
    assert colors == ["#d55e00", "#0072b2"]
    standard, fbar = out.splitlines()[:2]
    assert standard == "standard MPM: 2242 N at 2 mm, still rising (+32.8% over the second half)"
    assert fbar == "F-bar patch: 749.2 N at 2 mm, levelled off (+0.7% over the second half)"


def test_name_of_a_comparison_draws_both(post, figure, example):
    job = example("stretch", "fbar")
    assert post("curve", job.with_name("stretch"))[0] == 0
    assert len(figure[0][0].axes[0].lines) == 2


def test_same_formulation_twice_is_told_apart(post, figure, bar, single):
    assert post("curve", bar, single, "-y", "RF1")[0] == 0
    axes = figure[0][0].axes[0]
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == [f"{job.parent.name}/bar, F-bar patch" for job in (bar, single)]
    assert len({line.get_color() for line in axes.lines}) == 2
    assert post("curve", bar, single, "--labels", "four", "one")[0] == 0
    labels = [text.get_text() for text in figure[-1][0].axes[0].get_legend().get_texts()]
    assert labels == ["four", "one"]


def test_several_columns_share_the_axis(post, figure, bar):
    assert post("curve", bar, "-y", "U1", "U2", "-x", "time")[0] == 0
    axes = figure[0][0].axes[0]
    assert axes.get_ylabel() == "displacement [m]"
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels == ["F-bar patch: U1[X1]", "F-bar patch: U2[X1]"]


def test_killed_job_is_marked(post, figure, killed):
    code, _, err = post("curve", killed)
    assert code == 0
    assert "tessera-post: note: 'bar' has not finished" in err
    labels = [text.get_text() for text in figure[0][0].axes[0].get_legend().get_texts()]
    assert labels == ["F-bar patch (unfinished)"]
    assert len(figure[0][0].axes[0].lines[0].get_xdata()) >= 8


def test_other_units_are_converted(post, figure, bar, run_deck, tmp_path):
    other = run_deck(tmp_path, bar_deck().replace("FORCE=kN", "FORCE=MN"), name="other")
    assert post("curve", bar, other)[0] == 0
    first, second = (line.get_ydata() for line in figure[0][0].axes[0].lines)
    np.testing.assert_allclose(second, 1e3 * first, rtol=1e-12)
    strange = run_deck(tmp_path, bar_deck().replace("FORCE=kN", "FORCE=lbf"), name="strange")
    code, _, err = post("curve", bar, strange)
    assert code == 2
    assert err == ("tessera-post: error: 'strange' has RF1[X1] in 'lbf/m': no way to 'kN/m'\n")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["-y", "RF9"],
            "the history of 'bar' has no column 'RF9': expected one of step, increment,",
        ),
        (["-x", "V1"], "the history of 'bar' has no column 'V1': expected one of step, increment,"),
        (["-y", "RF1", "U1"], "-y: expected columns of one unit, found force, length"),
        (["--line", "high", "x"], "--line: expected a number, found 'high'"),
        (["--band", "0", "up", "x"], "--band: expected a number, found 'up'"),
        (["--labels", "a", "b"], "--labels: expected 1 texts, found 2"),
        (["--x-unit", "kN"], "'bar' has U1[X1] in 'm': no way to 'kN'"),
    ],
)
def test_wrong_options_are_told(post, bar, options, message):
    code, out, err = post("curve", bar, *options)
    assert (code, out) == (2, "")
    assert err.startswith(f"tessera-post: error: {message}")
    assert err.count("\n") == 1
