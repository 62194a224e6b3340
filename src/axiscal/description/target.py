"""The target of a campaign: how good, over which volume, and how much it may cost.

Parts may fill only some of the volume: a cylinder or a box in the workpiece frame.

What a job is about: the rows that a target asks for, such as "positioning X 5 um".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from pydantic import Field

from axiscal.description.fields import Duration, Ends, Spans, Wanted, ends_on, span
from axiscal.document import Document, QuantityText, nearest, shown
from axiscal.document.toml_table import Table
from axiscal.document.validation import Beside, EachAs, ReadAs
from axiscal.errors.volume import EVERY_WAY, Counted
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import tip_at
from axiscal.measurement.charts.room import Room
from axiscal.measurement.setup import FINEST
from axiscal.numerics import Array
from axiscal.units import Dimension, format_quantity, within
from axiscal_core.machine import Machine
from axiscal_core.points import even_points

MOST_READINGS = 100_000
"""Weeks of measuring; whoever says more has slipped."""
Kind = Literal[
    "positioning", "scale", "backlash", "straightness", "pitch", "yaw", "roll", "squareness", "centre", "tilt", "volume"
]
"""What the tool's path along a line, or its deviation over the volume, is asked about."""
ANGLES: tuple[Kind, ...] = ("pitch", "yaw", "roll")
ABOUT: tuple[Kind, ...] = ("centre", "tilt")
"""Where the line of a rotary axis is, and which way it points."""
_LETTERS = "XYZ"


class RowName(NamedTuple):
    """A row of an answer: its kind, and the axes it is about by name.

    axes : one; of a straightness the axis that moves and the one it deviates along; of a squareness both; else none
    """

    kind: Kind
    axes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The row as a person writes it."""
        if self.kind == "straightness":
            return f"straightness {' in '.join(self.axes)}"
        if self.kind in ABOUT:
            return f"{self.kind} of {self.axes[0]}"
        return f"{self.kind} {''.join(self.axes)}".rstrip()


class Want(NamedTuple):
    """A wanted row and its limit, m or rad; None where no limit is given."""

    row: RowName
    limit: float | None = None


def rows_of(machine: Machine) -> list[RowName]:
    """Return the rows that can be asked of a machine."""
    every, linear = [axis.name for axis in machine.axes], [axis for axis in machine.axes if not axis.rotary]
    found: list[tuple[Kind, tuple[str, ...]]] = [("positioning", (name,)) for name in every]
    found += [("backlash", (name,)) for name in every]
    found += [("scale", (axis.name,)) for axis in linear]
    for axis in linear:
        others = (name for name in _LETTERS if letter_direction(name) != letter_direction(axis.letter))
        found += [("straightness", (axis.name, other)) for other in others]
    found += [(kind, (axis.name,)) for kind in ANGLES for axis in linear]
    found += [(kind, (axis.name,)) for kind in ABOUT for axis in machine.axes if axis.rotary]
    found += [("squareness", pair) for pair in combinations(sorted({*_LETTERS} & {a.name for a in linear}), 2)]
    return [RowName(*row) for row in (*found, ("volume", ()))]


def dimension(row: RowName, machine: Machine) -> Dimension:
    """Return whether a row is a length or an angle, or a strain, which has the units of an angle."""
    if row.kind in ("positioning", "backlash"):
        return machine.axis(row.axes[0]).dimension
    return "angle" if row.kind in ("scale", "squareness", "tilt", *ANGLES) else "length"


def _want(_: int, text: str, given: Beside) -> Want:
    known = {row.name.casefold(): row for row in rows_of(given.context.machine)}
    planes = [row for row in known.values() if row.kind == "squareness"]
    known |= {RowName(row.kind, row.axes[::-1]).name.casefold(): row for row in planes}
    plain = " ".join(text.split()).casefold()
    name = max((each for each in known if f"{plain} ".startswith(f"{each} ")), key=len, default=None)
    if name is None:
        word = re.split(r"\s[+-]?[0-9.]", plain)[0]
        near = nearest(word, known)
        firsts = {row.kind: f'"{row.name}"' for row in reversed(known.values())}
        named = ", ".join(reversed(firsts.values()))
        remedy = said("Ask for rows such as {names}, each with a limit or without", names=named)
        remedy = said("Perhaps {word} is meant", word=f'"{known[near].name}"') if near else remedy
        raise DescriptionError("{text} is no row of an answer for this machine", remedy, text=shown(text))
    row, rest = known[name], " ".join(text.split())[len(name) :].strip()
    return Want(row, within(rest, dimension(row, given.context.machine), FINEST) if rest else None)


def _once(wants: list[Want]) -> tuple[Want, ...]:
    rows = [want.row for want in wants]
    for row in rows:
        if rows.count(row) > 1:
            raise DescriptionError("{row} is asked for twice", "Ask for it once", row=shown(row.name))
    return tuple(wants)


Criterion = Literal["volume", "rows", "joint", "worst"]
RefersTo = Literal["20 degC", "as read"]
_LOOKED_AT, _FEWEST = 1000, 20
"""Poses looked at, and how many of them have to be within the travels for a part to be in reach."""
_MARGIN, _THIN = 0.02, 1e-6
"""Shares of width and travel by which the box is wider than the poses looked at, which miss its edges."""


@dataclass(frozen=True, slots=True)
class Target:
    """When to stop: at its readings or budget, or once all rows with a limit and one of rms, worst, U are reached.

    rms, worst : m, of the TCP over the volume; budget : s
    volume : (lowest, highest) coordinate per axis in chain order, m or rad
    criterion : what the next reading is chosen to reduce
    part : where the work is done, instead of a volume of axes; the volume is then the box around its poses
    aligned : a rigid motion of the part is not counted: it is probed
    expanded : U, of the TCP in space over the volume with 95 %, m
    refers_to : the temperature for which it is to be good: 20 °C (ISO 1), or that of the readings
    counted : whether deviations of the TCP along x, y and z of the workpiece frame count
    wants : the rows of the answer that are asked for; none where they follow from the set-ups
    checks : readings at places drawn at random, among all; None for as many as is usual
    """

    rms: float | None
    worst: float | None
    readings: int | None
    budget: float | None
    volume: tuple[tuple[float, float], ...]
    criterion: Criterion
    part: PartVolume | None = None
    aligned: bool = True
    expanded: float | None = None
    counted: Counted = EVERY_WAY
    refers_to: RefersTo = "as read"
    wants: tuple[Want, ...] = ()
    checks: int | None = None

    @property
    def lines(self) -> tuple[Want, ...]:
        """The rows with a limit that are not the volume's."""
        return tuple(want for want in self.wants if want.limit is not None and want.row.kind != "volume")

    @property
    def of_volume(self) -> bool:
        """Return whether the volume is asked about: by an accuracy, by name, or because no row is."""
        named = not self.wants or any(want.row.kind == "volume" for want in self.wants)
        return named or not self.rms is self.worst is self.expanded is None

    @property
    def accurate(self) -> bool:
        """Return whether the target wants an accuracy, of the volume or of a row."""
        return bool(self.lines) or not self.rms is self.worst is self.expanded is None

    def taken(self, count: int) -> str | None:
        """Return in words that so many readings are all that were wanted; None where they are not."""
        if self.readings is None or count < self.readings:
            return None
        return f"{count} reading{'' if count == 1 else 's'} taken"

    @property
    def empty(self) -> bool:
        """Whether nothing would ever stop the campaign."""
        return not self.accurate and self.readings is self.budget is None


POSES = 4000
_TRIED = 16
"""How many times more places are tried than are wanted before fewer are returned."""


@dataclass(frozen=True, slots=True)
class PartVolume:
    """Where the work is done.

    spans : along x, y, z, m, workpiece frame; radius : of a cylinder about z instead of the spans along x and y, m
    turns : (rotary axes,) the range in which each turns, rad, in chain order
    """

    spans: tuple[Ends, Ends, Ends]
    radius: float | None
    turns: tuple[Ends, ...]

    def poses(self, machine: Machine, count: int = POSES) -> Array:
        """Return up to so many poses within the travels, spread evenly over places of the part and turns, (m, q)."""
        unit = even_points(_TRIED * count, 3 + len(self.turns))
        room, found = Room.empty(machine), np.zeros((0, len(machine.axes)))
        for tried in np.split(unit, _TRIED):
            poses = self._at(machine, tried)
            found = np.concatenate([found, poses[room.in_travel(poses)]])
            if len(found) >= count:
                break
        return found[:count]

    def _at(self, machine: Machine, unit: Array) -> Array:
        """Return the poses of places of the part, within the travels or not, (m, q).  unit : (m, 3 + turns) shares"""
        park = np.zeros((len(unit), len(machine.axes)))
        park[:, [not axis.rotary for axis in machine.axes]] = [sum(a.travel) / 2 for a in machine.axes if not a.rotary]
        low, high = np.array(self.turns).reshape(-1, 2).T
        park[:, [axis.rotary for axis in machine.axes]] = low + (high - low) * unit[:, 3:]
        low, high = np.array(self.spans).T
        points = low + (high - low) * unit[:, :3]
        if self.radius is not None:
            far, turn = self.radius * np.sqrt(unit[:, 0]), 2 * np.pi * unit[:, 1]
            points[:, 0], points[:, 1] = far * np.cos(turn), far * np.sin(turn)
        return tip_at(machine, park, points)


Size = float | Ends
_SIZES = dict[str, QuantityText | list[QuantityText]]
_SHAPE = 'Write { radius = "200 mm", z = ["-100 mm", "100 mm"] } or { x = [...], y = [...], z = [...] }'


def _size(key: str, given: str | list[str], known: Beside) -> Size:
    """Return the radius of a part, or from where to where it goes along one way, or an axis turns, m or rad."""
    if key == "radius":
        if isinstance(given, str):
            return within(given, "length", FINEST)
        raise DescriptionError("{text} is no radius", 'Give one such as "200 mm"', text=shown(given))
    ends = given if isinstance(given, list) else [given]
    if key in ("x", "y", "z"):
        return span(ends)
    axis = known.context.machine.axis(key)
    if not axis.rotary:
        remedy = "Name x, y, z in the workpiece frame, or a rotary axis"
        raise DescriptionError("{axis} follows the part", remedy, axis=axis.name)
    return ends_on(ends, axis)


def _part(given: Mapping[str, Any], known: Beside) -> PartVolume:
    if known.data.get("volume"):
        raise DescriptionError("part and volume exclude one another", "Give one of them")
    radius, along = given.get("radius"), {"x", "y", "z"} & set(given)
    if along != ({"x", "y", "z"} if radius is None else {"z"}):
        raise DescriptionError("the part has no shape", _SHAPE)
    turns = tuple(given.get(axis.name, axis.travel) for axis in known.context.machine.axes if axis.rotary)
    width = (-(radius or 0.0), radius or 0.0)
    return PartVolume((given.get("x", width), given.get("y", width), given["z"]), radius, turns)


def _checks(checks: int, known: Beside) -> int:
    readings, remedy = known.data.get("readings"), "Leave checks out for the usual number"
    if readings is not None and checks >= readings:
        what = "{checks} checks leave none of {readings} readings to plan"
        raise DescriptionError(what, remedy, checks=checks, readings=readings)
    return checks


def _worst(worst: float, known: Beside) -> float:
    rms = known.data.get("rms")
    if rms is not None and worst <= rms:
        what = "{worst} for the worst point can never be reached before {rms} RMS, and the first one reached stops"
        remedy, sizes = "Give a worst that is larger than rms, or only one of them", (worst, rms)
        shorter, longer = (format_quantity(each, "um") for each in sizes)
        raise DescriptionError(what, remedy, worst=shorter, rms=longer)
    return worst


def _expanded(stated: float, known: Beside) -> float:
    if any(want.row.kind == "volume" and want.limit is not None for want in known.data.get("wants", ())):
        raise DescriptionError("U and the limit of the row volume are one thing", "Give one of them")
    return stated


def _counted(directions: list[str]) -> Counted:
    if not directions:
        remedy = 'Give one or more of "x", "y", "z", such as directions = ["z"] for a height'
        raise DescriptionError("no direction is left in which the tool point counts", remedy)
    x, y, z = (way in directions for way in ("x", "y", "z"))
    return x, y, z


class TargetTable(Table):
    """[target]: when to stop, and over what."""

    rms: Wanted | None = Field(None, examples=['"2 um"'])
    worst: Annotated[float, ReadAs(Wanted, _worst, by=True)] | None = Field(None, examples=['"4 um"'])
    wants: Annotated[tuple[Want, ...], ReadAs(Annotated[list[Want], EachAs(list[str], _want)], _once)] = Field(
        (), examples=['["positioning X 5 um", "backlash X", "volume 20 um"]']
    )
    U: Annotated[float, ReadAs(Wanted, _expanded, by=True)] | None = Field(None, examples=['"12 um"'])
    readings: int | None = Field(None, gt=0, le=MOST_READINGS, examples=["40"])
    checks: Annotated[int, ReadAs(Annotated[int, Field(ge=0)], _checks, by=True)] | None = Field(None, examples=["5"])
    budget: Duration | None = Field(None, examples=['"90 min"'])
    volume: Spans = Field(default={}, examples=['{ X = ["50 mm", "550 mm"] }'])
    part: Annotated[PartVolume, ReadAs(Annotated[dict[str, Size], EachAs(_SIZES, _size)], _part, by=True)] | None = (
        Field(None, examples=['{ radius = "200 mm", z = ["-100 mm", "100 mm"], B = ["-30 deg", "100 deg"] }'])
    )
    aligned: bool | None = Field(None, examples=["true"])
    directions: Annotated[Counted, ReadAs(list[Literal["x", "y", "z"]], _counted)] = Field(
        EVERY_WAY, examples=['["z"]']
    )
    criterion: Literal["volume", "rows", "joint", "worst"] | None = Field(None, examples=['"volume"'])
    refers_to: Literal["20 degC", "as read"] | None = Field(None, examples=['"20 degC"'])
    unchecked: Literal["refuse", "allow"] = Field("refuse", examples=['"allow"'])


def read_target(table: TargetTable, machine: Machine, document: Document) -> Target:
    """Return the target; raises DescriptionError for a part that no pose reaches."""
    if table.part is None:
        volume = tuple(table.volume.get(axis.name, axis.travel) for axis in machine.axes)
    else:
        with document.placed("target", "part"):
            volume = _around(table.part, machine)
    usual = table.part is not None or all(table.directions)  # where heights alone count, as of a bed, no part is probed
    whole = next((want.limit for want in table.wants if want.row.kind == "volume"), None)
    return Target(
        volume=volume,
        criterion=table.criterion or ("rows" if any(want.row.kind != "volume" for want in table.wants) else "volume"),
        aligned=usual if table.aligned is None else table.aligned,
        expanded=table.U if whole is None else whole,
        counted=table.directions,
        **{key: getattr(table, key) for key in ("rms", "worst", "readings", "budget", "part", "wants", "checks")},
    )


def _around(part: PartVolume, machine: Machine) -> tuple[tuple[float, float], ...]:
    """Return the box of axes around the poses of a part; raises DescriptionError where no pose reaches it."""
    poses = part.poses(machine, _LOOKED_AT)
    if len(poses) < _FEWEST:
        raise DescriptionError("hardly a pose has the tool point in this part", "Place it within the travels")
    low, high = poses.min(axis=0), poses.max(axis=0)
    lowest, highest = np.array([axis.travel for axis in machine.axes]).T
    margin = _MARGIN * (high - low) + _THIN * (highest - lowest)
    bounds = np.stack([np.maximum(low - margin, lowest), np.minimum(high + margin, highest)], axis=1)
    return tuple((float(first), float(last)) for first, last in bounds)
