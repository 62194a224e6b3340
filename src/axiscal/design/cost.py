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


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def visit_seconds(machine: Machine, setup: Setup, before: Array | None, pose: Array) -> float:
    """Return the time of one reading, from the pose before it in the same set-up; None: the set-up is mounted first."""
    if before is None:
        return setup.setup_time + reading_seconds(setup)
    return float(travel_seconds(machine, before, pose)) + reading_seconds(setup)
