"""What keys of campaign.toml may say, read to SI: directions, places on the machine, sizes with their bounds, names."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Annotated, NamedTuple

import numpy as np

from axiscal.document import Document, Length, QuantityText, meant, shown
from axiscal.document.ports import names
from axiscal.document.toml_table import AS_TUPLE
from axiscal.document.validation import Beside, EachAs, QuantityOf, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import LANGUAGES, later, said
from axiscal.machine.axis import travel_text
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.written import PORTS, named
from axiscal.measurement.setup import FINEST, Nodes, Setup, Vector
from axiscal.units import format_quantity, parse_quantity
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine

Ends = tuple[float, float]
_PLANES = ("xy", "yz", "zx")
_SHORTEST = 2e-3
"""m, of a line."""
_SAME_WAY = 1e-6
"""Sine: rounding of two directions that are one."""
WARM = 253.15, 333.15
"""-20 and 60 degC, K: no scale is read outside."""
_LETTER = re.compile(r"([+-]?)([xyzXYZ])")
WAYS = later('Write "x", "-y" or three numbers such as [1, 0, 0], in the workpiece frame')


class TableContext(NamedTuple):
    """What a campaign is read by: its machine, and the document itself.  own : a person named the file of it"""

    machine: Machine
    document: Document
    own: bool = False


def unit_vector(value: str | Sequence[float]) -> Vector:
    """Return a direction; raises DescriptionError."""
    if isinstance(value, str):
        found = _LETTER.fullmatch(value)
        if found is None:
            raise DescriptionError("{text} is not a direction", WAYS, text=shown(value))
        sign = -1.0 if found[1] == "-" else 1.0
        x, y, z = (sign if letter == found[2].lower() else 0.0 for letter in "xyz")
        return x, y, z
    largest = max((abs(number) for number in value), default=0)
    if len(value) != 3 or not 1e-100 < largest < 1e100:
        raise DescriptionError("{text} is not a direction", WAYS, text=shown(list(value)))
    x, y, z = (number / math.hypot(*value) for number in value)
    return x, y, z


def two_ends(given: Sequence[str], read: Callable[[str], float]) -> Ends:
    """Return two ends that increase; raises DescriptionError, and what reading one does."""
    ends = [read(text) for text in given]
    if len(ends) != 2 or not ends[0] < ends[1]:
        remedy = "Give two ends, the lower one first"
        raise DescriptionError("{text} does not increase", remedy, text=shown(list(given)))
    return ends[0], ends[1]


def span(given: Sequence[str]) -> Ends:
    """Return two lengths that increase, m; raises DescriptionError or UnitError."""
    return two_ends(given, lambda text: parse_quantity(text, "length"))


def line_ends(ends: tuple[Vector, Vector]) -> tuple[Vector, Vector]:
    """Return both ends of a line, m; raises DescriptionError."""
    if math.dist(*ends) < _SHORTEST:
        raise DescriptionError("the ends of the line are one place", "Give two places that are apart")
    return ends


def arc_ends(given: Sequence[str]) -> Ends:
    """Return from where to where an arc goes, rad; raises DescriptionError or UnitError."""
    low, high = two_ends(given, lambda text: parse_quantity(text, "angle"))
    if high - low > 4 * math.tau:
        raise DescriptionError("{text} is no arc", "Give four turns at most", text=shown(given))
    return low, high


def plane_ways(given: str | Sequence[str | Sequence[float]]) -> tuple[Vector, Vector]:
    """Return two directions in a plane, across each other; raises DescriptionError."""
    if isinstance(given, str) and given not in _PLANES:
        remedy = 'Write "xy", "yz", "zx" or two directions'
        raise DescriptionError("{text} is not a plane", remedy, text=shown(given))
    ways = [np.array(unit_vector(way)) for way in given]
    if len(ways) != 2 or np.linalg.norm(np.cross(ways[0], ways[1])) < _SAME_WAY:
        remedy = "Give two directions that are not the same"
        raise DescriptionError("{text} is not a plane", remedy, text=shown(given))
    second = ways[1] - (ways[1] @ ways[0]) * ways[0]
    (x, y, z), (u, v, w) = ways[0].tolist(), (second / np.linalg.norm(second)).tolist()
    return (x, y, z), (u, v, w)


Spot = Annotated[tuple[Length, Length, Length], AS_TUPLE]
"""A place, m."""
Span = Annotated[Ends, ReadAs(list[QuantityText], span)]
Direction = Annotated[Vector, ReadAs(str | list[float | int], unit_vector)]


def coordinate(text: str, axis: Axis) -> float:
    """Return a position on an axis, m or rad; raises UnitError, or DescriptionError outside the travel."""
    return within_travel(parse_quantity(text, axis.dimension), axis, text)


def within_travel(value: float, axis: Axis, text: str = "") -> float:
    """Return a position on an axis, m or rad; raises DescriptionError outside the travel.  text : as it is stated"""
    low, high = axis.travel
    slack = 1e-9 * axis.length
    if not low - slack <= value <= high + slack:
        what, at = '"{text}" is outside the travel of {axis}', text or format_quantity(value, axis.unit)
        raise DescriptionError(what, "It goes from {travel}", text=at, axis=axis.name, travel=travel_text(axis))
    return min(max(value, low), high)


def ends_on(texts: Sequence[str], axis: Axis) -> Ends:
    """Return two increasing coordinates within the travel, m or rad; raises DescriptionError or UnitError."""
    return two_ends(texts, lambda text: coordinate(text, axis))


def _coordinate(name: str, text: str, known: Beside) -> float:
    return coordinate(text, known.context.machine.axis(name))


def _ends(name: str, texts: Sequence[str], known: Beside) -> Ends:
    return ends_on(texts, known.context.machine.axis(name))


Coordinates = Annotated[dict[str, float], EachAs(dict[str, QuantityText], _coordinate)]
Spans = Annotated[dict[str, Ends], EachAs(dict[str, list[QuantityText]], _ends)]
"""By the name of an axis."""
LONGEST_NAME = 80
"""Characters of a name that still fits on a line of a program."""
_LONGEST = 500
"""Characters of a text in a report: a paragraph; a matter of taste."""


def _name(text: str) -> str:
    if not text.strip() or text != text.strip() or not text.isprintable() or len(text) > LONGEST_NAME:
        remedy = "Give it up to {most} printable characters, without blanks at its ends"
        raise DescriptionError("{text} is not a name", remedy, text=shown(text), most=LONGEST_NAME)
    return text


def _printable(text: str) -> str:
    if len(text) > _LONGEST or not text.replace("\n", " ").isprintable():
        remedy = "Write up to {most} characters that can be printed"
        raise DescriptionError("{text} cannot stand in a report", remedy, text=shown(text), most=_LONGEST)
    return text


def _language(text: str) -> str:
    if text and text not in LANGUAGES:
        known = ", ".join(f'language = "{short}" ({long})' for short, long in LANGUAGES.items())
        raise DescriptionError("{text} is no language of reports", "There are {known}", text=shown(text), known=known)
    return text


def _active(given: bool | str | list[str]) -> bool | tuple[str, ...]:
    """Return whether a compensation is active, or its files."""
    if isinstance(given, bool):
        return given
    names = (given,) if isinstance(given, str) else tuple(given)
    if not names or not all(name.strip() and name.isprintable() for name in names):
        remedy = 'Write false, true, or the files that are active, such as ["X.comp", "Y.comp"]'
        raise DescriptionError("compensation_active = {text} names no file", remedy, text=shown(given))
    return names


Name = Annotated[str, ReadAs(str, _name)]
Printable = Annotated[str, ReadAs(str, _printable)]
Language = Annotated[str, ReadAs(Printable, _language)]
Active = Annotated[bool | tuple[str, ...], ReadAs(bool | str | list[str], _active)]
Wanted = Annotated[float, QuantityOf("length", FINEST)]
Doubt = Annotated[float, QuantityOf("length", 0.0, 0.1)]
Base = Annotated[float, QuantityOf("length", 0.0)]
Bar = Annotated[float, QuantityOf("length", 5e-3, 5.0)]
Scale = Annotated[float, QuantityOf("angle", 0.0, 1e-2)]
Cone = Annotated[float, QuantityOf("angle", FINEST, math.pi)]
Placed = Annotated[float, QuantityOf("length", FINEST, 1.0)]
Turned = Annotated[float, QuantityOf("angle", FINEST, 1.0)]
Turn = Annotated[float, QuantityOf("angle", -math.tau, math.tau)]
Duration = Annotated[float, QuantityOf("time", 0.0)]
Warmth = Annotated[float, QuantityOf("temperature_difference", 0.0)]
Growth = Annotated[float, QuantityOf("expansion", 0.0)]
Warm = Annotated[float, QuantityOf("temperature", *WARM)]
"""What keys may say, in SI, with their bounds."""


def refuse_same_name(names: Sequence[str], document: Document, key: str, what: str) -> None:
    """Raise DescriptionError at the second table of a name.  key : of the tables; what : is wrong then"""
    for number, name in enumerate(names):
        if name in names[:number]:
            fault = DescriptionError(what, "Give each a name of its own", name=name)
            raise document.fault(fault, key, number, "name")


def nodes(name: str, given: tuple[str, str, int], known: Beside) -> Nodes:
    """Return where the nodes of a map lie along an axis; raises DescriptionError or UnitError."""
    low, high = ends_on(given[:2], known.context.machine.axis(name))
    if given[2] < 2:
        remedy = 'Write the first node, the last, and how many: ["20 mm", "280 mm", 5]'
        raise DescriptionError("{text} is no side of a map", remedy, text=shown([*given]))
    return low, high, given[2]


CONTROLS = "axiscal.exporters"
"""Group of the entry points by which packages bring controls."""


def read_instrument(name: str, known: Beside) -> type[Setup]:
    """Return an instrument of ours, or the one that somebody wrote; raises DescriptionError."""
    if name in INSTRUMENTS:
        return INSTRUMENTS[name]
    file = known.context.document
    of = [table.get("instrument") for table in file.data["setups"]]
    line = file.line("setups", of.index(name), "instrument")
    found = named(name, file.path, line, own=known.context.own)
    if found is None:
        every = [*INSTRUMENTS, *names(PORTS)]
        remedy = meant(name, every, said("Instruments are {known}", known=", ".join(every)))
        raise DescriptionError("{name} is not an instrument", remedy, name=shown(name))
    return found
