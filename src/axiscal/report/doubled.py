"""Whether a file holds readings twice: a file that was added twice, a block that was pasted again, a frozen display.

That a value is shown once more has a probability of at most p = q/(σ√2π), q the step of the values and σ the noise.
L values in a row come again somewhere among m by chance in at most m²/2 p^L files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.language.spoken import said
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.report.summary import Finding

_BY_CHANCE = 1e-4
"""A right file is taken for one with copies once in ten thousand."""
_FEWEST = 3
"""Two values that are the same in a row are none, however fine they are: a place read again and its neighbour."""
_FINEST = 6
"""Decimals of um or urad: values with more were not read off a display."""


@dataclass(frozen=True, slots=True)
class Copies:
    """Readings that show what others showed: indices of the first and the last one, there and before; how many."""

    before: tuple[int, int]
    again: tuple[int, int]
    count: int


def copies(readings: Sequence[Reading], setups: Sequence[Setup]) -> list[Finding]:
    """Return warnings of set-ups whose readings in a file show the same values, one by one, as others before them."""
    return list(_findings(readings, setups))


def _findings(readings: Sequence[Reading], setups: Sequence[Setup]) -> Iterator[Finding]:
    text = (
        'Of "{setup}" {count} values in {again} are those in {before}, one after the other: with its noise that comes '
        "by chance in less than one file of ten thousand. Take out what was copied (a file added twice, a block pasted "
        "again, a display that froze): it counts as read. If all of it was read, state a smaller noise."
    )
    for setup in setups:
        mine = [reading for reading in readings if reading.setup == setup.name]
        found = repeated(mine, setup.noise)
        if found is not None:
            where = {"again": _lines(mine, found.again), "before": _lines(mine, found.before)}
            yield Finding("copies", None, said(text, setup=setup.name, count=found.count, **where))


def _lines(readings: Sequence[Reading], ends: tuple[int, int]) -> str:
    """Return where readings stand in their file, else among the readings of their set-up."""
    first, last = (readings[end].line for end in ends)
    if first is None or last is None:
        return said("its readings {first} to {last}", first=ends[0] + 1, last=ends[1] + 1)
    return said("lines {first} to {last}", first=first, last=last)


def repeated(readings: Sequence[Reading], noise: float) -> Copies | None:
    """Return the first readings of one set-up that come again so many in a row that it is no chance, if any do.

    noise : m or rad
    """
    values = [reading.values for reading in readings]
    length = _telling(values, noise)
    seen: dict[tuple[tuple[float, ...], ...], int] = {}
    for at in range(len(values) - length + 1):
        start = seen.setdefault(tuple(values[at : at + length]), at)
        if at - start >= length:
            count = _run(values, start, at)
            return Copies((start, start + count - 1), (at, at + count - 1), count)
    return None


def _telling(values: Sequence[tuple[float, ...]], noise: float) -> int:
    """Return how many values in a row do not come again by chance; more than there are where no number does."""
    step = last_decimal(np.array([number for value in values for number in value]))
    same = step / (noise * math.sqrt(2 * math.pi)) if noise > 0 else math.inf
    if same >= 1 or not values:
        return len(values) + 1
    each = len(values[0]) * math.log(same)
    return max(_FEWEST, math.ceil((math.log(_BY_CHANCE) - math.log(len(values) ** 2 / 2)) / each))


def last_decimal(numbers: Array) -> float:
    """Return the step of the last decimal of um or urad that numbers use, m or rad.  numbers : (m,) m or rad"""
    micro = numbers * 1e6
    for decimals in range(_FINEST):
        shown = np.round(micro, decimals)
        if np.all(np.abs(micro - shown) <= 1e-9 * np.maximum(np.abs(micro), 1.0)):
            return float(10.0 ** -(6 + decimals))
    return float(10.0 ** -(6 + _FINEST))


def _run(values: Sequence[tuple[float, ...]], start: int, at: int) -> int:
    """Return how many values from one place on are those from another one on, as far as the other one."""
    count = 0
    while count < at - start and at + count < len(values) and values[start + count] == values[at + count]:
        count += 1
    return count
