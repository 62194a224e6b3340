"""What would be known with one reading more of each line, from the other side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from axiscal.estimation.belief import Belief
from axiscal.estimation.estimation import Estimation, printed
from axiscal.estimation.functionals.functional import AxisLine
from axiscal.estimation.learnt import posterior_of
from axiscal.measurement.reading import Reading

_SOON = 10.0
"""s after it: to go past the place and come back."""


def with_one_more(known: Estimation, lines: Sequence[AxisLine]) -> Belief | None:
    """Return what would be known with one reading more of each line; None of no line."""
    found = known.posterior
    if not lines or found is None:
        return None
    case = known.stated.linear_as(known.case)
    readings = [*known.readings, *(_turned(known.readings, line) for line in lines)]
    more = posterior_of(case, readings, {doubt.reading: doubt for doubt in known.outliers if doubt.implausible})
    # What it shows is not known, so it teaches no sizes and disagrees with nothing.
    return printed(known.knowledge, replace(more, agreement=found.agreement), known.checks).belief


def _turned(readings: Sequence[Reading], line: AxisLine) -> Reading:
    """Return the last reading of a line as if it came from the other side, with the same value."""
    last = next(reading for reading in reversed(readings) if reading.setup == line.setup)
    sides = tuple(-side if k == line.axis else side for k, side in enumerate(last.approach))
    time = None if last.time is None else last.time + _SOON
    return replace(last, approach=sides, time=time, accepted=True, check=False)
