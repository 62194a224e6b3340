"""A way in touch without a tool centre point mode: all axes together, in pieces so short that chords hardly leave it.

Linear and rotary axes have no feed in common, so each piece is given its time (G93). Between the ends of a piece of n
the tool point is off its ball, or off its straight way, by a chord's sag, which falls as 1/n².
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from axiscal.exceptions import ProgramError
from axiscal.gcode.gliding import SlideDriver
from axiscal.gcode.scale import AxisScale
from axiscal.gcode.steps import Evenly, Pieces, Step
from axiscal.gcode.targets import Decimals
from axiscal.machine.description import Machine
from axiscal.machine.inverse import tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.room import Room
from axiscal.measurement.travel import path_seconds
from axiscal.numerics import Array
from axiscal.units import from_unit

SAG = 0.1
"""Share of its stroke by which what touches may be off in the middle of a piece."""
_MOST = 4096
"""Pieces of one move: more are a way that no chords follow."""


class SegmentDriver:
    """All axes go together in the machine's coordinates, piece by piece.

    sag : m, by which the tool point may be off in the middle of a piece; gentle : feed into touch, mm/min
    """

    def __init__(
        self, machine: Machine, slides: SlideDriver, scales: Sequence[AxisScale], sag: float, gentle: int
    ) -> None:
        self._machine, self._slides, self._scales, self._sag, self._gentle = machine, slides, scales, sag, gentle
        self._room, self._at = Room.empty(machine), np.zeros(0)
        self.holding = False

    def written(self, pose: Array) -> Decimals:
        """Return the axes of a pose in the numbers of the program: slides follow the angles as these are written."""
        rotary = [k for k, axis in enumerate(self._machine.axes) if axis.rotary]
        numbers, turned = self._slides.written(pose), pose.copy()
        turned[rotary] = [from_unit(float(numbers[k]), "deg") for k in rotary]
        stands = tip_at(self._machine, turned[None], frames(self._machine, pose[None]).tcp)[0]
        low, high = np.array([axis.travel for axis in self._machine.axes]).T
        return self._slides.written(np.where(np.isfinite(stands), np.clip(stands, low, high), pose))

    def begin(self, pose: Array) -> Iterator[Step]:
        """Yield the way to where pieces begin."""
        yield from self._slides.begin(pose)
        self._at = pose
        yield Pieces(begin=True)

    def along(self, poses: Array, gently: bool = False) -> Iterator[Step]:
        """Yield pieces through poses (p, q); raises ProgramError where an axis would leave its travel."""
        for start, stop in pairwise(poses):
            way = self._cut(start, stop)
            seconds = self._seconds(way, gently) / (len(way) - 1)
            for pose in way[1:]:
                named = zip(self._machine.axes, self._scales, self.written(pose), strict=True)
                yield Evenly(tuple((axis.name, scale.written(at)) for axis, scale, at in named), seconds)
        self._at = poses[-1]

    def end(self) -> Iterator[Step]:
        """Yield the end of pieces."""
        self._slides.stands(self._at)
        yield Pieces(begin=False)

    def cleared(self) -> Iterator[Step]:
        """Yield the way of the axis that goes clear."""
        yield from self._slides.cleared()

    def _cut(self, start: Array, stop: Array) -> Array:
        """Return poses on a way between which axes may go straight, (n + 1, q)."""
        count = 1
        while count <= _MOST:
            fine = self._held(start, stop, 2 * count)
            chords = (fine[:-2:2] + fine[2::2]) / 2
            off = frames(self._machine, chords).tcp - frames(self._machine, fine[1::2]).tcp
            if float(np.linalg.norm(off, axis=1).max()) <= self._sag:
                if not np.all(self._room.in_travel(fine)):
                    raise ProgramError("a way in touch leaves the travels", "Read nearer to the middle of the travels")
                return fine[::2]
            count *= 2
        raise ProgramError("no short pieces follow this way in touch", "Read nearer to the middle of the travels")

    def _held(self, start: Array, stop: Array, count: int) -> Array:
        share = np.linspace(0.0, 1.0, count + 1)[:, None]
        ends = frames(self._machine, np.stack([start, stop])).tcp
        return tip_at(self._machine, start + share * (stop - start), ends[0] + share * (ends[1] - ends[0]))

    def _seconds(self, way: Array, gently: bool) -> float:
        """Return the time of a whole way from rest to rest."""
        fine = self._held(way[0], way[-1], max(32, 2 * (len(way) - 1)))
        far = float(np.linalg.norm(np.diff(frames(self._machine, way[[0, -1]]).tcp, axis=0)))
        slow = far / (self._gentle / 60e3) if gently else 0.0
        return max(float(path_seconds(self._machine, fine[:, None])[0]), slow, 1e-3)
