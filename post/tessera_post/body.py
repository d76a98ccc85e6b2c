"""What is drawn of a job at one output: points, elements, mesh, outline, with values."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyvista as pv
from scipy.spatial import KDTree

from tessera_post.errors import PostError
from tessera_post.fields import Quantity
from tessera_post.job import Job

VALUE = "value"
RADIUS = "radius"
NEIGHBOURS = 8  # that tell the volume of a point
FEATURE_ANGLE = 30.0  # between faces whose common edge belongs to the outline [degrees]


@dataclass(frozen=True)
class Clip:
    """Keeps the side of a plane with normal . x <= offset."""

    normal: tuple[float, float, float]
    offset: float

    @property
    def origin(self) -> np.ndarray:
        """A point of the plane."""
        normal = np.array(self.normal)
        return normal * self.offset / (normal @ normal)


@dataclass(frozen=True)
class Layer:
    """A data set that is drawn in one way; its values, if it has any, are named VALUE."""

    kind: str  # spheres, surface or lines
    data: pv.DataSet

    @property
    def values(self) -> np.ndarray | None:
        """Values of points or of cells, whichever are there."""
        for data in (self.data.point_data, self.data.cell_data):
            if VALUE in data:
                return np.asarray(data[VALUE])
        return None


@dataclass(frozen=True)
class Frame:
    """An output of a job, seen with displacements enlarged by a factor and cut by planes."""

    job: Job
    output: int
    warp: float = 1.0
    clips: Sequence[Clip] = ()


def enlarged(now: np.ndarray, start: np.ndarray, warp: float) -> np.ndarray:
    """Positions whose way from the start is `warp` times as long."""
    return now if warp == 1.0 else start + warp * (now - start)


def point_positions(frame: Frame) -> np.ndarray:
    """(n, 3) where the points are drawn. Points are matched with those of output 0 by ID."""
    series = frame.job.points
    now = series.points(frame.output)
    if frame.warp == 1.0:
        return now
    if "ID" not in series.point_fields:
        raise PostError(f"'{series.path.name}' has no field 'ID': displacements unknown")
    first, here = series.field("ID", 0), series.field("ID", frame.output)
    order = np.argsort(first)
    return enlarged(now, series.points(0)[order[np.searchsorted(first[order], here)]], frame.warp)


def node_positions(frame: Frame) -> np.ndarray:
    """(n_node, 3) where the nodes of the mesh are drawn."""
    mesh = frame.job.need_mesh()
    output = mesh_output(frame)
    return enlarged(mesh.points(output), mesh.points(0), frame.warp)


def mesh_output(frame: Frame) -> int:
    """The output of the mesh at the time of that of the points."""
    mesh = frame.job.need_mesh()
    return int(np.abs(mesh.times - frame.job.points.times[frame.output]).argmin())


def spheres(frame: Frame, quantity: Quantity | None) -> Layer:
    """The material points, each as large as its volume."""
    x = point_positions(frame)
    cloud = pv.PolyData(x)
    cloud.point_data[RADIUS] = radii(frame, x)
    if quantity is not None:
        cloud.point_data[VALUE] = frame.job.values(quantity, frame.output)
    keep = np.ones(len(x), dtype=bool)
    for clip in frame.clips:
        keep &= x @ np.array(clip.normal) <= clip.offset
    if not keep.all():
        kept = pv.PolyData(x[keep])
        for name in cloud.point_data:
            kept.point_data[name] = cloud.point_data[name][keep]
        cloud = kept
    return Layer("spheres", cloud)


def radii(frame: Frame, x: np.ndarray) -> np.ndarray:
    """(n) half the side of a cube (square) of the volume of each point [length]. Without VOL the
    volume is that of the ball (circle) around its nearest neighbours, over their number."""
    job = frame.job
    if "VOL" in job.points.point_fields:
        return 0.5 * job.points.field("VOL", frame.output) ** (1.0 / job.n_dim)
    n_near = min(NEIGHBOURS, len(x) - 1)
    if n_near < 1:
        return np.ones(len(x))
    distance, _ = KDTree(x).query(x, k=[n_near + 1])
    ball = np.pi if job.n_dim == 2 else 4.0 / 3.0 * np.pi
    return 0.5 * (ball / n_near) ** (1.0 / job.n_dim) * distance[:, 0]


def host_elements(frame: Frame) -> np.ndarray:
    """(n) index of the element of each point from 0, -1 for a point that is frozen."""
    series = frame.job.points
    if "ELEMENT" in series.point_fields:
        return series.field("ELEMENT", frame.output).astype(int) - 1
    grid = grid_of_mesh(Frame(frame.job, frame.output))
    x = series.points(frame.output)
    inside = np.asarray(grid.find_containing_cell(x))
    outside = inside < 0
    if outside.any():
        inside[outside] = grid.find_closest_cell(x[outside])
    return inside


def grid_of_mesh(frame: Frame) -> pv.UnstructuredGrid:
    """The background mesh where it is drawn."""
    mesh = frame.job.need_mesh()
    cells = mesh.cells(mesh_output(frame))
    return pv.UnstructuredGrid({pv.CellType(mesh.cell_type): cells}, node_positions(frame))


def means_of_elements(frame: Frame, quantity: Quantity, n_elements: int) -> np.ndarray:
    """(n_elements) mean of the points of each element, NaN without points. Weighted by volume if
    the volumes are there; numbers of things are those of the first point."""
    job = frame.job
    host = host_elements(frame)
    held = host >= 0
    host, values = host[held], job.values(quantity, frame.output)[held]
    result = np.full(n_elements, np.nan)
    if quantity.is_category:
        result[host[::-1]] = values[::-1]
        return result
    weight = np.ones(len(host))
    if "VOL" in job.points.point_fields:
        weight = job.points.field("VOL", frame.output)[held]
    total = np.bincount(host, weight, n_elements)
    filled = total > 0.0
    result[filled] = np.bincount(host, weight * values, n_elements)[filled] / total[filled]
    return result


def elements(frame: Frame, quantity: Quantity | None) -> Layer:
    """The elements that hold points, coloured by the mean of their points."""
    grid = grid_of_mesh(frame)
    if quantity is None:
        filled = np.zeros(grid.n_cells, dtype=bool)
        host = host_elements(frame)
        filled[host[host >= 0]] = True
    else:
        values = means_of_elements(frame, quantity, grid.n_cells)
        filled = np.isfinite(values)
        grid.cell_data[VALUE] = values
    return surface_of(grid.extract_cells(np.flatnonzero(filled)), frame.clips)


def mesh_surface(frame: Frame, quantity: Quantity | None) -> Layer:
    """The background mesh, coloured by a field of its nodes or elements."""
    grid = grid_of_mesh(frame)
    if quantity is not None:
        mesh = frame.job.need_mesh()
        values = quantity.evaluate(mesh.field(quantity.field, mesh_output(frame)))
        data = grid.point_data if quantity.field in mesh.point_fields else grid.cell_data
        data[VALUE] = values
    return surface_of(grid, frame.clips)


def surface_of(grid: pv.UnstructuredGrid, clips: Sequence[Clip]) -> Layer:
    """The surface of what the planes leave of a grid."""
    for clip in clips:
        grid = grid.clip(normal=clip.normal, origin=clip.origin)
    return Layer("surface", grid.extract_surface(algorithm="dataset_surface"))


def outline(frame: Frame) -> Layer:
    """The edges of the background mesh as a whole."""
    surface = grid_of_mesh(frame).extract_surface(algorithm="dataset_surface")
    edges = surface.extract_feature_edges(
        feature_angle=FEATURE_ANGLE, manifold_edges=False, non_manifold_edges=False
    )
    for clip in frame.clips:
        edges = edges.clip(normal=clip.normal, origin=clip.origin)
    return Layer("lines", edges)


def make_layers(frame: Frame, what: str, quantity: Quantity | None) -> list[Layer]:
    """What is drawn: points, elements or mesh, and the outline of the mesh if it is there."""
    if what == "points":
        body = spheres(frame, quantity)
    elif what == "elements":
        body = elements(frame, quantity)
    else:
        body = mesh_surface(frame, quantity)
    layers = [body] if frame.job.mesh is None else [body, outline(frame)]
    if body.data.n_points == 0 and (frame.clips or len(layers) == 1):
        why = "the planes of --clip leave nothing" if frame.clips else "there are no points left"
        increment = frame.job.increments[frame.output]
        raise PostError(f"'{frame.job.name}', increment {increment}: {why}")
    return layers
