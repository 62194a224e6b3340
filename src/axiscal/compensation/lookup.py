"""What most controls do with a table: look a position up, linear between points, constant outside, and move an axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.compensation.effect import Control
from axiscal.machine.description import Machine
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Lookup:
    """A table as a control has understood it.

    axis : that is moved; over : whose position is looked up
    positions : (n,) increasing, added : (n,) what is added to the command of `axis`, m or rad
    direction : 0 for both, else only after moving upwards (+1) or downwards (-1)
    """

    axis: str
    over: str
    positions: Array
    added: Array
    direction: int = 0

    def at(self, position: Array, approach: Array) -> Array:
        """Return what is added at positions (m,) of `over` that were approached from a side, (m,)."""
        value = np.interp(position, self.positions, self.added)
        return value if not self.direction else np.where(np.sign(approach) == self.direction, value, 0.0)


def lookup_control(machine: Machine, lookups: Sequence[Lookup]) -> Control:
    """Return the control that adds all of them."""

    def control(poses: Array, approaches: Array) -> Array:
        added = np.zeros_like(poses)
        for each in lookups:
            over = machine.index(each.over)
            added[:, machine.index(each.axis)] += each.at(poses[:, over], approaches[:, over])
        return added

    return control
