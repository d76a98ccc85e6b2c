"""Units of quantities from the labels of *UNITS."""

import re
from dataclasses import dataclass

STRESS = {
    ("N", "m"): "Pa",
    ("kN", "m"): "kPa",
    ("MN", "m"): "MPa",
    ("N", "mm"): "MPa",
    ("kN", "mm"): "GPa",
}
PREFIX = {"": 1.0, "k": 1e3, "M": 1e6, "G": 1e9, "c": 1e-2, "m": 1e-3, "u": 1e-6, "n": 1e-9}
SIMPLE = re.compile(r"(?P<prefix>[kMGcmun]?)(?P<base>Pa|N|m)(?P<rest>(?:/m)?)")
SUPERSCRIPT = {2: "²", 3: "³"}


@dataclass(frozen=True)
class Units:
    """Labels of length and force, empty if the deck has none; n_dim 2 is plane strain."""

    length: str = ""
    force: str = ""
    n_dim: int = 3

    @classmethod
    def from_text(cls, text: str, n_dim: int) -> "Units":
        """From the attribute `units` of the results, such as `length m force kN`."""
        found = re.fullmatch(r"(?:length (?P<length>.*?))? ?(?:force (?P<force>.*))?", text.strip())
        if found is None:
            return cls(n_dim=n_dim)
        return cls(found["length"] or "", found["force"] or "", n_dim)

    def of(self, dimension: str) -> str:
        """The unit of a dimension: length, force, stress, volume, mass, time or number."""
        length, force = self.length or "length", self.force or "force"
        match dimension:
            case "length":
                return length
            case "force":  # in plane strain per unit of thickness
                return force if self.n_dim == 3 else f"{force}/{length}"
            case "stress":
                return STRESS.get((self.force, self.length), f"{force}/{length}²")
            case "volume":
                return f"{length}{SUPERSCRIPT[self.n_dim]}"
            case "mass":
                return "mass"
        return "-"

    def axis(self, label: str, dimension: str, unit: str = "") -> str:
        """Text of an axis: what and in which unit."""
        return f"{label} [{unit or self.of(dimension)}]"


def conversion(old: str, new: str) -> float | None:
    """Factor from one unit to another one of the same kind; None if they are none that we know."""
    a, b = SIMPLE.fullmatch(old), SIMPLE.fullmatch(new)
    if a is None or b is None or (a["base"], a["rest"]) != (b["base"], b["rest"]):
        return None
    return PREFIX[a["prefix"]] / PREFIX[b["prefix"]]
