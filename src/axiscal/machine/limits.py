"""A quantity of the description between limits, outside which a unit has been confused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, InputError, UnitError
from axiscal.units import Dimension, format_quantity, parse_quantity

if TYPE_CHECKING:
    from pydantic import BaseModel

Keys = tuple[str | int, ...]
TableT = TypeVar("TableT", bound="BaseModel")

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


@dataclass(frozen=True, slots=True)
class Stated(Generic[TableT]):
    """A table of the document, with the quantities that it states.  keys : where it stands"""

    document: Document
    table: TableT
    keys: Keys

    def within(self, key: str, dimension: Dimension, least: float, most: float, index: int = 0) -> float | None:
        """Return a quantity, or one of a list, in SI units, None where it is not stated; raises as `within`."""
        found = getattr(self.table, key)
        place, text = ((key, index), found[index]) if isinstance(found, tuple) else ((key,), found)
        return None if text is None else within(self.document, (*self.keys, *place), text, dimension, least, most)

    def each(self, key: str, dimension: Dimension, least: float, most: float) -> tuple[float, ...]:
        """Return all quantities of a list in SI units; raises as `within`."""
        places = enumerate(getattr(self.table, key))
        return tuple(within(self.document, (*self.keys, key, k), text, dimension, least, most) for k, text in places)

    def misstated(self, key: str, what: str, remedy: str, **values: object) -> InputError:
        """Return a failure placed at a key."""
        return self.document.fault(DescriptionError(what, remedy, None, None, **values), *self.keys, key)
