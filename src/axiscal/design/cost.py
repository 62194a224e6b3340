"""What a calibration costs: seconds of machine time for mounting, travel, settling and reading."""

from __future__ import annotations

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


def travel_seconds(machine: Machine, start: Array, stop: Array) -> Array:
    """Return the time of straight moves; the slowest axis decides.  start, stop : (..., q) m or rad; returns (...,).

    Each axis accelerates, cruises if the way is long enough, and brakes: d/v + v/a, or 2 √(d/a) on a short way.
    """
    distance = np.abs(np.asarray(stop) - np.asarray(start))
    speed = np.array([axis.speed for axis in machine.axes])
    acceleration = np.array([axis.acceleration for axis in machine.axes])
    long = distance >= speed**2 / acceleration
    cruise = distance / speed + speed / acceleration
    seconds: Array = np.where(long, cruise, 2 * np.sqrt(distance / acceleration)).max(axis=-1)
    return seconds


OVERRUN_LENGTH = 1e-3
OVERRUN_ANGLE = 0.0087266462599716477
"""How far past its target an axis goes to come back from the right side: 1 mm, 0.5 deg."""


def overruns(machine: Machine) -> Array:
    """Return the overrun of each axis, (q,) m or rad."""
    return np.array([OVERRUN_ANGLE if axis.rotary else OVERRUN_LENGTH for axis in machine.axes])


def approach_seconds(machine: Machine, start: Array, stop: Array, approach: Array) -> Array:
    """Return the time of moves that arrive from the stated sides.  approach : (..., q) of +1, −1, 0 for any side.

    An axis that would not arrive over at least its overrun in the stated direction first goes past its target.
    """
    overrun = overruns(machine)
    wrong = (approach != 0) & ((np.asarray(stop) - np.asarray(start)) * approach < overrun)
    turning = np.where(wrong, stop - approach * overrun, stop)
    straight = travel_seconds(machine, start, turning)
    seconds: Array = straight + np.where(np.any(wrong, axis=-1), travel_seconds(machine, turning, stop), 0.0)
    return seconds


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def visit_seconds(machine: Machine, setup: Setup, before: Array | None, pose: Array) -> float:
    """Return the time of one reading, from the pose before it in the same set-up; None: the set-up is mounted first."""
    if before is None:
        return setup.setup_time + reading_seconds(setup)
    return float(travel_seconds(machine, before, pose)) + reading_seconds(setup)
