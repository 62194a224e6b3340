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
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.machine.motion import FAMILIES, Driving, move_groups, quick_share, turn_parts
from axiscal.programs.scale import AxisScale, Decimals, ReadingTarget
from axiscal.units import format_quantity, to_unit

FASTEST = 99_999
"""mm/min or deg/min; not every control is known to read a longer number."""


@dataclass(frozen=True, slots=True)
class Group:
    """Some axes by index, in the order X Y Z, A B C; their speeds (mm/s, deg/s) and accelerations (mm/s², deg/s²).

    near : mm/min or deg/min that are not exceeded near a reading; None where nothing is slow
    """

    names: tuple[str, ...]
    axes: tuple[int, ...]
    speeds: tuple[float, ...]
    accelerations: tuple[float, ...]
    near: int | None = None

    def feed(self, ways: Sequence[float] | None, slow: bool = False) -> int:
        """Return the fastest feed (mm/min, deg/min) of a straight move at which no axis exceeds its speed.

        ways : how far each axis goes, mm or deg; None where that is not known.  slow : the move is near a reading
        Raises ProgramError below 1.
        """
        fastest = min(self.speeds) if ways is None else _along(self.speeds, ways)
        most = self.near if slow and self.near is not None else FASTEST
        feed = min(math.floor(fastest * 60 * (1 + 1e-12)), most)
        if feed < 1:
            remedy = "Give these axes a higher speed, or programs a higher feed near the place"
            raise ProgramError("{axes} would move at less than 1 mm/min or deg/min", remedy, axes=" ".join(self.names))
        return feed

    def seconds(self, ways: Sequence[float], feed: int) -> float:
        """Return the time of a straight move that begins and ends at rest."""
        length, speed = math.hypot(*ways), feed / 60
        acceleration = _along(self.accelerations, ways)
        short = length < speed**2 / acceleration
        return 2 * math.sqrt(length / acceleration) if short else length / speed + speed / acceleration


def groups(machine: Machine, driving: Driving) -> tuple[Group, ...]:
    """Return the groups in the order they move; raises DescriptionError for an order that cannot be."""
    return tuple(_group(machine, axes, driving.feed) for axes in move_groups(machine, driving))


def _group(machine: Machine, members: Sequence[int], near: float | None) -> Group:
    axes = tuple(sorted(members, key=lambda k: _place(machine.axes[k])))
    speeds = tuple(_written(machine.axes[k], machine.axes[k].speed) for k in axes)
    accelerations = tuple(_written(machine.axes[k], machine.axes[k].acceleration) for k in axes)
    slow = None if near is None else math.floor(to_unit(near, "mm/min") * (1 + 1e-12))
    return Group(tuple(machine.axes[k].name for k in axes), axes, speeds, accelerations, slow)


def _place(axis: Axis) -> tuple[int, str]:
    return "".join(FAMILIES).index(axis.letter), axis.name


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
class Glide:
    """A straight move of the tool point on the workpiece, rotary axes in step.

    to : names of axes with where to, X Y Z on the workpiece, as text; feed in mm/min, deg/min where the point stays
    """

    to: tuple[tuple[str, str], ...]
    feed: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Hold:
    """From here on X Y Z are those of the tool point on the workpiece.  at : where it is, as text"""

    at: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Release:
    """From here on they are those of the machine again.  at : where its axes are, as text"""

    at: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Dwell:
    """The axes stand still, s."""

    seconds: float


@dataclass(frozen=True, slots=True)
class Halt:
    """The program halts until somebody presses start.  held : while the control holds the tool point"""

    held: bool = False


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


_BEGINNING = (
    ("PRESS START WHEN THE WAY TO THE START IS CLEAR", False),
    ("MOUNT AND ZERO THE INSTRUMENT THEN PRESS START", True),
)
"""What the stops before the first reading are for, and whether the way to the start is slow then."""

Step = Move | Glide | Hold | Release | Dwell | Halt | Remark | Arrival | Touched


Clearance = tuple[int, Decimal]
"""Index of the axis that goes clear before others move, and where it is clear, mm or deg."""


def run_through(
    targets: Sequence[ReadingTarget],
    scales: Sequence[AxisScale],
    groups: Sequence[Group],
    settle: float,
    reading: float | None,
    clearance: Clearance | None = None,
    read: Callable[[ReadingTarget], Iterator[Step]] | None = None,
) -> Iterator[Step]:
    """Yield the way through readings in one set-up; settle, reading : s, None stops the program.

    read : what the program does at a reading, instead of waiting or stopping; it ends where it began

    After the instrument is mounted every axis is sent to the start once more, in case somebody had to jog.
    Raises ProgramError for waits or feeds that cannot be.
    """
    standing = targets[0].turning
    for text, slow in _BEGINNING:
        yield from (Remark(text), Halt())
        yield from to_the_start(standing, scales, groups, clearance, targets[0].position if slow else None)
    for target in targets:
        yield from way_to(target, standing, scales, groups, clearance, first=target is targets[0])
        standing = target.position
        yield Remark(f"READING {target.number}")
        yield Arrival(target)
        yield from dwells(settle)
        yield from read(target) if read is not None else [Halt()] if reading is None else dwells(reading)
    yield from moves(standing, cleared(standing, clearance), scales, groups)


def way_to(
    target: ReadingTarget,
    standing: Decimals,
    scales: Sequence[AxisScale],
    groups: Sequence[Group],
    clearance: Clearance | None,
    first: bool = False,
) -> Iterator[Move]:
    """Yield the way to a reading from where the axes stand, over where they are clear if others move.

    first : they stand where its last way begins
    """
    clear = cleared(standing, clearance)
    turning = target.turning if first else target.way_in(standing)
    stops = [turning, target.position]
    if _others_move(standing, turning, clearance):
        turning = target.way_in(clear)
        stops = [clear, cleared(turning, clearance), turning, target.position]
    for stop in stops:
        yield from moves(standing, stop, scales, groups, target.position)
        standing = stop


def to_the_start(
    start: Decimals,
    scales: Sequence[AxisScale],
    groups: Sequence[Group],
    clearance: Clearance | None,
    place: Decimals | None = None,
) -> Iterator[Move]:
    """Yield the moves to the start from nobody knows where: what goes clear first does so, and comes down last.

    place : of the first reading, where something is mounted, so that the way is slow; with a clearance only near it
    """
    slow = place is not None
    if clearance is None:
        yield from (Move({k: start[k] for k in group.axes}, group.feed(None, slow), 0.0) for group in groups)
        return
    apart, (own,) = clearance[0], [group for group in groups if clearance[0] in group.axes]
    clear, there = {apart: clearance[1]}, {apart: start[apart]}
    low = place is not None and abs(clearance[1] - place[apart]) <= scales[apart].nearness
    yield from (Move(to, own.feed(None, low), 0.0) for to in [*_places(there, clear, scales)] or [clear])
    for group in groups:
        to = {k: start[k] for k in group.axes if k != apart}
        yield from [Move(to, group.feed(None, low), 0.0)] if to else []
    edge = there if place is None or own.near is None else _edge(clear, there, place, scales)
    yield from (Move(to, own.feed(None), 0.0) for to in _places(clear, edge, scales))
    yield from (Move(to, own.feed(None, slow), 0.0) for to in _places(edge, there, scales))


def cleared(place: Decimals, clearance: Clearance | None) -> Decimals:
    """Return the place with the axis of the clearance where it is clear."""
    if clearance is None:
        return place
    return tuple(clearance[1] if k == clearance[0] else value for k, value in enumerate(place))


def _others_move(start: Decimals, stop: Decimals, clearance: Clearance | None) -> bool:
    """Return whether there is a clearance and an axis moves that is not its own."""
    return clearance is not None and any(
        k != clearance[0] and a != b for k, (a, b) in enumerate(zip(start, stop, strict=True))
    )


def dwells(seconds: float) -> Iterator[Dwell]:
    """Yield dwells of at most a minute that add up to so many seconds; raises ProgramError for more than an hour."""
    if not 0 <= seconds <= LONGEST_WAIT:
        remedy = "Shorten settle or reading_time, or let the program stop for the instrument"
        raise ProgramError("a wait of {seconds} at each reading", remedy, seconds=format_quantity(seconds, "s"))
    parts = math.ceil(seconds / LONGEST_DWELL)
    yield from [Dwell(seconds / max(parts, 1))] * parts


def moves(
    start: Decimals,
    stop: Decimals,
    scales: Sequence[AxisScale],
    groups: Sequence[Group],
    place: Decimals | None = None,
) -> Iterator[Move]:
    """Yield the moves from one place to another, group after group; none where nothing is to move.

    place : of the reading that is gone to, near which moves are slow
    """
    for group in groups:
        begin, end = ({k: where[k] for k in group.axes} for where in (start, stop))
        edge = end if place is None or group.near is None else _edge(begin, end, place, scales)
        yield from _straight(begin, edge, scales, group, slow=False)
        yield from _straight(edge, end, scales, group, slow=True)


def _edge(begin: Places, end: Places, place: Decimals, scales: Sequence[AxisScale]) -> Places:
    """Return where a straight way comes near a reading with all its axes; its end if it never does."""
    ways = (np.array([float(at[k]) for k in end]) for at in (begin, end, place))
    share = Decimal(float(quick_share([float(scales[k].nearness) for k in end], *ways)))
    return {k: (begin[k] + (end[k] - begin[k]) * share).quantize(scales[k].step) for k in end}


def _straight(begin: Places, end: Places, scales: Sequence[AxisScale], group: Group, slow: bool) -> Iterator[Move]:
    """Yield a straight way as moves."""
    for stop in _places(begin, end, scales):
        ways = [float(abs(stop[k] - begin[k])) for k in group.axes]
        feed = group.feed(ways, slow)
        yield Move({k: stop[k] for k in group.axes if stop[k] != begin[k]}, feed, group.seconds(ways, feed))
        begin = stop


def _places(begin: Places, end: Places, scales: Sequence[AxisScale]) -> Iterator[Places]:
    """Yield the places on a straight way, its end included, between which no axis turns far; none for no way."""
    if begin == end:
        return
    turns = [math.radians(abs(end[k] - begin[k])) for k in end if scales[k].axis.rotary]
    count = int(turn_parts(np.array(max(turns, default=0.0))))
    for part in range(1, count + 1):
        yield {k: (begin[k] + (end[k] - begin[k]) * part / count).quantize(scales[k].step) for k in end}
