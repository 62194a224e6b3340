"""Two ways to drive along poses in touch: the control holds the tool point, or slides go straight together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from decimal import Decimal
from itertools import pairwise
from typing import Protocol

import numpy as np

from axiscal.exceptions import ProgramError
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.room import Room
from axiscal.measurement.travel import path_seconds
from axiscal.numerics import Array
from axiscal.programs.groups import FASTEST, Group
from axiscal.programs.kept_out import held_way
from axiscal.programs.scale import AxisScale, Decimals, exact
from axiscal.programs.steps import Clearance, Glide, Hold, Release, Step, cleared, moves, to_the_start
from axiscal.units import to_unit

GENTLE = 500
"""mm/min, into touch and out of it, where no feed near the place is asked for."""
_SAMPLES = 33
"""Places along a move, for how fast the axes may go and whether they stay within their travels."""

Words = tuple[tuple[str, str], ...]


class Driver(Protocol):
    """Drives along poses that are close to each other."""

    @property
    def holding(self) -> bool:
        """Whether the control holds the tool point now."""

    def written(self, pose: Array) -> Decimals:
        """Return the axes of a pose in the numbers of the program."""

    def begin(self, pose: Array) -> Iterator[Step]:
        """Yield the way from wherever the axes stand to a pose at which nothing is in touch."""

    def along(self, poses: Array, gently: bool = False) -> Iterator[Step]:
        """Yield straight moves through poses (p, q), from the first, at which the axes stand."""

    def end(self) -> Iterator[Step]:
        """Yield what is to be done when nothing is in touch any more."""

    def cleared(self) -> Iterator[Step]:
        """Yield the way to where the axes are clear."""


class SlideDriver:
    """Linear axes go together, in the machine's coordinates; no rotary axis turns."""

    def __init__(self, scales: Sequence[AxisScale], groups: Sequence[Group], clearance: Clearance | None) -> None:
        self._scales, self._groups, self._clearance = scales, groups, clearance
        self._standing: Decimals | None = None
        self.holding = False

    def written(self, pose: Array) -> Decimals:
        """Return the axes of a pose in the numbers of the program; raises ProgramError outside the travel."""
        numbers = [scale.nearest(float(value)) for scale, value in zip(self._scales, pose, strict=True)]
        for scale, number in zip(self._scales, numbers, strict=True):
            if number is None:
                remedy = "Read nearer to the middle of the travels"
                raise ProgramError("a way in touch leaves the travel of {axis}", remedy, axis=scale.axis.name)
        return tuple(number for number in numbers if number is not None)

    def stands(self, pose: Array) -> Decimals:
        """Return the axes of a pose, at which something else has brought them."""
        self._standing = self.written(pose)
        return self._standing

    def begin(self, pose: Array) -> Iterator[Step]:
        """Yield the way to the start; what goes clear does so before the others move."""
        there = self.written(pose)
        if self._standing is None:
            yield from to_the_start(there, self._scales, self._groups, self._clearance)
            self._standing = there
            return
        for stop in (cleared(self._standing, self._clearance), cleared(there, self._clearance), there):
            yield from self._move(stop)

    def along(self, poses: Array, gently: bool = False) -> Iterator[Step]:
        """Yield straight moves; raises ProgramError where the axes that move are not in one group."""
        for pose in poses[1:]:
            stop = self.written(pose)
            self._refuse_apart(stop)
            yield from self._move(stop, gently)

    def end(self) -> Iterator[Step]:
        """Nothing is to be done."""
        yield from ()

    def cleared(self) -> Iterator[Step]:
        """Yield the way of the axis that goes clear."""
        yield from self._move(cleared(self._stood, self._clearance))

    @property
    def _stood(self) -> Decimals:
        assert self._standing is not None, "every way begins with `begin`"
        return self._standing

    def _move(self, stop: Decimals, gently: bool = False) -> Iterator[Step]:
        yield from moves(self._stood, stop, self._scales, self._groups, stop if gently else None)
        self._standing = stop

    def _refuse_apart(self, stop: Decimals) -> None:
        moving = {k for k, (a, b) in enumerate(zip(self._stood, stop, strict=True)) if a != b}
        if not any(moving <= set(group.axes) for group in self._groups):
            names = " ".join(self._scales[k].axis.name for k in sorted(moving))
            remedy = "Let them be in one group"
            raise ProgramError("{names} move together while the instrument is in touch", remedy, names=names)


class TipDriver:
    """The control holds the tool point on the workpiece while rotary axes turn.

    step : the last decimal of a place of the tool point, mm; gentle : feed into touch and out of it, mm/min
    """

    def __init__(
        self, machine: Machine, slides: SlideDriver, scales: Sequence[AxisScale], step: Decimal, gentle: int
    ) -> None:
        self._machine, self._slides, self._scales, self._step, self._gentle = machine, slides, scales, step, gentle
        self._room, self._rotary = Room.empty(machine), [k for k, axis in enumerate(machine.axes) if axis.rotary]
        self._last: dict[str, str] = {}
        self._at: Array | None = None

    @property
    def holding(self) -> bool:
        """Whether the control holds the tool point now."""
        return self._at is not None

    def written(self, pose: Array) -> Decimals:
        """Return the axes of a pose in the numbers of the program."""
        return self._slides.written(pose)

    def begin(self, pose: Array) -> Iterator[Step]:
        """Yield the way to the gate, where the tool point begins to be held."""
        yield from self._slides.begin(pose)
        self._at, self._last = pose, {}
        yield Hold(self._tip(pose))

    def along(self, poses: Array, gently: bool = False) -> Iterator[Step]:
        """Yield straight moves of the tool point; raises ProgramError where an axis would leave its travel."""
        for start, stop in pairwise(poses):
            words = self._changed(stop)
            if words:
                feed, seconds = self._feed(start, stop, gently)
                yield Glide(words, feed, seconds)
        self._at = poses[-1]

    def end(self) -> Iterator[Step]:
        """Yield the end of holding, where the axes are: from there they go on in the machine's coordinates."""
        assert self._at is not None, "every way begins with `begin`"
        at = self._slides.stands(self._at)
        named = zip(self._machine.axes, self._scales, at, strict=True)
        yield Release(tuple((axis.name, scale.written(value)) for axis, scale, value in named if not axis.rotary))
        self._at = None

    def cleared(self) -> Iterator[Step]:
        """Yield the way of the axis that goes clear."""
        yield from self._slides.cleared()

    def _changed(self, pose: Array) -> Words:
        turned = ((self._scales[k], self.written(pose)[k]) for k in self._rotary)
        words = (*self._tip(pose), *((scale.axis.name, scale.written(value)) for scale, value in turned))
        new = tuple((name, text) for name, text in words if self._last.get(name) != text)
        self._last |= dict(new)
        return new

    def _tip(self, pose: Array) -> Words:
        point = frames(self._machine, pose[None]).tcp[0]
        texts = (exact(to_unit(float(value), "mm")).quantize(self._step) + 0 for value in point)
        return tuple((name, f"{text:f}") for name, text in zip("XYZ", texts, strict=True))

    def _feed(self, start: Array, stop: Array, gently: bool) -> tuple[int, float]:
        """Return feed and time of a move whose tool point goes straight and whose rotary axes turn evenly."""
        ends = frames(self._machine, np.stack([start, stop])).tcp
        path = held_way(self._machine, start, stop)(np.linspace(0.0, 1.0, _SAMPLES))
        if not np.all(self._room.in_travel(path)):
            raise ProgramError("a way in touch leaves the travels", "Read nearer to the middle of the travels")
        seconds = float(path_seconds(self._machine, path[:, None])[0])
        far = to_unit(float(np.linalg.norm(ends[1] - ends[0])), "mm")
        turned = to_unit(float(np.linalg.norm((stop - start)[self._rotary])), "deg")
        length = far if far > float(self._step) else turned
        feed = max(1, min(math.floor(length / max(seconds, 1e-9) * 60), self._gentle if gently else FASTEST))
        return feed, max(seconds, length / feed * 60)
