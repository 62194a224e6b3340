"""The steps of a measuring program, before any control's words: moves, waits, stops, remarks, touches.

Axes that move together: never linear and rotary ones at once, so that a feed has one meaning.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import ProgramError, TravelError
from axiscal.machine.motion import FAMILIES, move_groups, travel_seconds, turn_parts
from axiscal.measurement.reading import Place
from axiscal.measurement.setup import Setup
from axiscal.measurement.touched import cycle_of, touches
from axiscal.numerics import Array
from axiscal.programs.scale import AxisScale, Decimals, ReadingTarget, exact
from axiscal.units import format_quantity, from_unit, to_unit
from axiscal_core.machine import Machine

FASTEST = 99_999
"""mm/min or deg/min; not every control is known to read a longer number."""
LONGEST_DWELL = 60.0
"""s; a longer dwell is written in parts, for controls differ in what they take."""
LONGEST_WAIT = 3600.0
"""s; a description that asks for more has slipped."""
_TRAVEL = 600
"""mm/min beside a sphere: gentle on any probe."""
_CLEAR = "PRESS START WHEN THE WAY TO THE START IS CLEAR"
"""What the first stop is for."""
_NAME = 30
"""Characters of the name of an artefact, so that what is to be done with it stays on the screen."""

Places = Mapping[int, Decimal]
"""Index of an axis -> where it is, mm or deg."""


@dataclass(frozen=True, slots=True)
class Move:
    """A straight move: where to; feed in mm/min or deg/min; seconds, 0 where nobody knows where it begins."""

    to: Places
    feed: int
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class Dwell:
    """The axes stand still, s."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Halt:
    """The program halts until somebody presses start.  text : why, on the screen, of our own words and of names"""

    text: str = ""


@dataclass(frozen=True, slots=True)
class Remark:
    """A comment, of our own words only."""

    text: str


@dataclass(frozen=True, slots=True)
class Touched:
    """A sphere is met from beside it, fast and then slowly, the place is written into the log, and the tool goes back.

    reading, touch : numbers, from 1; letters : of the linear axes; into, beside : where to, back : steps, all as text
    fast, slow, travel : feeds, mm/min
    """

    reading: int
    touch: int
    letters: tuple[str, ...]
    into: tuple[str, ...]
    back: tuple[str, ...]
    beside: tuple[str, ...]
    fast: int
    slow: int
    travel: int
    seconds: float


Step = Move | Dwell | Halt | Remark | ReadingTarget | Touched
"""A target stands where the axes have come to it."""


@dataclass(frozen=True, eq=False, slots=True)
class ProgramAxes:
    """The axes of one set-up as its program moves them.

    scales : in chain order; groups : axes that move together, in the order X Y Z, A B C, as the groups move
    clearance : the axis that goes clear before others move, and where it is clear; None where nothing does
    """

    machine: Machine
    scales: tuple[AxisScale, ...]
    groups: tuple[tuple[int, ...], ...]
    clearance: tuple[int, Decimal] | None = None

    @classmethod
    def from_setup(cls, machine: Machine, setup: Setup, decimals: int) -> ProgramAxes:
        """Return those of a set-up; raises ProgramError."""
        scales = tuple(AxisScale.of_axis(axis, decimals) for axis in machine.axes)
        order = {k: ("".join(FAMILIES).index(axis.letter), axis.name) for k, axis in enumerate(machine.axes)}
        groups = tuple(tuple(sorted(group, key=order.__getitem__)) for group in move_groups(machine))
        return cls(machine, scales, groups, _clearance(machine, scales, setup))

    @property
    def order(self) -> str:
        """The groups as words: "X Y Z then A C"."""
        return " then ".join(" ".join(self._names(group)) for group in self.groups)

    def _names(self, group: Sequence[int]) -> tuple[str, ...]:
        return tuple(self.machine.axes[k].name for k in group)

    def run_through(
        self,
        targets: Sequence[ReadingTarget],
        setup: Setup,
        reading: float | None,
        read: Callable[[ReadingTarget], Iterator[Step]] | None = None,
    ) -> Iterator[Step]:
        """Yield the way through readings in one set-up.  reading : s, None stops the program

        read : what the program does at a reading, instead of waiting or stopping; it ends where it began

        After the instrument is mounted every axis is sent to the start once more, in case somebody had to jog.
        Raises ProgramError for waits or feeds that cannot be.
        """
        standing, mounting = targets[0].turning, "MOUNT AND ZERO THE INSTRUMENT THEN PRESS START"
        if setup.artefact is not None and setup.contact == "retracted":
            mounting = f"PUT DOWN {setup.artefact.name[:_NAME]} THEN PRESS START"
        yield Halt(_CLEAR)  # what is put down goes under a spindle that is clear
        yield from self.to_the_start(standing if setup.contact == "free" else self.cleared(standing))
        yield Halt(mounting)
        yield from self.to_the_start(standing)
        for target in targets:
            yield from self.way_to(target, standing, first=target is targets[0])
            standing = target.position
            yield Remark(f"READING {target.number}")
            yield target
            yield from dwells(setup.settle)
            yield from read(target) if read is not None else [Halt()] if reading is None else dwells(reading)
        yield from self.along(standing, [self.cleared(standing)])

    def way_to(self, target: ReadingTarget, standing: Decimals, first: bool = False) -> Iterator[Move]:
        """Yield the way to a reading from where the axes stand, over where they are clear if others move.

        first : they stand where its last way begins
        """
        clear = self.cleared(standing)
        turning = target.turning if first else target.way_in(standing)
        stops = [turning, target.position]
        if self.clearance is not None and clear != self.cleared(turning):  # an axis moves that is not its own
            turning = target.way_in(clear)
            stops = [clear, self.cleared(turning), turning, target.position]
        yield from self.along(standing, stops)

    def to_the_start(self, start: Decimals) -> Iterator[Move]:
        """Yield the moves to the start from nobody knows where: what goes clear first does so, and comes down last."""
        if self.clearance is None:
            yield from (Move({k: start[k] for k in group}, self._feed(group)) for group in self.groups)
            return
        apart, above = self.clearance
        clear, there, feed = {apart: above}, {apart: start[apart]}, self._feed(self._with(apart))
        yield from (Move(to, feed) for to in [*self._places(there, clear)] or [clear])
        for group in self.groups:
            to = {k: start[k] for k in group if k != apart}
            yield from [Move(to, self._feed(group))] if to else []
        yield from (Move(to, feed) for to in self._places(clear, there))

    def cleared(self, place: Decimals) -> Decimals:
        """Return the place with the axis of the clearance where it is clear."""
        if self.clearance is None:
            return place
        apart, above = self.clearance
        return (*place[:apart], above, *place[apart + 1 :])

    def along(self, standing: Decimals, stops: Sequence[Decimals]) -> Iterator[Move]:
        """Yield the moves from one stop to the next, group after group; none where nothing is to move."""
        for stop in stops:
            for group in self.groups:
                begin, end = (dict[int, Decimal]((k, where[k]) for k in group) for where in (standing, stop))
                for to in self._places(begin, end):
                    ways, far = {k: to[k] - begin[k] for k in group if to[k] != begin[k]}, np.zeros(len(self.scales))
                    for k, way in ways.items():
                        far[k] = from_unit(float(way), self.scales[k].unit)
                    seconds = float(travel_seconds(self.machine, np.zeros(len(far)), far))
                    yield Move({k: to[k] for k in ways}, self._feed(ways, ways), seconds)
                    begin = to
            standing = stop

    def _with(self, axis: int) -> tuple[int, ...]:
        return next(group for group in self.groups if axis in group)

    def _feed(self, axes: Sequence[int] | Places, ways: Places | None = None) -> int:
        """Return the fastest feed (mm/min, deg/min) of a straight move at which no axis exceeds its speed.

        ways : how far each axis goes; None where that is not known.  Raises ProgramError below 1.
        """
        far = {k: float(way) for k, way in ways.items()} if ways else {}
        length = math.hypot(*far.values()) if ways else 1.0
        speeds = {k: to_unit(self.machine.axes[k].speed, self.scales[k].unit) for k in axes}
        fastest = min(speed * length / abs(far.get(k, 1.0)) for k, speed in speeds.items())
        feed = min(math.floor(fastest * 60 * (1 + 1e-12)), FASTEST)
        if feed < 1:
            what, remedy = "{axes} would move at less than 1 mm/min or deg/min", "Give these axes a higher speed"
            raise ProgramError(what, remedy, axes=" ".join(self._names(self._with(next(iter(axes))))))
        return feed

    def _places(self, begin: Places, end: Places) -> Iterator[dict[int, Decimal]]:
        """Yield the places on a straight way, its end included, between which no axis turns far; none for no way."""
        if begin == end:
            return
        turns = [math.radians(abs(end[k] - begin[k])) for k in end if self.scales[k].axis.rotary]
        count = int(turn_parts(np.array(max(turns, default=0.0))))
        for part in range(1, count + 1):
            yield {k: (begin[k] + (end[k] - begin[k]) * part / count).quantize(self.scales[k].step) for k in end}

    def touching(self, setup: Setup, target: ReadingTarget, place: Place) -> Iterator[Step]:
        """Yield the touches of a sphere from all sides, from where the tool is drawn back and back to there.

        X, Y and Z move in it.  Raises ProgramError where these are not one group, TravelError.
        """
        group = next((each for each in self.groups if set(self._names(each)) == set("XYZ")), None)
        if group is None:
            what = "X, Y and Z touch the spheres of {setup} and are not one group of moves"
            remedy = "Name the linear axes X, Y and Z, and let them move together in --order"
            raise ProgramError(what, remedy, setup=shown(setup.name))
        standing, cycle = target.position, cycle_of(self.machine, setup)
        fast, slow = (math.floor(to_unit(speed, "mm/min")) for speed in (cycle.fast, cycle.slow))
        travel, clear, back = min(_TRAVEL, self._feed(group)), to_unit(cycle.clear, "mm"), to_unit(cycle.back, "mm")
        seconds = 60 * (clear / fast + back * (1 / fast + 1 / slow) + clear / travel)
        for number, touch in enumerate(touches(self.machine, np.array(place.pose), cycle), start=1):
            *way, beside, into = (self._reached(setup, each, target) for each in (*touch.way, touch.beside, touch.into))
            steps = [
                exact(to_unit(each, "mm")).quantize(s.step) for each, s in zip(touch.back, self.scales, strict=True)
            ]
            yield from self.along(standing, [*way, beside])
            ends, backs, begins = (tuple(f"{values[k] + 0:f}" for k in group) for values in (into, steps, beside))
            where = self._names(group), ends, backs, begins
            yield Touched(target.number, number, *where, fast, slow, travel, seconds)
            yield from self.along(beside, way[::-1])
            standing = way[0]
        yield from self.along(standing, [target.position])

    def _reached(self, setup: Setup, pose: Array, target: ReadingTarget) -> Decimals:
        """Return a pose in the numbers of the program, the rotary axes as they stand; raises TravelError."""
        numbers = []
        for k, (scale, value) in enumerate(zip(self.scales, pose.tolist(), strict=True)):
            number = target.position[k] if scale.axis.rotary else scale.nearest(value)
            if number is None:
                what = "reading {number} of {setup}: touching leaves the travel of {axis}"
                remedy = "Put the sphere nearer to the middle of the travels"
                raise TravelError(what, remedy, number=target.number, setup=shown(setup.name), axis=scale.axis.name)
            numbers.append(number)
        return tuple(numbers)


def dwells(seconds: float) -> Iterator[Dwell]:
    """Yield dwells of at most a minute that add up to so many seconds; raises ProgramError for more than an hour."""
    if not 0 <= seconds <= LONGEST_WAIT:
        remedy = "Shorten settle or reading_time, or let the program stop for the instrument"
        raise ProgramError("a wait of {seconds} at each reading", remedy, seconds=format_quantity(seconds, "s"))
    parts = math.ceil(seconds / LONGEST_DWELL)
    yield from [Dwell(seconds / max(parts, 1))] * parts


def _clearance(machine: Machine, scales: Sequence[AxisScale], setup: Setup) -> tuple[int, Decimal] | None:
    """Return the axis that goes clear and where; raises ProgramError for a place outside its travel.

    For balls on the table that axis is Z at its upper end, unless another is stated.
    """
    if setup.driving.clearance is None:
        over = [k for k, axis in enumerate(machine.axes) if axis.name == "Z" and setup.contact != "free"]
        return next(((k, scales[k].last if machine.axes[k].direction[2] > 0 else scales[k].first) for k in over), None)
    name, place = setup.driving.clearance
    index = machine.index(name)
    number, scale = scales[index].nearest(place), scales[index]
    if number is None:
        what, at = "{name} is to go clear at {place}, outside its travel", format_quantity(place, scale.unit)
        raise ProgramError(what, "Choose a place within {travel}", name=name, place=at, travel=scale.travel)
    return index, number
