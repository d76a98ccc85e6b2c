"""How pictures look: fonts, colours that are safe for the colour-blind, colour scales."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from cmcrameri import cm
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure

from tessera_post.fields import Quantity

COLOR_OF = {"standard MPM": "#d55e00", "F-bar patch": "#0072b2"}
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
GOLDEN = 0.618033988749895
CONSTANT = 1e-8  # a field that varies less, over its size, shows round-off only
SIGNED = 0.02  # share of the range that must lie on either side of 0 for a scale around 0

plt.rcParams.update(
    {
        "font.size": 11.0,
        "axes.titlesize": 12.0,
        "axes.grid": True,
        "grid.alpha": 0.3,
        "legend.framealpha": 0.9,
        "text.parse_math": False,  # a name with dollar signs is a name
        "savefig.dpi": 150,
        "figure.constrained_layout.use": True,
    }
)


def colors_of(labels: Sequence[str]) -> list[str]:
    """One colour per curve: that of its formulation, unless two curves would get the same."""
    wanted = [COLOR_OF.get(label.removesuffix(" (unfinished)")) for label in labels]
    if None in wanted or len(set(wanted)) < len(wanted):
        return [COLORS[i % len(COLORS)] for i in range(len(labels))]
    return [color for color in wanted if color]


def shown(label: str) -> str:
    """A label for a legend: matplotlib leaves out those that begin with an underscore."""
    return f" {label}" if label.startswith("_") else label


@dataclass(frozen=True)
class ColorScale:
    """From values to colours, one for all panels of a picture."""

    low: float
    high: float
    cmap: Colormap
    extend: str = "neither"  # where values lie outside: neither, min, max or both

    @property
    def norm(self) -> Normalize:
        """For matplotlib."""
        return Normalize(self.low, self.high)


def category_shades(values: np.ndarray) -> np.ndarray:
    """Numbers of things as shades between 0 and 1, neighbouring numbers far apart."""
    return np.mod(np.asarray(values, dtype=float) * GOLDEN, 1.0)


def make_scale(
    quantity: Quantity, values: Sequence[np.ndarray], limits: tuple[float, float] | None
) -> ColorScale:
    """The scale of all values; around 0 when they have both signs. NaN does not count."""
    if quantity.is_category:
        return ColorScale(0.0, 1.0, cm.batlow)
    found = [v[np.isfinite(v)] for v in values]
    found = [v for v in found if len(v)]
    least = min((float(v.min()) for v in found), default=0.0)
    most = max((float(v.max()) for v in found), default=1.0)
    low, high = limits or (least, most)
    cmap = cm.batlow
    if low < 0.0 < high and min(-low, high) > SIGNED * (high - low):
        cmap = cm.vik
        if limits is None:
            high = max(-low, high)
            low = -high
    if high - low <= CONSTANT * max(abs(low), abs(high)):
        width = 1e-3 * max(abs(low), abs(high)) or 1.0
        low, high = low - width, high + width
    below, above = least < low, most > high
    extend = {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]
    return ColorScale(low, high, cmap, extend)


def save(figure: Figure, path: Path) -> None:
    """Writes a picture and frees it. OSError when the file cannot be written."""
    figure.savefig(path)
    plt.close(figure)
