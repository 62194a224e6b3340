"""The volume where parts are: a cylinder or a box in the workpiece frame, and poses with the tool point in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.machine.description import Machine
from axiscal.machine.inverse import tip_at
from axiscal.measurement.charts.room import Room
from axiscal.numerics import Array
from axiscal.numerics.spread import even_points

Span = tuple[float, float]
POSES = 4000
_TRIED = 16
"""How many times more places are tried than are wanted before fewer are returned."""


@dataclass(frozen=True, slots=True)
class PartVolume:
    """Where the work is done.

    spans : along x, y, z, m, workpiece frame; radius : of a cylinder about z instead of the spans along x and y, m
    turns : (rotary axes,) the range in which each turns, rad, in chain order
    """

    spans: tuple[Span, Span, Span]
    radius: float | None
    turns: tuple[Span, ...]

    def poses(self, machine: Machine, count: int = POSES) -> Array:
        """Return up to so many poses within the travels, spread evenly over places of the part and turns, (m, q)."""
        unit = even_points(_TRIED * count, 3 + len(self.turns))
        park = np.zeros((len(unit), len(machine.axes)))
        park[:, [not axis.rotary for axis in machine.axes]] = [sum(a.travel) / 2 for a in machine.axes if not a.rotary]
        low, high = np.array(self.turns).reshape(-1, 2).T
        park[:, [axis.rotary for axis in machine.axes]] = low + (high - low) * unit[:, 3:]
        found = tip_at(machine, park, self._points(unit[:, :3]))
        reachable: Array = found[Room.empty(machine).in_travel(found)][:count]
        return reachable

    def _points(self, unit: Array) -> Array:
        low, high = np.array(self.spans).T
        points: Array = low + (high - low) * unit
        if self.radius is not None:
            far, turn = self.radius * np.sqrt(unit[:, 0]), 2 * np.pi * unit[:, 1]
            points[:, 0], points[:, 1] = far * np.cos(turn), far * np.sin(turn)
        return points
