"""Figure of Cook's membrane, and the job with ghost penalty beside that without."""

from tessera_post.style import COLORS, MARKERS, plt, save
from verification.siblings import ratio_to_sibling

__all__ = ["draw_tip", "ratio_to_sibling"]

CELLS = (2, 4, 8, 16, 32)
CURVES = (("fbar", "F-bar patch"), ("standard", "standard"))
RATIOS = (("03", "0.3", 7.885), ("04999", "0.4999", 6.945))  # name, nu, reference [mm]


def draw_tip(jobs, path):
    """Deflection of the tip over the cells per side, one curve per formulation and ratio."""
    figure, axes = plt.subplots(figsize=(7.0, 4.6))
    for i, (formulation, label) in enumerate(CURVES):
        for k, (name, ratio, _) in enumerate(RATIOS):
            tips = [jobs[f"{formulation}-{name}-{n:02d}"].history["U2[TIP]"][-1] for n in CELLS]
            style = {"color": COLORS[i], "marker": MARKERS[k], "linestyle": ("-", "--")[k]}
            axes.semilogx(CELLS, tips, label=f"{label}, nu = {ratio}", **style)
    for k, (_, ratio, reference) in enumerate(RATIOS):
        style = {"color": "0.5", "linestyle": ("-", "--")[k], "linewidth": 1.0}
        axes.axhline(reference, label=f"reference, nu = {ratio}", zorder=0, **style)
    axes.set(xlabel="cells per side", ylabel="deflection of the tip [mm]", ylim=(3.0, 8.3))
    axes.set_xticks(CELLS, [str(n) for n in CELLS])
    axes.set_xticks([], minor=True)
    figure.legend(loc="outside upper center", ncols=2)
    save(figure, path)
