"""Draws the pressure on a symmetry plane of the footing, standard beside F-bar.

    python post/footing_pressure.py DIRECTORY [PICTURE]

The directory holds footing_standard.vtkhdf, footing_fbar.vtkhdf and their _mesh files; each
element has one colour, the mean pressure of its material points at the end of the run. The two
scales differ.
"""

import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

METHODS = {"standard": "Standard MPM", "fbar": "F-bar patch"}
WINDOW = 1.6  # part of the plane that is shown, beside and below the footing [m]
HALF_WIDTH = 0.5  # of the footing [m]
FACES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


def last_step(grid, dataset, offsets):
    """Rows of a dataset that belong to the last step."""
    return grid[dataset][grid[offsets][-1] :]


def element_pressures(path):
    """Mean pressure of the points of each element, as {element number from 1: pressure}."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        stress, element = (
            last_step(grid, f"PointData/{name}", f"Steps/PointDataOffsets/{name}")
            for name in ("S", "ELEMENT")
        )
    keep = element > 0
    pressure = -stress[keep, :3].mean(axis=1)
    numbers, group = np.unique(element[keep], return_inverse=True)
    return dict(zip(numbers, np.bincount(group, pressure) / np.bincount(group)))


def plane_faces(path):
    """Faces of elements on the plane x = 0: corner coordinates (n, 3, 2), elements from 1."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        x = last_step(grid, "Points", "Steps/PointOffsets")
        cells = grid["Connectivity"][()].reshape(-1, 4)
    on_plane = np.abs(x[:, 0]) < 1e-9
    on_corner = on_plane[cells]
    element, opposite = np.nonzero((on_corner.sum(axis=1) == 3)[:, None] & ~on_corner)
    nodes = np.take_along_axis(cells[element], FACES[opposite], axis=1)
    return x[nodes][:, :, 1:], element + 1


def draw(axis, folder, method, title):
    """One panel with its own colour scale; answers the image for the colour bar."""
    pressure = element_pressures(folder / f"footing_{method}.vtkhdf")
    faces, element = plane_faces(folder / f"footing_{method}_mesh.vtkhdf")
    corners = faces.reshape(-1, 2)
    values = np.array([pressure.get(number, np.nan) for number in element])
    limit = np.nanpercentile(np.abs(values), 99)
    image = axis.tripcolor(
        corners[:, 0],
        corners[:, 1] - corners[:, 1].max(),
        np.arange(len(corners)).reshape(-1, 3),
        facecolors=values,
        cmap="RdBu_r",
        vmin=-limit,
        vmax=limit,
        edgecolors="0.4",
        linewidth=0.2,
    )
    footing = {"color": "black", "linewidth": 5, "solid_capstyle": "butt", "clip_on": False}
    axis.plot([0.0, HALF_WIDTH], [0.02, 0.02], **footing)
    axis.set(
        title=f"{title}: {np.nanmin(values):.1f} to {np.nanmax(values):.1f} kPa",
        xlabel="distance from the axis [m]",
        xlim=(0.0, WINDOW),
        ylim=(-WINDOW, 0.05),
        aspect="equal",
    )
    return image


def main():
    folder = Path(sys.argv[1])
    picture = Path(sys.argv[2]) if len(sys.argv) > 2 else folder / "footing_pressure.png"
    figure, axes = plt.subplots(1, 2, figsize=(10.0, 4.4), layout="constrained", sharey=True)
    for axis, (method, title) in zip(axes, METHODS.items()):
        image = draw(axis, folder, method, title)
        figure.colorbar(image, ax=axis, label="pressure [kPa]", shrink=0.9)
    axes[0].set_ylabel("depth [m]")
    figure.savefig(picture, dpi=150)
    print(f"picture {picture}")


if __name__ == "__main__":
    main()
