"""Whether readings move in coarse steps that nobody stated: a display's, or those of decimals that were not written.

The largest step q of whose multiples all values of a set-up differ is sought, to within the last decimal d written. If
the display were no coarser than p = q/m ≤ 3σ, σ the noise, a different value would fall on the steps of q with a
probability of 1/m (of 3d/q where d is what hides that q is no decimal), and one that was there before again with

    r = Σⱼ Φ((jq + p/2)/σ) − Φ((jq − p/2)/σ)

at most. Of a different values beside the first, and of b that came again, chance then leaves Σ m^−a r^b over all m from
the one found on, at most m^−a (1 + m/(a − 1)) r^b.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.inference.intervals import COARSE
from axiscal.language.spoken import said
from axiscal.measurement.instrument import values_of
from axiscal.measurement.place_texts import reading_unit
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import FINEST, Setup
from axiscal.numerics import Array
from axiscal.report.doubled import last_decimal
from axiscal.report.summary import Finding
from axiscal.units import format_quantity, said_quantity

_BY_CHANCE = 1e-2
"""Of displays as coarse as may be and curves that stay where they show the same, one in a hundred; hardly any other."""
_FEWEST = 3
"""Two different values are any step apart."""
_TOLD = 6.0
"""Last decimals within which a step that is no decimal can be told from its neighbours: ±1 is a third of it."""
_DIGITS = range(2, 7)
"""A step is written with as few digits as tell it."""


def coarse_displays(readings: Sequence[Reading], setups: Sequence[Setup]) -> list[Finding]:
    """Return warnings of set-ups whose values move in steps that are coarse beside the noise and not stated."""
    return list(_findings(readings, setups))


def _findings(readings: Sequence[Reading], setups: Sequence[Setup]) -> Iterator[Finding]:
    text = (
        'The values of "{setup}" move in steps of {step}, {times:.3g} times its noise: as they stand, the same number '
        'read again passes for better knowledge. State resolution = "{written}" or, if the display shows finer steps '
        "and the values were written with too few decimals, write them all. {effect}"
    )
    for setup in setups:
        mine = [each for each in readings if each.setup == setup.name and each.std is None]
        step = step_of(np.array([number for each in mine for number in each.values]), setup.noise)
        if step is None or step <= setup.interval * (1 + 1e-6):
            continue
        unit, effect = (
            reading_unit(setup),
            said("Each reading counts as the interval it fell into where that is stated."),
        )
        if values_of(setup) > 1:
            effect = said("What is rounded off counts as noise where that is stated.")
        shown, written = said_quantity(step, unit, 6), format_quantity(step, unit)
        times = step / setup.noise
        yield Finding(
            "resolution", None, said(text, setup=setup.name, step=shown, times=times, written=written, effect=effect)
        )


def step_of(values: Array, noise: float) -> float | None:
    """Return the step in which values move, m or rad, where it is coarse beside the noise and no chance; else None.

    values : (m,) m or rad; noise : m or rad
    """
    if len(values) < _FEWEST:
        return None
    decimal = last_decimal(values)
    whole = np.unique(np.rint(values / decimal))
    if len(whole) < _FEWEST:
        return None
    again = len(values) - len(whole)
    exact = float(np.gcd.reduce(np.diff(whole).astype(np.int64)))
    if exact < _TOLD:
        found = _hidden(whole, noise / decimal, again)
        if found is not None:
            return found * decimal
    told = exact * decimal > max(COARSE * noise, FINEST) and _chance(exact * decimal / noise, len(whole), again)
    return exact * decimal if told else None


def _chance(steps: float, different: int, again: int) -> bool:
    """Return whether no chance puts so many values on steps of so many noises that are written out."""
    finer, beside = math.ceil(steps / COARSE), different - 1
    tail = float(finer) ** -beside * (1 + finer / (beside - 1))
    return tail * _same(steps, steps / finer) ** again <= _BY_CHANCE


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
        if parts * each ** (len(whole) - 2) * _same(step / noise, step / noise / finer) ** again > _BY_CHANCE:
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
    return _shortest(low, high)


def _shortest(low: float, high: float) -> float:
    """Return the number within two others, in the middle, that has the fewest digits."""
    middle = (low + high) / 2
    rounded = (float(f"{middle:.{digits}g}") for digits in _DIGITS)
    return next((each for each in rounded if low <= each <= high), middle)
