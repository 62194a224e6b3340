"""The way through readings in touch: the tool point stays at its ball, or on the circle of its bar.

If rotary axes turn, the control itself must hold the tool point: then places are those of the workpiece. Rotary axes
are at zero when that begins, with the tool drawn back from the ball. If none turns, the slides go together.

The sphere cycle of a program that touches by itself: which sides, over what ways, in the numbers of the program.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from decimal import Decimal
from itertools import pairwise

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import ProgramError, TravelError
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import drawn_back, frames
from axiscal.machine.motion import LARGEST_TURN
from axiscal.measurement.charts.room import KNOWN, Chart, Room, starts_of_ways
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import SideTouch, cycle_of, touches
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.programs.gliding import SlideDriver, Way, free, free_held
from axiscal.programs.scale import Decimals, ReadingTarget, exact
from axiscal.programs.standing import CLEAR, mounting
from axiscal.programs.steps import Arrival, Clearance, Group, Halt, ProgramAxes, Remark, Step, Touched, dwells
from axiscal.units import to_unit

_TRAVEL = 600
"""mm/min beside a sphere, where no feed near the place is asked for: gentle on any probe."""


class SphereCycle:
    """Touches the spheres of one set-up by moves of the linear axes, which must be one group called X, Y and Z."""

    def __init__(self, machine: Machine, setup: Setup, axes: ProgramAxes) -> None:
        self._machine, self._setup, self._scales = machine, setup, axes.scales
        self._cycle = cycle_of(machine, setup)
        self._group = next((group for group in axes.groups if set(group.names) == set("XYZ")), None)

    def steps(self, target: ReadingTarget, place: Place) -> Iterator[Step]:
        """Yield the touches of a reading, from where the tool is drawn back and back to there."""
        group = self._group
        if group is None:
            what = "X, Y and Z touch the spheres of {setup} and are not one group of moves"
            remedy = "Name the linear axes X, Y and Z, and let them move together in --order"
            raise ProgramError(what, remedy, setup=shown(self._setup.name))
        standing, axes = target.position, ProgramAxes(self._scales, (group,))
        for number, touch in enumerate(touches(self._machine, np.array(place.pose), self._cycle), start=1):
            stops = [self._written(pose, target) for pose in (*touch.way, touch.beside)]
            for stop in stops:
                yield from axes.moves(standing, stop)
                standing = stop
            yield self._touched(target, number, touch, standing, group)
            for stop in stops[-2::-1]:
                yield from axes.moves(standing, stop)
                standing = stop
        yield from axes.moves(standing, target.position)

    def _written(self, pose: Array, target: ReadingTarget) -> Decimals:
        """Return a pose in the numbers of the program, the rotary axes as they stand; raises TravelError."""
        numbers = []
        for k, (scale, value) in enumerate(zip(self._scales, pose.tolist(), strict=True)):
            number = target.position[k] if scale.axis.rotary else scale.nearest(value)
            if number is None:
                what = "reading {number} of {setup}: touching leaves the travel of {axis}"
                remedy, setup = "Put the sphere nearer to the middle of the travels", shown(self._setup.name)
                raise TravelError(what, remedy, number=target.number, setup=setup, axis=scale.axis.name)
            numbers.append(number)
        return tuple(numbers)

    def _touched(self, target: ReadingTarget, number: int, touch: SideTouch, beside: Decimals, group: Group) -> Touched:
        def texts(values: Sequence[Decimal]) -> tuple[str, ...]:
            return tuple(f"{values[k] + 0:f}" for k in group.axes)

        steps = [exact(to_unit(each, "mm")).quantize(s.step) for each, s in zip(touch.back, self._scales, strict=True)]
        fast, slow = (math.floor(to_unit(speed, "mm/min")) for speed in (self._cycle.fast, self._cycle.slow))
        travel = min(_TRAVEL if group.near is None else group.near, group.feed(None))
        way = to_unit(self._cycle.clear, "mm") / fast + to_unit(self._cycle.back, "mm") * (1 / fast + 1 / slow)
        seconds = 60 * (way + to_unit(self._cycle.clear, "mm") / travel)
        into = texts(self._written(touch.into, target))
        return Touched(
            target.number, number, group.names, into, texts(steps), texts(beside), fast, slow, travel, seconds
        )


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


class InTouch:
    """Goes through the readings of one set-up; raises ProgramError for what the machine cannot do in one piece.

    from_zero : rotary axes must stand at zero when the control begins to hold the tool point
    """

    def __init__(self, machine: Machine, setup: Setup, chart: Chart, driver: SlideDriver, from_zero: bool) -> None:
        self._machine, self._setup, self._chart, self._driver = machine, setup, chart, driver
        self._from_zero, self._clear = from_zero, _inside(machine, driver.axes.clearance)

    def run_through(self, readings: Sequence[tuple[int, Place]], reading: float | None) -> Iterator[Step]:
        """Yield the way through numbered readings; reading : s, None stops the program at each."""
        poses, approaches = (np.array([getattr(place, key) for _, place in readings]) for key in ("pose", "approach"))
        there = self._chart.places(poses)
        sides = sides_of(self._chart, there, approaches)
        standing = starts_of_ways(self._chart, there[:1], sides[:1])[0]
        yield from [Halt(CLEAR)]
        driver = yield from self._together(self._driver, standing)
        yield from [Halt(mounting(self._setup), driver.holding)]
        for (number, place), at, side in zip(readings, there, sides, strict=True):
            for stop in self._stops(standing, at, side):
                driver = yield from self._way(driver, standing, stop)
                standing = stop
            yield Remark(f"READING {number}")
            position = driver.written(np.array(place.pose))
            yield Arrival(ReadingTarget(number, position, position, place.approach))
            yield from dwells(self._setup.settle)
            yield from [Halt(held=driver.holding)] if reading is None else dwells(reading)
        driver = yield from self._apart(driver, standing)
        yield from driver.cleared()

    def _stops(self, standing: Array, there: Array, side: Array) -> list[Array]:
        """Return over which places u a place is come to from its side."""
        straight = self._chart.between(standing, there)
        if straight is not None and len(straight) == 2 and self._comes_right(standing, there, side):
            return [there]
        return [starts_of_ways(self._chart, there[None], side[None])[0], there]

    def _way(self, driver: SlideDriver, here: Array, there: Array) -> Way:
        """Yield a way in touch; where there is none the tool goes off, and comes back."""
        legs = self._chart.between(here, there)
        if legs is not None:
            for start, stop in pairwise(legs):
                driver = yield from driver.along(self._poses_along(start, stop))
            return driver
        bar = self._setup.length is not None
        yield from [Halt("TAKE THE BAR OFF THEN PRESS START", driver.holding)] if bar else ()
        driver = yield from self._apart(driver, here)
        driver = yield from self._together(driver, there)
        yield from [Halt("PUT THE BAR ON THEN PRESS START", driver.holding)] if bar else ()
        return driver

    def _together(self, driver: SlideDriver, place: Array) -> Way:
        """Yield the way from anywhere to a place u: to the gate, then with the tool held to the place drawn back."""
        gate, drawn, pose = self._entrance(place)
        driver = yield from driver.begin(gate[0])
        driver = yield from driver.along(gate)
        return (yield from driver.along(np.stack([drawn, pose]), gently=True))

    def _apart(self, driver: SlideDriver, place: Array) -> Way:
        gate, drawn, pose = self._entrance(place)
        driver = yield from driver.along(np.stack([pose, drawn]), gently=True)
        driver = yield from driver.along(gate[::-1])
        return (yield from driver.end())

    def _comes_right(self, here: Array, there: Array, side: Array) -> bool:
        """Return whether a straight way, and the axes that follow, come from the right side over the whole overrun.

        These go by its slant: coming far along one coordinate and hardly along another a slide may come from elsewhere.
        """
        overrun, gone, asked = np.array([end.overrun for end in self._chart.coordinates]), there - here, side != 0
        if not np.all(~asked | (gone * side >= overrun - _SLACK)):
            return False
        last = float(np.max(overrun[asked] / np.abs(gone[asked]), initial=0.0))
        start = starts_of_ways(self._chart, there[None], side[None])
        at, slanted, begin = self._chart.poses(np.vstack([there, there - last * gone, start]))
        known = KNOWN * np.array([axis.overrun for axis in self._machine.axes])
        return bool(np.all((np.abs(at - begin) < known) | ((at - slanted) * np.sign(at - begin) >= known)))

    def _poses_along(self, start: Array, stop: Array) -> Array:
        """Return poses between which the control may go straight, both ends among them, (p, q)."""
        count = max(1, math.ceil(float(np.max(np.abs(stop - start), initial=0.0)) / self._step - 1e-9))
        return self._chart.poses(start + np.linspace(0.0, 1.0, count + 1)[:, None] * (stop - start))

    @property
    def _step(self) -> float:
        """How far a coordinate goes in one move, rad: a long turn, or a chord that hardly leaves the circle."""
        if self._setup.length is None:
            return LARGEST_TURN
        return math.sqrt(8 * _SAG * (self._setup.stroke or 1e-3) / self._setup.length)

    def _entrance(self, place: Array) -> Entrance:
        """Return how a place u is come to from where nothing is in touch.  Raises ProgramError where it cannot be."""
        pose = self._chart.poses(place[None])[0]
        artefact, bar = self._setup.artefact, self._setup.length is not None
        tip = frames(self._machine, pose[None]).tcp
        own = () if artefact is None or bar else artefact.nearest(tip, self._setup.balls).tolist()
        room = Room.among(self._machine, artefact, own)
        boxes = room.occupied
        for far in (*_BACK, *(_OUT if boxes else ())):
            drawn = drawn_back(self._machine, pose[None], far)[0]
            way = self._from_zeros(drawn) if self._from_zero else drawn[None]
            if room.in_travel(way).all() and (not boxes or self._leads_out(room, way, pose)):
                return way, drawn, pose
        what = '"{setup}": the tool cannot be drawn back within the travels where its way begins or ends'
        if boxes:
            what = (
                '"{setup}": the tool cannot be drawn back, beside what is to be kept out, within the travels where its '
                "way begins or ends"
            )
        remedy = "Read nearer to the middle of the travels, or move the artefact"
        raise ProgramError(what, remedy, setup=self._setup.name)

    def _leads_out(self, room: Room, way: Array, pose: Array) -> bool:
        """Return whether nothing is in the way from where it is clear to a pose in touch.  way : (p, q), as the gate"""
        clear = way[0].copy()
        if self._clear is not None:
            clear[self._clear[0]] = self._clear[1]
        pairs = all(free_held(room, start, stop) for start, stop in pairwise([*way, pose]))
        return pairs and free(room, clear, way[0])

    def _from_zeros(self, drawn: Array) -> Array:
        """Return poses from rotary axes at zero to a pose, turning where it is clear, (p, q)."""
        assert self._clear is not None  # a tool point is held by X, Y and Z, and Z goes clear unless another is said
        above = drawn.copy()
        above[self._clear[0]] = self._clear[1]
        rotary = np.array([axis.rotary for axis in self._machine.axes])
        turned = _between(np.where(rotary, 0.0, above), above)
        return np.concatenate([turned, _between(above, drawn)[1:]])


def _inside(machine: Machine, clearance: Clearance | None) -> tuple[int, float] | None:
    """Return the axis that goes clear and where, m, a little within the travel: chords of a turn may rise."""
    if clearance is None:
        return None
    axis = machine.axes[clearance[0]]
    low, high = axis.travel
    place = float(clearance[1]) / to_unit(1.0, axis.unit)
    return clearance[0], min(max(place, low + axis.overrun), high - axis.overrun)


def _between(start: Array, stop: Array) -> Array:
    count = max(1, math.ceil(float(np.abs(stop - start).max()) / _TURN))
    return start + np.linspace(0.0, 1.0, count + 1)[:, None] * (stop - start)
