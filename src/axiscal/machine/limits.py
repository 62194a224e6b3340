"""A quantity of the description between limits, outside which a unit has been confused."""

from __future__ import annotations

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, UnitError
from axiscal.units import Dimension, format_quantity, parse_quantity

Keys = tuple[str | int, ...]

_SHOWN_IN: dict[Dimension, str] = {
    "length": "mm",
    "angle": "deg",
    "speed": "m/min",
    "rotation_speed": "rpm",
    "acceleration": "m/s^2",
    "rotation_acceleration": "deg/s^2",
}


def within(document: Document, keys: Keys, text: str, dimension: Dimension, least: float, most: float) -> float:
    """Return a quantity in SI units; raises UnitError, or DescriptionError when it is not between two limits."""
    try:
        value = parse_quantity(text, dimension)
    except UnitError as fault:
        raise document.fault(fault, *keys) from None
    if least <= value <= most:
        return value
    what = "{text} is too small" if value < least else "{text} is too large"
    what = "{text} is negative" if value < 0 <= least else "{text} is zero" if value == 0 else what
    low, high = (format_quantity(limit, _SHOWN_IN[dimension]) for limit in (least, most))
    remedy = "Write a value from {low} to {high}"
    raise document.fault(DescriptionError(what, remedy, text=shown(text), low=low, high=high), *keys)
