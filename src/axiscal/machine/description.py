"""A machine: its axes from the workpiece to the tool, its tool, and what is known beforehand about its errors.

From the tables of machine.toml to a machine: what no single key can show is checked here.

The kinematic chain is a string in the manner of ISO 10791-6: "w-C'-B'-b-Y-X-Z-t".
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from axiscal.document import Document, read_model, shown
from axiscal.document.quoting import meant
from axiscal.document.validation import Stated
from axiscal.exceptions import ChainError, DescriptionError, Faults, InputError
from axiscal.language.spoken import said
from axiscal.machine.axis import LINEAR_LETTERS, ROTARY_LETTERS, iso_axis
from axiscal.machine.errors_table import read_errors
from axiscal.machine.machine_schema import AxisTable, MachineFile
from axiscal.units import Dimension, format_quantity
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine, Nose
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


def _described(document: Document, fine_knots: bool = True) -> DescribedMachine:
    """Return the machine in a document; raises DescriptionError, ChainError or UnitError.  fine_knots : as in it"""
    tables, faults = read_model(document, MachineFile), Faults()
    tool = Stated(document, tables.tool, ("tool",))
    name = faults.tried(_name, document, tables.name)
    axes = _axes(document, tables, faults)
    stated = tables.tool.head is not None
    head = faults.tried(tool.each, "head", "length", _LEAST_HEAD, _LARGEST_HEAD) if stated else None
    sizes = {key: faults.tried(tool.within, key, "length", 0.0, most) for key, most in _TOOL.items()}
    known = {axis.name: axis for axis in axes}
    errors = read_errors(document, tables.errors, known, set(tables.axes), faults, fine_knots)
    faults.refuse()
    length, radius, stylus, reach = (size or 0.0 for size in sizes.values())
    return DescribedMachine(
        axes,
        errors,
        length,
        name=name or "",
        nose=Nose(radius, stylus, reach, head or ()),
        unit=_unit(axes, tables),
        text=document.text,
        fine_knots=fine_knots,
    )


def _unit(axes: Sequence[Axis], tables: MachineFile) -> str:
    """Return the unit in which the control counts lengths: in where all linear travels are written so, else mm."""
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
    found = (_axis(document, axis, tables.axes[axis.name], faults) for axis in links)
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


def _axis(document: Document, axis: Axis, table: AxisTable, faults: Faults) -> Axis | None:
    """Return an axis as its table has it; None where something there is wrong, which is noted, all of it."""
    before, stated, turns = len(faults.found), Stated(document, table, ("axes", axis.name)), axis.rotary
    speed = faults.tried(stated.within, "speed", "rotation_speed" if turns else "speed", 1e-9, 1e4)
    rate: Dimension = "rotation_acceleration" if turns else "acceleration"
    acceleration = faults.tried(stated.within, "acceleration", rate, 1e-9, 1e6)
    origin = faults.tried(_origin, stated, axis)
    spans = faults.tried(_spans, stated, axis)
    with faults.noted():
        if axis.rotary and table.shows == "diameter":
            raise stated.misstated("shows", "{axis} turns, and shows no diameter", "Take it out", axis=axis.name)
    if len(faults.found) > before or spans is None or origin is None:
        return None
    travel, overrun, beyond = spans
    said = table.direction, table.shows == "diameter"
    fast = speed or 0.0, acceleration or 0.0
    return iso_axis(axis.name, axis.workpiece_side, travel, *fast, origin, overrun, beyond, *said)


def _spans(stated: Stated[AxisTable], axis: Axis) -> tuple[Span, float | None, tuple[int, int] | None]:
    """Return travel, overrun and turns."""
    travel = _travel(stated, axis)
    most = LARGEST_OVERRUN * (travel[1] - travel[0])
    return travel, stated.within("overrun", axis.dimension, LEAST_OVERRUN, most), _turns(stated, axis, travel)


def _travel(stated: Stated[AxisTable], axis: Axis) -> Span:
    """Return the travel; it must increase, be one that exists, and be at most one turn of a rotary axis."""
    unit, most = ("deg", 10 * math.tau) if axis.rotary else ("m", LONGEST_TRAVEL)
    low, high = stated.each("travel", axis.dimension, -most, most)
    given = shown(stated.table.travel)
    if high - low < 1e-6:
        what, remedy = "travel {given} is empty or reversed", "Write the two ends of the travel, the lower one first"
        raise stated.misstated("travel", what, remedy, given=given)
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


def parse_chain(text: str) -> tuple[Axis, ...]:
    """Return the axes of a chain from the workpiece to the tool, of no travel yet, spindles in parentheses left out.

    text : "w-C'-B'-b-Y-X-Z-(C)-t" or "[w C' B' b Y X Z (C) t]", one to six axes, each once
    Raises ChainError: w, b or t missing or misplaced, an axis unknown, twice, or primed on the wrong side.
    """
    plain = text.translate(_PRIMES).strip()
    if len(plain) > _LONGEST:
        raise ChainError("a chain of {count} characters is too long", _EXAMPLE, count=len(plain))
    bracketed = plain.startswith("[") and plain.endswith("]")
    words = plain[1:-1].split() if bracketed else [word.strip() for word in plain.split("-")]
    if (words[:1], words[-1:], words.count("b")) != (["w"], ["t"], 1):
        what = "the chain {text} needs w first, one b, and t last"
        raise ChainError(what, _EXAMPLE, text=shown(text))
    bed = words.index("b")
    links = [_link(word, True, text) for word in words[1:bed]]
    links += [_link(word, False, text) for word in words[bed + 1 : -1] if not _SPINDLE.fullmatch(word)]
    names = [link.name for link in links]
    twice = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if twice:
        what = "{axis} stands twice in the chain {text}"
        remedy = "Every axis stands in the chain once; name a second one {letter}2 or with another letter"
        raise ChainError(what, remedy, axis=twice, text=shown(text), letter=twice[0])
    if not 1 <= len(names) <= MOST_AXES:
        what = "the chain {text} has {count} axes"
        raise ChainError(what, "One to {most} axes are possible", text=shown(text), count=len(names), most=MOST_AXES)
    return tuple(links)


def _link(word: str, workpiece_side: bool, text: str) -> Axis:
    """Return one axis; raises ChainError for a word that is none, or whose prime does not fit its side of the bed."""
    found = _LINK.fullmatch(word)
    if found is None:
        remedy = "Axes are X Y Z U V W P Q R (linear) and A B C (rotary), in capitals, with one digit if needed"
        if _SPINDLE.fullmatch(word.replace("'", "")):
            remedy = "A spindle in parentheses stands behind b; a table that is positioned has no parentheses"
        raise ChainError("{word} in the chain {text} is not an axis", remedy, word=shown(word), text=shown(text))
    if bool(found["prime"]) != workpiece_side:
        what = "{word} in the chain {text} is on the wrong side of the bed"
        remedy = "Axes between w and b carry the workpiece and have a prime, {name}'; those behind b have none"
        raise ChainError(what, remedy, word=word, text=shown(text), name=found["name"])
    return iso_axis(found["name"], workpiece_side, (0.0, 1.0))


_LIBRARY = Path(__file__).parent / "library"


@dataclass(frozen=True, eq=False, repr=False, init=False)
class DescribedMachine(Machine):
    """A machine as its owner wrote it.

    text : the TOML that it came from
    fine_knots : knots of which nothing is said are as close as is cheap; in records of before they were not
    """

    text: str
    fine_knots: bool

    def __init__(self, *given: Any, text: str = "", fine_knots: bool = True, **named: Any) -> None:
        super().__init__(*given, **named)
        object.__setattr__(self, "text", text)
        object.__setattr__(self, "fine_knots", fine_knots)

    def index(self, name: str) -> int:
        """Return the place of an axis in a pose; raises DescriptionError for an axis that the machine does not have."""
        if name not in self.axis_names:
            same = [each for each in self.axis_names if each.casefold() == name.casefold()]
            remedy = meant(name, same, said("Its axes are {known}", known=", ".join(self.axis_names)), quoted="{}")
            what = "there is no axis {axis} on the machine {machine}"
            raise DescriptionError(what, remedy, axis=shown(name), machine=shown(self.name))
        return self.axis_names.index(name)


def builtin_names() -> tuple[str, ...]:
    """Return the names of the built-in machines."""
    return tuple(sorted(path.stem for path in _LIBRARY.glob("*.toml")))


def load_machine(source: str | Path) -> DescribedMachine:
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


def machine_from_text(
    text: str, source_name: str | Path = "machine.toml", *, fine_knots: bool = True
) -> DescribedMachine:
    """Return the machine in a TOML text; raises as `load_machine`.

    source_name : what failures call it; fine_knots : as in `DescribedMachine`
    """
    return _described(Document.parse(text, source_name), fine_knots)
