"""A machine: its axes from the workpiece to the tool, its tool, and what is known beforehand about its errors.

From the tables of machine.toml to a machine: what no single key can show is checked here.

The kinematic chain is a string in the manner of ISO 10791-6: "w-C'-B'-b-Y-X-Z-t".
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from axiscal.document import Document, read_model, shown
from axiscal.document.quoting import meant
from axiscal.document.validation import Stated
from axiscal.exceptions import ChainError, DescriptionError, Faults, InputError
from axiscal.language.spoken import said
from axiscal.machine.axis import LINEAR_LETTERS, ROTARY_LETTERS, iso_axis
from axiscal.machine.entry import ErrorEntry, as_fine_as_is_cheap
from axiscal.machine.errors_table import read_errors
from axiscal.machine.machine_schema import AxisTable, MachineFile
from axiscal.units import Dimension, format_quantity
from axiscal_core.axes import Axis
from axiscal_core.refusals import one

Span = tuple[float, float]
LONGEST_TRAVEL = 1000.0
"""m; also the largest coordinate of a point on an axis line."""
LEAST_OVERRUN = 1e-5
"""m or rad."""
LARGEST_OVERRUN = 0.25
"""Share of the travel."""
_TOOL = {"length": 10.0, "radius": 1.0, "stylus": 0.1, "reach": 1.0}
"""m, at most."""
_LEAST_HEAD, _LARGEST_HEAD = 1e-3, 2.0
"""m, of the spindle nose: less is a slip."""
_FAR = 1000 * math.tau
"""rad; no control counts the turns of an axis further."""


def _described(document: Document, fine_knots: bool = True) -> Machine:
    """Return the machine in a document; raises DescriptionError, ChainError or UnitError.  fine_knots : as in it"""
    tables, faults = read_model(document, MachineFile), Faults()
    tool = Stated(document, tables.tool, ("tool",))
    name = faults.tried(_name, document, tables.name)
    axes = _axes(document, tables, faults)
    stated = tables.tool.head is not None
    head = faults.tried(tool.each, "head", "length", _LEAST_HEAD, _LARGEST_HEAD) if stated else None
    sizes = {key: faults.tried(tool.within, key, "length", 0.0, most) for key, most in _TOOL.items()}
    known = {axis.name: axis for axis in axes}
    curves, planes = read_errors(document, tables.errors, known, set(tables.axes), faults)
    faults.refuse()
    length, radius, stylus, reach = (size or 0.0 for size in sizes.values())
    curves = as_fine_as_is_cheap(curves, known) if fine_knots else curves
    return Machine(
        name=name or "",
        axes=axes,
        tool=length,
        errors=curves,
        chain=tables.chain,
        text=document.text,
        planes=planes,
        tool_radius=radius,
        stylus=stylus,
        reach=reach,
        head=head or (),
        fine_knots=fine_knots,
        unit=_unit(axes, tables),
    )


def _unit(axes: Sequence[Axis], tables: MachineFile) -> str:
    """Return the unit in which the control counts lengths, mm or in."""
    inches = [tables.axes[axis.name].travel[1].endswith(("in", "inch")) for axis in axes if not axis.rotary]
    return "in" if inches and all(inches) else "mm"


def _name(document: Document, name: str | None) -> str:
    if name is not None and (not name.strip() or len(name) > 200 or not name.isprintable()):
        fault = DescriptionError("{name} is not a name", "Write up to 200 printable characters", name=shown(name))
        raise document.fault(fault, "name")
    return document.path.stem if name is None else name


def _axes(document: Document, tables: MachineFile, faults: Faults) -> tuple[Axis, ...]:
    """Return the axes in the order of the chain; every axis has a table, every table an axis.

    A fault in the table of an axis is noted, and the axis left out.
    """
    try:
        links = parse_chain(tables.chain)
    except InputError as fault:
        raise document.fault(fault, "chain") from None
    _check_tables(document, tables, [link.name for link in links])
    found = (_axis(document, link, tables.axes[link.name], faults) for link in links)
    return tuple(axis for axis in found if axis is not None)


def _check_tables(document: Document, tables: MachineFile, names: list[str]) -> None:
    """Raise DescriptionError for a table without an axis in the chain, or an axis without a table."""
    for name in tables.axes:
        if name not in names:
            otherwise = said("Put it into the chain, or take the table out")
            remedy = meant(name, [each for each in names if each not in tables.axes], otherwise, quoted="{}")
            what = said("there is no axis {axis} in the chain {chain}", axis=shown(name), chain=shown(tables.chain))
            raise document.fault(DescriptionError(what, remedy), "axes", name)
    for name in names:
        if name not in tables.axes:
            what, remedy = "axis {axis} of {chain} has no table [axes.{axis}]", "Add [axes.{axis}] with its travel"
            raise document.fault(DescriptionError(what, remedy, axis=name, chain=shown(tables.chain)), "chain")


def _axis(document: Document, link: Link, table: AxisTable, faults: Faults) -> Axis | None:
    """Return an axis; None where something in its table is wrong, which is noted, all of it."""
    axis, before = iso_axis(link.name, link.workpiece_side, (0.0, 1.0)), len(faults.found)
    stated, turns = Stated(document, table, ("axes", link.name)), axis.rotary
    speed = faults.tried(stated.within, "speed", "rotation_speed" if turns else "speed", 1e-9, 1e4)
    rate: Dimension = "rotation_acceleration" if turns else "acceleration"
    acceleration = faults.tried(stated.within, "acceleration", rate, 1e-9, 1e6)
    origin = faults.tried(_origin, stated, axis)
    spans = faults.tried(_spans, stated, axis)
    faults.tried(_refuse_diameter, stated, axis)
    if len(faults.found) > before or spans is None or origin is None:
        return None
    travel, overrun, beyond = spans
    said = table.direction, table.shows == "diameter"
    fast = speed or 0.0, acceleration or 0.0
    return iso_axis(axis.name, axis.workpiece_side, travel, *fast, origin, overrun, beyond, *said)


def _refuse_diameter(stated: Stated[AxisTable], axis: Axis) -> None:
    if axis.rotary and stated.table.shows == "diameter":
        raise stated.misstated("shows", "{axis} turns, and shows no diameter", "Take it out", axis=axis.name)


def _spans(stated: Stated[AxisTable], axis: Axis) -> tuple[Span, float | None, tuple[int, int] | None]:
    """Return travel, overrun and turns."""
    travel = _travel(stated, axis)
    most = LARGEST_OVERRUN * (travel[1] - travel[0])
    return travel, stated.within("overrun", axis.dimension, LEAST_OVERRUN, most), _turns(stated, axis, travel)


def _travel(stated: Stated[AxisTable], axis: Axis) -> Span:
    """Return the travel; it must increase, be one that exists, and be at most one turn of a rotary axis."""
    unit, most = ("deg", 10 * math.tau) if axis.rotary else ("m", LONGEST_TRAVEL)
    low, high = stated.each("travel", axis.dimension, -most, most)
    text, given = stated.table.travel, shown(stated.table.travel)
    if low > high:
        what, remedy = "travel {given} is reversed", 'Write the lower end first: ["{high}", "{low}"]'
        raise stated.misstated("travel", what, remedy, given=given, high=text[1], low=text[0])
    if high - low < 1e-6:
        raise stated.misstated("travel", "travel {given} is empty", "Write the two ends of the travel", given=given)
    if axis.rotary and high - low > math.tau + 1e-9:
        what = "travel {given} is more than one turn ({span})"
        remedy = 'The errors repeat after a turn: give one, such as ["0 deg", "360 deg"]'
        raise stated.misstated("travel", what, remedy, given=given, span=format_quantity(high - low, unit))
    return low, high


def _turns(stated: Stated[AxisTable], axis: Axis, travel: Span) -> tuple[int, int] | None:
    """Return the whole turns below and above the travel that the limits of a full-turn axis reach into."""
    if stated.table.limits is None:
        return None
    text = shown(stated.table.limits)
    if not replace(axis, travel=travel).cyclic:
        what = "limits {text} of {axis}, whose travel is not one turn"
        remedy = "Take them out: its travel is where it may go"
        raise stated.misstated("limits", what, remedy, text=text, axis=axis.name)
    low, high = stated.each("limits", "angle", -_FAR, _FAR)
    if low > travel[0] + 1e-9 or high < travel[1] - 1e-9:
        what = "limits {text} do not hold the travel of {axis}"
        remedy = "Write how far the control lets it turn, lower end first"
        raise stated.misstated("limits", what, remedy, text=text, axis=axis.name)
    below, above = (math.ceil(beyond / math.tau - 1e-9) for beyond in (travel[0] - low, high - travel[1]))
    return below, above


def _origin(stated: Stated[AxisTable], axis: Axis) -> tuple[float, float, float]:
    """Return a point on the axis line of a rotary axis; a linear axis has none."""
    if stated.table.origin is None:
        return (0.0, 0.0, 0.0)
    if not axis.rotary:
        what, remedy = "{origin}: a linear axis has no axis line", "Take it out; origins belong to rotary axes A B C"
        raise stated.misstated("origin", what, remedy, origin=shown(stated.table.origin))
    x, y, z = stated.each("origin", "length", -LONGEST_TRAVEL, LONGEST_TRAVEL)
    return x, y, z


MOST_AXES = 6
"""More axes have not been tried; nothing else ends there."""
_LONGEST = 200
"""Characters; a chain of six axes has thirty."""
_LINK = re.compile(rf"(?P<name>[{LINEAR_LETTERS}{ROTARY_LETTERS}][1-9]?)(?P<prime>'?)")
_SPINDLE = re.compile(rf"\([{ROTARY_LETTERS}][1-9]?\)")
_PRIMES = str.maketrans(dict.fromkeys("’‘′´`", "'"))
_EXAMPLE = "Write the chain from the workpiece w over the bed b to the tool t, such as \"w-X'-Y'-b-Z-t\""


@dataclass(frozen=True, slots=True)
class Link:
    """One axis in the chain; workpiece_side: primed, between workpiece and bed."""

    name: str
    workpiece_side: bool


def parse_chain(text: str) -> tuple[Link, ...]:
    """Return the axes of a chain from the workpiece to the tool; a spindle in parentheses is left out.

    text : "w-C'-B'-b-Y-X-Z-(C)-t" or "[w C' B' b Y X Z (C) t]", one to six axes, each once
    Raises ChainError: w, b or t missing or misplaced, an axis unknown, twice, or primed on the wrong side.
    """
    words = _words(text)
    before, after = _sides(words, text)
    links = [_link(word, True, text) for word in before]
    links += [_link(word, False, text) for word in after if not _SPINDLE.fullmatch(word)]
    _check_names([link.name for link in links], text)
    return tuple(links)


def _words(text: str) -> list[str]:
    """Return the parts of a chain string between dashes, or between blanks inside brackets."""
    plain = text.translate(_PRIMES).strip()
    if len(plain) > _LONGEST:
        raise ChainError("a chain of {count} characters is too long", _EXAMPLE, count=len(plain))
    if plain.startswith("[") and plain.endswith("]"):
        return plain[1:-1].split()
    return [word.strip() for word in plain.split("-")]


def _sides(words: list[str], text: str) -> tuple[list[str], list[str]]:
    """Return the words between w and b and those between b and t."""
    for end, word in ((0, "w"), (-1, "t")):
        if not words or words[end] != word:
            what = "the chain {text} does not begin with w, the workpiece"
            what = what if word == "w" else "the chain {text} does not end with t, the tool"
            raise ChainError(what, _EXAMPLE, text=shown(text))
    inner = words[1:-1]
    if inner.count("b") != 1:
        what = "the chain {text} has more than one bed b" if "b" in inner else "the chain {text} has no bed b"
        raise ChainError(what, _EXAMPLE, text=shown(text))
    bed = inner.index("b")
    return inner[:bed], inner[bed + 1 :]


def _link(word: str, workpiece_side: bool, text: str) -> Link:
    """Return one axis; raises ChainError for a word that is none, or whose prime does not fit its side of the bed."""
    found = _LINK.fullmatch(word)
    if found is None:
        what = "{word} in the chain {text} is not an axis"
        raise ChainError(what, _word_remedy(word), word=shown(word), text=shown(text))
    name, primed = found["name"], bool(found["prime"])
    if workpiece_side and not primed:
        remedy = "Axes between w and b carry the workpiece and have a prime: write {name}', or put it behind b"
        raise ChainError("{name} in the chain {text} has no prime", remedy, name=name, text=shown(text))
    if primed and not workpiece_side:
        remedy = "Axes between b and t carry the tool and have no prime: write {name}, or put it before b"
        raise ChainError("{name}' in the chain {text} has a prime", remedy, name=name, text=shown(text))
    return Link(name, workpiece_side)


def _word_remedy(word: str) -> str:
    if _LINK.fullmatch(word.upper()):
        return said("Axes are written in capitals: {word}", word=word.upper())
    if _SPINDLE.fullmatch(word.replace("'", "")):
        return said(
            "A spindle in parentheses stands behind b; a table that is positioned is written without parentheses"
        )
    return said("Axes are X Y Z U V W P Q R (linear) and A B C (rotary), with one digit after them if needed")


def _check_names(names: list[str], text: str) -> None:
    """Raise ChainError unless there are one to six axes, each once."""
    twice = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if twice:
        what = "{axis} stands twice in the chain {text}"
        remedy = "Every axis stands in the chain once; name a second one {letter}2 or with another letter"
        raise ChainError(what, remedy, axis=twice, text=shown(text), letter=twice[0])
    if not 1 <= len(names) <= MOST_AXES:
        what = "the chain {text} has {count} axes"
        raise ChainError(what, "One to {most} axes are possible", text=shown(text), count=len(names), most=MOST_AXES)


__all__ = ["ErrorEntry", "Machine", "builtin_names", "load_machine", "machine_from_text"]

_LIBRARY = Path(__file__).parent / "library"
TOOL_RADIUS = 0.04
"""m, of the tool and what holds it where nobody says."""


@dataclass(frozen=True, slots=True)
class Machine:
    """A machine as described by its owner.

    axes : in the order of the chain, from the workpiece to the tool; tool : length of the tool, m
    tool_radius : m, of tool and holder, up to the spindle nose; reach : m, how far a stylus stands free below them
    head : diameter and height of the nose with what carries it, m; none where nobody says
    errors : one entry per error of one axis that is not taken to be zero; text : the TOML it came from
    planes : one entry per error of two axes together; stylus : diameter of the ball at the end of a probe, m, or 0
    fine_knots : knots of which nothing is said are as close as is cheap; in records of before they were not
    unit : in which its control counts lengths: "in" where all linear travels are written in inches, else "mm"
    """

    name: str
    axes: tuple[Axis, ...]
    tool: float
    errors: tuple[ErrorEntry, ...]
    chain: str
    text: str
    planes: tuple[ErrorEntry, ...] = ()
    tool_radius: float = TOOL_RADIUS
    stylus: float = 0.0
    reach: float = 0.05
    head: tuple[float, ...] = ()
    fine_knots: bool = True
    unit: str = "mm"

    def index(self, axis_name: str) -> int:
        """Return the place of an axis in a pose; raises DescriptionError for an axis that the machine does not have."""
        names = [axis.name for axis in self.axes]
        if axis_name not in names:
            same = [name for name in names if name.casefold() == axis_name.casefold()]
            remedy = meant(axis_name, same, said("Its axes are {known}", known=", ".join(names)), quoted="{}")
            what = "there is no axis {axis} on the machine {machine}"
            raise DescriptionError(what, remedy, axis=shown(axis_name), machine=shown(self.name))
        return names.index(axis_name)

    def with_rests(self, rests: Mapping[str, float]) -> Machine:
        """Return the machine with other rests of errors, by name, m or rad."""
        errors = tuple(replace(e, rest=rests.get(e.name, e.rest)) for e in self.errors)
        planes = tuple(replace(e, rest=rests.get(e.name, e.rest)) for e in self.planes)
        return replace(self, errors=errors, planes=planes)

    @property
    def error_names(self) -> tuple[str, ...]:
        """The names of all errors that are described, those of one axis first."""
        return *(entry.name for entry in self.errors), *(entry.name for entry in self.planes)

    @property
    def only(self) -> int | None:
        """The one linear axis of which displacements alone are described; None where more is, or an axis turns."""
        names = [entry.parts for entry in self.errors]
        axes = {name.axis for name in names}
        more = len(axes) != 1 or self.planes or any(name.angular for name in names)
        return None if more or any(axis.rotary for axis in self.axes) else self.index(*axes)

    @property
    def zero(self) -> tuple[float, ...]:
        """The pose called machine zero: every axis at 0, or at the end of its travel nearest to it, m or rad."""
        return tuple(min(max(0.0, axis.travel[0]), axis.travel[1]) for axis in self.axes)

    def axis(self, name: str) -> Axis:
        """Return the axis of that name; raises DescriptionError when there is none."""
        return self.axes[self.index(name)]


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in machines."""
    return tuple(sorted(path.stem for path in _LIBRARY.glob("*.toml")))


def load_machine(source: str | Path) -> Machine:
    """Return the machine in a file, or the built-in one of that name.

    source : a path, or a name of `builtin_names`, which goes before a file of the same name without an ending
    Raises DescriptionError, ChainError or UnitError with file, line, what is wrong and what would be right.
    """
    one("load_machine", "source", source, (str, Path), '"dmu60", or "machine.toml"')
    if isinstance(source, str) and source in builtin_names():
        return _described(Document.read(_LIBRARY / f"{source}.toml"))
    path = Path(source)
    if path.suffix != ".toml" and len(path.parts) == 1 and not os.path.exists(path):
        otherwise = said("The built-in machines are {known}", known=", ".join(builtin_names()))
        remedy = meant(str(source), builtin_names(), otherwise, quoted="{}")
        raise DescriptionError("{text} is neither a file nor a built-in machine", remedy, text=shown(str(source)))
    return _described(Document.read(path))


def machine_from_text(text: str, source_name: str | Path = "machine.toml", *, fine_knots: bool = True) -> Machine:
    """Return the machine in a TOML text; raises as `load_machine`.

    source_name : what failures call it; fine_knots : as in `Machine`
    """
    return _described(Document.parse(text, source_name), fine_knots)
