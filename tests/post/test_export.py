"""export: VTK XML, CSV and the deck, compared with what h5py reads from the results."""

import csv
import resource
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyvista as pv
from post_runs import bar_deck, deck_of
from raw_results import raw_outputs

pytest_plugins = ["lost_point_runs"]
JOBS = ["stretch", "strip-footing", "bar", "single", "killed", "thinned", "emptied"]
SYMMETRIC = ["11", "22", "33", "12", "23", "13"]


def read_csv(text):
    """Comments, names and rows of a table."""
    lines = text.splitlines()
    comments = [line for line in lines if line.startswith("#")]
    names, *rows = csv.reader(lines[len(comments) :])
    return comments, names, {name: [row[i] for row in rows] for i, name in enumerate(names)}


def numbers(column):
    return np.array([float(value) for value in column])


# --- vtk -----------------------------------------------------------------------------------------


def check_collection(path, raw):
    """Every output of a .pvd is that of the results, to the last bit."""
    reader = pv.get_reader(str(path))
    assert reader.time_values == [output.time for output in raw]
    for step, output in enumerate(raw):
        reader.set_active_time_point(step)
        grid = reader.read()[0]
        assert grid.points.dtype == output.points.dtype
        np.testing.assert_array_equal(grid.points, output.points)
        np.testing.assert_array_equal(grid.cell_connectivity, output.connectivity)
        assert set(grid.point_data) | set(grid.cell_data) == set(output.fields)
        for name, values in output.fields.items():
            assert grid[name].dtype == values.dtype
            np.testing.assert_array_equal(grid[name], values, err_msg=name)


@pytest.mark.parametrize("any_job", JOBS, indirect=True)
def test_vtk_files_hold_every_field_of_every_time(any_job, post, tmp_path):
    code, out, _ = post("export", any_job, "vtk", "-o", tmp_path / "vtk")
    assert code == 0
    for name in (any_job.name, f"{any_job.name}_mesh"):
        raw = raw_outputs(any_job.parent / f"{name}.vtkhdf")
        collection = tmp_path / "vtk" / f"{name}.pvd"
        assert f"wrote {collection}\n  with {len(raw)} files {name}_*.vtu beside it\n" in out
        check_collection(collection, raw)


def test_footing_is_exported_for_paraview(example, post, tmp_path):
    job = example("footing", "fbar")
    assert post("export", job, "vtk", "-o", tmp_path)[0] == 0
    check_collection(tmp_path / "footing_fbar.pvd", raw_outputs(f"{job}.vtkhdf"))
    check_collection(tmp_path / "footing_fbar_mesh.pvd", raw_outputs(f"{job}_mesh.vtkhdf"))


def test_vtk_files_are_binary_and_compressed(bar, post, tmp_path):
    post("export", bar, "vtk", "-o", tmp_path)
    data = (tmp_path / "bar_0004.vtu").read_bytes()
    assert b'<VTKFile type="UnstructuredGrid"' in data
    assert b'compressor="vtkZLibDataCompressor"' in data
    assert b'<AppendedData encoding="raw">' in data
    entries = ET.parse(tmp_path / "bar.pvd").getroot().findall("Collection/DataSet")
    assert [entry.get("file") for entry in entries] == [f"bar_{i:04d}.vtu" for i in range(5)]


def test_vtk_files_lie_in_a_folder_beside_the_results(run_deck, post, tmp_path):
    job = run_deck(tmp_path, bar_deck(size=1.0))
    assert post("export", job, "vtk")[0] == 0
    assert sorted(path.name for path in (tmp_path / "bar_vtk").iterdir()) == [
        "bar.pvd",
        "bar_0000.vtu",
        "bar_0001.vtu",
        "bar_mesh.pvd",
        "bar_mesh_0000.vtu",
        "bar_mesh_0001.vtu",
    ]


def test_job_without_mesh_file_is_exported_with_a_note(run_deck, post, tmp_path):
    job = run_deck(tmp_path, bar_deck(size=1.0))
    (tmp_path / "bar_mesh.vtkhdf").unlink()
    code, _, err = post("export", job, "vtk")
    assert code == 0
    assert "note: 'bar_mesh.vtkhdf' cannot be read" in err
    assert not list((tmp_path / "bar_vtk").glob("bar_mesh*"))
    check_collection(tmp_path / "bar_vtk" / "bar.pvd", raw_outputs(f"{job}.vtkhdf"))


# --- files that are there, and files that cannot be written --------------------------------------


def test_existing_files_are_kept_without_force(bar, post, tmp_path):
    for format_, name in (("vtk", "bar_0002.vtu"), ("csv", "a.csv"), ("deck", "a.inp")):
        path = tmp_path / name
        path.write_text("mine")
        output = tmp_path if format_ == "vtk" else path
        code, out, err = post("export", bar, format_, "-o", output)
        assert (code, out) == (2, "")
        assert err == (
            f"tessera-post: error: '{path}' exists already: it is only overwritten with --force\n"
        )
        assert path.read_text() == "mine"
        assert post("export", bar, format_, "-o", output, "--force")[0] == 0
        assert path.read_bytes() != b"mine"


def files_after_full_disk(job, folder, *arguments):
    """Runs export where files cannot grow beyond 2,000 bytes; code, stderr and what is there."""
    result = subprocess.run(
        [sys.executable, "-m", "tessera_post", "export", str(job), *map(str, arguments)],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)),
        check=False,
    )
    assert result.stdout == ""
    return result.returncode, result.stderr, sorted(path.name for path in folder.iterdir())


def test_full_disk_leaves_earlier_files_and_nothing_else(bar, tmp_path):
    old = tmp_path / "bar.csv"
    old.write_text("mine")
    code, err, there = files_after_full_disk(bar, tmp_path, "csv", "-o", old, "--force")
    assert (code, there) == (2, ["bar.csv"])
    assert err == f"tessera-post: error: cannot write '{old}': File too large\n"
    assert old.read_text() == "mine"
    folder = tmp_path / "a" / "b"
    code, err, there = files_after_full_disk(bar, tmp_path, "vtk", "-o", folder)
    assert (code, there) == (2, ["bar.csv"])
    first = folder / "bar_0000.vtu"
    assert err == f"tessera-post: error: cannot write '{first}': no permission, or no space left\n"


def test_missing_folder_is_an_error(bar, post, tmp_path):
    path = tmp_path / "no" / "a.csv"
    code, _, err = post("export", bar, "csv", "-o", path)
    assert code == 2
    assert err == (
        f"tessera-post: error: cannot write '{path}': there is no folder '{path.parent}'\n"
    )
    code, _, err = post("export", bar, "csv", "-o", tmp_path)
    assert (code, err) == (
        2,
        f"tessera-post: error: '{tmp_path}' is a folder: expected the name of a file\n",
    )


# --- csv -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("any_job", JOBS, indirect=True)
def test_table_holds_all_fields_of_the_last_output(any_job, post):
    code, out, _ = post("export", any_job, "csv", "-o", "-")
    assert code == 0
    _, names, columns = read_csv(out)
    raw = raw_outputs(f"{any_job}.vtkhdf")[-1]
    assert names[:4] == ["ID", "x", "y", "z"]
    np.testing.assert_array_equal(numbers(columns["ID"]), raw.fields["ID"])
    for axis, name in enumerate("xyz"):
        np.testing.assert_array_equal(numbers(columns[name]), raw.points[:, axis])
    for i, component in enumerate(SYMMETRIC):
        np.testing.assert_array_equal(numbers(columns[f"S{component}"]), raw.fields["S"][:, i])
    n_columns = sum(values[0].size if len(values) else 1 for values in raw.fields.values())
    if len(raw.points):
        assert len(names) == 3 + n_columns


def test_table_says_what_it_is(bar, post):
    comments, names, columns = read_csv(post("export", bar, "csv", "--time", "0.5", "-o", "-")[1])
    assert comments == [
        "# job bar, deck bar.inp, F-bar patch",
        "# Plastic bar",
        "# units: length m, force kN/m, stress kPa",
        "# points at time 0.5, increment 2",
    ]
    raw = raw_outputs(f"{bar}.vtkhdf")[2]
    assert "F11 F12 F13 F21 F22 F23 F31 F32 F33".split() == [n for n in names if n[0] == "F"]
    np.testing.assert_array_equal(numbers(columns["F12"]), raw.fields["F"][:, 1])
    np.testing.assert_array_equal(numbers(columns["U2"]), raw.fields["U"][:, 1])
    assert columns["PATCH"] == [str(value) for value in raw.fields["PATCH"]]


def test_table_holds_the_quantities_that_are_asked_for(bar, post):
    out = post("export", bar, "csv", "--field", "tau33,S:mises, peeq", "--increment", "1", "-o-")[1]
    _, names, columns = read_csv(out)
    raw = raw_outputs(f"{bar}.vtkhdf")[1].fields
    assert names == ["ID", "x", "y", "z", "TAU33", "S:MISES", "PEEQ"]
    np.testing.assert_array_equal(numbers(columns["TAU33"]), raw["TAU"][:, 2])
    s11, s22, s33, s12, s23, s13 = raw["S"].T
    j2 = ((s11 - s22) ** 2 + (s22 - s33) ** 2 + (s33 - s11) ** 2) / 6 + s12**2 + s23**2 + s13**2
    np.testing.assert_allclose(numbers(columns["S:MISES"]), np.sqrt(3 * j2), rtol=1e-12)
    np.testing.assert_array_equal(numbers(columns["PEEQ"]), raw["PEEQ"])


def test_name_of_the_table_tells_points_and_increment(run_deck, post, tmp_path):
    job = run_deck(tmp_path, bar_deck(size=0.5))
    for arguments, name in (
        (["--increment", "1"], "bar_points_0001.csv"),
        (["--mesh", "nodes"], "bar_nodes_0002.csv"),
        (["--mesh", "elements"], "bar_elements_0002.csv"),
    ):
        assert post("export", job, "csv", *arguments)[1] == f"wrote {tmp_path / name}\n"
        assert (tmp_path / name).read_text().startswith("# job bar, deck bar.inp")


def test_tables_of_the_mesh_hold_nodes_and_elements(bar, post):
    raw = raw_outputs(f"{bar}_mesh.vtkhdf")[-1]
    _, names, columns = read_csv(post("export", bar, "csv", "--mesh", "nodes", "-o", "-")[1])
    assert names[0] == "NODE"
    np.testing.assert_array_equal(numbers(columns["NODE"]), np.arange(1, len(raw.points) + 1))
    np.testing.assert_array_equal(numbers(columns["RF1"]), raw.fields["RF"][:, 0])
    np.testing.assert_array_equal(numbers(columns["y"]), raw.points[:, 1])
    _, names, columns = read_csv(post("export", bar, "csv", "--mesh", "elements", "-o", "-")[1])
    assert names[0] == "ELEMENT"
    corners = raw.points[raw.connectivity.reshape(-1, 3)]
    np.testing.assert_allclose(numbers(columns["x"]), corners[:, :, 0].mean(axis=1), rtol=1e-14)
    np.testing.assert_array_equal(numbers(columns["NPOINTS"]), raw.fields["NPOINTS"])
    assert numbers(columns["NPOINTS"]).sum() == 96


# --- deck ----------------------------------------------------------------------------------------


def test_deck_comes_back_byte_for_byte(run_deck, tmp_path):
    deck = "** tab\tand umlaut \u00e4  \n\n" + bar_deck(size=1.0).rstrip("\n")
    job = run_deck(tmp_path, deck)
    command = [sys.executable, "-m", "tessera_post", "export", str(job), "deck"]
    result = subprocess.run(command, capture_output=True, check=True)
    assert result.stdout == deck.encode()
    assert result.stderr == b""
    again = tmp_path / "again.inp"
    result = subprocess.run([*command, "-o", str(again)], capture_output=True, check=True)
    assert result.stdout == f"wrote {again}\n".encode()
    assert again.read_bytes() == deck.encode()


def history_of(job):
    with h5py.File(f"{job}.vtkhdf") as file:
        return {name: column[()] for name, column in file["tessera/history"].items()}


def test_deck_with_includes_runs_again_and_gives_the_same(run_deck, post, tmp_path):
    deck = bar_deck()
    start, end = deck.index("*MATERIAL, NAME"), deck.index("*MATERIAL POINTS")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "steel.inp").write_text(
        "*MATERIAL, NAME=STEEL\n*INCLUDE, INPUT=moduli.inp\n*PLASTIC, LAW=VON MISES,\n"
        " STRENGTH=UNIAXIAL\n20.0"  # the last line has no end
    )
    (tmp_path / "parts" / "moduli.inp").write_text("*ELASTIC\n1000.0, 0.3\n")
    whole = deck[:start] + '*INCLUDE, INPUT="parts/steel.inp"\n' + deck[end:]
    first = run_deck(tmp_path, whole)
    again = tmp_path / "again"
    again.mkdir()
    assert post("export", first, "deck", "-o", again / "one.inp")[0] == 0
    text = (again / "one.inp").read_text()
    assert "\n*INCLUDE" not in text
    assert "** *INCLUDE" in text
    second = run_deck(again, text, name="one")
    plain = tmp_path / "plain"
    plain.mkdir()
    expected = history_of(run_deck(plain, deck))
    for job in (first, second):
        history = history_of(job)
        assert list(history) == list(expected)
        for name, column in expected.items():
            np.testing.assert_array_equal(history[name], column)


@pytest.mark.parametrize("name", ["footing", "stretch", "strip-footing"])
def test_deck_of_an_example_is_that_of_its_file(name, example, post, tmp_path):
    assert post("export", example(name, "standard"), "deck", "-o", tmp_path / "d")[0] == 0
    assert (tmp_path / "d").read_bytes() == deck_of(name).read_bytes()


# --- errors --------------------------------------------------------------------------------------


def test_killed_job_is_exported_with_a_note(killed, post):
    code, out, err = post("export", killed, "csv", "-o", "-")
    assert code == 0
    assert "note: 'bar' has not finished (killed, or still running)" in err
    comments, _, _ = read_csv(out)
    raw = raw_outputs(f"{killed}.vtkhdf")[-1]
    assert comments[-1].startswith(f"# points at time {float(raw.time)!r}, increment ")


def test_missing_field_names_those_there_are(bar, post):
    code, out, err = post("export", bar, "csv", "--field", "S33,WATER", "-o", "-")
    assert (code, out) == (2, "")
    assert err.startswith("tessera-post: error: 'bar.vtkhdf' has no field 'WATER': there are ")
    assert "S:mises" in err
    assert err.count("\n") == 1
    code, _, err = post("export", bar, "csv", "--mesh", "nodes", "--field", "PEEQ")
    assert (code, err) == (
        2,
        "tessera-post: error: 'bar_mesh.vtkhdf' on nodes has no field 'PEEQ': there are"
        " RF, RF1..RF3, U, U1..U3, U_INC, U_INC1..U_INC3\n",
    )
    assert post("export", bar, "csv", "--field", ",")[2].startswith(
        "tessera-post: error: --field names no field: there are "
    )


def test_missing_output_names_those_there_are(bar, post):
    assert post("export", bar, "csv", "--increment", "9") == (
        2,
        "",
        "tessera-post: error: 'bar' has no output at increment 9: there are 0, 1, 2, 3, 4\n",
    )


def test_options_of_csv_are_refused_with_other_formats(bar, post):
    code, _, err = post("export", bar, "deck", "--field", "S")
    assert (code, err) == (2, "tessera-post: error: --field goes with csv, not with deck\n")
    code, _, err = post("export", bar, "vtk", "-o", "-")
    assert code == 2
    assert err == (
        "tessera-post: error: vtk writes several files: expected a folder, not standard output\n"
    )


@pytest.mark.parametrize("format_", ["vtk", "csv", "deck"])
def test_file_that_is_not_ours_is_one_line_of_error(format_, post, tmp_path):
    text = tmp_path / "text.vtkhdf"
    text.write_text("no HDF5")
    other = tmp_path / "other.vtkhdf"
    with h5py.File(other, "w") as file:
        file["VTKHDF"] = np.arange(3)
    for path, words in ((text, "is no HDF5 file"), (other, "is no result of Tessera")):
        code, out, err = post("export", path, format_, "-o", tmp_path / "out")
        assert (code, out) == (2, "")
        assert err.startswith(f"tessera-post: error: '{path}' {words}")
        assert err.count("\n") == 1
    assert not Path(tmp_path / "out").exists()


def test_help_shows_examples(post):
    code, out, _ = post("export", "--help")
    assert code == 0
    assert "tessera-post export footing_fbar csv --field TAU33,S:mises,PEEQ" in out
