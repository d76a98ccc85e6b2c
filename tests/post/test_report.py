"""The HTML report: its numbers, what it says when something is missing, and hostile text."""

import base64
import hashlib
import io
import re
import shutil

import h5py
import numpy as np
import pytest
from matplotlib.image import imread
from post_runs import bar_deck
from pygments.token import Comment, Keyword, Name, Number, String
from report_page import Page, decode
from tessera_post import report_scene
from tessera_post.cli import main
from tessera_post.deck_lexer import DeckLexer
from tessera_post.report_attempts import find_reference

EXPECT = """\
*EXPECT, QUANTITY=RF, SET=X1, COMPONENT=1, STATISTIC=SUM
analytic, 20.0, 0.2
frozen, 1.0, 1e-6"""
HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(2)>"


def file_of(job):
    """The results, read without the package."""
    return h5py.File(job.with_name(f"{job.name}.vtkhdf"), "r")


def last_output(job, name):
    """A field of the points at the last output, all of which have the same number of points."""
    with file_of(job) as file:
        grid = file["VTKHDF"]
        data = grid["Points"] if name == "Points" else grid["PointData"][name]
        return data[-int(grid["NumberOfPoints"][-1]) :]


def copied(job, folder, but=()):
    """The files of a job in another folder, without some."""
    for path in job.parent.glob(f"{job.name}*"):
        if path.name not in but:
            shutil.copy(path, folder)
    return folder / job.name


@pytest.fixture
def report(post, tmp_path):
    """report(job, *options): the page; the command must succeed."""

    def make(job, *options):
        path = tmp_path / "page.html"
        code, out, err = post("report", job, "-o", path, *options)
        assert code == 0, err
        assert out == f"wrote {path}\n"
        return Page(path.read_text(encoding="utf-8"))

    return make


@pytest.fixture(scope="module")
def bar_page(bar, tmp_path_factory):
    """The page of the bar, made once for the tests that only look at it."""
    path = tmp_path_factory.mktemp("report") / "page.html"
    assert main(["report", str(bar), "-o", str(path)]) == 0
    return Page(path.read_text(encoding="utf-8"))


def test_page_lies_beside_the_results(post, bar):
    code, out, _ = post("report", bar)
    path = bar.with_name("bar_report.html")
    assert (code, out) == (0, f"wrote {path}\n")
    assert path.stat().st_size < 8e6


def test_reaction_curve_is_the_history(bar_page, bar):
    with file_of(bar) as file:
        history = {name: column[()] for name, column in file["tessera/history"].items()}
    trace = bar_page.trace("reaction")
    np.testing.assert_array_equal(trace["x"], history["U1[X1]"])
    np.testing.assert_array_equal(trace["y"], history["RF1[X1]"])
    assert "RF1[X1] = %{y:.6~g} kN/m<br>U1[X1] = %{x:.6~g} m<br>" in trace["hovertemplate"]
    layout = bar_page.figure("reaction")["layout"]
    assert layout["xaxis"]["title"]["text"] == "displacement 1 of X1 [m]"
    assert layout["yaxis"]["title"]["text"] == "reaction 1 of X1 [kN/m]"
    for trace in decode(bar_page.figure("history-force")["data"]):
        np.testing.assert_array_equal(trace["x"], history["time"])
        np.testing.assert_array_equal(trace["y"], history[trace["name"]])
    names = {trace["name"] for trace in bar_page.figure("history-length")["data"]}
    assert names == {"U1[X1]", "U2[X1]"}


def test_convergence_plot_holds_every_positive_residual(bar_page, bar):
    with file_of(bar) as file:
        table = {name: column[()] for name, column in file["tessera/iterations"].items()}
    lines = [t for t in decode(bar_page.figure("convergence")["data"]) if t.get("text")]
    assert len(lines) == 4
    shown = np.concatenate([line["y"] for line in lines])
    np.testing.assert_array_equal(shown, table["residual"][table["residual"] > 0.0])
    names = [t.get("name") for t in bar_page.figure("convergence")["data"] if t.get("name")]
    assert names == ["order 2: r → C r²", "tolerance of Newton's method"]
    assert bar_page.figure("convergence")["layout"]["yaxis"]["type"] == "log"


def test_dashed_curve_and_slope_are_of_order_two(bar_page):
    (dashed,) = [
        t for t in decode(bar_page.figure("convergence")["data"]) if "order 2" in t.get("name", "")
    ]
    at = dict(zip(np.round(dashed["x"], 6), dashed["y"]))
    whole = [k for k in range(8) if k in at and k + 1 in at and k + 2 in at]
    assert whole
    for k in whole:  # r(k+1) = C r(k)^2 with the same C
        assert at[k + 2] / at[k + 1] ** 2 == pytest.approx(at[k + 1] / at[k] ** 2)
    slopes = {t["name"]: t for t in decode(bar_page.figure("order")["data"]) if t.get("name")}
    for name, slope in (("slope 1", 1.0), ("slope 2", 2.0)):
        x, y = np.log(slopes[name]["x"]), np.log(slopes[name]["y"])
        assert (y[1] - y[0]) / (x[1] - x[0]) == pytest.approx(slope)


def test_without_attempts_there_is_no_reference():
    assert find_reference([]) is None


def test_cost_table_adds_up(bar_page, bar):
    head, *rows, foot = bar_page.table("newton")
    assert head[3:6] == ["iterations", "residual", "kinematics [s]"]
    assert head[-1] == "outcome"
    with file_of(bar) as file:
        table = {name: column[()] for name, column in file["tessera/iterations"].items()}
    assert [int(row[1]) for row in rows] == [1, 2, 3, 4]
    for row in rows:
        mine = table["increment"] == int(row[1])
        assert int(row[3]) == table["iteration"][mine].max()
        assert float(row[4]) == pytest.approx(table["residual"][mine][-1], rel=5e-3)
        assert row[-1] == "converged"
    parts = ("kinematics", "stress", "assembly", "factorisation", "solve")
    assert foot[:2] == ["4 attempts", str(int((table["iteration"] > 0).sum()))]
    expected = [table[part].sum() for part in parts]
    found = [float(cell) for cell in foot[3:9]]
    np.testing.assert_allclose(found, [*expected, sum(expected)], atol=6e-4)


def test_ledger_is_that_of_the_file(bar_page, bar):
    head, *rows, foot = bar_page.table("ledger")
    with file_of(bar) as file:
        ledger = {name: column[()] for name, column in file["tessera/ledger"].items()}
    assert head[3:] == ["points", "mass", "volume [m²]", "lost", "extrapolated"]
    np.testing.assert_allclose([float(row[5]) for row in rows], ledger["volume"], rtol=1e-8)
    assert [int(row[3]) for row in rows] == ledger["count"].tolist()
    assert foot[1] == "0"
    change = float(foot[3].split()[0])
    assert change == pytest.approx(ledger["volume"][-1] - ledger["volume"][0], rel=1e-6)


def test_view_has_points_and_means_of_elements(bar_page, bar):
    stress, x = last_output(bar, "S"), last_output(bar, "Points")
    element = last_output(bar, "ELEMENT") - 1
    volume = last_output(bar, "VOL")
    pressure = -stress[:, :3].mean(axis=1)
    surface, points, outline = (bar_page.trace("view", i) for i in range(3))
    np.testing.assert_array_equal(points["marker"]["color"], pressure.astype("f4"))
    np.testing.assert_array_equal(
        np.stack([points["x"], points["y"], points["z"]], 1), x.astype("f4")
    )
    mean = np.bincount(element, volume * pressure) / np.bincount(element, volume)
    np.testing.assert_allclose(np.sort(surface["intensity"]), np.sort(mean), rtol=1e-6)
    assert len(surface["i"]) == len(np.unique(element)) == 32
    assert outline["mode"] == "lines"
    layout = bar_page.figure("view")["layout"]
    assert layout["scene"]["xaxis"]["title"]["text"] == "x [m]"
    assert layout["coloraxis"]["colorbar"]["title"]["text"] == "pressure [kPa]"
    assert layout["scene"]["camera"]["projection"]["type"] == "orthographic"
    labels = [b["label"] for b in layout["updatemenus"][0]["buttons"]]
    assert labels == ["surface", "points"]


def test_axes_of_the_view_have_one_scale(bar_page):
    scene = bar_page.figure("view")["layout"]["scene"]
    sides = [np.ptp(scene[f"{name}axis"]["range"]) for name in "xyz"]
    ratio = [scene["aspectratio"][name] for name in "xyz"]
    np.testing.assert_allclose(np.array(ratio) / ratio[0], np.array(sides) / sides[0])


def test_many_points_are_thinned_with_a_note(report, bar, monkeypatch):
    monkeypatch.setattr(report_scene, "MOST_POINTS", 40)
    page = report(bar)
    assert len(page.trace("view", 1)["x"]) == 40
    assert "40 of 96 points are drawn, evenly chosen." in page.text("turn")


def test_field_and_output_can_be_chosen(report, bar):
    page = report(bar, "--field", "PEEQ", "--increment", "2")
    with file_of(bar) as file:
        first = int(file["VTKHDF/Steps/PointDataOffsets/PEEQ"][2])
        peeq = file["VTKHDF/PointData/PEEQ"][first : first + 96]
    np.testing.assert_array_equal(page.trace("view", 1)["marker"]["color"], peeq.astype("f4"))
    assert "Accumulated plastic strain at increment 2, time 0.5" in page.text("turn")
    assert "increment 2, time 0.5." in page.text("pictures")
    page = report(bar, "--time", "0.5", "--field", "PATCH")
    assert "Patch at increment 2, time 0.5" in page.text("turn")
    assert page.figure("view")["layout"]["coloraxis"]["showscale"] is False


def test_view_can_be_left_out(report, bar):
    page = report(bar, "--no-3d")
    assert not any(name == "data-view" for name, _, _ in page.scripts)
    assert "#turn" not in page.links


def test_pictures_are_not_blank(bar_page):
    pictures = [link for link in bar_page.links if link.startswith("data:image/png")]
    assert len(pictures) == 2
    for picture in pictures:
        image = imread(io.BytesIO(base64.b64decode(picture.partition(",")[2])))
        assert image[..., :3].std() > 0.05


def test_deck_is_shown_as_it_is(bar_page, bar):
    assert bar_page.deck == bar.with_suffix(".inp").read_text()
    assert '<span class="k">*HEADING</span>' in bar_page.source


def test_contents_lead_to_every_section(bar_page):
    anchors = [link for link in bar_page.links if link.startswith("#")]
    assert len(anchors) == 9
    assert all(f'<section id="{anchor[1:]}"' in bar_page.source for anchor in anchors)


def test_verdicts_and_status_are_shown(report, run_deck, tmp_path):
    page = report(run_deck(tmp_path, bar_deck(expect=EXPECT), code=7))
    assert "finished, an *EXPECT failed" in page.text("")
    _, *rows = page.table("verdicts")
    assert [row[:4] for row in rows] == [
        ["met", "analytic", "SUM RF1[X1]", "1"],
        ["FAILED", "frozen", "SUM RF1[X1]", "1"],
    ]
    with file_of(tmp_path / "bar") as file:
        reaction = file["tessera/history/RF1[X1]"][-1]
    assert float(rows[0][6]) == pytest.approx(reaction, rel=1e-5)
    assert rows[0][7] == "bar.inp:28"


def test_other_formulation_has_no_verdicts(report, run_deck, tmp_path):
    deck = bar_deck(expect=EXPECT.replace("frozen, 1.0, 1e-6", ""))
    job = run_deck(tmp_path, deck, "--compare", "standard,fbar")
    page = report(job.with_name("bar_standard"))
    assert "the formulation that the deck names; this run is standard MPM." in page.text("verdicts")
    assert report(job.with_name("bar_fbar")).table("verdicts")[1][0] == "met"


def test_deck_without_expectations_is_told(bar_page):
    assert "The deck has no *EXPECT." in bar_page.text("verdicts")


def test_failed_attempts_are_listed(report, run_deck, tmp_path):
    deck = bar_deck(size=0.5).replace("*BOUNDARY", "*CONTROLS, MAX ITERATIONS=1\n*BOUNDARY")
    page = report(run_deck(tmp_path, deck, code=4))
    status = "ended early with exit code 4: no convergence at the smallest increment"
    assert status in page.text("")
    _, *rows = page.table("warnings")
    assert [row[2] for row in rows] == [str(i) for i in range(1, len(rows) + 1)]
    assert rows[0][3:] == ["0.5", "too many iterations after 1 iterations, worst node 27"]
    assert "error: no convergence at the smallest increment" in page.text("warnings")
    failed = [t for t in page.figure("convergence")["data"] if t.get("text")]
    assert {t["line"]["dash"] for t in failed} == {"dash"}
    assert {t["marker"]["symbol"] for t in failed} == {"x"}
    assert [t.get("name") for t in page.figure("convergence")["data"]][-1] == "attempt that failed"


def test_warnings_of_the_log_are_shown(report, run_deck, tmp_path):
    deck = bar_deck().replace("*FORMULATION", "*NSET, NSET=<b>\n1\n*FORMULATION")
    page = report(run_deck(tmp_path, deck, "--lax"))
    assert "'<b>'" in page.text("warnings")


def test_killed_job_is_shown_as_far_as_it_goes(report, killed):
    page = report(killed)
    assert "unfinished" in page.text("")
    assert "'bar' has not finished (killed, or still running): shown up to" in page.text("")
    with file_of(killed) as file:
        n = len(file["tessera/history/time"])
    assert len(page.trace("reaction")["y"]) == n
    assert len(page.table("ledger")) >= n


def test_single_increment_makes_a_page(report, single):
    page = report(single)
    assert len(page.trace("reaction")["y"]) == 2
    assert page.figure("convergence")["layout"]["coloraxis"]["showscale"] is False


def test_missing_log_and_mesh_are_told(report, bar, tmp_path):
    job = copied(bar, tmp_path, but=("bar.log", "bar_mesh.vtkhdf"))
    page = report(job)
    assert "there is no 'bar.log'" in page.text("")
    assert "'bar_mesh.vtkhdf' cannot be read" in page.text("")
    assert "unknown: there is no log" in page.text("")
    assert "the verdicts are not known" in page.text("verdicts")
    assert "Without the mesh file only the points are drawn." in page.text("turn")
    assert page.trace("view", 0)["type"] == "scatter3d"
    assert page.trace("view", 0)["visible"] is True
    assert [row[-1] for row in page.table("newton")[1:-1]] == ["accepted"] * 4


def test_results_without_stress_show_another_field(report, run_deck, tmp_path):
    deck = bar_deck().replace("S, TAU, LE, PEEQ", "LE, PEEQ")
    page = report(run_deck(tmp_path, deck))
    assert "Accumulated plastic strain at increment 4" in page.text("turn")


def test_missing_field_names_those_that_there_are(post, bar, tmp_path):
    code, out, err = post("report", bar, "--field", "T", "-o", tmp_path / "no.html")
    assert (code, out) == (2, "")
    assert err.startswith("tessera-post: error: 'bar.vtkhdf' has no field 'T': there are ")
    assert "PEEQ" in err
    assert err.count("\n") == 1
    assert not (tmp_path / "no.html").exists()


def test_foreign_file_is_refused_in_one_line(post, tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("no results\n")
    code, _, err = post("report", path)
    assert code == 2
    expected = f"'{path}' is no HDF5 file: expected a .vtkhdf file of Tessera"
    assert err == f"tessera-post: error: {expected}\n"


def test_hostile_text_stays_text(report, run_deck, tmp_path):
    deck = bar_deck(heading=HOSTILE).replace("FORCE=kN", f'FORCE="{HOSTILE}"')
    deck = deck.replace("*FORMULATION", '*NSET, NSET="<b>%{x}"\n1, 2\n*FORMULATION')
    deck = deck.replace("*OUTPUT", '*HISTORY, NSET="<b>%{x}"\nRF\n*OUTPUT')
    page = report(run_deck(tmp_path, deck))
    assert HOSTILE in page.text("")
    assert page.deck == deck
    assert page.handlers == []
    assert all(link.startswith(("data:", "#")) for link in page.links)
    kinds = [kind for _, kind, _ in page.scripts if not kind]
    assert len(kinds) == 2  # plotly and what draws with it
    names = {trace["name"] for trace in page.figure("history-force")["data"]}
    assert "RF1[&lt;b&gt;&#37;{x}]" in names


def test_only_the_scripts_of_the_page_may_run(bar_page):
    allowed = re.search(r"script-src ([^;]*);", bar_page.policy)[1].split()
    hashes = [
        hashlib.sha256(text.encode()).digest() for _, kind, text in bar_page.scripts if not kind
    ]
    assert allowed == [f"'sha256-{base64.b64encode(value).decode()}'" for value in hashes]
    assert bar_page.policy.startswith("default-src 'none';")


def test_lexer_tells_the_parts_of_a_deck_apart():
    deck = (
        "** text\n*HEADING\na, b=1\n*UNITS, LENGTH=m,\n  FORCE=kN ** end\n"
        '*MOVING MESH, DRIVER="my set", DIRECTION=0,0,1D0, FIXED=X\n*STATIC, DIRECT\n-.5, BASE\n'
    )
    tokens = list(DeckLexer(stripnl=False, ensurenl=False).get_tokens(deck))
    assert "".join(text for _, text in tokens) == deck

    def all_of(kind):
        return [text for token, text in tokens if token in kind]

    assert all_of(Comment) == ["** text", "** end"]
    assert all_of(Keyword) == ["*HEADING", "*UNITS", "*MOVING MESH", "*STATIC"]
    names = ["LENGTH", "FORCE", "DRIVER", "DIRECTION", "FIXED", "DIRECT"]
    assert all_of(Name.Attribute) == names
    assert all_of(Number) == ["0", "0", "1D0", "-.5"]
    assert all_of(String) == ['"my set"']
    assert all_of(Name.Constant) == ["m", "kN", "X", "BASE"]


@pytest.mark.parametrize("name", ["footing", "stretch", "strip-footing"])
@pytest.mark.parametrize("method", ["standard", "fbar"])
def test_every_example_has_a_page(report, example, name, method):
    job = example(name, method)
    page = report(job)
    n_dim = 2 if name == "strip-footing" else 3
    assert f"The continuum has {n_dim} unknowns" in page.text("model")
    stress = last_output(job, "S")
    color = page.trace("view", 1)["marker"]["color"]
    np.testing.assert_array_equal(color, (-stress[:, :3].mean(axis=1)).astype("f4"))
    if method == "fbar":
        assert all(row[0] == "met" for row in page.table("verdicts")[1:])
