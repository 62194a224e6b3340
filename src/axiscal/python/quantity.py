"""Quantities as a person may give them in Python: a number in SI units, or a text with its unit."""

from __future__ import annotations

from axiscal.units import Dimension, parse_quantity

Quantity = float | int | str
"""A number in m, rad or s, or text such as "12 um"."""


def si(value: Quantity, dimension: Dimension) -> float:
    """Return a quantity in SI units; raises UnitError for text that is none."""
    return parse_quantity(value, dimension) if isinstance(value, str) else float(value)
