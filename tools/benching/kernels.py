"""The programs that measure parts alone: stress update, machine, location of points."""

import subprocess
from pathlib import Path

from benching.running import environment

# Operations per material point, counted from the source for three dimensions: +, -, *, / and roots
# are one each, ln, exp and the functions of an angle 20. Symmetric moduli have 21 entries. The
# checked update finds eigenvectors by rotations and forms all 36 moduli: it does more than that.
OPERATIONS = (  # step, elastic, plastic
    ("trial b - 1 by push-forward", 138, 138),
    ("eigenvalues and directions, in closed form", 212, 212),
    ("three logarithms", 63, 63),
    ("trial deviator and yield condition", 19, 19),
    ("return, consistent principal moduli", 0, 51),
    ("principal stresses", 9, 9),
    ("dyads of the directions", 63, 63),
    ("strain and stress, with flow b - 1 (three exponentials)", 60, 153),
    ("spatial moduli", 450, 450),
    ("Cauchy stress and sums over the element", 63, 63),
)
FLOPS = {
    "elastic": sum(elastic for _, elastic, _ in OPERATIONS),
    "plastic": sum(plastic for _, _, plastic in OPERATIONS),
}
# Bytes per material point: number, material, b - 1, hardening, volume and J read; strain, b - 1,
# hardening, J and stress written; the arrays of an element (increment, sums), over 11 points.
BYTES = 80 + 160 + 40
WAYS = ("blocked", "pointwise")


def run_lines(program: Path, n_threads: int) -> list[list[str]]:
    """The words of the lines that a program writes."""
    run = subprocess.run(
        [program], env=environment(n_threads), stdout=subprocess.PIPE, text=True, check=True
    )
    return [line.split() for line in run.stdout.splitlines()]


def measure_kernel(program: Path, n_threads: int) -> dict:
    """Peak, triad, and for each kind and way the microseconds of CPU and wall time per point."""
    found: dict = {"lines": [], "difference": 0.0}
    for words in run_lines(program, n_threads):
        if words[0] == "kernel":
            kind, way, points, flowing, cpu, wall = words[1:]
            line = {"kind": kind, "way": way, "points": int(points), "plastic": int(flowing)}
            found["lines"].append(line | {"cpu": float(cpu), "wall": float(wall)})
        elif words[0] == "difference":
            found["difference"] = max(found["difference"], float(words[3]))
        else:
            found[words[0]] = float(words[1])
    return found


def measure_location(program: Path) -> dict:
    """The figures of bench_location."""
    return {name: float(value) for name, value in run_lines(program, 1)}
