"""Designs that need no thought, where exchange begins: no plan may be worse than they are."""

from __future__ import annotations

import numpy as np

from axiscal.measurement.candidates import snapped, spread
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.planning.plan.task import Task
from axiscal_core.machine import Machine


def plain_designs(task: Task, counts: list[tuple[int, int]]) -> list[Places]:
    """Return the usual and the space-filling readings; once where every set-up is read on a chart, and both are one."""
    evenly, filling = evenly_spaced(task, counts), space_filling(task, counts)
    return [evenly] if evenly.same_as(filling) else [evenly, filling]


def space_filling(task: Task, counts: list[tuple[int, int]]) -> Places:
    """Return so many readings per set-up, spread over everything that may move."""
    machine, setups = task.observation.machine, task.observation.setups
    parts = [(index, count, spread(machine, (setups[index],), max(count, 2))) for index, count in counts]
    return Places.joined([Places.of_setup(i, part.poses[:count], part.approaches[:count]) for i, count, part in parts])


def evenly_spaced(task: Task, counts: list[tuple[int, int]]) -> Places:
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
    """Return poses and approaches of so many readings, shared between the axes that move, each (count, q).

    Where both sides are allowed they take turns.
    """
    shares = np.array_split(np.arange(count), len(setup.moves))
    lines = [_line(machine, setup, axis, len(share)) for axis, share in zip(setup.moves, shares, strict=True)]
    even = np.concatenate([np.arange(len(line)) for line in lines]) % 2 == 0
    approaches = np.zeros((count, len(setup.park)))
    approaches[:, list(setup.moves)] = np.where(even, setup.sides[0], setup.sides[-1])[:, None]
    return np.concatenate(lines), approaches


def _line(machine: Machine, setup: Setup, axis: int, count: int) -> Array:
    """Return poses from one end of an axis to the other, (count, q); one alone where it is parked."""
    poses = np.tile(np.array(setup.park), (count, 1))
    poses[:, axis] = np.linspace(*setup.span(machine.axes[axis], axis), count) if count > 1 else setup.park[axis]
    return snapped(setup, poses)
