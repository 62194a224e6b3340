"""One reading: what an instrument said at one place of the machine. Many places stand as columns.

People and files write places, directions and approaches in mm and deg, "-y", "X+ Y-".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from axiscal.exceptions import ReadingError
from axiscal.language.spoken import listed, put, said
from axiscal.measurement.setup import MOST, Reads, Setup
from axiscal.numerics import Array
from axiscal.units import to_unit
from axiscal_core.axes import Axis

KEPT_AS = {"pose": "position", "number": "reading"}
"""What a record calls fields of a place and of a reading."""
_ABSURD = 1e9
"""m or rad: no number of a reading is as large; what deviates by less is judged by those who know the machine."""
Size = Annotated[float, Field(gt=-_ABSURD, lt=_ABSURD)]
_Pose = Annotated[tuple[float, ...], Field(alias=KEPT_AS["pose"])]
_Sides = tuple[Annotated[int, Field(ge=-1, le=1)], ...]


@dataclass(frozen=True, slots=True)
class Place:
    """Where one reading is taken.

    setup : name; pose : (n_axes,) m or rad, in chain order
    approach : (n_axes,) from where each axis comes, +1, −1, 0 for any side; left out for any side of all
    check : it was drawn at random; the same place all the same
    """

    setup: str
    pose: _Pose
    approach: _Sides = ()
    check: bool = field(default=False, compare=False, kw_only=True)


@dataclass(frozen=True, eq=False, slots=True)
class Places:
    """Where many readings are taken.  setups : (m,) indices; poses : (m, q) m or rad; approaches : (m, q) +1, −1, 0."""

    setups: NDArray[np.intp]
    poses: Array
    approaches: Array

    @classmethod
    def none(cls, axes: int) -> Places:
        """Return no places, of a machine with so many axes."""
        return cls(np.zeros(0, dtype=np.intp), np.zeros((0, axes)), np.zeros((0, axes)))

    @classmethod
    def one(cls, setup: int, pose: Array, approach: Array) -> Places:
        """Return a single place.  pose, approach : (q,)"""
        return cls(np.array([setup], dtype=np.intp), pose[None], approach[None])

    @classmethod
    def of_setup(cls, setup: int, poses: Array, approaches: Array) -> Places:
        """Return places of one set-up.  poses, approaches : (m, q)"""
        return cls(np.full(len(poses), setup, dtype=np.intp), poses, approaches)

    @classmethod
    def joined(cls, parts: Sequence[Places]) -> Places:
        """Return the places of all parts, one after another; at least one part."""
        columns = zip(*((part.setups, part.poses, part.approaches) for part in parts), strict=True)
        setups, poses, approaches = (np.concatenate(column) for column in columns)
        return cls(setups.astype(np.intp), poses, approaches)

    def in_setup(self, setup: int) -> tuple[Array, Array]:
        """Return poses and approaches of one set-up."""
        mine = self.setups == setup
        return self.poses[mine], self.approaches[mine]

    def by_setup(self) -> Iterator[tuple[int, NDArray[np.intp]]]:
        """Yield each set-up with the indices of its places."""
        for setup in sorted(set(self.setups.tolist())):  # np.unique would load numpy.ma, a tenth of a second
            yield setup, np.flatnonzero(self.setups == setup)

    def within(self, kept: NDArray[np.bool_] | NDArray[np.intp] | slice) -> Places:
        """Return some of them: those that are kept, or those at indices, in their order."""
        return Places(self.setups[kept], self.poses[kept], self.approaches[kept])

    def single(self, index: int) -> Places:
        """Return one of them."""
        return self.within(np.array([index], dtype=np.intp))

    def without(self, index: int) -> Places:
        """Return all but one of them."""
        return self.within(np.arange(len(self)) != index)

    def exchanged(self, index: int, place: Places) -> Places:
        """Return them with another single place for one of them."""
        order = np.arange(len(self))
        order[index] = len(self)
        return Places.joined([self, place]).within(order)

    def listed(self, setups: Sequence[Setup]) -> tuple[Place, ...]:
        """Return them one by one.  setups : those that the indices count"""
        rows = zip(self.setups.tolist(), self.poses.tolist(), self.approaches.astype(int).tolist(), strict=True)
        return tuple(Place(setups[of].name, tuple(pose), tuple(sides)) for of, pose, sides in rows)

    def same_as(self, others: Places) -> bool:
        """Return whether they are the same places in any order."""
        mine, theirs = (np.column_stack([each.setups, each.poses, each.approaches]) for each in (self, others))
        return mine.shape == theirs.shape and bool(np.all(mine[np.lexsort(mine.T)] == theirs[np.lexsort(theirs.T)]))

    def __len__(self) -> int:
        return len(self.setups)


LARGEST = 1e3
"""m or rad: no machine deviates by a kilometre; any bound between a machine's size and this would do."""


@dataclass(frozen=True, slots=True)
class Reading(Place):
    """A deviation, actual minus commanded, of the TCP relative to the workpiece along (about) the set-up's direction.

    value : m or rad; along x where an instrument reads three directions
    others : its values along y and z
    time : when it was taken, s since the campaign began; None where nobody looked at a clock
    std : standard deviation of this reading in the unit of the value; None takes the set-up's noise
    line : line of the file it came from, if it came from one
    accepted : somebody vouches for it, however much it surprises
    number : under which a campaign knows it for life, from 1; None outside of a campaign
    """

    value: Size = 0.0
    std: Annotated[Size, Field(gt=0)] | None = None
    line: int | None = None
    accepted: bool = False
    others: tuple[Size, ...] = ()
    time: float | None = None
    number: Annotated[int | None, Field(alias=KEPT_AS["number"])] = None

    @property
    def place(self) -> Place:
        """Where it was taken."""
        return Place(self.setup, self.pose, self.approach, check=self.check)

    def numbered(self, index: int) -> int:
        """Return its number; where no campaign gave one, that of its place in the list of readings, from 1."""
        return index + 1 if self.number is None else self.number

    def under(self, number: int) -> Reading:
        """Return the same reading under the number by which a campaign knows it."""
        return replace(self, number=number)

    @property
    def values(self) -> tuple[float, ...]:
        """All numbers of the reading, m or rad."""
        return (self.value, *self.others)


def drawn(readings: Sequence[Reading], most: int) -> list[Reading]:
    """Return all readings, or `most` of them, drawn the same way each time."""
    if len(readings) <= most:
        return list(readings)
    chosen = np.sort(np.random.default_rng(0).choice(len(readings), most, replace=False))
    return [readings[int(i)] for i in chosen]


_VALUE_COLUMNS = ("value_um", "value_urad", *(f"value_{name}_um" for name in ("x", "y", "z", *range(1, MOST + 1))))
"""Columns for values in a file of readings, in their order."""
_UNIT: Mapping[Reads, str] = {"length": "um", "angle": "urad"}
_TO_A_MICROMETRE = 6
"""Decimals of m, or rad: a reading is told from others by less, and where it was taken stands in the list."""


def in_radii(position: Mapping[str, float], axes: Iterable[Axis]) -> dict[str, float]:
    """Return coordinates by axis, of those that a file has as "X_radius" or "X_diameter" as well.

    Raises ReadingError where a display shows diameters and the file does not say which they are, or says both.
    """
    found = dict(position)
    for axis in axes:
        radius, diameter = (found.pop(f"{axis.name}_{kind}", None) for kind in ("radius", "diameter"))
        said = [value for value in (radius, None if diameter is None else diameter / 2) if value is not None]
        if len(said) > 1 or (axis.diameters and axis.name in found):
            what = "{axis} shows diameters, and this file does not say whether its {axis} is the radius or the diameter"
            what = "{axis} is given twice" if len(said) > 1 else what
            raise ReadingError(what, "Call the column {axis}_radius_mm or {axis}_diameter_mm", axis=axis.name)
        if said:
            found[axis.name] = said[0]
    return found


def shown_coordinate(value: float, axis: Axis) -> float:
    """Return a coordinate (m or rad) in mm or deg, without the digits that the conversion left."""
    converted = to_unit(value, axis.unit)
    return round(converted, 9) + 0.0 if math.isfinite(converted) else converted


def shown_pose(axes: Sequence[Axis], pose: Sequence[float]) -> dict[str, float]:
    """Return a pose (n_axes,) in mm and deg by axis."""
    return {axis.name: shown_coordinate(value, axis) for axis, value in zip(axes, pose, strict=True)}


def place_text(axes: Sequence[Axis], pose: Sequence[float], only: Sequence[int] | None = None) -> str:
    """Return a pose as "X = 120 mm, C = 30 deg", of all axes or of some."""
    chosen = range(len(axes)) if only is None else only
    at = [(axes[k], float(shown_coordinate(pose[k], axes[k]))) for k in chosen]
    return listed(", ", [put("{axis} = {at:.9g} {unit}", axis=a.name, at=shown, unit=a.unit) for a, shown in at])


def reading_text(axes: Sequence[Axis], setup: Setup, reading: Reading, index: int) -> str:
    """Return which reading is meant: 'reading 7 in "laser" at X = 120 mm'.  index : in the list of readings"""
    place = place_text(axes, [round(value, _TO_A_MICROMETRE) for value in reading.pose], setup.moves)
    number = reading.numbered(index)
    if place:
        return said('reading {number} in "{setup}" at {place}', number=number, setup=setup.name, place=place)
    return said('reading {number} in "{setup}"', number=number, setup=setup.name)


def shown_approach(axes: Sequence[Axis], approach: Sequence[float]) -> dict[str, str]:
    """Return "+" or "-" by axis, for the axes whose direction of the last motion counts.  approach : +1, -1, 0."""
    return {a.name: "+" if sign > 0 else "-" for a, sign in zip(axes, approach, strict=True) if sign}


def approach_text(axes: Sequence[Axis], approach: Sequence[float]) -> str:
    """Return the directions of approach as files of readings have them: "X+ Y-"."""
    return " ".join(name + sign for name, sign in shown_approach(axes, approach).items())


def direction_text(setup: Setup) -> str:
    """Return the direction that a set-up reads along or about: "x", "-y" or "(0.6, 0.8, 0)"."""
    for letter, component in zip("xyz", setup.direction, strict=True):
        if abs(component) == 1:
            return letter if component > 0 else f"-{letter}"
    return "(" + ", ".join(f"{component:.4g}" for component in setup.direction) + ")"


class Sense(NamedTuple):
    """What a set-up reads, of the tool, seen from the workpiece.

    reads : "x, y and z", "the distance from its station", "along x" or "about -y"; sign : when a reading is positive
    """

    reads: str
    sign: str


def sense(setup: Setup) -> Sense:
    """Return what a set-up reads."""
    direction = direction_text(setup)
    if setup.written:
        return Sense(", ".join(setup.names), said("+ as the instrument counts"))
    towards = "+ where the tool stands too far towards {way}, seen from the workpiece"
    if len(setup.numbers) > 1:
        return Sense(said("x, y and z"), said(towards, way="+x, +y, +z"))
    if not setup.directed:
        several, one = "the distances from its {count} stations, in their order", "the distance from its station"
        reads = said(several, count=len(setup.stations)) if setup.stations else said(one)
        return Sense(reads, said("+ where the distance is longer than it should be"))
    way = direction if direction[0] in "-(" else f"+{direction}"
    if setup.reads == "angle":
        turned = "+ where the tool is turned too far about {way} by the right hand, seen from the workpiece"
        return Sense(said("about {way}", way=direction), said(turned, way=way))
    return Sense(said("along {way}", way=direction), said(towards, way=way))


def value_columns(setup: Setup) -> tuple[str, ...]:
    """Return the columns of a file of readings for its values, such as value_um, or value_x_um and two more."""
    return tuple(f"{setup.column(n)}_{unit}" for n, unit in zip(setup.names, units_of(setup), strict=True))


def refuse_other_values(setup: Setup, count: int, dimension: str | None = None) -> None:
    """Raise ReadingError for values that a set-up's instrument does not read.  dimension : where a file says it"""
    reads, values, instrument = setup.reads, len(setup.names), setup.instrument
    if dimension not in (None, reads):
        what = 'the {instrument} of the set-up "{setup}" reads a length, not an angle'
        if reads == "angle":
            what = 'the {instrument} of the set-up "{setup}" reads an angle, not a length'
        remedy, unit = "Give the value as value_{unit}", reading_unit(setup)
        raise ReadingError(what, remedy, instrument=instrument, setup=setup.name, unit=unit)
    if count != values:
        *first, last = value_columns(setup)
        what = 'the {instrument} of "{setup}" gives {count} values a reading'
        remedy = "Give one value, in a file as {last}" if values == 1 else "Give each, in a file as {first} and {last}"
        columns = {"first": ", ".join(first), "last": last}
        raise ReadingError(what, remedy, None, None, instrument=instrument, setup=setup.name, count=values, **columns)


def columns_of(setups: Iterable[Setup]) -> list[str]:
    """Return the columns of a file of readings for the values of set-ups, those of each kind beside each other."""
    needed = dict.fromkeys(column for setup in setups for column in value_columns(setup))
    usual = [column for column in _VALUE_COLUMNS if column in needed]
    return [*usual, *(column for column in needed if column not in usual)]


def reading_unit(setup: Setup) -> str:
    """Return the unit in which its readings are shown: "um" or "urad"; of unlike numbers that of the first."""
    return units_of(setup)[0]


def reading_units(setup: Setup) -> str:
    """Return the units of all numbers of its readings, each once: "um", or "um, urad"."""
    return listed(", ", [*dict.fromkeys(units_of(setup))])


def asked_values(setup: Setup) -> str:
    """Return what is asked for at a reading: "um", or of several numbers "dx um, dy um"."""
    pairs = zip(setup.names, units_of(setup), strict=True)
    return listed(", ", [put("{name} {unit}", name=name, unit=unit) if name else unit for name, unit in pairs])


def units_of(setup: Setup) -> tuple[str, ...]:
    """Return the unit in which each number of its readings is shown."""
    return tuple(_UNIT[reads] for reads in setup.reads_each)


def seconds_since(begun: str, readings: Sequence[Reading]) -> float:
    """Return the seconds since a campaign was begun, ISO 8601; never less than at its last reading."""
    now = (datetime.now(UTC) - datetime.fromisoformat(begun)).total_seconds()
    return max([0.0, round(now, 3), *(each.time for each in readings[-1:] if each.time is not None)])
