"""Quantities: a number is SI, a text carries its unit.

>>> si("12 um", "Error", "std"), si(0.5, "Error", "std"), si("6 um/h", "Laser", "drift", WANDER)
(1.2e-05, 0.5, 1.6666666666666667e-09)
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from axiscal_core.refusals import LARGEST, Array, InputError, finite, within

Quantity = float | str
"""A number in m, rad, s or 1/s of them, or a text such as "12 um"."""
Poses = Sequence[Sequence[Quantity]] | Array
"""(m, q) in the order of the axes, m and rad or texts; as sides +1, -1, 0: from where each axis comes."""
Of = Sequence[str]
"""What a text may be a quantity of."""
METRES, RADIANS, SECONDS, EITHER, WANDER = ("m",), ("rad",), ("s",), ("m", "rad"), ("m/s", "rad/s")

# Each factor is a ratio of exact numbers, so that "120 mm" is exactly 0.12.
_UNITS: dict[str, dict[str, tuple[float, float]]] = {
    "m": {"nm": (1, 1e9), "um": (1, 1e6), "mm": (1, 1e3), "cm": (1, 100), "m": (1, 1), "in": (254, 1e4)},
    "rad": {
        "urad": (1, 1e6), "mrad": (1, 1e3), "rad": (1, 1), "deg": (np.pi, 180), "arcsec": (np.pi, 648000),
        "um/m": (1, 1e6), "mm/m": (1, 1e3),
    },
    "s": {"s": (1, 1), "min": (60, 1), "h": (3600, 1)},
}  # fmt: skip
_WORDS = {"m": "length", "rad": "angle", "s": "time", "m/s": "length in a time", "rad/s": "angle in a time"}
_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")


def si(value: object, function: str, argument: str, of: Of = EITHER, pose: int | None = None) -> float:
    """Return a quantity in SI units.  of : what a text may be"""
    if isinstance(value, str):
        return _read(value, function, argument, of, pose)
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        remedy = 'Give a number in SI units, or "12 um"'
        raise InputError(function, argument, f"= {value!r} is no quantity", remedy, pose)
    number = float(value)
    if not abs(number) < LARGEST:
        raise InputError(function, argument, f"= {value!r} is no number", f"Give one below {LARGEST:g}", pose)
    return number


def like(usual: object) -> Of:
    """Return what a text may be where another is usual: a length, an angle; either where that one is a bare number."""
    unit = usual.split()[-1] if isinstance(usual, str) else ""
    return next(((of,) for of in EITHER if unit in _UNITS[of]), EITHER)


def in_minutes(value: object, function: str, argument: str) -> float:
    """Return a time that is above zero: a number of minutes, or a text with a unit of its own."""
    number = si(value, function, argument, SECONDS) / (60 if isinstance(value, str) else 1)
    return within(function, argument, number, 0.0, open_end=True)


def _read(text: str, function: str, argument: str, of: Of, pose: int | None) -> float:
    units = {name: factor for each in of for name, factor in _units(each).items()}
    found = _TEXT.fullmatch(text.translate({ord("µ"): "u", ord("μ"): "u"}))
    number = float(found[1]) if found else float("nan")
    times, by = units.get(found[2] if found else "", (0.0, 1.0))
    if not times or not abs(number) < LARGEST:
        what = f"= {text!r} is no {' or '.join(_WORDS[each] for each in of)}"
        raise InputError(function, argument, what, f"Units are {', '.join(units)}", pose)
    return number * times / by


def _units(si_unit: str) -> dict[str, tuple[float, float]]:
    """Return the units of a quantity, and of how fast it changes: what each is times and by, in SI."""
    above, _, below = si_unit.partition("/")
    if not below:
        return _UNITS[above]
    over, under = _UNITS[above].items(), _UNITS[below].items()
    return {f"{a}/{b}": (p * s, q * r) for a, (p, q) in over for b, (r, s) in under}


def as_given(values: object, found: Array) -> Array:
    """Return values as they were given, shaped as what was found, where texts are among them; else what was found."""
    if isinstance(values, np.ndarray) and values.dtype.kind not in "OU":
        return found
    given = np.array(values, dtype=object)
    return given.reshape(found.shape) if any(isinstance(each, str) for each in given.flat) else found


def quantities(
    values: object, function: str, argument: str, shape: tuple[int | None, ...], of: Sequence[Of] = (EITHER,),
    posed: bool = False,
) -> Array:  # fmt: skip
    """Return an array of quantities, numbers or texts.

    of : what texts are, one for all or each along the last index; posed : the first index is of poses
    """
    given = np.array(values, dtype=object) if isinstance(values, str | list | tuple) else np.asarray(values)
    if given.dtype.kind in "OU" and any(isinstance(each, str) for each in given.flat):
        width = given.size // len(given) if posed and given.ndim else 0
        found = [
            si(each, function, argument, of[i % len(of)], i // width if width else None)
            for i, each in enumerate(given.flat)
        ]
        return finite(function, argument, np.reshape(found, given.shape), shape, posed)
    return finite(function, argument, values, shape, posed)
