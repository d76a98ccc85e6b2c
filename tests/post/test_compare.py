"""compare: differences that are put into a copy of a result are found where they are."""

import re
import shutil

import h5py
import numpy as np
import pytest
from post_runs import bar_deck, run_and_kill

pytest_plugins = ["lost_point_runs"]
JOBS = ["footing", "stretch", "strip-footing", "bar", "single", "killed", "thinned", "emptied"]
END = {
    "footing": "9 history columns, 8 point fields, 9 mesh fields",
    "bar": "4 history columns, 14 point fields, 9 mesh fields",
}


@pytest.fixture
def twin(bar, tmp_path):
    """A copy of the bar, to be changed: path of the job."""
    for path in bar.parent.glob("bar*"):
        shutil.copy(path, tmp_path)
    return tmp_path / "bar"


def change(path, dataset, index, value):
    """Sets or adds to values of a dataset; returns those before."""
    with h5py.File(path, "r+") as file:
        before = file[dataset][()]
        changed = before.copy()
        changed[index] = value(before[index]) if callable(value) else value
        file[dataset][...] = changed
    return before


def rows_of(out):
    """Rows of the table by name: worst, rms, scale, relative and where."""
    lines = out.split("\n\n")[0].splitlines()
    assert lines[0].split() == "what worst rms scale relative where the worst one is".split()
    result = {}
    for line in lines[1:]:
        name, *rest = re.split(r" {2,}", line)
        result[name] = rest
    return result


def last_line(out):
    return out.splitlines()[-1]


# --- the same ------------------------------------------------------------------------------------


@pytest.mark.parametrize("any_job", JOBS, indirect=True)
def test_run_is_bitwise_identical_with_itself(any_job, post):
    code, out, _ = post("compare", any_job, any_job)
    assert code == 0
    assert last_line(out).startswith("the same within rtol 1e-09, atol 0 (bitwise identical): ")
    assert last_line(out).endswith(END.get(any_job.name.removesuffix("_fbar"), " mesh fields"))
    assert all(row[-1] == "identical" for row in rows_of(out).values())


def test_second_run_of_a_deck_is_bitwise_identical(bar, run_deck, post, tmp_path):
    again = run_deck(tmp_path, bar_deck(), name="again")
    code, out, err = post("compare", bar, again)
    assert (code, err) == (0, "")
    assert "(bitwise identical)" in last_line(out)


def test_quiet_prints_one_line(bar, twin, post):
    assert post("compare", bar, twin, "--quiet") == (
        0,
        "the same within rtol 1e-09, atol 0 (bitwise identical): 4 history columns,"
        " 14 point fields, 9 mesh fields\n",
        "",
    )


def test_small_difference_is_within_the_tolerance_but_not_identical(bar, twin, post):
    change(f"{twin}.vtkhdf", "tessera/history/RF1[X1]", 4, lambda old: old * (1 + 1e-12))
    code, out, _ = post("compare", bar, twin)
    assert code == 0
    assert last_line(out).startswith("the same within rtol 1e-09, atol 0: 4 history columns")
    assert post("compare", bar, twin, "--rtol", "0")[0] == 1
    assert post("compare", bar, twin, "--rtol", "0", "--atol", "1e-8")[0] == 0


def test_tolerance_is_that_share_of_the_scale(bar, twin, post):
    before = change(f"{twin}.vtkhdf", "tessera/history/RF1[X1]", 1, lambda old: old - 1e-3)
    scale = np.abs(before).max()
    just = 1e-3 / scale
    assert post("compare", bar, twin, "-q", "--rtol", just * 1.001)[0] == 0
    assert post("compare", bar, twin, "-q", "--rtol", just * 0.999)[0] == 1
    assert post("compare", bar, twin, "-q", "--rtol", "0", "--atol", 1.001e-3)[0] == 0
    assert post("compare", bar, twin, "-q", "--rtol", "0", "--atol", 0.999e-3)[0] == 1


def test_nan_on_both_sides_is_the_same_and_on_one_side_a_difference(bar, twin, post, tmp_path):
    change(f"{twin}.vtkhdf", "VTKHDF/PointData/S", (100, 4), np.nan)
    other = tmp_path / "other"
    for ending in (".vtkhdf", "_mesh.vtkhdf", ".log"):
        shutil.copy(f"{twin}{ending}", f"{other}{ending}")
    assert post("compare", twin, other, "-q")[0] == 0
    assert "(bitwise identical)" in post("compare", twin, other, "-q")[1]
    change(f"{other}.vtkhdf", "VTKHDF/PointData/S", (103, 0), lambda old: old + 1e-3)
    code, out, _ = post("compare", twin, other, "--fields", "S", "--atol", "1.1e-3")
    assert code == 0
    assert rows_of(out)["points S"][-1] == "time 0.25, increment 1, point 8, component 11"
    code, out, _ = post("compare", bar, twin, "--rtol", "1e9")
    assert code == 1
    place = ["inf", "time 0.25, increment 1, point 5, component 23"]
    assert rows_of(out)["points S"][-2:] == place
    assert last_line(out).endswith("at time 0.25, increment 1, point 5, component 23")


# --- what differs, by how much and where ---------------------------------------------------------


def test_difference_of_a_history_is_measured(bar, twin, post):
    before = change(f"{twin}.vtkhdf", "tessera/history/RF1[X1]", 3, lambda old: old - 0.5)
    code, out, _ = post("compare", bar, twin)
    assert code == 1
    with h5py.File(f"{bar}.vtkhdf") as file:
        scale = max(np.abs(before).max(), np.abs(file["tessera/history/RF2[X1]"][()]).max())
    rms = np.sqrt(0.5**2 / 5)
    assert rows_of(out)["history RF1[X1]"] == [
        f"{0.5:.3e}",
        f"{rms:.3e}",
        f"{scale:.3e}",
        f"{0.5 / scale:.3e}",
        "time 0.75, increment 3",
    ]
    assert next(iter(rows_of(out))) == "history RF1[X1]"
    assert last_line(out) == (
        "they differ: 1 of 27 beyond rtol 1e-09, atol 0; most history RF1[X1],"
        f" by {0.5 / scale:.3g} of its scale, at time 0.75, increment 3"
    )


def test_components_of_a_history_have_one_scale(bar, twin, post):
    change(f"{twin}.vtkhdf", "tessera/history/RF2[X1]", 3, lambda old: old + 1e-12)
    code, out, _ = post("compare", bar, twin)
    assert code == 0
    with h5py.File(f"{bar}.vtkhdf") as file:
        history = file["tessera/history"]
        scale = np.abs(history["RF1[X1]"][()]).max()
        assert np.abs(history["RF2[X1]"][()]).max() < 1e-9 * scale
    assert rows_of(out)["history RF2[X1]"][2] == f"{scale:.3e}"


def test_difference_of_a_point_field_is_measured_over_all_outputs(bar, twin, post):
    with h5py.File(f"{bar}.vtkhdf") as file:
        before = file["VTKHDF/PointData/TAU"][()]
    row = 2 * 96 + 16
    change(f"{twin}.vtkhdf", "VTKHDF/PointData/TAU", (row, 5), lambda old: old + 2.0)
    change(f"{twin}.vtkhdf", "VTKHDF/PointData/TAU", (0, 0), lambda old: old - 1.0)
    code, out, _ = post("compare", bar, twin, "--fields", "tau, position")
    assert code == 1
    rows = rows_of(out)
    assert {name for name in rows if not name.startswith("history")} == {
        "points TAU",
        "points POSITION",
        "mesh POSITION",
    }
    scale = np.abs(before).max()
    assert rows["points TAU"] == [
        f"{2.0:.3e}",
        f"{np.sqrt((2.0**2 + 1.0**2) / before.size):.3e}",
        f"{scale:.3e}",
        f"{2.0 / scale:.3e}",
        "time 0.5, increment 2, point 17, component 13",
    ]
    assert rows["points POSITION"][-1] == "identical"


def test_worst_of_a_mesh_field_is_named_by_node_and_element(bar, twin, post):
    with h5py.File(f"{bar}_mesh.vtkhdf") as file:
        n_nodes = int(file["VTKHDF/NumberOfPoints"][0])
        n_elements = int(file["VTKHDF/NumberOfCells"][0])
    change(f"{twin}_mesh.vtkhdf", "VTKHDF/PointData/RF", (4 * n_nodes + 6, 1), 1e3)
    change(f"{twin}_mesh.vtkhdf", "VTKHDF/CellData/J", 1 * n_elements + 30, 2.0)
    change(f"{twin}_mesh.vtkhdf", "VTKHDF/Points", (3 * n_nodes + 2, 0), 9.0)
    rows = rows_of(post("compare", bar, twin)[1])
    assert rows["mesh RF"][-1] == "time 1, increment 4, node 7, component 2"
    assert rows["mesh J"][-1] == "time 0.25, increment 1, element 31"
    assert rows["mesh POSITION"][-1] == "time 0.75, increment 3, node 3, component x"


def test_table_begins_with_the_worst(bar, twin, post):
    change(f"{twin}.vtkhdf", "tessera/history/RF1[X1]", 3, lambda old: old * 1.1)
    change(f"{twin}.vtkhdf", "tessera/history/U1[X1]", 3, lambda old: old * 1.5)
    change(f"{twin}.vtkhdf", "VTKHDF/PointData/PEEQ", 200, 70.0)
    rows = rows_of(post("compare", bar, twin)[1])
    assert list(rows)[:3] == ["points PEEQ", "history U1[X1]", "history RF1[X1]"]
    relative = [float(row[3]) for row in rows.values() if row[3] != "-"]
    assert relative == sorted(relative, reverse=True)


def test_numbers_of_things_must_be_equal_whatever_the_tolerance(bar, twin, post):
    change(f"{twin}.vtkhdf", "VTKHDF/PointData/PATCH", slice(100, 103), lambda old: old + 1)
    code, out, _ = post("compare", bar, twin, "--rtol", "100")
    assert code == 1
    where = "time 0.25, increment 1, point 5"
    assert rows_of(out)["points PATCH"] == ["3 unequal", "of 480", "-", "-", where]
    assert last_line(out) == (
        "they differ: 1 of 27 beyond rtol 100, atol 0; most points PATCH, in 3 of 480,"
        " at time 0.25, increment 1, point 5"
    )


def test_points_are_matched_by_their_number(bar, twin, post):
    order = np.arange(96)[::-1]
    with h5py.File(f"{twin}.vtkhdf", "r+") as file:
        grid = file["VTKHDF"]
        for dataset in (grid["Points"], *grid["PointData"].values()):
            values = dataset[()]
            for step in range(len(values) // 96):  # what never changes stands there once
                values[96 * step : 96 * (step + 1)] = values[96 * step : 96 * (step + 1)][order]
            dataset[...] = values
    code, out, _ = post("compare", bar, twin)
    assert code == 0
    assert "(bitwise identical)" in last_line(out)


def test_points_that_only_one_run_lost_are_a_difference(thinned, run_deck, post, tmp_path):
    from lost_point_runs import MOVING

    deck = bar_deck().replace(MOVING, "*LOST POINTS, ACTION=FREEZE")
    frozen = run_deck(tmp_path, deck, name="frozen")
    code, out, err = post("compare", thinned, frozen, "--fields", "ID,S")
    assert code == 1
    with h5py.File(f"{thinned}.vtkhdf") as file:
        ledger = {name: column[()] for name, column in file["tessera/ledger"].items()}
    first = int(np.flatnonzero(ledger["lost"])[0])
    assert last_line(out).endswith(
        f"at time {ledger['time'][first]:g}, increment {first}, points of one run only"
    )
    n_missing, n_all = int(ledger["lost"].sum()), 96 * len(ledger["lost"])
    assert rows_of(out)["points ID"][:2] == [f"{n_missing} unequal", f"of {n_all}"]
    assert "other deck, first in line" in err


@pytest.mark.parametrize("name", ["footing", "stretch", "strip-footing"])
def test_formulations_of_an_example_differ(name, example, post):
    standard, fbar = example(name, "standard"), example(name, "fbar")
    code, out, err = post("compare", standard, fbar)
    assert code == 1
    assert err == "tessera-post: note: other formulation: standard MPM against F-bar patch\n"
    with h5py.File(f"{standard}.vtkhdf") as a, h5py.File(f"{fbar}.vtkhdf") as b:
        stress_a, stress_b = (file["VTKHDF/PointData/S"][()] for file in (a, b))
    apart = np.abs(stress_a - stress_b)
    scale = max(np.abs(stress_a).max(), np.abs(stress_b).max())
    assert rows_of(out)["points S"][:4] == [
        f"{value:.3e}"
        for value in (apart.max(), np.sqrt(np.mean(apart**2)), scale, apart.max() / scale)
    ]


# --- what only one run has -----------------------------------------------------------------------


def test_only_common_times_are_compared_with_a_note(bar, run_deck, post, tmp_path):
    fine = run_deck(tmp_path, bar_deck(size=0.125, every=2), name="fine")
    code, out, err = post("compare", bar, fine, "--rtol", "0.5", "--fields", "S")
    assert code == 0
    assert last_line(out) == ("the same within rtol 0.5, atol 0: 4 history columns, 1 point fields")
    assert (
        "note: 5 increments compared, time 0 included; left out: 0 of 'bar', 4 of 'fine'\n" in err
    )
    assert "outputs" not in err
    sparse = run_deck(tmp_path, bar_deck(every=3), name="sparse")
    code, out, err = post("compare", bar, sparse)
    assert code == 0
    assert "note: 3 outputs compared, time 0 included; left out: 2 of 'bar', 0 of 'sparse'" in err
    assert "note: 3 outputs of the mesh compared" in err


def test_names_that_only_one_run_has_are_left_out_with_a_note(bar, run_deck, post, tmp_path):
    deck = bar_deck().replace("S, TAU, LE, PEEQ, F,", "S,").replace("RF, U", "RF")
    code, out, err = post("compare", bar, run_deck(tmp_path, deck, name="less"))
    assert code == 0
    assert "note: history columns left out, only in 'bar': U1[X1], U2[X1]\n" in err
    assert "note: point fields left out, only in 'bar': F, LE, PEEQ, TAU\n" in err
    assert "points TAU" not in out


def test_killed_runs_are_compared_as_far_as_both_go(killed, tessera_release, post, tmp_path):
    other = run_and_kill(tessera_release, tmp_path, after=40)
    code, out, err = post("compare", killed, other)
    assert code == 0
    assert last_line(out).startswith("the same within rtol 1e-09, atol 0 (bitwise identical): 4 h")
    assert "'bar' has not finished" in err
    n_times = []
    for job in (killed, other):
        with h5py.File(f"{job}.vtkhdf") as file:
            n_times.append(min(len(column) for column in file["tessera/history"].values()))
    few, many = sorted(n_times)
    assert f"note: {few} increments compared, time 0 included; left out: " in err
    assert f"{many - few} of 'bar'" in err


def test_run_that_never_went_on_is_not_comparable(bar, run_deck, post, tmp_path):
    start = run_deck(tmp_path, bar_deck(), "--check", name="start")
    assert error_of(post("compare", bar, start, "-q")) == (
        "'bar' and 'start' are not comparable: they have no time after 0 in common"
    )
    again = run_deck(tmp_path, bar_deck(), "--check", name="again")
    assert post("compare", again, start, "-q")[0] == 0


def test_single_increment_is_compared_with_four(bar, single, post):
    code, _, err = post("compare", single, bar, "--rtol", "0.5", "--no-fields")
    assert code == 0
    assert "2 increments compared, time 0 included; left out: 0 of 'bar', 3 of 'bar'" in err


def test_other_deck_and_units_are_told(bar, run_deck, post, tmp_path):
    deck = bar_deck(heading="Bar").replace("LENGTH=m", "LENGTH=mm")
    code, _, err = post("compare", bar, run_deck(tmp_path, deck, name="other"))
    assert code == 0
    assert "note: other deck, first in line 2: 'Plastic bar' against 'Bar'\n" in err
    assert "note: other units: 'length m force kN' against 'length mm force kN'" in err


def test_run_without_mesh_file_is_compared_without_it(bar, twin, post):
    (twin.parent / "bar_mesh.vtkhdf").unlink()
    code, out, err = post("compare", bar, twin)
    assert code == 0
    assert last_line(out).endswith(": 4 history columns, 14 point fields")
    assert "note: meshes are not compared: 'bar' has none\n" in err


# --- not comparable, and errors ------------------------------------------------------------------


def error_of(result):
    code, out, err = result
    assert (code, out) == (2, "")
    assert err.startswith("tessera-post: error: ")
    assert err.count("\n") == 1
    return err.removeprefix("tessera-post: error: ").rstrip("\n")


def test_other_mesh_is_not_comparable(bar, example, run_deck, post, tmp_path):
    deck = bar_deck().replace("X, 0, 4, 4", "X, 0, 4, 5")
    other = run_deck(tmp_path, deck, name="other")
    assert error_of(post("compare", bar, other)) == (
        "'bar' and 'other' are not comparable: other mesh, 27 nodes and 32 elements against"
        " 33 nodes and 40 elements"
    )
    assert post("compare", bar, other, "--no-fields", "--rtol", "0.1")[0] == 0
    longer = run_deck(tmp_path, bar_deck().replace("X, 0, 4, 4", "X, 0, 5, 4"), name="longer")
    assert error_of(post("compare", bar, longer)) == (
        "'bar' and 'longer' are not comparable: other mesh, its nodes start at other places"
    )
    message = error_of(post("compare", example("stretch", "fbar"), bar))
    assert message.startswith("'stretch_fbar' and 'bar' are not comparable: other mesh, 26 nodes")


def test_other_points_are_not_comparable(bar, run_deck, post, tmp_path):
    more = run_deck(tmp_path, bar_deck().replace("ELEMENT=3", "ELEMENT=6"), name="more")
    assert error_of(post("compare", bar, more)) == (
        "'bar' and 'more' are not comparable: other material points, 96 and 192 at the start"
    )


def test_no_time_in_common_is_not_comparable(bar, run_deck, post, tmp_path):
    other = run_deck(tmp_path, bar_deck(size=0.3).replace("0.3, 1.0", "0.3, 0.9"), name="other")
    assert error_of(post("compare", bar, other)) == (
        "'bar' and 'other' are not comparable: they have no time after 0 in common"
    )


def test_missing_field_names_those_there_are(bar, post):
    message = error_of(post("compare", bar, bar, "--fields", "S,WATER"))
    assert message == (
        "'WATER' is no field of both runs: there are POSITION, ELEMENT, F, ID, J, JBAR, LE, MAT,"
        " PATCH, PEEQ, S, TAU, U, VOL, RF, U_INC, ACTIVE, JPATCH, NPOINTS"
    )
    assert error_of(post("compare", bar, bar, "--fields", "")).startswith("--fields names no field")


def test_file_that_is_not_ours_is_one_line_of_error(bar, post, tmp_path):
    text = tmp_path / "text.vtkhdf"
    text.write_text("no HDF5")
    assert error_of(post("compare", bar, text)) == (
        f"'{text}' is no HDF5 file: expected a .vtkhdf file of Tessera"
    )
    assert error_of(post("compare", text, bar)).startswith(f"'{text}' is no HDF5 file")
    assert error_of(post("compare", bar, tmp_path / "no")).startswith("there are no results of")


@pytest.mark.parametrize("value", ["-1", "nan", "inf", "much"])
def test_tolerance_is_a_number_from_0_on(bar, post, value):
    code, _, err = post("compare", bar, bar, "--rtol", value)
    assert code == 2
    assert "argument --rtol: " in err


def test_help_says_what_the_scale_is(post):
    code, out, _ = post("compare", "--help")
    assert code == 0
    assert "The scale of a history column is the\nlargest absolute value" in out
    assert "tessera-post compare footing_fbar reference/footing_fbar" in out
