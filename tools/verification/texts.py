"""Numbers as they are shown."""

import math
from collections.abc import Sequence

ROUNDING = 1e-10  # smaller relative errors depend on the compiler


def number_text(value: float | None) -> str:
    """Six digits; a dash for what is not there."""
    if value is None:
        return "-"
    if math.isnan(value):
        return "none"
    return f"{value:.6g}"


def error_text(error: float | None, is_relative: bool) -> str:
    """An error or a tolerance, in percent when it is relative and not small."""
    if error is None:
        return "-"
    if math.isnan(error):
        return "none"
    if abs(error) < ROUNDING:
        return "0" if error == 0.0 else f"< {ROUNDING:g}"
    if not is_relative or abs(error) < 1e-5:
        return f"{error:.2g}"
    return f"{100.0 * error:.3g} %"


def balance_text(found: Sequence[float]) -> str:
    """What the balances of forces of some decks say, if there are any."""
    if not found:
        return ""
    many = "one deck" if len(found) == 1 else f"{len(found)} decks"
    worst = max(found)
    most = f"at most {worst:.2g}" if worst >= ROUNDING else f"less than {ROUNDING:g}"
    return f"{many}: {most} of all forces is out of balance in any increment"


def order_text(order: float) -> str:
    """Two decimals."""
    return "none" if math.isnan(order) else f"{order:.2f}"
