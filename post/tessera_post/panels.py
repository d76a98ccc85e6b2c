"""Images side by side in one figure, with one colour bar, titles, axes and units."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from tessera_post.fields import Quantity
from tessera_post.scene import View, Window
from tessera_post.style import ColorScale, category_shades, plt
from tessera_post.units import Units

LARGEST = 5.6  # side of a panel [inch]
WIDEST = 13.0  # all panels of a row [inch]
NARROWEST = 1.7  # panel [inch]
LETTER = 0.0076  # width of a letter, over the size of the font [inch per point]
BAR_LETTER = 0.088  # letter beside the colour bar [inch]
TITLE_SIZES = (7.0, 11.0)  # smallest and largest font [point]
MOST_CATEGORIES = 12  # in a legend
AXIS_NAMES = "xyz"
ARROW = 0.07  # length of the arrows that show the axes, over the larger side of a panel


@dataclass(frozen=True)
class Panel:
    """One image and what stands above it."""

    title: str
    image: np.ndarray  # (height, width, 3)


@dataclass(frozen=True)
class Sheet:
    """What all panels of a figure share."""

    view: View
    window: Window
    units: Units
    quantity: Quantity | None
    scale: ColorScale | None
    title: str = ""
    categories: tuple[int, ...] = ()  # numbers of things that the panels show

    @property
    def has_bar(self) -> bool:
        """Numbers of things have no scale."""
        return self.scale is not None and not (self.quantity and self.quantity.is_category)


def panel_size(window: Window, n_columns: int) -> tuple[float, float]:
    """Width and height of a panel [inch]."""
    width = max(min(LARGEST, WIDEST / n_columns), NARROWEST)
    height = width * window.height / window.width
    if height > LARGEST:
        width, height = width * LARGEST / height, LARGEST
    return width, height


def pixels_of(window: Window, n_columns: int) -> int:
    """Pixels of the larger side of an image: somewhat finer than the picture."""
    return max(round(max(panel_size(window, n_columns)) * 220), 200)


def compose(rows: Sequence[Sequence[Panel]], sheet: Sheet) -> Figure:
    """The figure of rows of panels."""
    n_rows, n_columns = len(rows), max(len(row) for row in rows)
    width, height = panel_size(sheet.window, n_columns)
    plane = sheet.view.axes is not None
    beside, above = (0.75, 1.05) if plane else (0.15, 0.6)
    bar = 1.15 if sheet.has_bar or has_legend(sheet) else 0.1
    total = n_columns * (width + 0.15) + beside + bar
    tall = n_rows * (height + above) + (0.35 if sheet.title else 0.0)
    size = max(total, 4.0), max(tall, BAR_LETTER * len(bar_label(sheet)) + 0.4)
    figure, grid = plt.subplots(
        n_rows, n_columns, figsize=size, squeeze=False, sharex=True, sharey=True
    )
    for i, row in enumerate(rows):
        for j in range(n_columns):
            axes = grid[i, j]
            if j >= len(row):
                axes.set_axis_off()
                continue
            show(axes, row[j], sheet, width)
            if plane:
                label_axes(axes, sheet, left=j == 0, bottom=i == n_rows - 1)
    if has_legend(sheet):
        add_legend(figure, sheet)
    if sheet.has_bar:
        add_bar(figure, grid, sheet, n_rows * height)
    if sheet.title:
        figure.suptitle(sheet.title)
    figure.get_layout_engine().set(h_pad=0.08, w_pad=0.06)
    figure.draw_without_rendering()  # titles of images of fixed shape fit at the second layout only
    return figure


def title_size(title: str, width: float) -> float:
    """A font in which the title is no wider than a panel of that width [inch]."""
    letters = max(len(line) for line in title.splitlines())
    smallest, largest = TITLE_SIZES
    return max(smallest, min(largest, (width + 0.1) / (LETTER * letters)))


def has_legend(sheet: Sheet) -> bool:
    """Few numbers of things are named."""
    return 0 < len(sheet.categories) <= MOST_CATEGORIES


def add_legend(figure: Figure, sheet: Sheet) -> None:
    """The colours of numbers of things."""
    assert sheet.scale is not None
    assert sheet.quantity is not None
    colors = sheet.scale.cmap(category_shades(np.array(sheet.categories)))
    patches = [Patch(color=color) for color in colors]
    figure.legend(
        patches,
        [str(number) for number in sheet.categories],
        title=sheet.quantity.label,
        loc="outside center right",
    )


def show(axes: Axes, panel: Panel, sheet: Sheet, width: float) -> None:
    """One image; its coordinates are those of the plane of projection."""
    window = sheet.window
    axes.grid(visible=False)
    axes.imshow(
        panel.image,
        extent=(window.left, window.right, window.bottom, window.top),
        interpolation="antialiased",
        aspect="equal",
    )
    axes.set_title(panel.title, fontsize=title_size(panel.title, width))
    if sheet.view.axes is None:
        axes.set(xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
        draw_triad(axes, sheet)
    elif sheet.view.right.sum() < 0.0:
        axes.xaxis.set_major_formatter(lambda value, _: f"{-value + 0.0:g}")


def label_axes(axes: Axes, sheet: Sheet, left: bool, bottom: bool) -> None:
    """Names and units of the coordinates, at the outer panels only."""
    plane = sheet.view.axes
    assert plane is not None
    across, upwards = (sheet.units.axis(AXIS_NAMES[i], "length") for i in plane)
    axes.locator_params(axis="x", nbins=5 if sheet.window.width > 0.5 * sheet.window.height else 3)
    if left:
        axes.set_ylabel(upwards)
    if bottom:
        axes.set_xlabel(across)


def draw_triad(axes: Axes, sheet: Sheet) -> None:
    """Arrows of the axes in the lower left corner, and a bar that shows the scale."""
    window, view = sheet.window, sheet.view
    length = ARROW * max(window.width, window.height)
    tips = length * np.stack([view.right, view.up], axis=1)
    origin = np.array([window.left, window.bottom]) + 0.4 * length - tips.min(axis=0, initial=0.0)
    for tip, name in zip(tips, AXIS_NAMES):
        if np.linalg.norm(tip) < 0.15 * length:
            continue
        style = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", xy=origin + tip, xytext=origin, arrowprops=style)
        place = origin + 1.28 * tip
        axes.text(place[0], place[1], name, ha="center", va="center", fontsize=10)
    draw_ruler(axes, sheet)


def draw_ruler(axes: Axes, sheet: Sheet) -> None:
    """A bar of a round length in the lower right corner: aslant views have no axes."""
    window = sheet.window
    raw = 0.25 * window.width
    step = 10.0 ** np.floor(np.log10(raw))
    length = step * max(factor for factor in (1.0, 2.0, 5.0) if factor * step <= raw)
    right = window.right - 0.03 * window.width
    y = window.bottom + 0.015 * window.height
    axes.plot([right - length, right], [y, y], color="black", linewidth=2.5)
    axes.text(
        right - 0.5 * length,
        y + 0.012 * window.height,
        f"{length:g} {sheet.units.of('length')}",
        ha="center",
        va="bottom",
        fontsize=10,
    )


def bar_label(sheet: Sheet) -> str:
    """What stands beside the colour bar."""
    if not sheet.has_bar or sheet.quantity is None:
        return ""
    return sheet.units.axis(sheet.quantity.label, sheet.quantity.dimension)


def add_bar(figure: Figure, grid: np.ndarray, sheet: Sheet, height: float) -> None:
    """The colour bar of all panels."""
    scale, quantity = sheet.scale, sheet.quantity
    assert scale is not None
    assert quantity is not None
    bar = figure.colorbar(
        ScalarMappable(scale.norm, scale.cmap),
        ax=grid.ravel().tolist(),
        label=bar_label(sheet),
        extend=scale.extend,
        shrink=min(0.85, 4.5 / height),
        aspect=25,
        pad=0.02,
    )
    bar.ax.grid(visible=False)
