"""machine.toml: the chain, the axes and the tool, each key read by what it is a key of.

The kinematic chain is a string in the manner of ISO 10791-6: "w-C'-B'-b-Y-X-Z-t".
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from axiscal.document import QuantityText, meant, shown
from axiscal.document.toml_table import AS_TUPLE, Table
from axiscal.document.validation import NAME, Beside, EachAs, QuantityOf, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal.machine.axis import LINEAR_LETTERS, ROTARY_LETTERS, iso_axis
from axiscal.machine.errors_table import ErrorTable, every_error, prior_of
from axiscal.units import Dimension, format_quantity, within
from axiscal_core.axes import Axis, Counting, Three
from axiscal_core.errors import Error

Span = tuple[float, float]
LONGEST_TRAVEL = 1000.0
"""m; also the largest coordinate of a point on an axis line."""
_LEAST_OVERRUN, _LARGEST_OVERRUN = 1e-5, 0.25
"""m or rad; share of the travel."""
_FAR = 1000 * math.tau
"""rad; no control counts the turns of an axis further."""
MOST_AXES = 6
"""More axes have not been tried; nothing else ends there."""
_LONGEST = 200
"""Characters; a chain of six axes has thirty."""
_LINK = re.compile(rf"(?P<name>[{LINEAR_LETTERS}{ROTARY_LETTERS}][1-9]?)(?P<prime>'?)")
_SPINDLE = re.compile(rf"\([{ROTARY_LETTERS}][1-9]?\)")
_EXAMPLE = "Write the chain from the workpiece w over the bed b to the tool t, such as \"w-X'-Y'-b-Z-t\""


def parse_chain(text: str) -> tuple[Axis, ...]:
    """Return the axes of a chain from the workpiece to the tool, of no travel yet, spindles in parentheses left out.

    text : "w-C'-B'-b-Y-X-Z-(C)-t" or "[w C' B' b Y X Z (C) t]", one to six axes, each once
    Raises DescriptionError: w, b or t missing or misplaced, an axis unknown, twice, or primed on the wrong side.
    """
    plain = re.sub("[’‘′´`]", "'", text[:_LONGEST]).strip()
    bracketed = plain.startswith("[") and plain.endswith("]")
    words = plain[1:-1].split() if bracketed else [word.strip() for word in plain.split("-")]
    if (words[:1], words[-1:], words.count("b")) != (["w"], ["t"], 1):
        raise DescriptionError("the chain {text} needs w first, one b, and t last", _EXAMPLE, text=shown(text))
    bed, links = words.index("b"), dict[str, Axis]()
    for place, word in enumerate(words[1:-1], 1):
        if place == bed or (place > bed and _SPINDLE.fullmatch(word)):
            continue
        found = _LINK.fullmatch(word)
        if found is None or found["name"] in links:
            what = "{word} in the chain {text} is not an axis, or stands there twice"
            remedy = "Axes are X Y Z U V W P Q R (linear) and A B C (rotary), in capitals, with one digit if needed"
            if _SPINDLE.fullmatch(word.replace("'", "")):
                remedy = "A spindle in parentheses stands behind b; a table that is positioned has no parentheses"
            raise DescriptionError(what, remedy, word=shown(word), text=shown(text))
        if bool(found["prime"]) != (place < bed):
            what = "{word} in the chain {text} is on the wrong side of the bed"
            remedy = "Axes between w and b carry the workpiece and have a prime, {name}'; those behind b have none"
            raise DescriptionError(what, remedy, word=word, text=shown(text), name=found["name"])
        links[found["name"]] = iso_axis(found["name"], place < bed, (0.0, 1.0))
    if not 1 <= len(links) <= MOST_AXES:
        what, remedy = "the chain {text} has {count} axes", "One to {most} axes are possible"
        raise DescriptionError(what, remedy, text=shown(text), count=len(links), most=MOST_AXES)
    return tuple(links.values())


def _turns(known: Beside) -> bool:
    return known.data["name"][:1] in ROTARY_LETTERS


def _along(linear: Dimension, rotary: Dimension, least: float, most: float) -> ReadAs:
    """Return what reads a quantity of a linear or of a rotary axis."""

    def made(text: str, known: Beside) -> float:
        return within(text, rotary if _turns(known) else linear, least, most)

    return ReadAs(QuantityText, made, by=True)


def _span(texts: tuple[str, str], known: Beside) -> Span:
    """Return two ends that increase, m or rad; raises DescriptionError or UnitError."""
    dimension: Dimension = "angle" if _turns(known) else "length"
    most = _FAR if _turns(known) else LONGEST_TRAVEL
    low, high = (within(text, dimension, -most, most) for text in texts)
    if high - low < 1e-6:
        remedy = "Write the two ends of the travel, the lower one first"
        raise DescriptionError("travel {given} is empty or reversed", remedy, given=shown([*texts]))
    return low, high


def _travel(texts: tuple[str, str], known: Beside) -> Span:
    """Return the travel: at most one turn of a rotary axis."""
    low, high = _span(texts, known)
    if _turns(known) and high - low > math.tau + 1e-9:
        what = "travel {given} is more than one turn ({span})"
        remedy = 'The errors repeat after a turn: give one, such as ["0 deg", "360 deg"]'
        raise DescriptionError(what, remedy, given=shown([*texts]), span=format_quantity(high - low, "deg"))
    return low, high


def _overrun(text: str, known: Beside) -> float:
    low, high = known.data.get("travel", (0.0, math.inf))
    return within(text, "angle" if _turns(known) else "length", _LEAST_OVERRUN, _LARGEST_OVERRUN * (high - low))


def _origin(point: Three, known: Beside) -> Three:
    """Return a point on the axis line of a rotary axis; a linear axis has none."""
    if not _turns(known):
        remedy = 'Origins belong to rotary axes A B C, such as ["0 mm", "0 mm", "-150 mm"]'
        raise DescriptionError("this is no point on the line of a rotary axis", remedy)
    return point


def _limits(texts: tuple[str, str], known: Beside) -> tuple[int, int] | None:
    """Return the whole turns below and above the travel that the limits of a full-turn axis reach into."""
    if (travel := known.data.get("travel")) is None:
        return None
    low, high = _span(texts, known)
    if not (_turns(known) and abs(travel[1] - travel[0] - math.tau) <= 1e-9):
        what, remedy = "{text} are limits of an axis whose travel is not one turn", "Take them out"
        raise DescriptionError(what, remedy, text=shown([*texts]))
    if low > travel[0] + 1e-9 or high < travel[1] - 1e-9:
        what, remedy = "limits {text} do not hold the travel", "Write how far the control lets it turn"
        raise DescriptionError(what, remedy, text=shown([*texts]))
    below, above = (math.ceil(beyond / math.tau - 1e-9) for beyond in (travel[0] - low, high - travel[1]))
    return below, above


def _shows(word: str, known: Beside) -> bool:
    if word == "diameter" and _turns(known):
        raise DescriptionError("{axis} turns, and shows no diameter", "Take it out", axis=known.data["name"])
    return word == "diameter"


_Ends = Annotated[tuple[QuantityText, QuantityText], AS_TUPLE]
_Coordinate = Annotated[float, QuantityOf("length", -LONGEST_TRAVEL, LONGEST_TRAVEL)]


def _named(tables: Any) -> Any:
    if not isinstance(tables, dict):
        return tables
    return {key: {NAME: key, **each} if isinstance(each, dict) else each for key, each in tables.items()}


_WITH_NAMES = BeforeValidator(_named)


class AxisTable(Table):
    """[axes.X]"""

    name: str = Field(alias=NAME)
    travel: Annotated[Span, ReadAs(_Ends, _travel, by=True)] = Field(examples=['["0 mm", "600 mm"]'])
    speed: Annotated[float, _along("speed", "rotation_speed", 1e-9, 1e4)] = Field(0.0, examples=['"10 m/min"'])
    acceleration: Annotated[float, _along("acceleration", "rotation_acceleration", 1e-9, 1e6)] = Field(
        0.0, examples=['"2 m/s^2"']
    )
    origin: Annotated[
        Three, ReadAs(Annotated[tuple[_Coordinate, _Coordinate, _Coordinate], AS_TUPLE], _origin, by=True)
    ] = Field((0.0, 0.0, 0.0), examples=['["0 mm", "0 mm", "-150 mm"]'])
    overrun: Annotated[float, ReadAs(QuantityText, _overrun, by=True)] | None = Field(None, examples=['"2 mm"'])
    limits: Annotated[tuple[int, int] | None, ReadAs(_Ends, _limits, by=True)] = Field(
        None, examples=['["-720 deg", "1080 deg"]']
    )
    direction: Counting | None = Field(None, examples=['"reversed"', '"iso"'])
    shows: Annotated[bool, ReadAs(Literal["radius", "diameter"], _shows, by=True)] = Field(
        False, examples=['"diameter"']
    )


def _axes(tables: Mapping[str, AxisTable], known: Beside) -> dict[str, Axis]:
    """Return the axes in the order of the chain; every axis has a table, every table an axis."""
    if (links := known.data.get("chain")) is None:
        return {}
    names = [link.name for link in links]
    for name in (each for each in tables if each not in names):
        otherwise = said("Put it there, or take the table out")
        remedy = meant(name, [each for each in names if each not in tables], otherwise, quoted="{}")
        raise DescriptionError("there is no axis {axis} in the chain", remedy, axis=name)
    for name in (each for each in names if each not in tables):
        raise DescriptionError("axis {axis} has no table", "Add [axes.{axis}] with its travel", axis=name)
    found = ((link, tables[link.name]) for link in links)
    return {
        link.name: iso_axis(
            link.name, link.workpiece_side, t.travel, t.speed, t.acceleration, t.origin, t.overrun, t.limits,
            t.direction, t.shows,
        )
        for link, t in found
    }  # fmt: skip


def _name(name: str) -> str:
    if not name.strip() or len(name) > _LONGEST or not name.isprintable():
        raise DescriptionError("{name} is not a name", "Write up to 200 printable characters", name=shown(name))
    return name


class ToolTable(Table):
    """[tool]"""

    length: Annotated[float, QuantityOf("length", 0.0, 10.0)] = Field(0.0, examples=['"120 mm"'])
    radius: Annotated[float, QuantityOf("length", 0.0, 1.0)] = Field(0.04, examples=['"31.5 mm"'])
    stylus: Annotated[float, QuantityOf("length", 0.0, 0.1)] = Field(0.0, examples=['"6 mm"'])
    reach: Annotated[float, QuantityOf("length", 0.0, 1.0)] = Field(0.05, examples=['"50 mm"'])
    head: list[Annotated[float, QuantityOf("length", 1e-3, 2.0)]] = Field(
        [], min_length=2, max_length=2, examples=['["130 mm", "130 mm"]']
    )


class MachineFile(Table):
    """The whole file"""

    name: Annotated[str, ReadAs(str, _name)] = Field("", examples=['"Three-axis mill"'])
    maker: str = Field("", examples=['"Example Machine Works, type 600"'])
    serial: str = Field("", examples=['"M-1042"'])
    chain: Annotated[tuple[Axis, ...], ReadAs(str, parse_chain)] = Field(examples=["\"w-X'-Y'-b-Z-t\""])
    tool: ToolTable = Field(default_factory=lambda: ToolTable.model_validate({}))
    axes: Annotated[dict[str, Axis], ReadAs(Annotated[dict[str, AxisTable], _WITH_NAMES], _axes, by=True)] = Field(
        examples=['{ X = { travel = ["0 mm", "600 mm"] } }']
    )
    errors: Annotated[
        tuple[Error, ...],
        ReadAs(
            Annotated[dict[str, Error], EachAs(Annotated[dict[str, ErrorTable], _WITH_NAMES], prior_of)],
            every_error,
            by=True,
        ),
    ] = Field(examples=['{ EXX = { std = "10 um" } }'])
