"""Which rows a job is about: those that its target asks for, else those that its set-ups can answer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import ABOUT, ANGLES, RowName, Want
from axiscal.estimation.functionals.functional import (
    AxisLine,
    Functional,
    direction_of,
    functional,
    line_of,
    seen_by,
    through_the_volume,
)
from axiscal.machine.axis import Axis, letter_direction
from axiscal.machine.description import Machine
from axiscal.measurement.reading import Reading

_LETTERS = "XYZ"


@dataclass(frozen=True, eq=False)
class AskedRow:
    """A row with the lines it is about; map : None of the volume."""

    want: Want
    lines: tuple[AxisLine, ...] = ()
    map: Functional | None = None

    def pairs(self, machine: Machine) -> list[tuple[str, str]]:
        """Return the axes that tables move to take the row away, each with the axis over which they do."""
        axes, kind = self.want.row.axes, self.want.row.kind
        if kind in ("positioning", "backlash"):
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
        if setup.name in left_out or (seen := seen_by(setup)) is None:
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
        yield from (RowName("positioning", (axis.name,)), RowName("backlash", (axis.name,)))
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
    row, machine = want.row, description.machine
    if row.kind == "volume":
        return AskedRow(want)
    if row.kind == "squareness":
        names = [row.axes, row.axes[::-1]]
        ways = [letter_direction(machine.axis(name).letter) for name in reversed(row.axes)]
        chosen = [_line(description, lines, RowName("straightness", (one, other))) for one, other in names]
    else:
        ways = [] if row.kind in ABOUT else [direction_of(row.kind, machine.axis(row.axes[0]), *row.axes[1:])]
        chosen = [_line(description, lines, row)]
    return AskedRow(want, tuple(chosen), functional(row.kind, chosen, machine, ways))


def _line(description: CampaignDescription, lines: dict[RowName, AxisLine], row: RowName) -> AxisLine:
    """Return the line of a row: its own, else any along the same axis as if nothing was read, else one through all."""
    if row in lines:
        return lines[row]
    axis = description.machine.index(row.axes[0])
    others = (line for line in lines.values() if line.axis == axis)
    found = next(others, None)
    return through_the_volume(description, axis) if found is None else AxisLine(axis, found.poses)
