"""One axis of a picture: from values to pixels, and the round values at which it has ticks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from axiscal.language.spoken import decimals

_SLACK = 1e-9
"""Share of a step by which a tick may lie outside through rounding."""
_WIDE_DECADES = 1.6
"""From so many decades on, ticks stand at 1 alone."""
_FINE_DECADES = 0.5
"""Up to so many decades ticks stand as on a linear axis: 1, 2 and 5 would leave one or two."""


@dataclass(frozen=True, slots=True)
class PixelScale:
    """low, high : range, logarithms to base ten where `logarithmic`; start, end : pixels"""

    low: float
    high: float
    start: float
    end: float
    logarithmic: bool = False

    def pixel(self, value: float) -> float:
        """Return where a value stands."""
        return self.of_range(math.log10(value) if self.logarithmic else value)

    def of_range(self, place: float) -> float:
        """Return where a place of the range stands: a value, or its logarithm."""
        return self.start + (place - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, count: int, step: float | None = None) -> list[tuple[float, str]]:
        """Return about so many ticks as (pixel, text).  step : between two of them, where it is given"""
        values = self._decades(count) if self.logarithmic else _even(self.low, self.high, count, step)
        return [(self.pixel(value), tick_text(value)) for value in values]

    def _decades(self, count: int) -> list[float]:
        if self.high - self.low < _FINE_DECADES:
            return [value for value in _even(10**self.low, 10**self.high, count, None) if value > 0]
        factors = (1,) if self.high - self.low > _WIDE_DECADES and count < _MANY else (1, 2, 5)
        powers = range(math.floor(self.low), math.ceil(self.high) + 1)
        values = [factor * 10.0**power for power in powers for factor in factors]
        return [value for value in values if self.low <= math.log10(value) <= self.high]


_FEWEST = 2
"""Ticks without which a picture has no scale."""
_MANY = 5
"""Ticks from which there is room for 1, 2 and 5 of several decades."""


def tick_text(value: float) -> str:
    """Return the text of a tick."""
    text = f"{value:.6g}"
    return "0" if text in ("0", "-0") else decimals(text).replace("-", "−")


def _even(low: float, high: float, count: int, step: float | None) -> list[float]:
    size = step or _round((high - low) / max(count, 1))
    found = _multiples(low, high, size)
    while len(found) < _FEWEST and step is None and high > low:
        size = _round(size / 3)  # 5, 2, 1: the next round step down
        found = _multiples(low, high, size)
    return found


def _multiples(low: float, high: float, size: float) -> list[float]:
    first, last = math.ceil(low / size - _SLACK), math.floor(high / size + _SLACK)
    return [float(f"{number * size:.9g}") for number in range(first, last + 1)]


def _round(size: float) -> float:
    """Return the smallest of 1, 2, 5 times a power of ten that is not below size."""
    power = 10.0 ** math.floor(math.log10(size))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= size * (1 - _SLACK))


def spread_of(values: Sequence[float], from_nought: bool) -> tuple[float, float]:
    """Return the range of an axis that nobody has chosen: all values with a margin.  from_nought : it begins there"""
    low, high = min(values, default=0.0), max(values, default=1.0)
    margin = 0.05 * (high - low) or max(abs(high), 1.0) * 0.05
    return (min(0.0, low) if from_nought else low - margin), high + margin
