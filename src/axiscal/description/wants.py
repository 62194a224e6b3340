"""What a job is about: the rows that a target asks for, such as "positioning X 5 um"."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import Literal, NamedTuple

from axiscal.document import Document, nearest, shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine import Axis, Machine
from axiscal.machine.axis import letter_direction
from axiscal.units import Dimension, parse_quantity

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
        others = [name for name in square if letter_direction(name) != letter_direction(axis.letter)]
        yield from (RowName("straightness", (axis.name, other)) for other in others)
    for kind in ANGLES:
        yield from (RowName(kind, (axis.name,)) for axis in linear)
    for kind in ABOUT:
        yield from (RowName(kind, (axis.name,)) for axis in axes if axis.rotary)
    yield from (RowName("squareness", pair) for pair in combinations(square, 2))


def read_wants(texts: Sequence[str], machine: Machine, document: Document) -> tuple[Want, ...]:
    """Return the rows that are asked for; raises DescriptionError or UnitError at the line of the text."""
    known = {row.name.casefold(): row for row in rows_of(machine)}
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
