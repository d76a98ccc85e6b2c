"""From layers to images: camera, lights, off-screen rendering. All text is matplotlib's."""

import os
from collections.abc import Sequence
from ctypes.util import find_library
from dataclasses import dataclass

import numpy as np

if not os.environ.get("DISPLAY"):  # VTK would look for a display first, and complain
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")

import pyvista as pv
from vtkmodules.vtkCommonCore import vtkLogger

from tessera_post.body import RADIUS, Layer
from tessera_post.errors import PostError
from tessera_post.fields import Quantity
from tessera_post.style import ColorScale, category_shades

vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)

VIEWS = {  # direction from the body to the camera, and what is up
    "x": ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "y": ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    "z": ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    "x-": ((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
    "y-": ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "z-": ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0)),
    "iso": ((1.0, -1.5, 0.9), (0.0, 0.0, 1.0)),
}
STEEP = 1e-6  # a direction nearer to the vertical than this is seen with y upwards
MARGIN = 0.03  # of the larger side of the body, around it
FOOT = 0.13  # of the larger side, below an aslant view: for the arrows of the axes
SMALLEST_SIDE = 0.25  # of an image, over its larger side
PLAIN = np.array([143, 163, 184], dtype=np.uint8)  # a body without a field
MISSING = np.array([190, 190, 190], dtype=np.uint8)  # NaN
MOST_EDGED = 20000  # faces; more edges would be a grey surface
SHADER = """//VTK::Color::Impl
float dist = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);
if (dist > 1.0) discard;
float shade = {dark} + (1.0 - {dark}) * sqrt(1.0 - dist);
ambientColor *= shade;
diffuseColor *= shade;
"""
DARKEST = {2: 1.0, 3: 0.5}  # rim of a point over its middle: discs in 2-D, spheres in 3-D
SOFTWARE_WINDOW = "vtkOSOpenGLRenderWindow"


@dataclass(frozen=True)
class View:
    """Parallel projection; right, up and towards (from body to camera) are orthonormal."""

    right: np.ndarray
    up: np.ndarray
    towards: np.ndarray

    @property
    def axes(self) -> tuple[int, int] | None:
        """Coordinates that run to the right and up; None when the view is aslant."""
        plane = [np.flatnonzero(np.abs(vector) > 1.0 - 1e-9) for vector in (self.right, self.up)]
        return (int(plane[0][0]), int(plane[1][0])) if all(len(p) for p in plane) else None


@dataclass(frozen=True)
class Window:
    """The part of the plane of projection that an image shows [length]."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def width(self) -> float:
        """To the right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Upwards."""
        return self.top - self.bottom

    def zoomed(self, factor: float) -> "Window":
        """A window of 1/factor of the size with the same centre."""
        x, y = 0.5 * (self.left + self.right), 0.5 * (self.bottom + self.top)
        across, upwards = 0.5 * self.width / factor, 0.5 * self.height / factor
        return Window(x - across, x + across, y - upwards, y + upwards)


def find_view(text: str | None, n_dim: int) -> View:
    """A preset, or a direction x,y,z from the body to the camera; 2-D jobs are seen from above."""
    if text is None:
        text = "z" if n_dim == 2 else "iso"
    if text in VIEWS:
        return make_view(*VIEWS[text])
    try:
        direction = tuple(float(number) for number in text.split(","))
    except ValueError:
        direction = ()
    if len(direction) != 3 or not np.isfinite(direction).all() or not any(direction):
        raise PostError(f"--view: expected {', '.join(VIEWS)} or a direction x,y,z, found '{text}'")
    largest = max(abs(number) for number in direction)
    direction = tuple(number / largest for number in direction)
    upright = max(abs(direction[0]), abs(direction[1])) > STEEP
    up = (0.0, 0.0, 1.0) if upright else (0.0, 1.0, 0.0)
    return make_view(direction, up)


def make_view(direction: Sequence[float], up: Sequence[float]) -> View:
    """A view from a direction; `up` need not be at right angles to it."""
    towards = np.array(direction) / np.linalg.norm(direction)
    right = np.cross(up, towards)
    right /= np.linalg.norm(right)
    return View(right, np.cross(towards, right), towards)


def find_window(bodies: Sequence[pv.DataSet], view: View) -> Window:
    """The window around all bodies."""
    seen = [np.asarray(body.points) @ np.stack([view.right, view.up], axis=1) for body in bodies]
    low = np.min([s.min(axis=0) for s in seen], axis=0)
    high = np.max([s.max(axis=0) for s in seen], axis=0)
    side = max(float((high - low).max()), 1e-300)
    half = np.maximum(0.5 * (high - low) + MARGIN * side, 0.5 * SMALLEST_SIDE * side)
    centre = 0.5 * (low + high)
    (left, bottom), (right, top) = centre - half, centre + half
    if view.axes is None:
        bottom -= FOOT * side
    return Window(left, right, bottom, top)


def colors_of_layer(
    layer: Layer, quantity: Quantity | None, scale: ColorScale | None
) -> np.ndarray | None:
    """(n, 3) colours from 0 to 255; None for a layer without values."""
    values = layer.values
    if values is None or scale is None or quantity is None:
        return None
    shades = category_shades(values) if quantity.is_category else scale.norm(values)
    colors = (scale.cmap(np.clip(np.nan_to_num(shades), 0.0, 1.0))[:, :3] * 255.0).round()
    colors[~np.isfinite(values)] = MISSING
    return colors.astype(np.uint8)


def check_window(plotter: pv.Plotter) -> None:
    """Without a library that draws off-screen VTK takes a window that crashes when it draws."""
    if plotter.render_window.GetClassName() != SOFTWARE_WINDOW or find_library("OSMesa"):
        return
    raise PostError(
        "cannot draw in 3-D: expected a display, or the library EGL or OSMesa (Debian: apt-get"
        " install libegl1 libgl1-mesa-dri)"
    )


class Renderer:
    """Draws layers into images of one size; used again for frame after frame."""

    def __init__(self, view: View, window: Window, pixels: int) -> None:
        scale = pixels / max(window.width, window.height)
        size = [2 * round(0.5 * scale * side) for side in (window.width, window.height)]
        self._plotter = pv.Plotter(off_screen=True, window_size=size, lighting="none")
        check_window(self._plotter)
        self._plotter.render_window.SetMultiSamples(0)  # the picture is drawn larger than it is
        self._plotter.set_background("white")
        self._plotter.add_light(pv.Light(light_type="headlight", intensity=1.0))
        self._view, self._window = view, window

    def draw(
        self, layers: Sequence[Layer], quantity: Quantity | None, scale: ColorScale | None
    ) -> np.ndarray:
        """(height, width, 3) image of the layers."""
        plotter = self._plotter
        plotter.clear_actors()
        for layer in layers:
            add_layer(plotter, layer, colors_of_layer(layer, quantity, scale))
        self._aim()
        return np.asarray(plotter.screenshot(return_img=True))

    def _aim(self) -> None:
        view, window = self._view, self._window
        across = 0.5 * (window.left + window.right) * view.right
        focus = across + 0.5 * (window.bottom + window.top) * view.up
        bounds = np.array(self._plotter.bounds).reshape(3, 2)
        middle = bounds.mean(axis=1)
        focus = focus + (middle @ view.towards) * view.towards
        distance = 2.0 * float(np.linalg.norm(np.ptp(bounds, axis=1))) + window.height
        camera = self._plotter.camera
        camera.parallel_projection = True
        camera.focal_point = tuple(focus)
        camera.position = tuple(focus + distance * view.towards)
        camera.up = tuple(view.up)
        camera.parallel_scale = 0.5 * window.height
        self._plotter.renderer.ResetCameraClippingRange()

    def close(self) -> None:
        """Frees the off-screen window."""
        self._plotter.close()


def add_layer(plotter: pv.Plotter, layer: Layer, colors: np.ndarray | None) -> None:
    """Adds a layer to the scene."""
    data = layer.data
    if data.n_points == 0:
        return
    if layer.kind == "lines":
        plotter.add_mesh(data, color="black", line_width=1.5, lighting=False)
        return
    shown = data.copy(deep=False)
    on_points = colors is None or len(colors) == data.n_points
    count = data.n_points if on_points else data.n_cells
    rgb = np.broadcast_to(PLAIN, (count, 3)) if colors is None else colors
    (shown.point_data if on_points else shown.cell_data)["rgb"] = np.ascontiguousarray(rgb)
    light = {"ambient": 0.65, "diffuse": 0.38, "specular": 0.0}
    common = {"scalars": "rgb", "rgb": True, "show_scalar_bar": False, **light}
    if layer.kind == "spheres":
        actor = plotter.add_mesh(
            shown, style="points_gaussian", render_points_as_spheres=True, emissive=False, **common
        )
        actor.mapper.SetScaleArray(RADIUS)
        actor.mapper.SetScaleFactor(1.0)
        n_dim = 2 if data.bounds.z_min == data.bounds.z_max else 3
        actor.mapper.SetSplatShaderCode(SHADER.format(dark=DARKEST[n_dim]))
        return
    edges = data.n_cells <= MOST_EDGED
    plotter.add_mesh(shown, show_edges=edges, edge_color="#404040", edge_opacity=0.5, **common)
