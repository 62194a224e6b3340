"""Which part of a circle a ball bar can go round."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from axiscal.exceptions import DescriptionError
from axiscal.measurement.charts.circle import Circle
from axiscal.numerics import Array

_FINE = math.radians(0.25)
"""Finer than the whole degrees of the result."""
_SHORTEST = math.radians(5.0)
"""Nobody goes round a shorter arc."""
_WHOLE_DEGREES = math.radians(1.0)
"""What a person dials in."""


def reached_arc(circle: Circle, name: str) -> tuple[float, float]:
    """Return the longest arc that is reached in one piece, to whole degrees; raises DescriptionError for none."""
    angles = _FINE * np.arange(float(round(math.tau / _FINE)))
    taken = _taken(circle, angles)
    if np.all(taken):
        return 0.0, math.tau
    start, count = _longest(taken)
    low, high = _whole(angles[start], angles[start] + (count - 1) * _FINE)
    if high - low < _SHORTEST:
        what = f'the bar of "{name}" reaches no arc of its circle within the travels and clear of stems'
        raise DescriptionError(what, "Give another plane, station or length, or park the rotary axes elsewhere")
    return (low - math.tau, high - math.tau) if low >= math.pi else (low, high)


def refuse_gap(circle: Circle, name: str) -> None:
    """Raise DescriptionError where an arc that was asked for cannot be gone round."""
    low, high = circle.arc
    angles = np.linspace(low, high, 2 + int((high - low) / _FINE))
    taken = _taken(circle, angles)
    if np.all(taken):
        return
    bad = float(angles[np.flatnonzero(~taken)[0]])
    pose = circle.poses(np.array([[bad]]))[0]
    away = [
        a.name for a, at in zip(circle.room.machine.axes, pose, strict=True) if not a.travel[0] <= at <= a.travel[1]
    ]
    leaves = f"leaves the travel of {', '.join(away)}" if away else "meets a stem, or what is to be kept out,"
    first, count = _longest_of(taken)
    low, high = _whole(angles[first], angles[first + max(count, 1) - 1])
    if high - low < _SHORTEST:
        low, high = reached_arc(circle, name)
    what = f'the bar of "{name}" {leaves} at {math.degrees(bad):.0f} deg'
    raise DescriptionError(what, f'Give arc = ["{math.degrees(low):.0f} deg", "{math.degrees(high):.0f} deg"]')


def _whole(low: float, high: float) -> tuple[float, float]:
    """Return the whole degrees within an arc, rad."""
    first, last = low / _WHOLE_DEGREES - 1e-9, high / _WHOLE_DEGREES + 1e-9
    return math.ceil(first) * _WHOLE_DEGREES, math.floor(last) * _WHOLE_DEGREES


def _taken(circle: Circle, angles: Array) -> NDArray[np.bool_]:
    return circle.feasible(circle.poses(angles[:, None]))


def _longest(taken: NDArray[np.bool_]) -> tuple[int, int]:
    """Return start and length of the longest run around a circle."""
    start, count = _longest_of(np.concatenate([taken, taken]))
    return start % len(taken), min(count, len(taken))


def _longest_of(taken: NDArray[np.bool_]) -> tuple[int, int]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], taken.astype(int), [0]])))
    starts, stops = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    best = int((stops - starts).argmax())
    return int(starts[best]), int(stops[best] - starts[best])
