"""From the tables of machine.toml to a machine: what no single key can show is checked here.

The kinematic chain is a string in the manner of ISO 10791-6: "w-C'-B'-b-Y-X-Z-t".
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from axiscal.document import Document, read_model, shown
from axiscal.document.quoting import meant
from axiscal.exceptions import ChainError, DescriptionError, Faults, InputError
from axiscal.language.spoken import said
from axiscal.machine.axis import COUNTINGS, LINEAR_LETTERS, ROTARY_LETTERS, Axis, Counting
from axiscal.machine.entry import ErrorEntry, as_fine_as_is_cheap
from axiscal.machine.errors_table import error_entries
from axiscal.machine.limits import Keys, within
from axiscal.machine.machine_schema import AxisTable, MachineFile
from axiscal.machine.plane_entry import PlaneEntry
from axiscal.machine.planes_table import plane_entries
from axiscal.units import Dimension, format_quantity

LONGEST_TRAVEL = 1000.0
"""m; also the largest coordinate of a point on an axis line."""
LEAST_OVERRUN = 1e-5
"""m or rad."""
LARGEST_OVERRUN = 0.25
"""Share of the travel."""
_FAR = 1000 * math.tau
"""rad; no control counts the turns of an axis further."""


@dataclass(frozen=True, slots=True)
class Parts:
    """Everything that a machine consists of."""

    name: str
    axes: tuple[Axis, ...]
    tool: float
    tool_radius: float
    stylus: float
    errors: tuple[ErrorEntry, ...]
    planes: tuple[PlaneEntry, ...]
    chain: str


def assemble(document: Document, fine_knots: bool) -> Parts:
    """Return the parts of the machine in a document; raises DescriptionError, ChainError or UnitError.

    fine_knots : knots of which nothing is said are as close as is cheap
    """
    tables, faults = read_model(document, MachineFile), Faults()
    name, tool, radius, stylus = document.path.stem, 0.0, 0.0, 0.0
    with faults.noted():
        name = _name(document, tables)
    axes = _axes(document, tables, faults)
    with faults.noted():
        tool = within(document, ("tool", "length"), tables.tool.length, "length", 0.0, 10.0)
    with faults.noted():
        radius = within(document, ("tool", "radius"), tables.tool.radius, "length", 0.0, 1.0)
    with faults.noted():
        stylus = within(document, ("tool", "stylus"), tables.tool.stylus, "length", 0.0, 0.1)
    known = {axis.name: axis for axis in axes}
    entries = error_entries(document, tables.errors, known, set(tables.axes), faults)
    planes = plane_entries(document, tables.errors, known, set(tables.axes), faults)
    faults.refuse()
    curves = as_fine_as_is_cheap(entries, known) if fine_knots else entries
    return Parts(name, axes, tool, radius, stylus, curves, planes, tables.chain)


def _name(document: Document, tables: MachineFile) -> str:
    name = document.path.stem if tables.name is None else tables.name
    if tables.name is not None and (not name.strip() or len(name) > 200 or not name.isprintable()):
        fault = DescriptionError("{name} is not a name", "Write up to 200 printable characters", name=shown(name))
        raise document.fault(fault, "name")
    return name


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
    keys: Keys = ("axes", link.name)
    axis, before = Axis.named(link.name, link.workpiece_side, (0.0, 1.0)), len(faults.found)
    speed, acceleration, overrun, origin, turns, counting = axis.speed, axis.acceleration, None, axis.origin, None, None
    if table.speed is not None:
        dimension: Dimension = "rotation_speed" if axis.rotary else "speed"
        with faults.noted():
            speed = within(document, (*keys, "speed"), table.speed, dimension, 1e-9, 1e4)
    if table.acceleration is not None:
        dimension = "rotation_acceleration" if axis.rotary else "acceleration"
        with faults.noted():
            acceleration = within(document, (*keys, "acceleration"), table.acceleration, dimension, 1e-9, 1e6)
    with faults.noted():
        origin = _origin(document, axis, table)
    with faults.noted():
        counting = _counting(document, keys, table.direction)
    with faults.noted():
        travel = _travel(document, axis, table)
        overrun = _overrun(document, axis, table, travel)
        turns = _turns(document, axis, table, travel)
    if len(faults.found) > before:
        return None
    return Axis.named(axis.name, axis.workpiece_side, travel, speed, acceleration, origin, overrun, turns, counting)


def _overrun(document: Document, axis: Axis, table: AxisTable, travel: tuple[float, float]) -> float | None:
    if table.overrun is None:
        return None
    most = LARGEST_OVERRUN * (travel[1] - travel[0])
    return within(document, ("axes", axis.name, "overrun"), table.overrun, axis.dimension, LEAST_OVERRUN, most)


def _counting(document: Document, keys: Keys, text: str | None) -> Counting | None:
    """Return which way an axis counts, None where it is not said."""
    for counting in COUNTINGS:
        if text == counting:
            return counting
    if text is None:
        return None
    remedy = 'Write "iso" (ISO 841: counting up moves the tool positively relative to the workpiece) or "reversed"'
    raise document.fault(DescriptionError("{text} is not a direction", remedy, text=shown(text)), *keys, "direction")


def _travel(document: Document, axis: Axis, table: AxisTable) -> tuple[float, float]:
    """Return the travel; it must increase, be one that exists, and be at most one turn of a rotary axis."""
    keys: Keys = ("axes", axis.name, "travel")
    dimension: Dimension = axis.dimension
    unit, most = ("deg", 10 * math.tau) if axis.rotary else ("m", LONGEST_TRAVEL)
    low = within(document, (*keys, 0), table.travel[0], dimension, -most, most)
    high = within(document, (*keys, 1), table.travel[1], dimension, -most, most)
    given = shown(table.travel)
    if low > high:
        remedy = 'Write the lower end first: ["{high}", "{low}"]'
        raise document.fault(
            DescriptionError(
                "travel {given} is reversed", remedy, given=given, high=table.travel[1], low=table.travel[0]
            ),
            *keys,
        )
    if high - low < 1e-6:
        remedy = "Write the two ends of the travel"
        raise document.fault(DescriptionError("travel {given} is empty", remedy, given=given), *keys)
    if axis.rotary and high - low > math.tau + 1e-9:
        what = "travel {given} is more than one turn ({span})"
        remedy = 'The errors repeat after a turn: give one, such as ["0 deg", "360 deg"]'
        raise document.fault(DescriptionError(what, remedy, given=given, span=format_quantity(high - low, unit)), *keys)
    return low, high


def _turns(document: Document, axis: Axis, table: AxisTable, travel: tuple[float, float]) -> tuple[int, int] | None:
    """Return the whole turns below and above the travel that the limits of a full-turn axis reach into."""
    keys: Keys = ("axes", axis.name, "limits")
    if table.limits is None:
        return None
    if not Axis.named(axis.name, False, travel).cyclic:
        what = "limits {text} of {axis}, whose travel is not one turn"
        remedy = "Take them out: its travel is where it may go"
        raise document.fault(DescriptionError(what, remedy, text=shown(table.limits), axis=axis.name), *keys)
    low, high = (within(document, (*keys, end), table.limits[end], "angle", -_FAR, _FAR) for end in (0, 1))
    if low > travel[0] + 1e-9 or high < travel[1] - 1e-9:
        what = "limits {text} do not hold the travel of {axis}"
        remedy = "Write how far the control lets it turn, lower end first"
        raise document.fault(DescriptionError(what, remedy, text=shown(table.limits), axis=axis.name), *keys)
    below, above = (math.ceil(beyond / math.tau - 1e-9) for beyond in (travel[0] - low, high - travel[1]))
    return below, above


def _origin(document: Document, axis: Axis, table: AxisTable) -> tuple[float, float, float]:
    """Return a point on the axis line of a rotary axis; a linear axis has none."""
    keys: Keys = ("axes", axis.name, "origin")
    if table.origin is None:
        return (0.0, 0.0, 0.0)
    if not axis.rotary:
        what, remedy = "{origin}: a linear axis has no axis line", "Take it out; origins belong to rotary axes A B C"
        raise document.fault(DescriptionError(what, remedy, origin=shown(table.origin)), *keys)
    x, y, z = (
        within(document, (*keys, place), text, "length", -LONGEST_TRAVEL, LONGEST_TRAVEL)
        for place, text in enumerate(table.origin)
    )
    return (x, y, z)


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
