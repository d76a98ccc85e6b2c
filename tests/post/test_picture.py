"""Pictures: what is drawn, where it is drawn, and in which colours."""

import itertools

import h5py
import matplotlib.image
import numpy as np
import pytest
from tessera_post import curve, picture
from tessera_post.body import Clip, Frame, elements, make_layers, mesh_surface, radii, spheres
from tessera_post.errors import PostError
from tessera_post.job import open_job
from tessera_post.picture import PictureOptions, parse_clip
from tessera_post.scene import Renderer, find_view, find_window
from tessera_post.style import make_scale


def rows(path, name, output=-1, kind="PointData"):
    """A dataset of an output, read without tessera_post."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        if name == "Points":
            first, count = grid["Steps/PointOffsets"][output], grid["NumberOfPoints"][()]
        else:
            first = grid[f"Steps/{kind}Offsets/{name}"][output]
            count = grid["NumberOfPoints" if kind == "PointData" else "NumberOfCells"][()]
        count = count[grid["Steps/PartOffsets"][output]]
        data = grid[name] if name == "Points" else grid[kind][name]
        return data[first : first + count]


def pressure(path, output=-1):
    return -rows(path, "S", output)[:, :3].mean(axis=1)


@pytest.fixture
def drawn(monkeypatch):
    """Layers and scales that reach the renderer, in order."""
    calls = []
    draw = Renderer.draw

    def spy(self, layers, quantity, scale):
        image = draw(self, layers, quantity, scale)
        calls.append((layers, quantity, scale, image))
        return image

    monkeypatch.setattr(Renderer, "draw", spy)
    return calls


def is_blank(path):
    image = matplotlib.image.imread(path)[:, :, :3]
    return len(np.unique(image.reshape(-1, 3), axis=0)) < 20


@pytest.mark.parametrize(
    ("name", "method"),
    [("footing", "fbar"), ("stretch", "standard"), ("strip-footing", "fbar")],
)
def test_points_carry_the_values_of_the_file(post, drawn, example, name, method, tmp_path):
    job = example(name, method)
    path = tmp_path / "picture.png"
    code, out, err = post("picture", job, "--field", "pressure", "-o", path)
    assert (code, err) == (0, "")
    assert out == f"wrote {path}\n"
    assert not is_blank(path)
    layers, _, scale, image = drawn[0]
    results = job.with_name(f"{job.name}.vtkhdf")
    np.testing.assert_allclose(layers[0].values, pressure(results), rtol=1e-14)
    np.testing.assert_array_equal(np.asarray(layers[0].data.points), rows(results, "Points"))
    assert [layer.kind for layer in layers] == ["spheres", "lines"]
    low, high = pressure(results).min(), pressure(results).max()
    if low < 0.0 < high and min(-low, high) > 0.02 * (high - low):
        low, high = -max(-low, high), max(-low, high)
    assert (scale.low, scale.high) == pytest.approx((low, high), rel=1e-12)
    assert image.std() > 1.0


def test_jobs_side_by_side_share_one_scale(post, drawn, example, tmp_path):
    jobs = [example("footing", method) for method in ("standard", "fbar")]
    assert post("picture", *jobs, "--as", "elements", "-o", tmp_path / "p.png")[0] == 0
    (_, _, first, one), (_, _, second, two) = drawn
    assert first is second
    assert one.shape == two.shape
    assert first.high == pytest.approx(-first.low)
    biggest = max(np.abs(layers[0].values).max() for layers, *_ in drawn)
    assert biggest <= first.high


def test_elements_have_the_mean_of_their_points(bar):
    job = open_job(str(bar))
    frame = Frame(job, job.output_of())
    layer = elements(frame, job.quantity("S11"))
    path = bar.with_name("bar.vtkhdf")
    element, volume = rows(path, "ELEMENT"), rows(path, "VOL")
    stress = rows(path, "S")[:, 0]
    ids = np.asarray(layer.data.cell_data["vtkOriginalCellIds"])
    active = np.unique(element)
    assert layer.data.n_cells == len(active)
    for number, value in zip(active[ids], layer.values):
        of = element == number
        assert value == pytest.approx(np.average(stress[of], weights=volume[of]), rel=1e-12)


def test_elements_are_found_without_their_numbers(example, monkeypatch):
    job = open_job(str(example("footing", "fbar")))
    frame = Frame(job, job.output_of())
    quantity = job.quantity("pressure")
    known = elements(frame, quantity).values
    monkeypatch.setattr(job.points, "point_fields", ["S", "ID"])
    found = elements(frame, quantity).values
    different = np.abs(found - known) > 1e-9 * np.abs(known).max()
    assert different.sum() < 0.02 * len(known)  # points on faces


def nodes_of(layer):
    """Numbers of the nodes of a surface in the mesh."""
    return np.asarray(layer.data.point_data["vtkOriginalPointIds"])


def test_mesh_is_coloured_by_nodes_and_by_elements(bar):
    job = open_job(str(bar))
    frame = Frame(job, job.output_of())
    path = bar.with_name("bar_mesh.vtkhdf")
    by_node = mesh_surface(frame, job.mesh_quantity("U1"))
    np.testing.assert_array_equal(by_node.values, rows(path, "U")[nodes_of(by_node), 0])
    by_cell = mesh_surface(frame, job.mesh_quantity("JPATCH"))
    ids = np.asarray(by_cell.data.cell_data["vtkOriginalCellIds"])
    np.testing.assert_array_equal(by_cell.values, rows(path, "JPATCH", kind="CellData")[ids])


def test_points_are_as_large_as_their_volumes(bar, monkeypatch):
    job = open_job(str(bar))
    frame = Frame(job, job.output_of())
    volume = rows(bar.with_name("bar.vtkhdf"), "VOL")
    x = job.points.points(frame.output)
    np.testing.assert_allclose((2.0 * radii(frame, x)) ** 2, volume, rtol=1e-12)
    monkeypatch.setattr(job.points, "point_fields", ["S", "ID"])
    guessed = (2.0 * radii(frame, x)) ** 2
    assert 0.3 < np.median(guessed / volume) < 3.0


def test_displacements_are_enlarged(bar):
    job = open_job(str(bar))
    frame = Frame(job, job.output_of(), warp=3.0)
    path = bar.with_name("bar.vtkhdf")
    start, now = rows(path, "Points", 0), rows(path, "Points")
    expected = start + 3.0 * (now - start)
    np.testing.assert_allclose(spheres(frame, None).data.points, expected, atol=1e-12)
    mesh = bar.with_name("bar_mesh.vtkhdf")
    start, now = rows(mesh, "Points", 0), rows(mesh, "Points")
    expected = start + 3.0 * (now - start)
    surface = mesh_surface(frame, None)
    np.testing.assert_allclose(surface.data.points, expected[nodes_of(surface)], atol=1e-12)


def test_planes_cut_points_and_elements(bar):
    job = open_job(str(bar))
    frame = Frame(job, job.output_of(), clips=[parse_clip("x<1.0"), parse_clip("0,1,0>0.5")])
    x = rows(bar.with_name("bar.vtkhdf"), "Points")
    kept = (x[:, 0] <= 1.0) & (x[:, 1] >= 0.5)
    body, edges = make_layers(frame, "points", job.quantity("PEEQ"))
    np.testing.assert_array_equal(np.asarray(body.data.points), x[kept])
    assert len(body.values) == kept.sum()
    assert edges.data.bounds.x_max == pytest.approx(1.0)
    body, _ = make_layers(frame, "elements", job.quantity("PEEQ"))
    assert body.data.bounds[:4] == pytest.approx((0.0, 1.0, 0.5, 1.0), abs=0.02)


@pytest.mark.parametrize(
    ("text", "normal", "offset"),
    [
        ("x<0.5", (1, 0, 0), 0.5),
        ("z >= -3", (0, 0, -1), 3.0),
        ("1,1,0<2", (1, 1, 0), 2.0),
        ("Y>1e-3", (0, -1, 0), -1e-3),
    ],
)
def test_planes_are_read(text, normal, offset):
    clip = parse_clip(text)
    assert (clip.normal, clip.offset) == (normal, offset)
    assert np.array(clip.normal) @ clip.origin == pytest.approx(clip.offset)


@pytest.mark.parametrize("text", ["x", "x<", "w<1", "1,2<3", "0,0,0<1", "x<a", "x<nan,1"])
def test_planes_that_are_none_are_refused(text):
    with pytest.raises(PostError, match=r"expected a plane such as 'x<0\.5'"):
        parse_clip(text)


@pytest.mark.parametrize("text", ["x", "y", "z", "x-", "y-", "z-", "iso", "-1,-1,0.7", "0,0,2"])
def test_views_are_right_handed(text):
    view = find_view(text, 3)
    axes = np.stack([view.right, view.up, view.towards])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)


def test_front_view_has_x_to_the_right_and_z_up():
    view = find_view("y", 3)
    assert view.axes == (0, 2)
    np.testing.assert_array_equal(view.right, [1, 0, 0])
    np.testing.assert_array_equal(view.up, [0, 0, 1])
    assert find_view(None, 2).axes == (0, 1)
    assert find_view("iso", 3).axes is None


def test_body_lies_where_the_axes_say(bar):
    """The pixels that are not white span the deformed bar."""
    job = open_job(str(bar))
    layers = make_layers(Frame(job, job.output_of()), "elements", job.quantity("MAT"))
    view = find_view(None, 2)
    window = find_window([layer.data for layer in layers], view)
    renderer = Renderer(view, window, 1000)
    scale = make_scale(job.quantity("MAT"), [layers[0].values], None)
    image = renderer.draw(layers, job.quantity("MAT"), scale)
    renderer.close()
    ink = np.any(image < 250, axis=2)
    columns, lines = np.flatnonzero(ink.any(axis=0)), np.flatnonzero(ink.any(axis=1))
    height, width = ink.shape
    left, right = (window.left + window.width * i / width for i in (columns[0], columns[-1] + 1))
    top, bottom = (window.top - window.height * i / height for i in (lines[0], lines[-1] + 1))
    x = rows(bar.with_name("bar_mesh.vtkhdf"), "Points")
    pixel = window.width / width
    assert [left, right] == pytest.approx([x[:, 0].min(), x[:, 0].max()], abs=3 * pixel)
    assert [bottom, top] == pytest.approx([x[:, 1].min(), x[:, 1].max()], abs=3 * pixel)


def test_colours_of_pixels_are_those_of_the_scale(bar):
    """In 2-D the body is lit evenly: each face has the colour of its value."""
    job = open_job(str(bar))
    quantity = job.quantity("U1")
    layers = make_layers(Frame(job, job.output_of()), "elements", quantity)[:1]
    view = find_view(None, 2)
    window = find_window([layers[0].data], view)
    scale = make_scale(quantity, [layers[0].values], None)
    renderer = Renderer(view, window, 1000)
    image = renderer.draw(layers, quantity, scale)
    renderer.close()
    centres = np.asarray(layers[0].data.cell_centers().points)
    j = ((centres[:, 0] - window.left) / window.width * image.shape[1]).astype(int)
    i = ((window.top - centres[:, 1]) / window.height * image.shape[0]).astype(int)
    expected = 255.0 * scale.cmap(scale.norm(layers[0].values))[:, :3]
    assert np.abs(image[i, j] - np.minimum(1.03 * expected, 255.0)).max() < 4.0


def test_scale_goes_around_zero_only_for_both_signs(bar):
    quantity = open_job(str(bar)).quantity("S11")
    both = make_scale(quantity, [np.array([-1.0, np.nan, 3.0])], None)
    assert (both.low, both.high, both.extend) == (-3.0, 3.0, "neither")
    one = make_scale(quantity, [np.array([0.0, 2.0]), np.array([5.0])], None)
    assert (one.low, one.high) == (0.0, 5.0)
    assert one.cmap is not both.cmap
    given = make_scale(quantity, [np.array([0.0, 2.0])], (0.5, 1.5))
    assert (given.low, given.high, given.extend) == (0.5, 1.5, "both")
    constant = make_scale(quantity, [np.full(3, 7.0)], None)
    assert constant.low < 7.0 < constant.high


def test_default_is_the_last_output_and_others_can_be_chosen(post, drawn, bar, tmp_path):
    path = bar.with_name("bar.vtkhdf")
    for options, output in ([], -1), (["--increment", "2"], 2), (["--time", "0.25"], 1):
        assert post("picture", bar, *options, "-o", tmp_path / "p.png")[0] == 0
        np.testing.assert_allclose(drawn[-1][0][0].values, pressure(path, output), atol=1e-12)


def test_axes_and_bar_have_units(example):
    job = open_job(str(example("strip-footing", "fbar")))
    figure = picture.draw([job], PictureOptions(field="S22"))
    panel, bar_axes = figure.axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("x [m]", "y [m]")
    assert bar_axes.get_ylabel() == "Cauchy stress 22 [kPa]"
    assert panel.get_title() == "F-bar patch\nincrement 60, time 3"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--field", "TAU44"], "'bar.vtkhdf' has no field 'TAU44': there are ELEMENT, F11..F33,"),
        (["--as", "mesh", "--field", "S11"], "'bar_mesh.vtkhdf' has no field 'S11': there are "),
        (["--increment", "9"], "'bar' has no output at increment 9: there are 0, 1, 2, 3, 4"),
        (["--time", "9"], "'bar' has no output at time 9: there are 0, 0.25, 0.5, 0.75, 1"),
        (["--view", "up"], "--view: expected x, y, z, x-, y-, z-, iso or a direction x,y,z, found"),
        (["--clip", "x<-1"], "'bar', increment 4: the planes of --clip leave nothing"),
        (["--range", "2", "1"], "--range: expected MIN below MAX, found 2 and 1"),
        (["--warp", "0"], "--warp: expected a number above 0"),
        (["--zoom", "1e7"], "--zoom: expected a number above 0, at most 1e+06"),
        (["--clip", "x<inf"], "--clip: expected a plane such as 'x<0.5' or '1,1,0<2', found"),
        (
            ["--view", "0,0,0"],
            "--view: expected x, y, z, x-, y-, z-, iso or a direction x,y,z, found",
        ),
    ],
)
def test_wrong_options_are_told(post, bar, tmp_path, options, message):
    code, out, err = post("picture", bar, *options, "-o", tmp_path / "p.png")
    assert (code, out) == (2, "")
    assert err.startswith(f"tessera-post: error: {message}")
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_clip_is_a_plane_through_its_origin():
    clip = Clip((0.0, 3.0, 4.0), 10.0)
    assert np.array(clip.normal) @ clip.origin == pytest.approx(10.0)


def test_jobs_of_one_formulation_have_their_names_above(bar, single):
    jobs = [open_job(str(job)) for job in (bar, single)]
    figure = picture.draw(jobs, PictureOptions(field="S11"))
    titles = [axes.get_title().splitlines()[0] for axes in figure.axes[:2]]
    assert titles == [f"{job.folder.name}/bar, F-bar patch" for job in jobs]


def test_few_numbers_of_things_have_a_legend(bar):
    figure = picture.draw([open_job(str(bar))], PictureOptions(field="PATCH"))
    (legend,) = figure.legends
    assert legend.get_title().get_text() == "patch"
    assert [text.get_text() for text in legend.get_texts()] == [str(i) for i in range(1, 9)]


def test_titles_fit_above_narrow_panels(bar):
    job = open_job(str(bar))
    frames = [[Frame(job, i) for i in (0, 1, 2, 3, 4, 0, 1, 2, 3, 4)]]
    figure = picture.draw_frames(frames, PictureOptions(field="S11"))
    figure.canvas.draw()
    boxes = [axes.title.get_window_extent() for axes in figure.axes[:10]]
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))


def test_ticks_of_the_footing_do_not_overlap(example, monkeypatch, post):
    figures = []
    monkeypatch.setattr(curve, "save", lambda figure, _: figures.append(figure))
    assert post("curve", example("footing", "standard"))[0] == 0
    figures[0].canvas.draw()
    labels = [text for text in figures[0].axes[0].get_xticklabels() if text.get_text()]
    boxes = [text.get_window_extent() for text in labels]
    assert len(boxes) >= 3
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(boxes))


def test_label_of_the_bar_fits_on_a_flat_picture(bar):
    figure = picture.draw([open_job(str(bar))], PictureOptions(field="LE:min"))
    figure.canvas.draw()
    box = figure.axes[-1].yaxis.label.get_window_extent()
    assert 0.0 < box.y0 < box.y1 < figure.bbox.height
