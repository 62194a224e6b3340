"""What a calibration costs: seconds of machine time for mounting, travel, settling and reading."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array


def reading_seconds(setup: Setup) -> float:
    """Return what one reading takes beside the way to it."""
    return setup.settle + setup.reading_time


def visit_seconds(
    machine: Machine, setup: Setup, before: Array | None, pose: Array, approach: Sequence[int] = ()
) -> float:
    """Return the time of one reading, from the pose before it in the same set-up; None: the set-up is mounted first.

    approach : (q,) +1, −1, 0 for any side; left out for any
    """
    if before is None:
        return setup.setup_time + reading_seconds(setup)
    sides = np.array(approach, dtype=float) if approach else np.zeros(len(pose))
    return float(way_seconds(machine, setup, before, pose, sides)) + reading_seconds(setup)


def travel_table(machine: Machine, setup: Setup, poses: Array, approaches: Array) -> Array:
    """Return the seconds from each pose of a set-up to each, overrun included, (m, m).

    approaches : (m, q), 0 where any side will do; in touch as if every way could be straight, to put them in order
    """
    return way_seconds(machine, setup, poses[:, None], poses[None], approaches[None], straight=True)
