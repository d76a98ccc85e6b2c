"""The programs that measure parts alone: stress update, machine, location of points."""

import subprocess
from pathlib import Path

from benching.running import environment

# Operations per material point, counted from mpm_stress_batch and mpm_eigen_batch: +, -, *, / and
# roots are one each; four sweeps of three rotations. The checked update does about the same, but
# for all 36 moduli.
OPERATIONS = (  # step, elastic, plastic
    ("trial b - 1 by push-forward", 138, 138),
    ("four sweeps of rotations", 642, 642),
    ("logarithms", 93, 93),
    ("trial deviator and yield condition", 18, 18),
    ("return and its moduli", 0, 25),
    ("principal stresses", 12, 12),
    ("dyads and stress", 48, 48),
    ("spatial moduli, 21 of them", 564, 564),
    ("sums over the element", 55, 55),
)
FLOPS = {
    "elastic": sum(elastic for _, elastic, _ in OPERATIONS),
    "plastic": sum(plastic for _, _, plastic in OPERATIONS),
}
# Bytes per material point. Read: place, element, material, b - 1, hardening, volume and J; read and
# written: a part of the arrays of an element with 11 points, increment and sums.
BYTES = 84 + 39
WAYS = ("batched", "pointwise")  # with moduli


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
