"""Every command on every kind of job, and on what is no job."""

import h5py
import pytest
from post_runs import bar_deck
from tessera_post.cli import COMMANDS, main
from test_picture import is_blank

pytest_plugins = ["lost_point_runs"]
JOBS = ("footing", "stretch", "strip-footing", "bar", "single", "killed")
DRAWING = {
    "curve": (["-o", "{out}.png"], ".png"),
    "picture": (["-o", "{out}.png"], ".png"),
    "scatter": (["-o", "{out}.png"], ".png"),
    "deformed": (["-o", "{out}.png"], ".png"),
    "animate": (["-q", "--every", "7", "-o", "{out}.gif"], ".gif"),
    "report": (["-o", "{out}.html"], ".html"),
}
OF_JOBS = [name for name in COMMANDS if name != "paper"]


@pytest.fixture
def job(request, example):
    """The job of a name: an example with F-bar patches, or a fixture."""

    def path(name):
        if name in ("bar", "single", "killed"):
            return request.getfixturevalue(name)
        return example(name, "fbar")

    return path


def arguments(command, job, out):
    """A call of a command for one job."""
    if command == "compare":
        return ["compare", job, job]
    if command == "export":
        return ["export", job, "csv", "-o", f"{out}.csv"]
    return [command, job, *(option.format(out=out) for option in DRAWING[command][0])]


@pytest.mark.parametrize("name", JOBS)
@pytest.mark.parametrize("command", OF_JOBS)
def test_every_command_takes_every_job(post, job, tmp_path, command, name):
    code, out, err = post(*arguments(command, job(name), tmp_path / "out"))
    assert code == 0, err
    notes = [line for line in err.splitlines() if "note:" in line]
    assert any("has not finished" in note for note in notes) == (name == "killed")
    if command == "compare":
        return
    ending = ".csv" if command == "export" else DRAWING[command][1]
    path = tmp_path / f"out{ending}"
    assert f"wrote {path}" in out
    assert path.stat().st_size > 1000
    if ending == ".png":
        assert not is_blank(path)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def foreign(folder, kind):
    """A path that is no result of Tessera, and what is said about it."""
    path = folder / f"{kind}.vtkhdf"
    if kind == "text":
        path.write_text("not HDF5\n" * 100)
        return path, f"'{path}' is no HDF5 file: expected a .vtkhdf file of Tessera"
    if kind == "empty":
        path.touch()
        return path, f"'{path}' is no HDF5 file: expected a .vtkhdf file of Tessera"
    if kind == "hdf5":
        with h5py.File(path, "w") as file:
            file["numbers"] = [1, 2, 3]
        return path, f"'{path}' is no result of Tessera, or was never finished: "
    if kind == "folder":
        path.mkdir()
        return path, f"'{path}' is a folder: expected a result file"
    return path, f"there is no file '{path}'"


@pytest.mark.parametrize("kind", ["text", "empty", "hdf5", "folder", "missing"])
@pytest.mark.parametrize("command", OF_JOBS)
def test_what_is_no_job_gets_one_line(post, tmp_path, command, kind):
    path, message = foreign(tmp_path, kind)
    code, out, err = post(*arguments(command, path, tmp_path / "out"))
    assert (code, out) == (2, "")
    assert err.startswith(f"tessera-post: error: {message}")
    assert err.count("\n") == 1
    assert not list(tmp_path.glob("out*"))


@pytest.fixture(scope="module")
def stuck(run_deck, tmp_path_factory):
    """The bar, with too few iterations to converge."""
    deck = bar_deck().replace("*BOUNDARY", "*CONTROLS, MAX ITERATIONS=2\n*BOUNDARY", 1)
    deck = deck.replace("0.25, 1.0", "0.25, 1.0, 0.1")
    return run_deck(tmp_path_factory.mktemp("stuck"), deck, code=4)


@pytest.mark.parametrize("command", OF_JOBS)
def test_file_of_a_failed_attempt_says_what_it_is(post, stuck, tmp_path, command):
    path = stuck.with_name(f"{stuck.name.removesuffix('.vtkhdf')}_fail.vtkhdf")
    code, out, err = post(*arguments(command, path, tmp_path / "out"))
    assert (code, out) == (2, "")
    assert err.startswith(
        f"tessera-post: error: '{path}' holds the attempt that ended a run, for ParaView: error: no"
        " convergence at the smallest increment 0.1: too many iterations"
    )
    assert err.count("\n") == 1
    assert not list(tmp_path.glob("out*"))


@pytest.mark.parametrize("command", OF_JOBS)
def test_unknown_job_is_told_with_those_nearby(post, bar, tmp_path, command):
    path = bar.with_name("baz")
    code, _, err = post(*arguments(command, path, tmp_path / "out"))
    assert code == 2
    assert err == (
        f"tessera-post: error: there are no results of '{path}': no file '{path}.vtkhdf';"
        " jobs there: bar\n"
    )


@pytest.mark.parametrize("command", ["picture", "scatter", "deformed", "animate", "report"])
def test_missing_field_is_told_with_those_there_are(post, example, tmp_path, command):
    job = example("strip-footing", "fbar")
    code, out, err = post(*arguments(command, job, tmp_path / "out"), "--field", "JBAR")
    assert (code, out) == (2, "")
    assert err.splitlines()[-1].startswith(
        "tessera-post: error: 'strip-footing_fbar.vtkhdf' has no field 'JBAR': there are ID, "
        "LE11..LE33, LE:norm"
    )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(post, command):
    code, out, _ = post(command, "--help")
    assert code == 0
    assert f"usage: tessera-post {command}" in out
    example = out[out.index("example:\n") :].splitlines()[1]
    assert example.startswith(f"  tessera-post {command}")


def test_help_lists_the_commands(post):
    code, out, _ = post("--help")
    assert code == 0
    for name, text in COMMANDS.items():
        assert f"{name:<10} {text}" in out
    code, _, err = post("draw")
    assert code == 2
    assert "invalid choice: 'draw'" in err
    assert post()[0] == 2


@pytest.mark.parametrize("command", ["curve", "picture", "scatter", "deformed"])
def test_picture_goes_beside_the_results(post, single, command):
    code, out, _ = post(command, single)
    path = single.with_name(f"bar_{command}.png")
    assert (code, path.is_file()) == (0, True)
    assert f"wrote {path}\n" in out


@pytest.mark.parametrize("command", DRAWING)
def test_file_that_cannot_be_written_is_told_before_drawing(post, bar, tmp_path, command):
    ending = DRAWING[command][1]
    results = bar.with_name("bar.vtkhdf").read_bytes()
    for path, message in (
        (tmp_path / "missing" / f"out{ending}", f"there is no folder '{tmp_path / 'missing'}'"),
        (tmp_path, f"'{tmp_path}' is a folder: expected the name of a file"),
        (tmp_path / "out.xyz", f"'{tmp_path / 'out.xyz'}': expected a name that ends in ."),
        (tmp_path / "out", f"'{tmp_path / 'out'}': expected a name that ends in ."),
        (bar.with_name("bar.vtkhdf"), "bar.vtkhdf': expected a name that ends in ."),
    ):
        code, out, err = post(command, bar, "-o", path)
        assert (code, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())
    assert bar.with_name("bar.vtkhdf").read_bytes() == results


@pytest.mark.parametrize(
    "call",
    [
        ["picture", "--zoom", "nan"],
        ["picture", "--warp", "inf"],
        ["picture", "--range", "0", "inf"],
        ["scatter", "--range", "nan", "0"],
        ["animate", "--fps", "nan"],
        ["compare", "--rtol", "inf"],
    ],
)
def test_numbers_must_be_finite(post, bar, call):
    code, _, err = post(call[0], bar, *([bar] if call[0] == "compare" else []), *call[1:])
    assert code == 2
    assert f"argument {call[1]}: expected a number, found" in err


@pytest.mark.parametrize("command", ["picture", "scatter", "deformed", "animate"])
def test_jobs_in_other_units_are_not_mixed(post, bar, run_deck, tmp_path, command):
    deck = bar_deck().replace("LENGTH=m, FORCE=kN", "LENGTH=mm, FORCE=N")
    other = run_deck(tmp_path, deck, name="other")
    ending = DRAWING[command][1]
    code, _, err = post(command, bar, other, "--field", "S11", "-o", tmp_path / f"out{ending}")
    assert code == 2
    units = ("kPa", "MPa") if command == "scatter" else ("m", "mm")
    assert err == (
        f"tessera-post: error: 'bar' is in {units[0]}, 'other' in {units[1]}: expected jobs with"
        " the same units\n"
    )


def test_default_field_is_one_that_all_jobs_have(post, bar, run_deck, tmp_path):
    deck = bar_deck().replace("S, TAU, LE, PEEQ, F, J, JBAR, U, VOL, MAT, PATCH, ELEMENT", "PEEQ")
    other = run_deck(tmp_path, deck, name="other")
    code, out, _ = post("scatter", bar, other, "-o", tmp_path / "out.png")
    assert code == 0
    first, second = (line.split(": ", 1)[1] for line in out.splitlines()[:2])
    assert first == second
    assert first.endswith(" -")


def test_name_of_the_mesh_file_means_the_job(post, bar, tmp_path):
    code, out, _ = post("curve", bar.with_name("bar_mesh"), "-o", tmp_path / "out.png")
    assert (code, out.startswith("F-bar patch: ")) == (0, True)


def test_job_without_mesh_file_is_drawn_with_a_note(post, run_deck, tmp_path):
    job = run_deck(tmp_path, bar_deck())
    job.with_name("bar_mesh.vtkhdf").unlink()
    code, _, err = post("picture", job)
    assert code == 0
    assert "note: 'bar_mesh.vtkhdf' cannot be read: drawn without the mesh" in err
    code, _, err = post("picture", job, "--as", "elements")
    assert code == 2
    assert err.splitlines()[-1].endswith("bar_mesh.vtkhdf' cannot be read")
    for command in ("scatter", "deformed", "animate", "report"):
        assert post(*arguments(command, job, tmp_path / command))[0] == 0


def test_interrupt_ends_with_one_line(monkeypatch, capsys, bar):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tessera_post.curve.collect", interrupt)
    assert main(["curve", str(bar)]) == 130
    assert capsys.readouterr().err == "tessera-post: error: interrupted\n"


@pytest.mark.parametrize("command", DRAWING)
def test_outputs_without_points_are_drawn(post, emptied, tmp_path, command):
    code, out, err = post(*arguments(command, emptied, tmp_path / "out"))
    assert code == 0, err
    assert "nan" not in out
    (path,) = tmp_path.iterdir()
    assert path.stat().st_size > 1000


@pytest.mark.parametrize("command", DRAWING)
def test_strange_names_are_no_formulas(post, run_deck, tmp_path, command):
    """What a deck may call its units and sets must not be taken for mathematics."""
    deck = bar_deck(heading=r"$\frac$ {x} %s").replace("LENGTH=m", 'LENGTH="$\\frac$"')
    job = run_deck(tmp_path, deck, name="it's a $job$ {}")
    code, _, err = post(*arguments(command, job, tmp_path / "out"))
    assert (code, "rror" in err) == (0, False), err
