"""Slips of people who read an axis, and of what they read it by."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.animals import Animal, Met
from benchmarks.zoo.axes import LASER, SCALE, AxisTruth, Meet, Rule, Visits, even, written

Slip = Callable[[Array], Array]
"""From the values that should stand in the file to those that stand there."""
Wrong = Callable[[Visits, Array], tuple[Visits, Array]]
"""The same of places and values."""
VISITS, RUNS = even(14, 1), even(14, 3)
N, M = np.arange(28), np.arange(84)
"""Numbers of the readings, from 0."""


def axis(x: Array, side: Array) -> Array:
    """Return a lead error of 40 um/m with a wave of 8 um and a backlash of 4 um."""
    found: Array = 0.04 * x + 8 * np.sin(2 * np.pi * x / 600) - 2 * side
    return found


def slipped(wrong: Wrong, rule: Rule = LASER, test: Visits = VISITS) -> Meet:
    """Return how the axis is met when a person slips."""

    def met(seed: int) -> Met:
        rng = np.random.default_rng((seed, 2))
        right = axis(test.x, test.sides) + rng.normal(0, rule.noise, len(test.x))
        return Met(written(rule, *wrong(test, right - right[0])), AxisTruth(axis))

    return met


def misread(slip: Slip, rule: Rule = LASER) -> Meet:
    """Return the same where places are right."""
    return slipped(lambda visits, values: (visits, slip(values)), rule)


def missed(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Miss one reading: each later value stands one row too high, and the last row is empty-handed."""
    return Visits(visits.x[:-1], visits.sides[:-1]), np.delete(values, 6)


def misplaced(visits: Visits, values: Array) -> tuple[Visits, Array]:
    """Write one position that is 200 mm off."""
    return Visits(visits.x + 200.0 * (N == 4), visits.sides), values


STUCK = misread(lambda values: np.where(N >= 8, values[8], values))
REPEATING = misread(lambda values: values[np.where(N % 3 == 2, N - 1, N)])
IN_MM = misread(lambda values: values / 1000)
TURNED = misread(lambda values: np.where(N == 9, -values, values))
IN_RUN = slipped(lambda visits, values: (visits, np.where(M // 28 == 1, -values, values)), test=RUNS)
SIDES = slipped(lambda at, values: (Visits(at.x, np.where(M < 28, 1, -1) * at.sides), values), test=RUNS)
BACK = slipped(lambda visits, values: (visits, values[np.where(M // 28 == 1, M // 14 * 28 + 13 - M, M)]), test=RUNS)
SWAPPED = misread(lambda values: values[np.where(N == 5, 8, np.where(N == 8, 5, N))])
ROUNDED = misread(lambda values: np.round(values, -1))
SET_ANEW = misread(lambda values: np.where(N >= 8, values - 140, values), SCALE)

SLIPS = (
    Animal("slip: stuck", LASER.job, STUCK, r"\bstuck", asked=True),
    Animal("slip: repeating", LASER.job, REPEATING, r"\bstuck|repeat", asked=True),
    Animal("slip: unit, mm for um", LASER.job, IN_MM, r"\bunit|in mm|1000 times", asked=True),
    Animal("slip: sign of one reading", LASER.job, TURNED, r"left out|does not agree|\bsign\b"),
    Animal("slip: sign of one run", LASER.job, IN_RUN, r"from reading 29 to 56 have the other sign", asked=True),
    Animal("slip: sides from a run on", LASER.job, SIDES, r"from reading 29 on fit the other sides", asked=True),
    Animal(
        "slip: one run counted back", LASER.job, BACK, r"29 to 56 fit places counted from the other end", asked=True
    ),
    Animal("slip: two readings swapped", LASER.job, SWAPPED, r"left out|does not agree|swapped|exchanged"),
    Animal("slip: rounded to 10 um", LASER.job, ROUNDED, r"round|resolution|steps of"),
    Animal("slip: dial set anew", SCALE.job, SET_ANEW, r"set anew|jump|\bstep of", asked=True),
    Animal("slip: one reading missed", LASER.job, slipped(missed), r"missed|one row|shifted|left out"),
    Animal("slip: wrong row", LASER.job, slipped(misplaced), r"left out|does not agree|place of reading"),
)
