"""Quantities: a number is SI, a text carries its unit.

>>> si("12 um", "Error", "std"), si(0.5, "Error", "std"), si("6 um/h", "Laser", "drift")
(1.2e-05, 0.5, 1.6666666666666667e-09)
"""

from __future__ import annotations

import re

import numpy as np

from axiscal_core.refusals import Array, InputError, finite

Quantity = float | str
"""A number in m, rad, s or 1/s of them, or a text such as "12 um"."""

# Each factor is a ratio of exact numbers, so that "120 mm" is exactly 0.12.
_LENGTHS = {"nm": (1, 1e9), "um": (1, 1e6), "mm": (1, 1e3), "cm": (1, 100), "m": (1, 1), "in": (254, 1e4)}
_ANGLES = {
    "urad": (1, 1e6), "mrad": (1, 1e3), "rad": (1, 1), "deg": (np.pi, 180), "arcsec": (np.pi, 648000),
    "um/m": (1, 1e6), "mm/m": (1, 1e3),
}  # fmt: skip
_TIMES = {"s": (1, 1), "min": (60, 1), "h": (3600, 1)}
UNITS: dict[str, tuple[float, float]] = _LENGTHS | _ANGLES | _TIMES
_TEXT = re.compile(r"\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(\S*)\s*")


def si(value: object, function: str, argument: str) -> float:
    """Return a quantity in SI units."""
    if isinstance(value, str):
        return _read(value, function, argument)
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise InputError(function, argument, f"= {value!r} is no quantity", 'Give a number in SI units, or "12 um"')
    number = float(value)
    if not np.isfinite(number):
        raise InputError(function, argument, f"= {value!r} is no number", "Give a finite one")
    return number


def _read(text: str, function: str, argument: str) -> float:
    found = _TEXT.fullmatch(text)
    unit = found[2] if found else ""
    times, by = UNITS.get(unit, (0.0, 1.0))
    if unit not in UNITS and "/" in unit:  # a speed: how fast a zero wanders
        above, _, below = unit.partition("/")
        (times, by), (over, under) = UNITS.get(above, (0.0, 1.0)), _TIMES.get(below, (0.0, 1.0))
        times, by = times * under, by * over
    try:
        number = float(found[1]) if found else float("nan")
    except ValueError:
        number = float("nan")
    if not times or not by or not np.isfinite(number):
        raise InputError(function, argument, f"= {text!r} has no unit that is known", f"Units are {', '.join(UNITS)}")
    return number * times / by


def quantities(values: object, function: str, argument: str, shape: tuple[int | None, ...]) -> Array:
    """Return an array of quantities, numbers or texts."""
    if isinstance(values, list | tuple) and any(isinstance(each, str) for each in np.ravel(np.array(values, object))):
        texts = np.array(values, dtype=object)
        numbers = [si(each, function, argument) for each in texts.ravel()]
        return finite(function, argument, np.reshape(numbers, texts.shape), shape)
    return finite(function, argument, values, shape)
