"""Two ways to drive along poses in touch: the control holds the tool point, or slides go straight together.

On every way of a program, as the control goes it, tool, holder and nose stay out of what stands there (`free_way`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from itertools import pairwise

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import ProgramError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames, tip_at
from axiscal.measurement.charts.room import Room
from axiscal.measurement.charts.ways import free_way
from axiscal.measurement.setup import Setup
from axiscal.measurement.travel import path_seconds
from axiscal.numerics import Array
from axiscal.programs.scale import AxisScale, Decimals, exact
from axiscal.programs.steps import FASTEST, Arrival, Glide, Hold, Move, ProgramAxes, Release, Step
from axiscal.units import from_unit, to_unit

_LIMIT = 2e-6
"""m, by which a way may enter a box: angles are written with four decimals, and some controls take three."""

Poses = Callable[[Array], Array]
"""Shares of a way (m,) -> poses (m, q)."""


def free(room: Room, start: Array, stop: Array) -> bool:
    """Return whether the axes can go straight from pose to pose, (q,), and stay out of what is to be kept out."""
    return free_way(room, _straight(np.stack([start, stop])), _turn(room.machine, start, stop), _LIMIT)


def free_held(room: Room, start: Array, stop: Array) -> bool:
    """Return whether the tool point can go straight while the rotary axes turn evenly, from pose to pose."""
    return free_way(room, held_way(room.machine, start, stop), _turn(room.machine, start, stop), _LIMIT)


def _turn(machine: Machine, start: Array, stop: Array) -> float:
    return float(np.abs(stop - start)[[axis.rotary for axis in machine.axes]].sum())


def _straight(ends: Array) -> Poses:
    """Return what goes straight from the first to the last.  ends : (2, k)"""
    return lambda shares: np.asarray(ends[0] + shares[:, None] * (ends[1] - ends[0]), dtype=np.float64)


def held_way(machine: Machine, start: Array, stop: Array) -> Poses:
    """Return the way of a tool point that goes straight while the rotary axes turn evenly, from pose to pose (q,)."""
    ends = np.stack([start, stop])
    turned, along = _straight(ends), _straight(frames(machine, ends).tcp)
    return lambda shares: tip_at(machine, turned(shares), along(shares))


def refuse_kept_out(
    machine: Machine, setup: Setup, balls: Mapping[int, int], scales: Sequence[AxisScale], run: Sequence[Step]
) -> None:
    """Raise ProgramError for the first way of a program that leads into what stands there.

    balls : by the number of each reading, the one that it touches
    Ways on which it is not known where every axis is, before all of them have been sent somewhere, are not looked at.
    """
    pending = False
    for step, clear in zip(run, free_ways(machine, setup, balls, scales, run), strict=True):
        pending = pending or not clear
        if isinstance(step, Arrival) and pending:
            raise _hit(setup, said("the way to reading {number}", number=step.target.number))
    if pending:
        raise _hit(setup, said("the way from the last reading"))


def _hit(setup: Setup, way: str) -> ProgramError:
    what = "{way} of the set-up {setup} leads into {artefact}: into a ball, a post, or what is to be kept out"
    remedy = (
        "Say what goes clear before others move (--clearance), read the place from another side, move the artefact, or "
        "correct length, reach, radius and head in [tool]"
    )
    artefact = shown(setup.artefact.name if setup.artefact else "")
    return ProgramError(what, remedy, way=way, setup=shown(setup.name), artefact=artefact)


def _rooms(machine: Machine, setup: Setup, balls: Mapping[int, int], run: Sequence[Step]) -> Iterator[Room]:
    """Yield the room of each step: the tool may come to the ball of the reading before it, and of the one after it."""
    behind, ahead = list[int](), [balls[step.target.number] for step in run if isinstance(step, Arrival) and balls]
    room = None
    for step in run:
        if isinstance(step, Arrival) and balls:
            behind, ahead, room = ahead[:1], ahead[1:], None
        room = room or Room.among(machine, setup.artefact, {*behind, *ahead[:1]}, setup.contact != "retracted")
        yield room


def free_ways(
    machine: Machine, setup: Setup, balls: Mapping[int, int], scales: Sequence[AxisScale], run: Sequence[Step]
) -> Iterator[bool]:
    """Yield of each step whether its way is free."""
    names = [scale.axis.name for scale in scales]
    at, tip = np.full(len(scales), np.nan), dict[str, float]()
    for step, room in zip(run, _rooms(machine, setup, balls, run), strict=True):
        before = at.copy()
        match step:
            case Hold():
                tip = _metres(step.at)
                yield True
            case Glide():
                to = dict(step.to)
                tip |= _metres([(name, text) for name, text in step.to if name in tip])
                _send(at, {k: to[name] for k, name in enumerate(names) if scales[k].axis.rotary and name in to}, scales)
                at = tip_at(room.machine, at[None], np.array([[tip[name] for name in "XYZ"]]))[0]
                yield not room.occupied or free_held(room, before, at)
            case Move() | Release():
                _send(at, step.to if isinstance(step, Move) else {names.index(n): text for n, text in step.at}, scales)
                known = np.all(np.isfinite(before)) and not np.all(before == at)
                yield not (known and room.occupied) or free(room, before, at)
            case _:
                yield True


def _send(at: Array, to: Mapping[int, Decimal] | Mapping[int, str], scales: Sequence[AxisScale]) -> None:
    """Put axes where a program sends them, in place.  at : (q,) m or rad"""
    for axis, value in to.items():
        at[axis] = from_unit(float(value), scales[axis].unit)


def _metres(words: Sequence[tuple[str, str]]) -> dict[str, float]:
    return {name: from_unit(float(text), "mm") for name, text in words}


GENTLE = 500
"""mm/min, into touch and out of it, where no feed near the place is asked for."""
_SAMPLES = 33
"""Places along a move, for how fast the axes may go and whether they stay within their travels."""

Words = tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class SlideDriver:
    """Drives along poses that are close to each other: linear axes go together, and no rotary axis turns.

    standing : where the axes stand, None before the first way; holding : whether the control holds the tool point
    Each way returns the driver that stands at its end.
    """

    axes: ProgramAxes
    standing: Decimals | None = None
    holding: bool = False

    def written(self, pose: Array) -> Decimals:
        """Return the axes of a pose in the numbers of the program; raises ProgramError outside the travel."""
        numbers = [scale.nearest(float(value)) for scale, value in zip(self.axes.scales, pose, strict=True)]
        for scale, number in zip(self.axes.scales, numbers, strict=True):
            if number is None:
                remedy = "Read nearer to the middle of the travels"
                raise ProgramError("a way in touch leaves the travel of {axis}", remedy, axis=scale.axis.name)
        return tuple(number for number in numbers if number is not None)

    def begin(self, pose: Array) -> Way:
        """Yield the way to the start; what goes clear does so before the others move."""
        there = self.written(pose)
        if self.standing is None:
            yield from self.axes.to_the_start(there)
            return replace(self, standing=there)
        driver = self
        for stop in (self.axes.cleared(self.standing), self.axes.cleared(there), there):
            driver = yield from driver._move(stop)
        return driver

    def along(self, poses: Array, gently: bool = False) -> Way:
        """Yield straight moves; raises ProgramError where the axes that move are not in one group."""
        driver = self
        for pose in poses[1:]:
            stop = self.written(pose)
            moving = {k for k, (a, b) in enumerate(zip(driver._stood, stop, strict=True)) if a != b}
            if not any(moving <= set(group.axes) for group in self.axes.groups):
                names = " ".join(self.axes.scales[k].axis.name for k in sorted(moving))
                remedy = "Let them be in one group"
                raise ProgramError("{names} move together while the instrument is in touch", remedy, names=names)
            driver = yield from driver._move(stop, gently)
        return driver

    def end(self) -> Way:
        """Nothing is to be done."""
        yield from ()
        return self

    def cleared(self) -> Way:
        """Yield the way of the axis that goes clear."""
        return (yield from self._move(self.axes.cleared(self._stood)))

    @property
    def _stood(self) -> Decimals:
        assert self.standing is not None, "every way begins with `begin`"
        return self.standing

    def _move(self, stop: Decimals, gently: bool = False) -> Way:
        yield from self.axes.moves(self._stood, stop, stop if gently else None)
        return replace(self, standing=stop)


@dataclass(frozen=True, eq=False, kw_only=True)
class TipDriver(SlideDriver):
    """The control holds the tool point on the workpiece while rotary axes turn.

    step : the last decimal of a place of the tool point, mm; gentle : feed into touch and out of it, mm/min
    at : the pose of the tool while it is held; last : what was written of each axis since
    """

    machine: Machine
    step: Decimal
    gentle: int
    at: Array | None = None
    last: Mapping[str, str] = field(default_factory=dict)

    def begin(self, pose: Array) -> Way:
        """Yield the way to the gate, where the tool point begins to be held."""
        driver = yield from super().begin(pose)
        yield Hold(self._tip(pose))
        return replace(self, standing=driver.standing, holding=True, at=pose, last={})

    def along(self, poses: Array, gently: bool = False) -> Way:
        """Yield straight moves of the tool point; raises ProgramError where an axis would leave its travel."""
        last = dict(self.last)
        for start, stop in pairwise(poses):
            if words := tuple((name, text) for name, text in self._words(stop) if last.get(name) != text):
                yield Glide(words, *self._feed(start, stop, gently))
                last |= dict(words)
        return replace(self, at=poses[-1], last=last)

    def end(self) -> Way:
        """Yield the end of holding, where the axes are: from there they go on in the machine's coordinates."""
        assert self.at is not None, "every way begins with `begin`"
        at = self.written(self.at)
        named = zip(self.machine.axes, self.axes.scales, at, strict=True)
        yield Release(tuple((axis.name, scale.written(value)) for axis, scale, value in named if not axis.rotary))
        return replace(self, standing=at, holding=False)

    @property
    def _rotary(self) -> list[int]:
        return [k for k, axis in enumerate(self.machine.axes) if axis.rotary]

    def _words(self, pose: Array) -> Words:
        turned = ((self.axes.scales[k], self.written(pose)[k]) for k in self._rotary)
        return (*self._tip(pose), *((scale.axis.name, scale.written(value)) for scale, value in turned))

    def _tip(self, pose: Array) -> Words:
        point = frames(self.machine, pose[None]).tcp[0]
        texts = (exact(to_unit(float(value), "mm")).quantize(self.step) + 0 for value in point)
        return tuple((name, f"{text:f}") for name, text in zip("XYZ", texts, strict=True))

    def _feed(self, start: Array, stop: Array, gently: bool) -> tuple[int, float]:
        """Return feed and time of a move whose tool point goes straight and whose rotary axes turn evenly."""
        ends = frames(self.machine, np.stack([start, stop])).tcp
        path = held_way(self.machine, start, stop)(np.linspace(0.0, 1.0, _SAMPLES))
        if not np.all(Room.empty(self.machine).in_travel(path)):
            raise ProgramError("a way in touch leaves the travels", "Read nearer to the middle of the travels")
        seconds = float(path_seconds(self.machine, path[:, None])[0])
        far = to_unit(float(np.linalg.norm(ends[1] - ends[0])), "mm")
        turned = to_unit(float(np.linalg.norm((stop - start)[self._rotary])), "deg")
        length = far if far > float(self.step) else turned
        feed = max(1, min(math.floor(length / max(seconds, 1e-9) * 60), self.gentle if gently else FASTEST))
        return feed, max(seconds, length / feed * 60)


Way = Generator[Step, None, SlideDriver]
"""The steps of a way, and the driver behind it."""
