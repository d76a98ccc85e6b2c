"""Draws the footing's reaction over its settlement, standard and F-bar, and prints the limit loads.

    python post/footing_curves.py DIRECTORY

The directory holds footing_standard_history.csv and footing_fbar_history.csv; the picture goes
there, too.
"""

import csv
import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

JOBS = {
    "standard": ("Standard MPM", "#c44e52", "s"),
    "fbar": ("F-bar patch", "#2b6ca3", "o"),
}
BRACKET_KN = (0.53, 0.70)  # rigorous lower and upper bound of a quarter of the footing
STILL_RISING = 0.03  # a curve that gains more over its second half has no limit load


def read_history(path):
    """Settlement in mm and reaction in kN, both positive downward, from the unloaded state on."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    if not rows:
        raise ValueError(f"{path} holds no increment")
    settlement = [-1e3 * float(row["U3[FOOTING]"]) for row in rows]
    reaction = [-float(row["RF3[FOOTING]"]) for row in rows]
    if settlement[0] > 0.0:
        settlement, reaction = [0.0, *settlement], [0.0, *reaction]
    return np.array(settlement), np.array(reaction)


def rise_over_second_half(settlement, reaction):
    """Relative gain of the reaction from half of the final settlement to all of it."""
    half = np.interp(0.5 * settlement[-1], settlement, reaction)
    return reaction[-1] / half - 1.0


def draw(curves, path):
    figure, axes = plt.subplots(figsize=(7.0, 4.6), layout="constrained")
    axes.axhspan(*BRACKET_KN, color="0.88", label="bounds of limit analysis, 0.53-0.70 kN")
    for job, (settlement, reaction) in curves.items():
        label, color, marker = JOBS[job]
        axes.plot(settlement, reaction, color=color, marker=marker, markersize=4, label=label)
    axes.set(
        xlabel="settlement of the footing [mm]",
        ylabel="reaction of a quarter of the footing [kN]",
        title="Smooth rigid square footing on weightless clay",
    )
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left")
    figure.savefig(path, dpi=150)


def summary(label, settlement, reaction):
    rise = rise_over_second_half(settlement, reaction)
    if rise > STILL_RISING:
        limit = f"no limit load: {reaction[-1]:.3f} kN at {settlement[-1]:g} mm, still rising"
    else:
        limit = f"limit load {reaction.max():.3f} kN"
    return f"  {label:<13} {limit} ({rise:+.1%} over the last {settlement[-1] / 2:g} mm)"


def main():
    folder = Path(sys.argv[1])
    try:
        curves = {job: read_history(folder / f"footing_{job}_history.csv") for job in JOBS}
    except (OSError, ValueError, KeyError) as problem:
        sys.exit(f"demo: cannot read the histories: {problem}")
    picture = folder / "footing.png"
    draw(curves, picture)

    print("\nReaction of a quarter of the footing. Limit analysis bounds it by 0.53 and 0.70 kN;")
    print("a mesh as coarse as this one lies somewhat above.")
    for job, curve in curves.items():
        print(summary(JOBS[job][0], *curve))
    print(f"\n  picture  {picture}")
    print(f"  results  {folder / 'footing_standard.*'}, {folder / 'footing_fbar.*'}")


if __name__ == "__main__":
    main()
