"""Rotary axes that turn on: LinuxCNC does not repeat a table after a turn, so it holds the turns themselves.

Beyond its ends a `COMP_FILE` is constant, and a joint counts on after 360 deg, with WRAPPED_ROTARY as well.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from axiscal.compensation.controllers.linuxcnc.reader import ROWS
from axiscal.compensation.sampling import own_table
from axiscal.compensation.table import CompensationTable
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.numerics import Array

MOST_TURNS = 5
"""256 rows hold five turns of 51 points."""


def one_turn(estimate: Estimate, table: CompensationTable) -> CompensationTable:
    """Return the table of a full-turn axis on as few points that all its turns fit; any other table as it is."""
    axis = estimate.machine.axis(table.axis)
    fits = (ROWS - 1) // (sum(turns(axis)) + 1)
    if not axis.cyclic or len(table.positions) - 1 <= fits:
        return table
    return own_table(estimate, estimate.machine.index(axis.name), np.linspace(*axis.travel, fits + 1), uneven=True)


def over_turns(table: CompensationTable, machine: Machine) -> CompensationTable:
    """Return a table of one turn repeated over the turns that its axis may make; any other table as it is."""
    axis = machine.axis(table.axis)
    whole = axis.cyclic and np.allclose(table.positions[[0, -1]], axis.travel)
    return _repeated(table, *turns(axis)) if whole else table


def turns(axis: Axis) -> tuple[int, int]:
    """Return the turns below and above the travel that a table holds: two each where nobody said, never over five."""
    below, above = axis.stated_turns or (MOST_TURNS // 2, MOST_TURNS // 2)
    spare = MOST_TURNS - 1
    low = min(below, max(spare // 2, spare - above))
    return low, min(above, spare - low)


def _repeated(table: CompensationTable, below: int, above: int) -> CompensationTable:
    """Return the table over whole turns; the end of one is the beginning of the next."""
    shifts = 2 * np.pi * np.arange(-below, above + 1)

    def again(values: Array) -> Array:
        return np.append(np.tile(values[:-1], len(shifts)), values[-1])

    at = np.append((shifts[:, None] + table.positions[:-1]).ravel(), shifts[-1] + table.positions[-1])
    silent = np.append(np.tile(table.prior_only[:-1], len(shifts)), table.prior_only[-1])
    columns = (again(values) for values in (table.forward, table.reverse, table.std))
    forward, reverse, std = columns
    return replace(table, positions=at, forward=forward, reverse=reverse, std=std, prior_only=silent)
