"""Figures as they are written: finite, and as many as the same campaign gives on any processor."""

from __future__ import annotations

import math
from collections.abc import Sequence

from axiscal.exceptions import SummaryError

_DIGITS = 6
"""Figures kept, so that the same campaign gives the same bytes on any processor."""


_DECIMALS = 9
"""Of a coordinate, mm or deg: what was commanded, as plans and programs have it, and far below a nanometre."""


def coordinate(value: float, what: str) -> float:
    """Return where an axis stood, at nine decimals; raises SummaryError if it is not finite."""
    if not math.isfinite(value):
        raise SummaryError(f"{what} is {value}; the report takes finite figures only.")
    return round(value, _DECIMALS) + 0.0


def number(value: float, what: str) -> float:
    """Return value at six significant digits; raises SummaryError if it is not finite."""
    if not math.isfinite(value):
        raise SummaryError(f"{what} is {value}; the report takes finite figures only.")
    return float(f"{value:.{_DIGITS}g}") + 0.0  # + 0.0 turns -0.0 into 0.0


def numbers(values: Sequence[float], what: str, size: int | None = None) -> list[float]:
    """Return values at six significant digits; raises SummaryError if one is not finite or their count is not size."""
    if size is not None and len(values) != size:
        raise SummaryError(f"{what} has {len(values)} values for {size} positions.")
    return [number(value, what) for value in values]
