"""How far two sets of values are apart."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Place = Callable[[int, int], str]  # (row, component) -> where that is, in words


@dataclass(frozen=True)
class Tolerance:
    """A difference counts when it is larger than rtol times the scale plus atol."""

    rtol: float
    atol: float

    def __str__(self) -> str:
        return f"rtol {self.rtol:g}, atol {self.atol:g}"


class Difference:
    """Worst and rms difference of a history column or a field, built up part by part.

    scale      largest absolute value of either run, over everything that is compared
    worst      largest absolute difference; infinite where only one of the values is a number
    n_unequal  values that are not the same
    where      place of the worst one, in words
    """

    def __init__(self, kind: str, name: str, numbers_things: bool = False) -> None:
        self.kind = kind  # history, points or mesh
        self.name = name
        self.numbers_things = numbers_things  # the next number is as wrong as any other one
        self.scale = 0.0
        self.worst = 0.0
        self.where = ""
        self.n_unequal = 0
        self.n_values = 0
        self.is_identical = True
        self._sum_of_squares = 0.0

    def add(self, a: np.ndarray, b: np.ndarray, place: Place) -> None:
        """Takes in values, (rows) or (rows, components), the same shape in both."""
        self.n_values += a.size
        self.scale = max(self.scale, largest(a), largest(b))
        if a.size == 0 or have_same_bits(a, b):
            return
        self.is_identical = False
        apart = distance(a, b)
        apart = apart[:, None] if apart.ndim == 1 else apart
        self.n_unequal += int(np.count_nonzero(apart))
        with np.errstate(over="ignore"):
            self._sum_of_squares += float(np.sum(apart**2))
        row, component = np.unravel_index(int(apart.argmax()), apart.shape)
        if apart[row, component] > self.worst:
            self.worst = float(apart[row, component])
            self.where = place(int(row), int(component))

    def add_unmatched(self, count: int, where: str) -> None:
        """Takes in things that only one of the runs has."""
        if count == 0:
            return
        self.n_values += count
        self.n_unequal += count
        self.is_identical = False
        self.where = self.where or where

    @property
    def rms(self) -> float:
        """Root of the mean square difference."""
        return float(np.sqrt(self._sum_of_squares / max(self.n_values, 1)))

    @property
    def relative(self) -> float:
        """Worst difference over the scale; of numbers of things the share that is unequal."""
        if self.numbers_things:
            return self.n_unequal / max(self.n_values, 1)
        if self.worst == 0.0:
            return 0.0
        return self.worst / self.scale if self.scale > 0.0 else np.inf

    def exceeds(self, tolerance: Tolerance) -> bool:
        """Whether the two differ; numbers of things must be equal."""
        if self.numbers_things:
            return self.n_unequal > 0
        return self.worst > tolerance.rtol * self.scale + tolerance.atol


def have_same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether the values are the same to the last bit, NaN and signs of zeros included."""
    return a.dtype == b.dtype and a.tobytes() == b.tobytes()


def largest(values: np.ndarray) -> float:
    """Largest absolute value; NaN and infinity do not count."""
    return float(np.abs(values[np.isfinite(values)]).max(initial=0))


def distance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Absolute differences: 0 where both are NaN, infinite where only one is a number."""
    a, b = a.astype(float), b.astype(float)
    with np.errstate(invalid="ignore", over="ignore"):
        apart = np.abs(a - b)
    apart[(a == b) | (np.isnan(a) & np.isnan(b))] = 0.0
    apart[np.isnan(apart)] = np.inf
    return apart
