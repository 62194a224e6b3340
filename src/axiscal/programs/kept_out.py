"""A proof that every way of a program, as the control goes it, stays out of the bodies to be kept out.

On a straight way of the axes a place of the tool goes at most as far as slides and turns carry it. Each turn counts at
the longest lever of the chain. With a held tool point this point and the turns of the tool set the limit. Pieces of a
way that are not proven to be free with that are halved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import ProgramError
from axiscal.language.spoken import said
from axiscal.machine.description import Machine
from axiscal.machine.inverse import tip_at
from axiscal.machine.kinematics import frames
from axiscal.measurement.charts.room import Room
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.programs.scale import AxisScale
from axiscal.programs.steps import Arrival, Glide, Hold, Move, Release, Step
from axiscal.units import from_unit

_LIMIT = 2e-6
"""m, by which a way may enter a box: angles are written with four decimals, and some controls take three."""
_MOST = 20_000
"""Pieces of one way: of time. Only a way that grazes a box for a long time needs more, and it is not gone."""

Poses = Callable[[Array], Array]
"""Shares of a way (m,) -> poses (m, q)."""


class KeptOut:
    """What the ways of one set-up stay out of."""

    def __init__(self, room: Room) -> None:
        self._room, self.machine = room, room.machine
        self._rotary = np.array([axis.rotary for axis in room.machine.axes])

    def free(self, start: Array, stop: Array) -> bool:
        """Return whether the axes can go straight from pose to pose, (q,)."""
        ends = np.stack([start, stop])
        slides, turns = (float(np.abs(stop - start)[these].sum()) for these in (~self._rotary, self._rotary))
        return self._proven(_straight(ends), slides + turns * (self._lever(ends) + slides))

    def free_held(self, start: Array, stop: Array) -> bool:
        """Return whether the tool point can go straight while the rotary axes turn evenly, from pose to pose."""
        ends = np.stack([start, stop])
        tips = frames(self.machine, ends).tcp
        turns = float(np.abs(stop - start)[self._rotary].sum())
        far = float(np.linalg.norm(tips[1] - tips[0])) + turns * self.machine.tool
        return self._proven(held_way(self.machine, start, stop), far)

    def _lever(self, poses: Array) -> float:
        """Return how far from any axis any place of the tool can be while the axes turn, m."""
        at = frames(self.machine, poses)
        corners = np.concatenate([at.origins, at.tcp[None]])
        links = np.linalg.norm(np.diff(corners, axis=0), axis=2).sum(axis=0)
        return float(links.max()) + self.machine.tool

    def _proven(self, poses: Poses, far: float) -> bool:
        """Return whether a way is free on which no place of the tool goes further than `far`, m."""
        left, right, tried = np.zeros(1), np.ones(1), 0
        while len(left):
            tried += len(left)
            at, widths = frames(self.machine, poses(np.concatenate([left, right]))), right - left
            if tried > _MOST or self._room.hit(at.tcp, at.stem, -_LIMIT).any():
                return False
            hit = self._room.hit(at.tcp, at.stem, np.tile(far * widths / 2 - _LIMIT, 2))
            open_ = (hit[: len(left)] | hit[len(left) :]) & (far * widths > _LIMIT)
            middle = (left[open_] + right[open_]) / 2
            left, right = np.concatenate([left[open_], middle]), np.concatenate([middle, right[open_]])
        return True


def _straight(ends: Array) -> Poses:
    """Return what goes straight from the first to the last.  ends : (2, k)"""
    return lambda shares: np.asarray(ends[0] + shares[:, None] * (ends[1] - ends[0]), dtype=np.float64)


def held_way(machine: Machine, start: Array, stop: Array) -> Poses:
    """Return the way of a tool point that goes straight while the rotary axes turn evenly, from pose to pose (q,)."""
    ends = np.stack([start, stop])
    turned, along = _straight(ends), _straight(frames(machine, ends).tcp)
    return lambda shares: tip_at(machine, turned(shares), along(shares))


def refuse_kept_out(kept: KeptOut, setup: Setup, scales: Sequence[AxisScale], run: Sequence[Step]) -> None:
    """Raise ProgramError for the first way of a program that leads into what is to be kept out.

    Ways on which it is not known where every axis is, before all of them have been sent somewhere, are not looked at.
    """
    follower, pending = _Follower(kept, scales), False
    for step in run:
        pending = pending or not follower.goes(step)
        if isinstance(step, Arrival) and pending:
            raise _hit(setup, said("the way to reading {number}", number=step.target.number))
    if pending:
        raise _hit(setup, said("the way from the last reading"))


def _hit(setup: Setup, way: str) -> ProgramError:
    what = "{way} of the set-up {setup} leads into what is to be kept out"
    what = (
        what
        if setup.artefact is None
        else "{way} of the set-up {setup} leads into what is to be kept out of {artefact}"
    )
    artefact = shown(setup.artefact.name if setup.artefact else "")
    remedy = (
        "Say what goes clear before others move (--clearance), read the place from another side, or move the artefact"
    )
    return ProgramError(what, remedy, way=way, setup=shown(setup.name), artefact=artefact)


class _Follower:
    """Goes through the steps of a program, in m and rad."""

    def __init__(self, kept: KeptOut, scales: Sequence[AxisScale]) -> None:
        self._kept, self._scales = kept, scales
        self._names = [scale.axis.name for scale in scales]
        self._at = np.full(len(scales), np.nan)
        self._tip: dict[str, float] | None = None

    def goes(self, step: Step) -> bool:
        """Take a step; return whether its way is free."""
        if isinstance(step, Hold):
            self._tip = _metres(step.at)
            return True
        if isinstance(step, Release):
            self._tip = None
        before = self._at.copy()
        if isinstance(step, Glide):
            return self._glides(before, dict(step.to))
        if isinstance(step, Move):
            for axis, value in step.to.items():
                self._at[axis] = from_unit(float(value), self._scales[axis].unit)
        elif isinstance(step, Release):
            for name, text in step.at:
                axis = self._names.index(name)
                self._at[axis] = from_unit(float(text), self._scales[axis].unit)
        return not np.all(np.isfinite(before)) or bool(np.all(before == self._at)) or self._kept.free(before, self._at)

    def _glides(self, before: Array, to: dict[str, str]) -> bool:
        tip = {} if self._tip is None else self._tip
        tip |= _metres([(name, text) for name, text in to.items() if name in tip])
        for axis, scale in enumerate(self._scales):
            if scale.axis.rotary and scale.axis.name in to:
                self._at[axis] = from_unit(float(to[scale.axis.name]), scale.unit)
        point = np.array([[tip[name] for name in "XYZ"]])
        machine = self._kept.machine
        self._at = tip_at(machine, self._at[None], point)[0]
        return self._kept.free_held(before, self._at)


def _metres(words: Sequence[tuple[str, str]]) -> dict[str, float]:
    return {name: from_unit(float(text), "mm") for name, text in words}
