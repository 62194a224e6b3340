"""Designs that need no thought: what a plan must never be worse than."""

from __future__ import annotations

import numpy as np

from axiscal.machine.description import Machine
from axiscal.measurement.candidates import snapped, spread
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.planning.plan.task import Task

Counts = list[tuple[int, int]]
"""(set-up, number of readings) for each set-up in use."""


def plain_designs(task: Task, counts: Counts) -> list[Places]:
    """Return the usual and the space-filling readings; once where every set-up is read on a chart, and both are one."""
    evenly, filling = evenly_spaced(task, counts), space_filling(task, counts)
    return [evenly] if evenly.same_as(filling) else [evenly, filling]


def space_filling(task: Task, counts: Counts) -> Places:
    """Return so many readings per set-up, spread over everything that may move."""
    machine, setups = task.observation.machine, task.observation.setups
    parts = [(index, count, spread(machine, (setups[index],), max(count, 2))) for index, count in counts]
    return Places.joined([Places.of_setup(i, part.poses[:count], part.approaches[:count]) for i, count, part in parts])


def evenly_spaced(task: Task, counts: Counts) -> Places:
    """Return so many readings per set-up, the usual way: one axis at a time from end to end, the others parked."""
    machine, setups = task.observation.machine, task.observation.setups
    parts = [
        Places.of_setup(i, *_axis_by_axis(machine, setups[i], count))
        if setups[i].chart is None
        else space_filling(task, [(i, count)])
        for i, count in counts
    ]
    return Places.joined(parts)


def _axis_by_axis(machine: Machine, setup: Setup, count: int) -> tuple[Array, Array]:
    """Return poses and approaches of so many readings, shared between the axes that move, each (count, q)."""
    shares = np.array_split(np.arange(count), len(setup.moves))
    lines = [_line(machine, setup, axis, len(share)) for axis, share in zip(setup.moves, shares, strict=True)]
    numbers = np.concatenate([np.arange(len(line)) for line in lines])
    return np.concatenate(lines), _approaches(setup, numbers)


def _line(machine: Machine, setup: Setup, axis: int, count: int) -> Array:
    """Return poses from one end of an axis to the other, (count, q); one alone where it is parked."""
    poses = np.tile(np.array(setup.park), (count, 1))
    poses[:, axis] = np.linspace(*setup.span(machine.axes[axis], axis), count) if count > 1 else setup.park[axis]
    return snapped(machine, setup, poses)


def _approaches(setup: Setup, numbers: Array) -> Array:
    """Return the approaches (m, q) of readings by their numbers (m,); where both sides are allowed they take turns."""
    result = np.zeros((len(numbers), len(setup.park)))
    result[:, list(setup.moves)] = np.where(numbers % 2 == 0, setup.sides[0], setup.sides[-1])[:, None]
    return result
