"""The steps of a measuring program, before any control's words: moves, waits, stops, remarks.

Axes that move together: never linear and rotary ones at once, so that a feed has one meaning.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from axiscal.exceptions import ProgramError
from axiscal.machine.motion import FAMILIES, move_groups, turn_parts
from axiscal.measurement.setup import Setup
from axiscal.programs.scale import AxisScale, Decimals, ReadingTarget
from axiscal.programs.standing import CLEAR, mounting
from axiscal.units import format_quantity, to_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

FASTEST = 99_999
"""mm/min or deg/min; not every control is known to read a longer number."""


@dataclass(frozen=True, slots=True)
class Group:
    """Some axes by index, in the order X Y Z, A B C; their speeds (mm/s, deg/s) and accelerations (mm/s², deg/s²)."""

    names: tuple[str, ...]
    axes: tuple[int, ...]
    speeds: tuple[float, ...]
    accelerations: tuple[float, ...]

    def feed(self, ways: Sequence[float] | None) -> int:
        """Return the fastest feed (mm/min, deg/min) of a straight move at which no axis exceeds its speed.

        ways : how far each axis goes, mm or deg; None where that is not known.  Raises ProgramError below 1.
        """
        fastest = min(self.speeds) if ways is None else _along(self.speeds, ways)
        feed = min(math.floor(fastest * 60 * (1 + 1e-12)), FASTEST)
        if feed < 1:
            what, remedy = "{axes} would move at less than 1 mm/min or deg/min", "Give these axes a higher speed"
            raise ProgramError(what, remedy, axes=" ".join(self.names))
        return feed

    def seconds(self, ways: Sequence[float], feed: int) -> float:
        """Return the time of a straight move that begins and ends at rest."""
        length, speed = math.hypot(*ways), feed / 60
        acceleration = _along(self.accelerations, ways)
        short = length < speed**2 / acceleration
        return 2 * math.sqrt(length / acceleration) if short else length / speed + speed / acceleration


def groups(machine: Machine) -> tuple[Group, ...]:
    """Return the groups in the order they move."""
    return tuple(_group(machine, axes) for axes in move_groups(machine))


def _group(machine: Machine, members: Sequence[int]) -> Group:
    axes = tuple(sorted(members, key=lambda k: ("".join(FAMILIES).index(machine.axes[k].letter), machine.axes[k].name)))
    speeds = tuple(_written(machine.axes[k], machine.axes[k].speed) for k in axes)
    accelerations = tuple(_written(machine.axes[k], machine.axes[k].acceleration) for k in axes)
    return Group(tuple(machine.axes[k].name for k in axes), axes, speeds, accelerations)


def _written(axis: Axis, value: float) -> float:
    """Return a speed or acceleration in mm or deg instead of m or rad."""
    return to_unit(value, axis.unit)


def _along(limits: Sequence[float], ways: Sequence[float]) -> float:
    """Return the most along a straight way that keeps within the limits of all axes."""
    length = math.hypot(*ways)
    return min(limit * length / way for limit, way in zip(limits, ways, strict=True) if way)


Places = Mapping[int, Decimal]
"""Index of an axis -> where it is, mm or deg."""

LONGEST_DWELL = 60.0
"""s; a longer dwell is written in parts, for controls differ in what they take."""
LONGEST_WAIT = 3600.0
"""s; a description that asks for more has slipped."""


@dataclass(frozen=True, slots=True)
class Move:
    """A straight move: index of each axis named -> where to, mm or deg; feed in mm/min or deg/min.

    seconds : how long it takes; 0 where nobody knows where it begins
    """

    to: Places
    feed: int
    seconds: float


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
class Arrival:
    """The axes have come to a reading."""

    target: ReadingTarget


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

    def words(self, values: tuple[str, ...]) -> tuple[tuple[str, str], ...]:
        """Return values of this touch with the letters of their axes."""
        return tuple(zip(self.letters, values, strict=True))


Step = Move | Dwell | Halt | Remark | Arrival | Touched


Clearance = tuple[int, Decimal]
"""Index of the axis that goes clear before others move, and where it is clear, mm or deg."""


@dataclass(frozen=True, eq=False, slots=True)
class ProgramAxes:
    """The axes of one set-up as its program moves them.

    scales : in chain order; groups : in the order in which they move; clearance : None where nothing goes clear
    """

    scales: tuple[AxisScale, ...]
    groups: tuple[Group, ...]
    clearance: Clearance | None = None

    @classmethod
    def from_setup(cls, machine: Machine, setup: Setup, decimals: Sequence[int]) -> ProgramAxes:
        """Return those of a set-up; decimals : of each axis.  Raises ProgramError."""
        scales = tuple(AxisScale.of_axis(axis, each) for axis, each in zip(machine.axes, decimals, strict=True))
        return cls(scales, groups(machine), clearance_of(machine, scales, setup))

    @property
    def order(self) -> str:
        """The groups as words: "X Y Z then A C"."""
        return " then ".join(" ".join(group.names) for group in self.groups)

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
        standing = targets[0].turning
        yield Halt(CLEAR)  # what is put down goes under a spindle that is clear
        yield from self.to_the_start(standing if setup.contact == "free" else self.cleared(standing))
        yield Halt(mounting(setup))
        yield from self.to_the_start(standing)
        for target in targets:
            yield from self.way_to(target, standing, first=target is targets[0])
            standing = target.position
            yield Remark(f"READING {target.number}")
            yield Arrival(target)
            yield from dwells(setup.settle)
            yield from read(target) if read is not None else [Halt()] if reading is None else dwells(reading)
        yield from self.moves(standing, self.cleared(standing))

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
        for stop in stops:
            yield from self.moves(standing, stop)
            standing = stop

    def to_the_start(self, start: Decimals) -> Iterator[Move]:
        """Yield the moves to the start from nobody knows where: what goes clear first does so, and comes down last."""
        if self.clearance is None:
            yield from (Move({k: start[k] for k in group.axes}, group.feed(None), 0.0) for group in self.groups)
            return
        apart, above = self.clearance
        (own,) = (group for group in self.groups if apart in group.axes)
        clear, there = {apart: above}, {apart: start[apart]}
        yield from (Move(to, own.feed(None), 0.0) for to in [*self._places(there, clear)] or [clear])
        for group in self.groups:
            to = {k: start[k] for k in group.axes if k != apart}
            yield from [Move(to, group.feed(None), 0.0)] if to else []
        yield from (Move(to, own.feed(None), 0.0) for to in self._places(clear, there))

    def cleared(self, place: Decimals) -> Decimals:
        """Return the place with the axis of the clearance where it is clear."""
        if self.clearance is None:
            return place
        apart, above = self.clearance
        return (*place[:apart], above, *place[apart + 1 :])

    def moves(self, start: Decimals, stop: Decimals) -> Iterator[Move]:
        """Yield the moves from one place to another, group after group; none where nothing is to move."""
        for group in self.groups:
            begin, end = ({k: where[k] for k in group.axes} for where in (start, stop))
            yield from self._straight(begin, end, group)

    def _straight(self, begin: Places, end: Places, group: Group) -> Iterator[Move]:
        """Yield a straight way as moves."""
        for stop in self._places(begin, end):
            ways = [float(abs(stop[k] - begin[k])) for k in group.axes]
            feed = group.feed(ways)
            yield Move({k: stop[k] for k in group.axes if stop[k] != begin[k]}, feed, group.seconds(ways, feed))
            begin = stop

    def _places(self, begin: Places, end: Places) -> Iterator[Places]:
        """Yield the places on a straight way, its end included, between which no axis turns far; none for no way."""
        if begin == end:
            return
        turns = [math.radians(abs(end[k] - begin[k])) for k in end if self.scales[k].axis.rotary]
        count = int(turn_parts(np.array(max(turns, default=0.0))))
        for part in range(1, count + 1):
            yield {k: (begin[k] + (end[k] - begin[k]) * part / count).quantize(self.scales[k].step) for k in end}


def dwells(seconds: float) -> Iterator[Dwell]:
    """Yield dwells of at most a minute that add up to so many seconds; raises ProgramError for more than an hour."""
    if not 0 <= seconds <= LONGEST_WAIT:
        remedy = "Shorten settle or reading_time, or let the program stop for the instrument"
        raise ProgramError("a wait of {seconds} at each reading", remedy, seconds=format_quantity(seconds, "s"))
    parts = math.ceil(seconds / LONGEST_DWELL)
    yield from [Dwell(seconds / max(parts, 1))] * parts


def clearance_of(machine: Machine, scales: Sequence[AxisScale], setup: Setup) -> Clearance | None:
    """Return the axis that goes clear and where; raises ProgramError for a place outside its travel.

    For balls on the table that axis is Z at its upper end, unless another is stated.
    """
    if setup.driving.clearance is None:
        high = {k: scales[k].last if axis.direction[2] > 0 else scales[k].first for k, axis in enumerate(machine.axes)}
        over = (k for k, axis in enumerate(machine.axes) if axis.name == "Z" and setup.contact != "free")
        return next(((k, high[k]) for k in over), None)
    name, place = setup.driving.clearance
    index = machine.index(name)
    number = scales[index].nearest(place)
    if number is None:
        scale, what = scales[index], "{name} is to go clear at {place}, outside its travel"
        shown = format_quantity(place, scale.unit)
        raise ProgramError(what, "Choose a place within {travel}", name=name, place=shown, travel=scale.travel)
    return index, number
