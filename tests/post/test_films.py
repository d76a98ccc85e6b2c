"""Scatter, deformed bodies and animations."""

import h5py
import imageio.v3 as iio
import numpy as np
import pytest
from PIL import Image
from tessera_post import animate, deformed, scatter
from tessera_post.animate import Film
from tessera_post.job import open_job
from tessera_post.picture import PictureOptions, frames_of
from tessera_post.style import plt
from test_picture import drawn, is_blank, rows  # noqa: F401


@pytest.fixture
def figure(monkeypatch):
    """The figures that scatter saves."""
    figures = []
    monkeypatch.setattr(scatter, "save", lambda made, path: figures.append((made, path)))
    return figures


def test_scatter_draws_all_points_and_their_statistics(post, figure, example):
    jobs = [example("stretch", method) for method in ("standard", "fbar")]
    options = ["--field", "TAU33", "--exact", "400", "yield stress"]
    code, out, err = post("scatter", *jobs, *options)
    assert (code, err) == (0, "")
    for job, axes in zip(jobs, figure[0][0].axes):
        path = job.with_name(f"{job.name}.vtkhdf")
        values = [rows(path, "TAU", i)[:, 2] for i in range(18)]
        dots, mean, low, high, exact = axes.lines
        np.testing.assert_array_equal(dots.get_ydata(), np.concatenate(values))
        np.testing.assert_array_equal(dots.get_xdata(), np.repeat(np.arange(18), 440))
        for line, statistic in ((mean, np.mean), (low, np.min), (high, np.max)):
            np.testing.assert_allclose(line.get_ydata(), [statistic(v) for v in values], atol=1e-9)
        assert list(exact.get_ydata()) == [400.0, 400.0]
        band = axes.collections[0].get_paths()[0].vertices
        assert band[:, 1].max() == pytest.approx(max(v.mean() + v.std() for v in values))
        assert axes.get_xlabel() == "increment [-]"
    assert figure[0][0].axes[0].get_ylabel() == "Kirchhoff stress 33 [Pa]"
    last = rows(jobs[1].with_name("stretch_fbar.vtkhdf"), "TAU")[:, 2]
    assert out.splitlines()[1] == (
        f"F-bar patch: at the end mean {last.mean():.6g}, standard deviation {last.std():.4g},"
        f" min {last.min():.6g}, max {last.max():.6g} Pa"
    )


def test_scatter_thins_the_dots_but_not_the_statistics(figure, post, example):
    job = example("footing", "standard")
    assert post("scatter", job, "--field", "pressure", "--against", "time")[0] == 0
    axes = figure[0][0].axes[0]
    dots, mean, low, high = axes.lines
    assert len(dots.get_ydata()) <= 21 * 1500
    path = job.with_name("footing_standard.vtkhdf")
    values = -rows(path, "S")[:, :3].mean(axis=1)
    assert low.get_ydata()[-1] == pytest.approx(values.min())
    assert high.get_ydata()[-1] == pytest.approx(values.max())
    assert mean.get_xdata()[-1] == 1.0


def test_deformed_draws_each_increment(post, drawn, example, tmp_path):  # noqa: F811
    job = example("stretch", "fbar")
    path = tmp_path / "deformed.png"
    options = ["--increments", "0,5,11,17", "--field", "TAU33", "-o", path]
    assert post("deformed", job, *options)[0] == 0
    assert not is_blank(path)
    results = job.with_name("stretch_fbar.vtkhdf")
    for (layers, _, scale, image), output in zip(drawn, (0, 5, 11, 17), strict=True):
        np.testing.assert_array_equal(layers[0].values, rows(results, "TAU", output)[:, 2])
        np.testing.assert_array_equal(
            np.asarray(layers[0].data.points), rows(results, "Points", output)
        )
        assert scale is drawn[0][2]
        assert image.shape == drawn[0][3].shape


def test_deformed_has_a_row_for_each_job(example):
    jobs = [open_job(str(example("stretch", method))) for method in ("standard", "fbar")]
    frames = [frames_of(jobs, PictureOptions(increment=i)) for i in (0, 17)]
    figure = deformed.draw_frames(frames, PictureOptions(field="TAU33"))
    titles = [axes.get_title() for axes in figure.axes[:4]]
    assert titles == [
        f"{name}\nincrement {i}, time {i}"
        for i in (0, 17)
        for name in ("standard MPM", "F-bar patch")
    ]


def test_deformed_says_which_increments_there_are(post, bar):
    code, _, err = post("deformed", bar, "--increments", "0,7")
    assert code == 2
    assert err == (
        "tessera-post: error: 'bar' has no output at increment 7: there are 0, 1, 2, 3, 4\n"
    )
    code, _, err = post("deformed", bar, "--increments", "0;7")
    assert code == 2
    assert "expected whole numbers such as 0,5,11, found '0;7'" in err


def test_animation_has_a_frame_per_output(post, bar, tmp_path):
    path = tmp_path / "bar.mp4"
    code, _, err = post("animate", bar, "--field", "PEEQ", "-o", path)
    assert code == 0
    assert "5/5" in err  # the progress bar
    frames = iio.imread(path, plugin="pyav")
    assert len(frames) == 5
    assert all(side % 2 == 0 for side in frames.shape[1:3])
    assert np.abs(frames[-1].astype(float) - frames[0]).mean() > 0.5
    assert [p.name for p in tmp_path.iterdir()] == ["bar.mp4"]


def test_gif_takes_every_second_output_and_the_last(post, bar, tmp_path):
    path = tmp_path / "bar.gif"
    code, out, err = post("animate", bar, "--every", "3", "--fps", "4", "-q", "-o", path)
    assert (code, out, err) == (0, f"wrote {path}\n", "")
    with Image.open(path) as film:
        assert (film.n_frames, film.info["duration"], film.info["loop"]) == (3, 250, 0)


def test_film_keeps_camera_and_scale(bar, drawn):  # noqa: F811
    film = Film([open_job(str(bar))], PictureOptions(field="S11"), 1)
    images = list(film.images())
    assert len({image.shape for image in images}) == 1
    assert len({id(scale) for _, _, scale, _ in drawn}) == 1
    path = bar.with_name("bar.vtkhdf")
    with h5py.File(path) as file:
        stress = file["VTKHDF/PointData/S"][:, 0]
    assert drawn[0][2].low <= stress.min()
    assert drawn[0][2].high == pytest.approx(stress.max())


def test_film_names_the_numbers_of_things(bar, monkeypatch):
    sheets = []

    def keep(rows, sheet):
        sheets.append(sheet)
        return plt.figure()

    monkeypatch.setattr(animate, "compose", keep)
    film = Film([open_job(str(bar))], PictureOptions(field="PATCH"), 1)
    list(film.images())
    with h5py.File(bar.with_name("bar.vtkhdf")) as file:
        patches = np.unique(file["VTKHDF/PointData/PATCH"][()])
    assert {sheet.categories for sheet in sheets} == {tuple(patches)}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["-o", "film.avi"], "'film.avi': expected a name that ends in .mp4 or .gif"),
        (["--every", "0"], "--every: expected a whole number above 0"),
        (["--fps", "0"], "--fps: expected a number from 0.1 to 100"),
    ],
)
def test_wrong_options_are_told(post, bar, options, message):
    code, out, err = post("animate", bar, *options)
    assert (code, out, err) == (2, "", f"tessera-post: error: {message}\n")


def test_film_that_cannot_be_written_leaves_nothing(post, bar, tmp_path):
    path = tmp_path / "missing" / "bar.mp4"
    code, _, err = post("animate", bar, "-q", "-o", path)
    assert code == 2
    assert err.count("\n") == 1
    assert err.startswith("tessera-post: error: ")
