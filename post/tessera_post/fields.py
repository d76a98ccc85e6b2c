"""Scalars to draw: `S33`, `mises`, `TAU:pressure`, `PEEQ`, ... from the fields of the results."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from tessera_post.errors import PostError, one_of

TENSORS = {
    "S": ("Cauchy stress", "stress"),
    "TAU": ("Kirchhoff stress", "stress"),
    "LE": ("elastic log strain", "number"),
}
VECTORS = {
    "U": ("displacement", "length"),
    "U_INC": ("displacement of the increment", "length"),
    "RF": ("reaction", "force"),
}
SCALARS = {
    "PEEQ": ("accumulated plastic strain", "number"),
    "J": ("volume ratio J", "number"),
    "JBAR": ("volume ratio J-bar", "number"),
    "JPATCH": ("volume ratio of the patch", "number"),
    "VOL": ("volume", "volume"),
    "NPOINTS": ("material points", "number"),
    "ACTIVE": ("active", "number"),
    "MAT": ("material", "number"),
    "PATCH": ("patch", "number"),
    "ELEMENT": ("element", "number"),
    "ID": ("point", "number"),
}
CATEGORIES = ("MAT", "PATCH", "ELEMENT", "ID", "ACTIVE")
COMPONENTS = {"11": 0, "22": 1, "33": 2, "12": 3, "23": 4, "13": 5, "21": 3, "32": 4, "31": 5}
GRADIENT = {f"{i}{j}": 3 * (i - 1) + j - 1 for i in (1, 2, 3) for j in (1, 2, 3)}
SHEARS_TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])

Evaluate = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Quantity:
    """A scalar of points, nodes or elements, made from one field of the file."""

    name: str  # as a user writes it, such as TAU22 or S:mises
    field: str  # dataset that it is made from
    label: str  # in words
    dimension: str  # stress, length, force, volume or number
    evaluate: Evaluate  # (rows, components) or (rows) -> (rows)

    @property
    def is_category(self) -> bool:
        """Whether the values are numbers of things, without an order."""
        return self.name in CATEGORIES


def norm(tensor: np.ndarray) -> np.ndarray:
    """(rows) Frobenius norm of symmetric tensors (rows, 6) in the order 11, 22, 33, 12, 23, 13."""
    return np.sqrt(tensor**2 @ SHEARS_TWICE)


def pressure(tensor: np.ndarray) -> np.ndarray:
    """(rows) mean compression, positive under pressure."""
    return -tensor[:, :3].mean(axis=1)


def mises(tensor: np.ndarray) -> np.ndarray:
    """(rows) sqrt(3 J2)."""
    deviator = tensor.copy()
    deviator[:, :3] += pressure(tensor)[:, None]
    return np.sqrt(1.5 * (deviator**2 @ SHEARS_TWICE))


def principal(tensor: np.ndarray) -> np.ndarray:
    """(rows, 3) principal values, ascending."""
    full = tensor[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    return np.linalg.eigvalsh(full)


INVARIANTS: dict[str, tuple[str, Evaluate]] = {
    "NORM": ("norm of {}", norm),
    "PRESSURE": ("pressure of {}", pressure),
    "MISES": ("von Mises value of {}", mises),
    "MAX": ("largest principal {}", lambda t: principal(t)[:, 2]),
    "MIN": ("smallest principal {}", lambda t: principal(t)[:, 0]),
}
SHORT = {  # without a tensor they are of the Cauchy stress
    "PRESSURE": "pressure",
    "MISES": "von Mises stress",
    "NORM": "norm of Cauchy stress",
    "MAX": "largest principal stress",
    "MIN": "smallest principal stress",
}


def column(index: int) -> Evaluate:
    """The evaluation that takes one component."""
    return lambda values: values[:, index]


def find_quantity(text: str, available: Iterable[str], where: str) -> Quantity:
    """The quantity that a user means, made from one of the available fields.

    Raises PostError with the names that there are when it is unknown or not in the file.
    """
    fields = list(available)
    quantity = parse(text)
    if quantity is None or quantity.field not in fields:
        names = one_of(quantities_of(fields), most=60)
        raise PostError(f"{where} has no field '{text}': there are {names}")
    return quantity


def parse(text: str) -> Quantity | None:
    """The quantity of a name, whatever a file holds; None if there is no such name."""
    name = re.sub(r"[\s:]+", ":", text.strip().upper())
    if name in SHORT:
        return Quantity(f"S:{name}", "S", SHORT[name], "stress", INVARIANTS[name][1])
    if name in SCALARS:
        return Quantity(name, name, *SCALARS[name], lambda values: values.astype(float))
    return parse_tensor(name) or parse_vector(name)


def parse_tensor(name: str) -> Quantity | None:
    """Component or invariant of a symmetric tensor, or component of F."""
    found = re.fullmatch(r"(S|TAU|LE)(?::?(\d\d)|:(\w+))?", name)
    if found is None:
        found = re.fullmatch(r"F(\d\d)", name)
        if found is None or found[1] not in GRADIENT:
            return None
        label = f"deformation gradient {found[1]}"
        return Quantity(name, "F", label, "number", column(GRADIENT[found[1]]))
    field, component, invariant = found.groups()
    words, dimension = TENSORS[field]
    if component is not None:
        if component not in COMPONENTS:
            return None
        evaluate = column(COMPONENTS[component])
        return Quantity(f"{field}{component}", field, f"{words} {component}", dimension, evaluate)
    invariant = invariant or "NORM"
    if invariant not in INVARIANTS:
        return None
    label, evaluate = INVARIANTS[invariant]
    if field == "S" and invariant in SHORT:
        label = SHORT[invariant]
    return Quantity(f"{field}:{invariant}", field, label.format(words), dimension, evaluate)


def parse_vector(name: str) -> Quantity | None:
    """Component or magnitude of a vector."""
    found = re.fullmatch(r"(U|U_INC|RF)([123])?", name)
    if found is None:
        return None
    field, component = found.groups()
    words, dimension = VECTORS[field]
    if component is None:
        return Quantity(name, field, words, dimension, lambda v: np.linalg.norm(v, axis=1))
    return Quantity(name, field, f"{words} {component}", dimension, column(int(component) - 1))


def quantities_of(fields: Iterable[str]) -> list[str]:
    """Names of the quantities that can be made from these fields, in short."""
    names = []
    for field in fields:
        if field in TENSORS:
            names += [f"{field}11..{field}33", *(f"{field}:{i.lower()}" for i in INVARIANTS)]
        elif field in VECTORS:
            names += [field, f"{field}1..{field}3"]
        elif field == "F":
            names.append("F11..F33")
        elif field in SCALARS:
            names.append(field)
    return names
