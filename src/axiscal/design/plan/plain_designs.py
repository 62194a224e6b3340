"""Designs that need no thought: what a plan must never be worse than."""

from __future__ import annotations

import numpy as np

from axiscal.design.gains.covariance import Point
from axiscal.design.plan.task import Task
from axiscal.measurement.candidates import snapped, spread
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

Counts = list[tuple[int, int]]
"""(set-up, number of readings) for each set-up in use."""


def space_filling(problem: Task, counts: Counts) -> list[Point]:
    """Return so many readings per set-up, spread over everything that may move."""
    machine = problem.observation.errors.machine
    result = []
    for index, count in counts:
        part = spread(machine, (problem.observation.setups[index],), max(count, 2))
        result += [Point(index, part.poses[i], part.approaches[i]) for i in range(count)]
    return result


def evenly_spaced(problem: Task, counts: Counts) -> list[Point]:
    """Return so many readings per set-up, the usual way: one axis at a time from end to end, the others parked."""
    machine = problem.observation.errors.machine
    result = []
    for index, count in counts:
        setup = problem.observation.setups[index]
        shares = np.array_split(np.arange(count), len(setup.moves))
        for axis, share in zip(setup.moves, shares, strict=True):
            poses = np.tile(np.array(setup.park), (len(share), 1))
            poses[:, axis] = (
                np.linspace(*setup.span(machine.axes[axis], axis), len(share)) if len(share) > 1 else setup.park[axis]
            )
            poses = snapped(machine, setup, poses)
            result += [Point(index, pose, _approach(setup, i)) for i, pose in enumerate(poses)]
    return result


def _approach(setup: Setup, number: int) -> Array:
    """Return the approach of the number-th reading; where both are allowed they take turns."""
    sign = {"+": 1.0, "-": -1.0, "both": 1.0 if number % 2 == 0 else -1.0}[setup.approach]
    result = np.zeros(len(setup.park))
    result[list(setup.moves)] = sign
    return result
