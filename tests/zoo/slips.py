"""Slips of people who read an axis, and of what they read it by."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from axiscal.numerics import Array
from tests.zoo.animals import Animal, Met
from tests.zoo.axes import LASER, SCALE, AxisTruth, Meet, Rule, Visits, even, written

Slip = Callable[[Visits, Array], tuple[Visits, Array]]
"""From what should stand in the file to what stands there."""


def axis(x: Array, side: Array) -> Array:
    """Return a lead error of 40 um/m with a wave of 8 um and a backlash of 4 um."""
    found: Array = 0.04 * x + 8 * np.sin(2 * np.pi * x / 600) - 2 * side
    return found


def made(slip: Slip, rule: Rule = LASER) -> Meet:
    """Return how the axis is met when a person slips."""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 2))
        visits = even(14, 1)
        right = axis(visits.x, visits.sides) + rng.normal(0, rule.noise, len(visits.x))
        return Met(written(rule, *slip(visits, right - right[0])), AxisTruth(axis))

    return met


def unit(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Write millimetres in the column of micrometres."""
    return visits, values / 1000


def sign(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Turn the sign of one reading."""
    return visits, np.where(np.arange(len(values)) == 9, -values, values)


def swapped(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Exchange two readings."""
    order = np.arange(len(values))
    order[[5, 8]] = order[[8, 5]]
    return visits, values[order]


def rounded(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Write down tens of micrometres."""
    return visits, np.round(values, -1)


def zeroed_again(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Set the dial anew before the ninth reading."""
    return visits, np.where(np.arange(len(values)) >= 8, values - 140, values)


def missed(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Miss one reading: each later value stands one row too high, and the last row is empty-handed."""
    return Visits(visits.x[:-1], visits.sides[:-1]), np.delete(values, 6)


def wrong_row(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Write one position that is 200 mm off."""
    x = visits.x.copy()
    x[4] += 200
    return Visits(x, visits.sides), values


def stuck(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Read by a laser that shows the same from the ninth reading on."""
    return visits, np.where(np.arange(len(values)) >= 8, values[8], values)


def repeating(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Read by a laser that shows its last value again at each third reading."""
    shown = np.arange(len(values))
    return visits, values[np.where(shown % 3 == 2, shown - 1, shown)]


SLIPS = (
    Animal("slip: stuck", LASER.job, made(stuck), r"\bstuck", quick=True, asked=True),
    Animal("slip: repeating", LASER.job, made(repeating), r"\bstuck|repeat", asked=True),
    Animal("slip: unit, mm for um", LASER.job, made(unit), r"\bunit|in mm|1000 times", quick=True, asked=True),
    Animal("slip: sign of one reading", LASER.job, made(sign), r"left out|does not agree|\bsign\b", quick=True),
    Animal("slip: two readings swapped", LASER.job, made(swapped), r"left out|does not agree|swapped|exchanged"),
    Animal("slip: rounded to 10 um", LASER.job, made(rounded), r"round|resolution|steps of", quick=True),
    Animal(
        "slip: dial set anew",
        SCALE.job,
        made(zeroed_again, SCALE),
        r"set anew|jump|\bstep of",
        quick=True,
        asked=True,
    ),
    Animal("slip: one reading missed", LASER.job, made(missed), r"missed|one row|shifted|left out", quick=True),
    Animal("slip: wrong row", LASER.job, made(wrong_row), r"left out|does not agree|place of reading"),
)
