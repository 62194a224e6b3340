"""Where the axes go while an instrument is in touch, as poses close to each other."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from axiscal.exceptions import ProgramError
from axiscal.gcode.kept_out import KeptOut
from axiscal.machine.description import Machine
from axiscal.machine.inverse import drawn_back
from axiscal.machine.motion import LARGEST_TURN
from axiscal.measurement.charts.arrivals import KNOWN, begun
from axiscal.measurement.charts.chart import Chart
from axiscal.measurement.charts.room import Room
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array

_BACK = (0.05, 0.02, 0.01, 0.005)
"""m, how far the tool is drawn back before and after: as far as the travels allow."""
_OUT = (0.1, 0.2, 0.3)
"""m, how far where something is to be kept out, and none of those leads clear of it."""
_SAG = 0.01
"""Share of its stroke by which a bar may be shorter in the middle of a chord."""
_TURN = math.radians(3.0)
"""Of the axes where nothing is in touch: at half a metre the chord is 0.2 mm nearer."""
_SLACK = 1e-9
"""m or rad: rounding."""

Entrance = tuple[Array, Array, Array]
"""Poses from where the tool point begins to be held, (p, q); the last of them, drawn back; in touch, (q,)."""


class Ways:
    """The ways of one set-up.

    from_zero : rotary axes must stand at zero when the control begins to hold the tool point
    clear : index of the axis that goes clear before others turn, and where it is clear, m
    """

    def __init__(
        self, machine: Machine, setup: Setup, chart: Chart, from_zero: bool, clear: tuple[int, float] | None
    ) -> None:
        self._machine, self._setup, self.chart, self._from_zero = machine, setup, chart, from_zero
        self._clear = clear
        self._room = Room.with_boxes(machine, () if setup.artefact is None else setup.artefact.keep_out)
        self._kept = KeptOut(self._room)
        self._ends = [chart.bounds(number) for number in range(chart.size)]

    def comes_right(self, here: Array, there: Array, side: Array) -> bool:
        """Whether a straight way comes from the right side over the whole overrun, and so do the axes that follow.

        These go by its slant: coming far along one coordinate and hardly along another a slide may come from elsewhere.
        """
        overrun, gone, asked = np.array([end.overrun for end in self._ends]), there - here, side != 0
        if not np.all(~asked | (gone * side >= overrun - _SLACK)):
            return False
        last = float(np.max(overrun[asked] / np.abs(gone[asked]), initial=0.0))
        start = begun(self.chart, there[None], side[None])
        at, slanted, begin = self.chart.poses(np.vstack([there, there - last * gone, start]))
        known = KNOWN * np.array([axis.overrun for axis in self._machine.axes])
        return bool(np.all((np.abs(at - begin) < known) | ((at - slanted) * np.sign(at - begin) >= known)))

    def legs(self, here: Array, there: Array) -> Array | None:
        """Return over which places (k, size) a way goes in touch; None where there is none."""
        return self.chart.between(here, there)

    def poses_along(self, start: Array, stop: Array) -> Array:
        """Return poses between which the control may go straight, both ends among them, (p, q)."""
        count = max(1, math.ceil(float(np.max(np.abs(stop - start), initial=0.0)) / self._step - 1e-9))
        return self.chart.poses(start + np.linspace(0.0, 1.0, count + 1)[:, None] * (stop - start))

    @property
    def _step(self) -> float:
        """How far a coordinate goes in one move, rad: a long turn, or a chord that hardly leaves the circle."""
        if self._setup.length is None:
            return LARGEST_TURN
        return math.sqrt(8 * _SAG * (self._setup.stroke or 1e-3) / self._setup.length)

    def entrance(self, place: Array) -> Entrance:
        """Return how a place u is come to from where nothing is in touch.  Raises ProgramError where it cannot be."""
        pose = self.chart.poses(place[None])[0]
        boxes = len(self._room.keep_out) > 0
        for far in (*_BACK, *(_OUT if boxes else ())):
            drawn = drawn_back(self._machine, pose[None], far)[0]
            way = self._from_zeros(drawn) if self._from_zero else drawn[None]
            if self._room.in_travel(way).all() and (not boxes or self._leads_out(way, pose)):
                return way, drawn, pose
        beside = ", beside what is to be kept out," if boxes else ""
        what = f'"{self._setup.name}": the tool cannot be drawn back{beside} within the travels where its way begins or'
        raise ProgramError(f"{what} ends", "Read nearer to the middle of the travels, or move the artefact")

    def _leads_out(self, way: Array, pose: Array) -> bool:
        """Return whether nothing is in the way from where it is clear to a pose in touch.  way : (p, q), as the gate"""
        clear = way[0].copy()
        if self._clear is not None:
            clear[self._clear[0]] = self._clear[1]
        pairs = all(self._kept.free_held(start, stop) for start, stop in pairwise([*way, pose]))
        return pairs and self._kept.free(clear, way[0])

    def _from_zeros(self, drawn: Array) -> Array:
        """Return poses from rotary axes at zero to a pose, turning where it is clear, (p, q)."""
        assert self._clear is not None  # a tool point is held by X, Y and Z, and Z goes clear unless another is said
        above = drawn.copy()
        above[self._clear[0]] = self._clear[1]
        rotary = np.array([axis.rotary for axis in self._machine.axes])
        turned = _between(np.where(rotary, 0.0, above), above)
        return np.concatenate([turned, _between(above, drawn)[1:]])


def _between(start: Array, stop: Array) -> Array:
    count = max(1, math.ceil(float(np.abs(stop - start).max()) / _TURN))
    return start + np.linspace(0.0, 1.0, count + 1)[:, None] * (stop - start)
