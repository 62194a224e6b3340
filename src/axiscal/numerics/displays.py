"""The step of a display, or of the decimals that were written, by the values that it showed.

The search is for the largest step q of whose multiples all values of a set-up differ, to the last decimal d written.
Suppose a display no coarser than p = q/m ≤ 3σ. A different value then falls on the steps of q with a probability of 1/m
(3d/q if d hides that q is no decimal). One that was there before comes again with at most

    r = Σⱼ Φ((jq + p/2)/σ) − Φ((jq − p/2)/σ)

Let a different values come beside the first, and b come again. Chance then leaves Σ m^−a r^b over all m from the one
found on, at most m^−a (1 + m/(a − 1)) r^b.
"""

from __future__ import annotations

import math

import numpy as np

from axiscal.numerics import Array

COARSE = 3.0
"""Steps of so many standard deviations of the scatter are taken as intervals."""
_LEAST = 1e-10
"""m or rad, an atom's width: no display shows less."""
_RARELY = 1e-2
"""Of displays as coarse as may be and curves that stay where they show the same, one in a hundred; hardly any other."""
_FEWEST_VALUES = 3
"""Two different values are any step apart."""
_TOLD = 6.0
"""Last decimals within which a step that is no decimal can be told from its neighbours: ±1 is a third of it."""
_DIGITS = range(2, 7)
"""A step is written with as few digits as tell it."""
_FINEST = 6
"""Decimals of um or urad: values with more were not read off a display."""


def step_of(values: Array, noise: float) -> float | None:
    """Return the step in which values move, m or rad, where it is coarse beside the noise and no chance; else None.

    values : (m,) m or rad; noise : m or rad
    """
    if len(values) < _FEWEST_VALUES:
        return None
    decimal = last_decimal(values)
    whole = np.unique(np.rint(values / decimal))
    if len(whole) < _FEWEST_VALUES:
        return None
    again = len(values) - len(whole)
    exact = float(np.gcd.reduce(np.diff(whole).astype(np.int64)))
    if exact < _TOLD:
        found = _hidden(whole, noise / decimal, again)
        if found is not None:
            return found * decimal
    told = exact * decimal > max(COARSE * noise, _LEAST) and _chance(exact * decimal / noise, len(whole), again)
    return exact * decimal if told else None


def _chance(steps: float, different: int, again: int) -> bool:
    """Return whether no chance puts so many values on steps of so many noises that are written out."""
    finer, beside = math.ceil(steps / COARSE), different - 1
    tail = float(finer) ** -beside * (1 + finer / (beside - 1))
    return tail * _same(steps, steps / finer) ** again <= _RARELY


def _same(steps: float, finer: float) -> float:
    """Return how probable it is at most that a display of finer steps, in noises, shows one of the coarse ones."""
    edges = [(j * steps - finer / 2, j * steps + finer / 2) for j in (-1, 0, 1)]
    return min(1.0, sum(math.erf(high / math.sqrt(2)) - math.erf(low / math.sqrt(2)) for low, high in edges) / 2)


def _hidden(whole: Array, noise: float, again: int) -> float | None:
    """Return the largest step that is hidden by rounding to whole numbers, if there is one that is no chance.

    whole : (m,) increasing; noise : in their unit
    """
    gaps = np.sort(np.diff(whole))
    further = np.concatenate([gaps, whole[1:] - whole[0]])
    for parts in range(1, int(gaps[0] / max(COARSE * noise, _TOLD)) + 1):
        step = float(gaps[0]) / parts
        finer = math.ceil(step / (COARSE * noise))
        each = max(3.0 / step, 1.0 / finer)
        if parts * each ** (len(whole) - 2) * _same(step / noise, step / noise / finer) ** again > _RARELY:
            return None  # smaller parts are rather by chance still
        found = _within(further, step, 1.0 / parts)
        if found is not None:
            return found
    return None


def _within(gaps: Array, step: float, slack: float) -> float | None:
    """Return the step, off by up to `slack`, of which all gaps, each off by up to 1, are multiples; None if none is."""
    low, high = step - slack, step + slack
    for gap in gaps.tolist():
        count = round(gap / ((low + high) / 2))
        low, high = max(low, (gap - 1) / count), min(high, (gap + 1) / count)
        if low > high:
            return None
    middle = (low + high) / 2
    rounded = (float(f"{middle:.{digits}g}") for digits in _DIGITS)
    return next((each for each in rounded if low <= each <= high), middle)


def last_decimal(numbers: Array) -> float:
    """Return the step of the last decimal of um or urad that numbers use, m or rad.  numbers : (m,) m or rad"""
    micro = numbers * 1e6
    for decimals in range(_FINEST):
        shown = np.round(micro, decimals)
        if np.all(np.abs(micro - shown) <= 1e-9 * np.maximum(np.abs(micro), 1.0)):
            return float(10.0 ** -(6 + decimals))
    return float(10.0 ** -(6 + _FINEST))
