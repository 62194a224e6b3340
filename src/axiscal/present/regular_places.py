"""What places at regular distances cannot see, and three odd places that can.

All places of an axis are multiples of one step apart, as in a standard test. A sine of that step's period has the same
value at all of them: it is taken for a constant, and no reading contradicts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.language.spoken import listed, said
from axiscal.machine.axis import Axis
from axiscal.measurement.reading import Reading, place_text
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.summary import Finding
from axiscal.units import format_quantity

_FEWEST = 5
"""Places of a standard test at least (ISO 230-2); any three are multiples of something apart."""
_MICROMETRE = 1e-6
"""m or rad: places are written down to that."""
_MOSTLY = 2
"""Times the step, so near at least the nearest places stand: of any two distances some small step is a divisor."""
_WHERE, _PHASES = (0.2, 0.5, 0.8), (0.31, 0.5, 0.73)
"""Shares of the range and of the step: any that no small fraction of the step joins."""


def regular_places(readings: Sequence[Reading], setups: Sequence[Setup], axes: Sequence[Axis]) -> Iterator[Finding]:
    """Yield a warning for each axis of a set-up whose places are all multiples of one step apart."""
    text = (
        'All places of "{setup}" are a multiple of {step} apart along {axis}: an error of that period looks like none. '
        'Read three more at odd places, such as {places}, with "yes" in a column check: they judge the others.'
    )
    for setup in setups:
        poses = np.array([reading.pose for reading in readings if reading.setup == setup.name]).reshape(-1, len(axes))
        for k in setup.moves if setup.chart is None else ():
            axis, places = axes[k], np.unique(np.round(poses[:, k] / _MICROMETRE).astype(np.int64))
            if (step := step_between(places)) is not None:
                odd = [place_text(axes, np.where(np.arange(len(axes)) == k, at, 0.0).tolist(), [k])
                       for at in _odd(places, step)]  # fmt: skip
                said_step = format_quantity(step * _MICROMETRE, axis.unit, 6)
                named = {"setup": setup.name, "step": said_step, "axis": axis.name, "places": listed(", ", odd)}
                yield Finding("aliasing", None, said(text, **named))


def step_between(places: Array) -> int | None:
    """Return the step of which all distances are multiples; None of few places, or where it is much finer than these.

    places : (m,) whole numbers, rising
    """
    if len(places) < _FEWEST:
        return None
    gaps = np.diff(places)
    step = int(np.gcd.reduce(gaps))
    return step if _MOSTLY * step >= gaps.min() else None


def _odd(places: Array, step: int) -> list[float]:
    """Return three places between others, m or rad."""
    first, count = int(places[0]), int(places[-1] - places[0]) // step
    return [
        (first + (int(share * count) + phase) * step) * _MICROMETRE
        for share, phase in zip(_WHERE, _PHASES, strict=True)
    ]
