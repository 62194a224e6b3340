"""The [errors] table: what is known beforehand about each error of one axis or of two, checked against the axes.

Sizes must lie within what a machine can have.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field

from axiscal.document import QuantityText, quantity_text, shown
from axiscal.document.toml_table import Table
from axiscal.document.validation import NAME, Beside, QuantityOf, ReadAs, refusal
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import joined, later, said
from axiscal.machine.axis import ROTARY_LETTERS, letter_direction, travel_text
from axiscal.machine.error_names import error_named, reference_in, shape_of, side_name
from axiscal.units import Dimension, within
from axiscal_core.axes import Axis
from axiscal_core.errors import COMPONENTS, ROUGH, SMOOTH, USUAL_KNOTS, Error
from axiscal_core.terms import JOINT, WAVE_KNOTS
from axiscal_core.theta import Sure

Along = tuple[float, ...]
"""One value, or one for each of two axes."""

FEWEST_INTERVALS = 4
FEWEST_CYCLIC_KNOTS = 4
MOST_KNOTS = 400
_COARSE, _FINE = 2, 4
"""Knot intervals in a correlation length: at two a smooth curve is followed, at four also one that is rougher, or that
turns out to be of half the length.
"""
CHEAP = 200
"""Control values of a machine: a plan of so many takes half a second more than one of half as many."""
MOST_HARMONICS = 4
"""What is finer than a quarter of a period is noise; a matter of taste."""
MOST_BREAKS = 4000
"""Of a curve along an axis: a step search meets each of them, and takes a second for so many."""
MOST_PRODUCTS = 1600
"""Control values of one plane: 40 x 40; an update with more takes seconds."""
LARGEST_ERROR, SMALLEST_ERROR = 1.0, 1e-12
"""m or rad."""
_LARGEST_SCALE = 0.1
"""A tenth of what an axis shows: more is another unit."""
AVERAGED = "estimate"
"""What is said of a rest that is to be learnt; in older files of a smoothness, too."""
_MOST_JOINTS = 40
"""More pieces than any scale has."""
_TURN = 1e-6
"""Share of a turn that a period may be off a whole part of it: rounding."""
_SHORTEST, _LONGEST = 1e-6, 1e4
"""m or rad, of a length along an axis."""


def _size(text: str, known: Beside) -> float:
    """Return a size of an error, m or rad; that of a name that is none is not read."""
    error = known.data.get("name")
    if error is None:
        return 0.0
    of: Dimension = "angle" if error.angular else "length"
    return within(text, of, 0.0 if error.sides else SMALLEST_ERROR, LARGEST_ERROR)


def _rest(text: str, known: Beside) -> float | None:
    """Return the standard deviation of the rest, m or rad; None where it is to be learnt."""
    return None if text.strip() == AVERAGED else _size(text, known)


def _each(given: Any, known: Beside) -> list[Any]:
    """Return a value for each axis of an error: one counts for both axes of a plane."""
    count = 2 if (error := known.data.get("name")) is not None and error.sides else 1
    if isinstance(given, list) and len(given) != count:
        remedy = "Write one value; two belong to an error of two axes, such as EZXY"
        raise DescriptionError("{value} are not one value for each axis", remedy, value=shown(given))
    return given if isinstance(given, list) else [given] * count


def _ways(known: Beside) -> list[Dimension]:
    """Return whether the axes of an error turn; of a name that is none nothing."""
    error = known.data.get("name")
    return ["angle" if axis[0] in ROTARY_LETTERS else "length" for axis in (error.axes if error else ())]


def _along(given: Any, known: Beside) -> Along:
    """Return a length along the axis of an error, or along each of two, m or rad."""
    texts = [quantity_text(text) for text in _each(given, known)]
    return tuple(within(text, of, _SHORTEST, _LONGEST) for text, of in zip(texts, _ways(known), strict=False))


def _knots(given: Any, known: Beside) -> Along:
    counts = _each(given, known)
    if not all(type(count) is int and 2 <= count <= MOST_KNOTS for count in counts):
        raise DescriptionError("{text} is not possible", "Write 2 to {most}", text=shown(given), most=MOST_KNOTS)
    return tuple(counts)


def _smoothness(given: Any) -> float:
    """Return how smooth a curve is; of older files that say "estimate" it is smooth, on knots as for a rough one."""
    if isinstance(given, bool) or given not in (SMOOTH, ROUGH, AVERAGED):
        remedy = "Write {smooth} for a smooth curve, {rough} for one that may have kinks"
        smooth, rough = str(SMOOTH), str(ROUGH)
        raise DescriptionError("{text} is not possible", remedy, text=shown(given), smooth=smooth, rough=rough)
    return math.nan if given == AVERAGED else float(given)


def _joints(texts: list[str], known: Beside) -> Along:
    of: Dimension = next(iter(_ways(known)), "length")
    return tuple(within(text, of, -_LONGEST, _LONGEST) for text in texts)


class ErrorTable(Table):
    """An entry of [errors]"""

    name: Annotated[Error, ReadAs(str, error_named)] = Field(alias=NAME)
    std: Annotated[float, ReadAs(QuantityText, _size, by=True)] | None = Field(None, examples=['"10 um"'])
    band: Annotated[float, ReadAs(QuantityText, _size, by=True)] | None = Field(None, examples=['"40 um"'])
    knots: Annotated[Along, ReadAs(Any, _knots, by=True)] | None = Field(None, examples=["13"])
    spacing: Annotated[Along, ReadAs(Any, _along, by=True)] | None = Field(None, examples=['"50 mm"'])
    length: Annotated[Along, ReadAs(Any, _along, by=True)] | None = Field(None, examples=['"150 mm"'])
    rest: Annotated[float | None, ReadAs(QuantityText, _rest, by=True)] = Field(
        None, examples=['"0.5 um"', '"estimate"']
    )
    period: Annotated[Along, ReadAs(Any, _along, by=True)] | None = Field(None, examples=['"5 mm"'])
    smoothness: Annotated[float, ReadAs(Any, _smoothness)] | None = Field(None, examples=["1.5"])
    sure: Sure | None = Field(None, examples=['"well"'])
    harmonics: int | None = Field(None, ge=1, le=MOST_HARMONICS, examples=["2"])
    at: Annotated[Along, ReadAs(list[QuantityText], _joints, by=True)] | None = Field(
        None, min_length=1, max_length=_MOST_JOINTS, examples=['["500 mm", "1000 mm"]']
    )
    scale: Annotated[float, QuantityOf("angle", 0.0, _LARGEST_SCALE)] | None = Field(None, examples=['"30 um/m"'])


_ALL = frozenset(ErrorTable.model_fields)
_CONSTANT = frozenset({"name", "std", "band"})
_ELSEWHERE = later("Take it out, or give it to {error}")
_KEYS = {
    "location": (_CONSTANT, later("It has only std or band")),
    "reversal": (_CONSTANT, later("Take it out, or give knots as well")),
    "pitch": (_CONSTANT | {"period", "harmonics", "sure"}, _ELSEWHERE),
    "step": (_CONSTANT | {"period", "at", "sure"}, _ELSEWHERE),
    "curve": (_ALL - {"harmonics", "at"}, later("Give it to {error}_pitch or {error}_step")),
    "plane": (_ALL - {"period", "scale"}, later("Take it out; give it to the curve of one axis")),
}
"""By kind of error: the keys that it may have, and what would be right for another."""


def _check_keys(key: str, table: ErrorTable) -> None:
    """Raise DescriptionError unless the keys of an entry fit each other and the kind of error.  key : as it is named"""
    name, given = table.name, [key for key in ErrorTable.model_fields if key in table.model_fields_set]
    for one, other in (("std", "band"), ("knots", "spacing")):
        if one in given and other in given:
            what, remedy = "both {one} and {other} are given", "Keep one of them: one gives the other"
            raise DescriptionError(what, remedy, one=one, other=other)
    if "std" not in given and "band" not in given:
        raise DescriptionError("neither std nor band is given", 'Add how large the error may be, such as std = "10 um"')
    curved = name.kind == "motion" or (name.kind == "reversal" and {"knots", "spacing"} & {*given})
    allowed, remedy = _KEYS[shape_of(name) if curved else name.kind]  # a reversal value with knots is a curve
    error = key.partition("_")[0]
    for each in given:
        if each not in allowed:
            raise DescriptionError("{name} has no {key}", said(remedy, error=error), key=each, name=key)
    if table.smoothness is not None and table.length is None:
        remedy = 'Add over which distance it changes, such as length = "150 mm"'
        raise DescriptionError("smoothness is said of an error without a correlation length", remedy)
    if not (table.std or table.band or table.rest):
        raise DescriptionError("an error of no size has no rest", 'Add how large it may be, such as std = "10 um"')


def prior_of(key: str, table: ErrorTable, known: Beside) -> Error:
    """Return what is known of an error; raises DescriptionError where name, keys and axes do not fit each other."""
    _check_keys(key, table)
    name, reference, axes = table.name, reference_in(key), known.data.get("axes")
    if not axes:  # what is wrong with them is said
        return name
    needed = [*name.axes] if reference is None else [name.axis, reference]
    for wanted in needed:
        if wanted not in axes or needed.count(wanted) > 1:
            what = "there is no axis {text} in the chain, or it is named twice"
            raise DescriptionError(what, "The axes are {known}", text=shown(wanted), known=", ".join(axes))
    axis, shape = axes[needed[0]], shape_of(name)
    if name.kind == "location" and not axis.rotary:
        _check_location(name, axis)
    if table.scale is not None and (axis.rotary or key != axis.positioning_error):
        remedy = "Give it to the position error of a linear axis, such as EXX"
        raise DescriptionError("scale: {name} is no length", remedy, name=key)
    std = (table.band or 0.0) / 4 if table.std is None else table.std
    learnt = table.rest is None and "rest" in table.model_fields_set
    if name.sides:
        first, second = (_side(table, axes[each], k) for k, each in enumerate(name.axes))
        count = first.count * second.count
        if std and count > MOST_PRODUCTS:
            remedy = "At most {most} are possible; give knots, spacing or length accordingly"
            raise DescriptionError("{count} knots in the plane are too many", remedy, count=count, most=MOST_PRODUCTS)
        return Error(name.name, std, rest=table.rest, learnt_rest=learnt, sides=(first, second))
    return Error(
        name.name,
        std,
        _knot_count(table, axis, 0),
        table.length[0] if table.length else None,
        table.rest,
        table.scale,
        table.period[0] if table.period else None,
        _waves(table, axis) if shape == "pitch" else 0,
        table.sure,
        smoothness=_smooth(table),
        joints=_pieces(table, axis) if shape == "step" else (),
        learnt_rest=learnt,
        free_knots=name.kind == "motion" and shape == "curve" and table.length is not None
        and table.knots is None is table.spacing,
    )  # fmt: skip


def every_error(found: Mapping[str, Error], known: Beside) -> tuple[Error, ...]:
    """Return what is known of errors, those of one axis first; each is there once, whatever its spelling.

    found : by their keys; known : its context says whether knots of which nothing is said are as close as a rough curve
    needs, if all control values stay few
    """
    if not found:
        remedy = 'Name at least one, such as EXX = { std = "10 um" }; an error that is not named is taken to be zero'
        raise DescriptionError("no error is named", remedy)
    seen = dict[object, str]()
    for key, name in found.items():
        first = seen.setdefault((name.kind, shape_of(name), name.component, frozenset(name.axes)), key)
        if first != key:
            what = "{key} is {name}, which is there already as {first}"
            fault = DescriptionError(what, "Keep one of them", key=key, first=first, name=found[first].name)
            raise refusal([((key,), fault)])
    every = tuple(sorted(found.values(), key=lambda error: bool(error.sides)))
    fine = tuple(_finer(error, known.data.get("axes", {})) for error in every)
    few = sum(error.count for error in fine if error.count > 1 and not error.sides) <= CHEAP
    return fine if known.context and few else every


def _finer(error: Error, axes: Mapping[str, Axis]) -> Error:
    """Return an error with as many knots as a rough curve needs, where nobody says how many it has."""
    if not error.free_knots or error.length is None or error.axis not in axes:
        return error
    return replace(error, knots=1 + max(FEWEST_INTERVALS, _intervals(axes[error.axis].length, error.length / _FINE)))


def _check_location(name: Error, axis: Axis) -> None:
    """Raise DescriptionError for a location error that a linear axis does not have (conventions, Errors)."""
    along = 3 + letter_direction(axis.letter)
    if name.angular and name.component != along:
        return
    possible = joined([f"{COMPONENTS[c]}0{axis.name}" for c in range(3, 6) if c != along])
    what = "a linear axis has no location error {name}: only two turns of its direction show"
    remedy = "The location errors of the linear axis {axis} are {possible}; a constant roll is part of {roll}"
    roll = f"E{COMPONENTS[along]}{axis.name}"
    raise DescriptionError(what, remedy, name=name.name, axis=axis.name, possible=possible, roll=roll)


def _smooth(table: ErrorTable) -> float:
    return SMOOTH if table.smoothness is None or math.isnan(table.smoothness) else table.smoothness


def _side(table: ErrorTable, axis: Axis, index: int) -> Error:
    """Return what is known along one of two axes: an error of std 1; one value for both counts for each."""
    length = table.length[index] if table.length else None
    knots = _knot_count(table, axis, index)
    return Error(side_name(table.name.component, axis.name), 1.0, knots, length, smoothness=_smooth(table))


def _knot_count(table: ErrorTable, axis: Axis, index: int) -> int | None:
    """Return the number of equidistant knots over the travel, both ends included; None of one number or a shape.

    `knots` as written. `spacing`: the fewest intervals not longer than it. Neither: at least four intervals, not
    longer than half the correlation length (a quarter for a rough curve). Without a correlation length:
    7 knots, as in the paper (B&H section V).
    Raises DescriptionError when that is not between 2 and 400 (a full turn needs 4 for a periodic curve).
    """
    name = table.name
    if name.kind == "location" or shape_of(name) in ("pitch", "step"):
        return None
    if name.kind == "reversal" and table.knots is table.spacing is None:
        return None
    count: float = USUAL_KNOTS
    if table.knots is not None:
        count = table.knots[index]
    elif table.spacing is not None:
        count = 1 + max(1, _intervals(axis.length, table.spacing[index]))
    elif table.length is not None:
        parts = _COARSE if table.smoothness in (None, SMOOTH) else _FINE
        count = 1 + max(FEWEST_INTERVALS, _intervals(axis.length, table.length[index] / parts))
    fewest = FEWEST_CYCLIC_KNOTS if axis.cyclic else 2
    if not fewest <= count <= MOST_KNOTS:
        what = "{error}: {count:.0f} knots are not possible"
        remedy = "Between {least} and {most} knots are possible; give knots, spacing or length accordingly"
        raise DescriptionError(what, remedy, error=name.name, count=count, least=fewest, most=MOST_KNOTS)
    return int(count)


def _intervals(travel: float, longest: float) -> int:
    """Return how many equal intervals, none longer than `longest`, fill the travel."""
    return math.ceil(travel / longest - 1e-9)


def _waves(table: ErrorTable, axis: Axis) -> int:
    if not table.period:
        raise DescriptionError("the period is missing", 'Add the pitch of the screw or of the scale: period = "10 mm"')
    harmonics, turns = table.harmonics or 1, axis.length / table.period[0]
    if turns * WAVE_KNOTS * harmonics > MOST_BREAKS:
        what = "{waves:.0f} waves over the travel of {axis} are too many"
        remedy, most = "At most {most}; fewer harmonics, or a longer period", MOST_BREAKS // WAVE_KNOTS
        raise DescriptionError(what, remedy, waves=turns * harmonics, axis=axis.name, most=most)
    if axis.cyclic and abs(turns - round(turns)) > _TURN * turns:
        remedy = "A period that repeats in every turn"
        raise DescriptionError("{turns:.6g} periods make no whole turn", remedy, turns=turns)
    return harmonics


def _pieces(table: ErrorTable, axis: Axis) -> Along:
    """Return where the pieces of a scale meet, within the travel, one after the other."""
    places, (low, high) = table.at or (), axis.travel
    if axis.cyclic:
        remedy = "Give EXX_step to an axis that does not turn round"
        raise DescriptionError("a scale around {axis} closes", remedy, axis=axis.name)
    if not places or any(after - before < 2 * JOINT for before, after in pairwise([low, *places, high])):
        what = "at: joints of a scale lie within the travel, one after the other"
        remedy = "{axis} goes from {travel}; leave 2 mm between them"
        raise DescriptionError(what, remedy, axis=axis.name, travel=travel_text(axis))
    return places
