"""The target of a campaign: how good, over which volume, and how much it may cost.

Parts may fill only some of the volume: a cylinder or a box in the workpiece frame.

What a job is about: the rows that a target asks for, such as "positioning X 5 um".
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal, NamedTuple

import numpy as np

from axiscal.description.campaign_schema import TargetTable
from axiscal.description.vectors import span
from axiscal.document import Document, nearest, shown
from axiscal.errors.volume import EVERY_WAY, Counted
from axiscal.exceptions import DescriptionError, InputError
from axiscal.language.spoken import said
from axiscal.machine import Axis, Machine
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import tip_at
from axiscal.measurement.charts.room import Room
from axiscal.numerics import Array, even_points
from axiscal.units import Dimension, format_quantity, parse_quantity

Kind = Literal[
    "positioning", "backlash", "straightness", "pitch", "yaw", "roll", "squareness", "centre", "tilt", "volume"
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
    return [*_rows_of(machine.axes), RowName("volume")]


def dimension(row: RowName, machine: Machine) -> Dimension:
    """Return whether a row is a length or an angle."""
    if row.kind in ("positioning", "backlash"):
        return machine.axis(row.axes[0]).dimension
    return "angle" if row.kind in ("squareness", "tilt", *ANGLES) else "length"


def _rows_of(axes: Sequence[Axis]) -> Iterator[RowName]:
    linear = [axis for axis in axes if not axis.rotary]
    square = sorted(axis.name for axis in linear if axis.name in _LETTERS)
    kinds: tuple[Kind, ...] = ("positioning", "backlash")
    for kind in kinds:
        yield from (RowName(kind, (axis.name,)) for axis in axes)
    for axis in linear:
        others = [name for name in _LETTERS if letter_direction(name) != letter_direction(axis.letter)]
        yield from (RowName("straightness", (axis.name, other)) for other in others)
    for kind in ANGLES:
        yield from (RowName(kind, (axis.name,)) for axis in linear)
    for kind in ABOUT:
        yield from (RowName(kind, (axis.name,)) for axis in axes if axis.rotary)
    yield from (RowName("squareness", pair) for pair in combinations(square, 2))


def read_wants(texts: Sequence[str], machine: Machine, document: Document) -> tuple[Want, ...]:
    """Return the rows that are asked for; raises DescriptionError or UnitError at the line of the text."""
    known = {row.name.casefold(): row for row in rows_of(machine)}
    planes = [row for row in known.values() if row.kind == "squareness"]
    known |= {RowName(row.kind, row.axes[::-1]).name.casefold(): row for row in planes}
    found = list[Want]()
    for index, text in enumerate(texts):
        with document.placed("target", "wants", index):
            want = _want(text, known, machine)
            if want.row in [each.row for each in found]:
                raise DescriptionError("{row} is asked for twice", "Ask for it once", row=shown(want.row.name))
        found.append(want)
    return tuple(found)


def _want(text: str, known: Mapping[str, RowName], machine: Machine) -> Want:
    plain = " ".join(text.split()).casefold()
    name = max((each for each in known if f"{plain} ".startswith(f"{each} ")), key=len, default=None)
    if name is None:
        word = re.split(r"\s[+-]?[0-9.]", plain)[0]
        near = nearest(word, known)
        remedy = said("Perhaps {word} is meant", word=f'"{known[near].name}"') if near else _examples(known)
        raise DescriptionError("{text} is no row of an answer for this machine", remedy, text=shown(text))
    row, rest = known[name], " ".join(text.split())[len(name) :].strip()
    if not rest:
        return Want(row)
    limit = parse_quantity(rest, dimension(row, machine))
    if not limit > 0:
        remedy = "Give a limit above zero, or none"
        raise DescriptionError("{text}: the limit is not above zero", remedy, text=shown(text))
    return Want(row, limit)


def _examples(known: Mapping[str, RowName]) -> str:
    firsts = dict[Kind, str]()
    for row in known.values():
        firsts.setdefault(row.kind, row.name)
    names = ", ".join(f'"{name}"' for name in firsts.values())
    return said("Ask for rows such as {names}, each with a limit or without", names=names)


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

    @property
    def lines(self) -> tuple[Want, ...]:
        """The rows with a limit that are not the volume's."""
        return tuple(want for want in self.wants if want.limit is not None and want.row.kind != "volume")

    @property
    def accurate(self) -> bool:
        """Return whether the target wants an accuracy, of the volume or of a row."""
        return bool(self.lines) or not self.rms is self.worst is self.expanded is None

    @property
    def empty(self) -> bool:
        """Whether nothing would ever stop the campaign."""
        return not self.accurate and self.readings is self.budget is None


def read_target(table: TargetTable, machine: Machine, document: Document) -> Target:
    """Return the target; raises DescriptionError or UnitError at the line that is wrong."""
    if table.rms is not None and table.worst is not None and table.worst <= table.rms:
        rms, worst = format_quantity(table.rms, "um"), format_quantity(table.worst, "um")
        what = "{worst} for the worst point can never be reached before {rms} RMS, and the first one reached stops"
        remedy = "Give a worst that is larger than rms, or only one of them"
        raise _fault(document, what, remedy, "worst", worst=worst, rms=rms)
    part = None if table.part is None else read_part(table.part, machine, document)
    if part is not None and table.volume:
        raise _fault(document, "part and volume exclude one another", "Give one of them", "part")
    volume = _volume(table, machine, document) if part is None else _around(part, machine, document)
    if not table.directions:
        remedy = 'Give one or more of "x", "y", "z", such as directions = ["z"] for a height'
        raise _fault(document, "no direction is left in which the tool point counts", remedy, "directions")
    x, y, z = (way in table.directions for way in ("x", "y", "z"))
    usual = part is not None or (x and y and z)  # where heights alone count, as of a bed, no part is probed
    aligned = usual if table.aligned is None else table.aligned
    limits = table.rms, table.worst, table.readings, table.budget
    wants = read_wants(table.wants, machine, document)
    expanded = _expanded(table.U, wants, document)
    criterion = table.criterion or ("rows" if any(want.row.kind != "volume" for want in wants) else "volume")
    return Target(*limits, volume, criterion, part, aligned, expanded, (x, y, z), wants=wants)


def _expanded(stated: float | None, wants: Sequence[Want], document: Document) -> float | None:
    """Return the U of the volume that the target wants, m, by its own key or by the row "volume"."""
    wanted = next((want.limit for want in wants if want.row.kind == "volume"), None)
    if stated is not None and wanted is not None:
        raise _fault(document, "U and the limit of the row volume are one thing", "Give one of them", "U")
    return stated if wanted is None else wanted


def _around(part: PartVolume, machine: Machine, document: Document) -> tuple[tuple[float, float], ...]:
    """Return the box of axes around the poses of a part; raises DescriptionError where no pose reaches it."""
    poses = part.poses(machine, _LOOKED_AT)
    if len(poses) < _FEWEST:
        raise _fault(document, "hardly a pose has the tool point in this part", "Place it within the travels", "part")
    low, high = poses.min(axis=0), poses.max(axis=0)
    lowest, highest = np.array([axis.travel for axis in machine.axes]).T
    margin = _MARGIN * (high - low) + _THIN * (highest - lowest)
    bounds = np.stack([np.maximum(low - margin, lowest), np.minimum(high + margin, highest)], axis=1)
    return tuple((float(first), float(last)) for first, last in bounds)


def coordinate(text: str, axis: Axis) -> float:
    """Return a position on an axis, m or rad; raises UnitError, or DescriptionError outside the travel."""
    value = parse_quantity(text, axis.dimension)
    low, high = axis.travel
    slack = 1e-9 * axis.length
    if not low - slack <= value <= high + slack:
        what = '"{text}" is outside the travel of {axis}'
        raise DescriptionError(what, "It goes from {travel}", text=text, axis=axis.name, travel=axis.travel_text)
    return min(max(value, low), high)


def _volume(table: TargetTable, machine: Machine, document: Document) -> tuple[tuple[float, float], ...]:
    bounds = {axis.name: axis.travel for axis in machine.axes}
    for name, texts in table.volume.items():
        with document.placed("target", "volume", name):
            bounds[name] = ends_on(texts, machine.axis(name))
    return tuple(bounds[axis.name] for axis in machine.axes)


def ends_on(texts: Sequence[str], axis: Axis) -> tuple[float, float]:
    """Return two increasing coordinates within the travel, m or rad; raises DescriptionError or UnitError."""
    if len(texts) != 2:
        remedy = "The axis goes from {travel}"
        raise DescriptionError("{text} has not two ends", remedy, text=shown(texts), travel=axis.travel_text)
    low, high = (coordinate(text, axis) for text in texts)
    if not low < high:
        raise DescriptionError("{text} does not increase", "Give the lower end first", text=shown(texts))
    return low, high


def _fault(document: Document, what: str, remedy: str, key: str, **values: object) -> InputError:
    return document.fault(DescriptionError(what, remedy, None, None, **values), "target", key)


_SHAPE = 'Write { radius = "200 mm", z = ["-100 mm", "100 mm"] } or { x = [...], y = [...], z = [...] }'


def read_part(given: Mapping[str, str | list[str]], machine: Machine, document: Document) -> PartVolume:
    """Return the part; raises DescriptionError or UnitError at the line that is wrong."""
    turns = {axis.name: axis.travel for axis in machine.axes if axis.rotary}
    spans: dict[str, Span] = {}
    radius = None
    for key, value in given.items():
        with document.placed("target", "part", key):
            if key == "radius":
                radius = _radius(value)
            elif key in ("x", "y", "z"):
                spans[key] = span(_listed(value))
            else:
                turns[key] = _turn(value, machine.axis(key))
    if "z" not in spans or (radius is None) != ({"x", "y"} <= set(spans)) or (radius is not None and len(spans) > 1):
        raise document.fault(DescriptionError("the part has no shape", _SHAPE), "target", "part")
    width = (-(radius or 0.0), radius or 0.0)
    return PartVolume((spans.get("x", width), spans.get("y", width), spans["z"]), radius, tuple(turns.values()))


def _radius(value: str | list[str]) -> float:
    radius = parse_quantity(value, "length") if isinstance(value, str) else 0.0
    if not radius > 0:
        raise DescriptionError("{text} is no radius", 'Give one such as "200 mm"', text=shown(value))
    return radius


def _turn(value: str | list[str], axis: Axis) -> Span:
    if not axis.rotary:
        remedy = "Name x, y, z in the workpiece frame, or a rotary axis"
        raise DescriptionError("{axis} follows the part", remedy, axis=axis.name)
    return ends_on(_listed(value), axis)


def _listed(value: str | list[str]) -> list[str]:
    return value if isinstance(value, list) else [value]


Span = tuple[float, float]
POSES = 4000
_TRIED = 16
"""How many times more places are tried than are wanted before fewer are returned."""


@dataclass(frozen=True, slots=True)
class PartVolume:
    """Where the work is done.

    spans : along x, y, z, m, workpiece frame; radius : of a cylinder about z instead of the spans along x and y, m
    turns : (rotary axes,) the range in which each turns, rad, in chain order
    """

    spans: tuple[Span, Span, Span]
    radius: float | None
    turns: tuple[Span, ...]

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
