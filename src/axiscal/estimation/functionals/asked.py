"""Which rows a job is about: those that its target asks for, else those that its set-ups can answer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import ABOUT, ANGLES, Kind, RowName, Want
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.functionals.functional import (
    AxisLine,
    Functional,
    direction_of,
    functional,
    line_of,
    seen_by,
    stand_of,
    through_the_volume,
    ways_of,
)
from axiscal.machine.axis import letter_direction
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.usual import OFFSET

_LETTERS = "XYZ"
EACH = 0.1
"""m, of which a person can think; U grows in proportion."""


@dataclass(frozen=True, eq=False)
class AskedRow:
    """A row with the lines it is about; map : None of the volume; whole : its figures are those of the volume."""

    want: Want
    lines: tuple[AxisLine, ...] = ()
    map: Functional | None = None
    whole: bool = False

    @property
    def own(self) -> Functional | None:
        """The map that its figures follow from; None where they are those of the volume."""
        return None if self.whole else self.map

    def pairs(self, machine: Machine) -> list[tuple[str, str]]:
        """Return the axes that tables move to take the row away, each with the axis over which they do."""
        axes, kind = self.want.row.axes, self.want.row.kind
        if kind in ("positioning", "scale", "backlash"):
            return [(axes[0], axes[0])]
        if kind not in ("straightness", "squareness"):
            return []
        ways = [axes[::-1], axes] if kind == "squareness" else [axes[::-1]]
        names = [axis.name for axis in machine.axes if not axis.rotary]
        return [(name, over) for way, over in ways for name in names if name[0] == way[0]]


def asked_rows(description: CampaignDescription, readings: Sequence[Reading], *, whole: bool = False) -> list[AskedRow]:
    """Return the rows of a campaign with their lines, in the order in which they are asked for.

    whole : lines go as far as set-ups may, read or not; else as far as they were read
    """
    lines = _lines(description, readings, whole)
    wants = description.target.wants or [Want(row) for row in (*_answered(lines), RowName("volume"))]
    return [_asked(want, description, lines) for want in wants]


def rows_served(description: CampaignDescription, readings: Sequence[Reading]) -> list[AskedRow]:
    """Return the rows that are asked for, and those that readings answer besides."""
    lines = _lines(description, readings, whole=False)
    read = {row: line for row, line in lines.items() if line.read}
    rows = dict.fromkeys([*(want.row for want in description.target.wants), *_answered(read)])
    return [_asked(Want(row), description, lines) for row in rows]


def _lines(description: CampaignDescription, readings: Sequence[Reading], whole: bool) -> dict[RowName, AxisLine]:
    """Return the line of each row that a set-up reads, of several set-ups that with the most places read.

    Set-ups that a plan has left out do not count where an accuracy of the volume is asked for.
    """
    machine, target, found = description.machine, description.target, dict[RowName, AxisLine]()
    left_out = set[str]()
    if readings and not whole and target.accurate:
        left_out = {setup.name for setup in description.setups} - {reading.setup for reading in readings}
    for setup in description.setups:
        seen = seen_by(setup, machine, stand_of(setup, readings))
        if setup.name in left_out or seen is None:
            continue
        line = line_of(setup, readings, machine, whole)
        for row in _rows_seen(machine.axes[line.axis], *seen):
            if row not in found or line.read > found[row].read:
                found[row] = line
    turned = {axis for setup in description.setups for axis in setup.moves}
    for axis in sorted(turned):
        if machine.axes[axis].rotary:
            line = through_the_volume(description, axis, readings)
            found |= {RowName(kind, (machine.axes[axis].name,)): line for kind in ABOUT}
    return found


def _rows_seen(axis: Axis, reads: str, way: int) -> Iterator[RowName]:
    """Yield the rows that a set-up answers which moves one axis and reads along, or about, a direction."""
    along = not axis.rotary if reads == "length" else axis.rotary
    if along and letter_direction(axis.letter) == way:
        kinds: tuple[Kind, ...] = ("positioning", "backlash") if axis.rotary else ("positioning", "scale", "backlash")
        yield from (RowName(kind, (axis.name,)) for kind in kinds)
    elif along and not axis.rotary:
        yield RowName("straightness", (axis.name, _LETTERS[way]))
    elif reads == "angle":
        yield from (RowName(kind, (axis.name,)) for kind in ANGLES if direction_of(kind, axis) == way)


def _answered(lines: dict[RowName, AxisLine]) -> Iterator[RowName]:
    """Yield the rows that lines answer: of two straightnesses that face each other the squareness, too."""
    straight = {row.axes for row in lines if row.kind == "straightness"}
    yield from lines
    for first, second in sorted(straight):
        if first < second and (second, first) in straight:
            yield RowName("squareness", (first, second))


def _asked(want: Want, description: CampaignDescription, lines: dict[RowName, AxisLine]) -> AskedRow:
    row, machine, only = want.row, description.machine, _only_line(description, lines)
    if row.kind == "volume":
        return AskedRow(want, () if only is None else (only,), whole=True)
    if only is not None and row == RowName("positioning", (machine.axes[only.axis].name,)) and _one_way(machine):
        own = direction_of(row.kind, machine.axes[only.axis])
        return AskedRow(want, (only,), functional(row.kind, [only], machine, [own]), whole=True)
    if row.kind == "squareness":
        names = [row.axes, row.axes[::-1]]
        ways = [letter_direction(machine.axis(name).letter) for name in reversed(row.axes)]
        chosen = [_line(description, lines, RowName("straightness", (one, other))) for one, other in names]
    else:
        ways = [] if row.kind in ABOUT else [direction_of(row.kind, machine.axis(row.axes[0]), *row.axes[1:])]
        chosen = [_line(description, lines, row)]
    return AskedRow(want, tuple(chosen), functional(row.kind, chosen, machine, ways))


def _only_line(description: CampaignDescription, lines: dict[RowName, AxisLine]) -> AxisLine | None:
    """Return the line through the volume where the machine describes displacements of one axis alone, else None."""
    only = description.machine.only
    if only is None:
        return None
    through = through_the_volume(description, only)
    read = max((line for line in lines.values() if line.axis == only), key=lambda line: line.read, default=through)
    return replace(read, poses=read.poses_at(through.positions.tolist()))


def _one_way(machine: Machine) -> bool:
    """Return whether the only errors are along the axis that they belong to: its positioning is all there is."""
    axis = machine.axes[machine.only or 0]
    return {error.component for error in machine.stated if not error.sides} == {letter_direction(axis.letter)}


def offset_each(description: CampaignDescription) -> float | None:
    """Return by how much U grows for each `EACH` beside the line that was read, m; None where the volume is known."""
    machine = description.machine
    told = description.usual and machine.only is not None and len(machine.axes) > 1
    return BAND * OFFSET.size * EACH if told else None


def beside_the_line(description: CampaignDescription, readings: Sequence[Reading], poses: Array) -> Array:
    """Return what pitch and yaw that nobody described add, (m, 3) m, one standard deviation, noughts without usual.

    poses : (m, q). It is their distance from the line that was read times `OFFSET`, along the axis that was read.
    """
    found = np.zeros((len(poses), 3))
    line = _only_line(description, _lines(description, readings, whole=False)) if description.usual else None
    if line is not None:
        away = poses - line.poses[0]
        away[:, line.axis] = 0.0
        own = letter_direction(description.machine.axes[line.axis].letter)
        way = ways_of(description.machine, line, angular=False)[own]
        found = OFFSET.size * np.linalg.norm(away, axis=1)[:, None] * np.abs(way)
    return found


def _line(description: CampaignDescription, lines: dict[RowName, AxisLine], row: RowName) -> AxisLine:
    """Return the line of a row: its own, else any along the same axis as if nothing was read, else one through all."""
    if row in lines:
        return lines[row]
    axis = description.machine.index(row.axes[0])
    found = next((line for line in lines.values() if line.axis == axis), None)
    return through_the_volume(description, axis) if found is None else AxisLine(axis, found.poses)
