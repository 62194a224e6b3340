"""Errors that repeat along an axis, read at positions that repeat likewise: they pass for something slower, or nothing.

Targets p apart see an error of period P as one of period p / |p/P − round(p/P)|.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_FEWEST = 4
"""Targets below which no period can be told."""
_EQUAL = 1e-3
"""Share of the distance: targets are set to micrometres, and nobody sets them uneven by less than a percent."""
_SAME_PHASE = 0.9
"""Of a circle's mean: all targets within about 26 deg of the same phase."""
_SAME_PLACE = 1e-6
"""Share of the travel: rounding of a position."""


@dataclass(frozen=True, slots=True)
class Alias:
    """Positions on an axis that hide what repeats.

    spacing : of the targets, m or rad, None where they are not equally spaced
    error, period : the error whose period is stated; seen_as : the one it passes for, m or rad, infinite for a constant
    """

    axis: Axis
    spacing: float | None
    error: str
    period: float
    seen_as: float


def aliases(machine: Machine, readings: Sequence[Reading]) -> Iterator[Alias]:
    """Yield what the positions of the readings hide, for the axes that moved."""
    for index, axis in enumerate(machine.axes):
        targets = _targets([reading.pose[index] for reading in readings], axis)
        if len(targets) < _FEWEST:
            continue
        spacing = _spacing(targets)
        for entry in machine.errors:
            period = entry.period if entry.axis == axis.name else None
            if period is not None and (spacing is not None or _in_phase(targets, period)):
                yield Alias(axis, spacing, entry.name, period, _seen_as(spacing, period))


def _targets(positions: Sequence[float], axis: Axis) -> Array:
    ordered = np.sort(np.array(positions))
    if not len(ordered):
        return ordered
    fresh = np.concatenate([[True], np.diff(ordered) > _SAME_PLACE * axis.length])
    targets: Array = ordered[fresh]
    return targets


def _spacing(targets: Array) -> float | None:
    gaps = np.diff(targets)
    mean = float(gaps.mean())
    return mean if float(np.ptp(gaps)) <= _EQUAL * mean else None


def _in_phase(targets: Array, period: float) -> bool:
    return abs(complex(np.exp(2j * np.pi * targets / period).mean())) > _SAME_PHASE


def _seen_as(spacing: float | None, period: float) -> float:
    if spacing is None:
        return np.inf
    turns = spacing / period
    left = abs(turns - round(turns))
    return float(spacing / left) if left > _EQUAL else np.inf
