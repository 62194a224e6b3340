"""Readings that were taken with tables in the control, less what these add: what they would have shown without.

A control with tables sends the axes elsewhere, and the nominal tool moves by what that does; a reading shows it as it
shows any other motion of the tool, by the direction in which it looks. To first order: the machine's own errors are
those of the place that was asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames, turn_between
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.observation import directions_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array


def without_tables(
    readings: Sequence[Reading], machine: Machine, setups: Sequence[Setup], control: Control
) -> list[Reading]:
    """Return readings less what a control adds to each of their numbers.  setups : of the campaign, by name"""
    named = {setup.name: setup for setup in setups}
    found = list[Reading]()
    for reading in readings:
        added = _added(reading, machine, named[reading.setup], control)
        value, *others = (value - float(each) for value, each in zip(reading.values, added, strict=True))
        found.append(replace(reading, value=value, others=tuple(others)))
    return found


def _added(reading: Reading, machine: Machine, setup: Setup, control: Control) -> Array:
    """Return what the control adds to each number of a reading, m or rad."""
    pose, approach = np.array([reading.pose]), np.array([reading.approach], dtype=float)
    before, after = frames(machine, pose), frames(machine, pose + control(pose, approach))
    each = directions_of(setup)
    if setup.base is not None:  # what stands on a way shows the way's own shape, wherever the control sends the axes
        return np.zeros(len(each))
    model = model_of(setup)
    moved = after.tcp - before.tcp if model.reads == "length" else turn_between(before.tool, after.tool)
    nominal = Nominal(machine, pose, setup.moves, approaches=approach)
    ways = [model.direction_of(setup, np.array(setup.direction) if d is None else d, nominal)[0] for d in each]
    added: Array = np.array(ways) @ moved[0]
    return added
