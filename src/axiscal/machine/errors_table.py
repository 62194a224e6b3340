"""The [errors] table: what is known beforehand about each error of one axis or of two, checked against the axes.

Sizes must lie within what a machine can have.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from axiscal.document import Document, shown
from axiscal.document.validation import Stated
from axiscal.exceptions import DescriptionError, Faults
from axiscal.language.spoken import joined, later, said
from axiscal.machine.axis import letter_direction, travel_text
from axiscal.machine.error_names import error_named, reference_in, shape_of, side_name
from axiscal.machine.machine_schema import ErrorTable
from axiscal.units import Dimension
from axiscal_core.axes import Axis
from axiscal_core.errors import COMPONENTS, ROUGH, SMOOTH, USUAL_KNOTS, Error
from axiscal_core.terms import JOINT, WAVE_KNOTS

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


def read_errors(
    document: Document,
    tables: Mapping[str, ErrorTable],
    axes: Mapping[str, Axis],
    described: set[str],
    faults: Faults,
    fine_knots: bool,
) -> tuple[Error, ...]:
    """Return what is known of errors, those of one axis first; each is there once, whatever its spelling.

    What is wrong is noted.

    described : axes that have a table; those not among `axes` have a faulty table; their errors are passed over
    fine_knots : knots of which nothing is said are as close as a rough curve needs, if all control values stay few
    """
    if not tables:
        remedy = 'Name at least one, such as EXX = { std = "10 um" }; an error that is not named is taken to be zero'
        faults.found.append(document.fault(DescriptionError("no error is named", remedy), "errors"))
    found = dict[object, tuple[str, Error, Error]]()
    for key, table in tables.items():
        with faults.noted(), document.placed("errors", key):
            name, reference = error_named(key), reference_in(key)
            needed = [*name.axes] if reference is None else [name.axis, reference]
            if set(needed) & (described - axes.keys()):
                continue
            stated = Stated(document, table, ("errors", key))
            own = _checked(name, key, table, needed, axes)
            coarse, fine = _of_one(name, stated, own[0]) if not name.sides else (_of_two(name, stated, own),) * 2
            identity = name.kind, shape_of(name), name.component, frozenset(name.axes)
            first, before, _ = found.setdefault(identity, (key, coarse, fine))
            if before is not coarse:
                earlier = document.line("errors", first)
                what = "{key} is {name}, which is there already in line {earlier}"
                raise DescriptionError(what, "Keep one of them", key=key, name=before.name, earlier=earlier)
    every = [each for plane in (False, True) for each in found.values() if bool(each[1].sides) is plane]
    finer = tuple(fine for _, _, fine in every)
    few = sum(each.count for each in finer if each.count > 1 and not each.sides) <= CHEAP
    return finer if fine_knots and few else tuple(coarse for _, coarse, _ in every)


def _checked(name: Error, key: str, table: ErrorTable, needed: Sequence[str], axes: Mapping[str, Axis]) -> list[Axis]:
    """Return the axes of an error; raises DescriptionError where name, keys and axes do not fit each other."""
    for wanted in needed:
        if wanted not in axes:
            what = "there is no axis {text} in the chain"
            raise DescriptionError(what, "The axes are {known}", text=shown(wanted), known=", ".join(axes))
    if len(set(needed)) < len(needed):
        what = "{axis} cannot be its own reference"
        raise DescriptionError(what, "Name another axis behind the 0", axis=needed[0])
    own = [axes[each] for each in needed]
    _check_location(name, own[0])
    _check_keys(name, key, table)
    if table.scale is not None and (own[0].rotary or key != own[0].positioning_error):
        remedy = "Give it to the position error of a linear axis, such as EXX"
        raise DescriptionError("scale = {value}: {name} is no length", remedy, value=shown(table.scale), name=key)
    return own


def _check_location(name: Error, axis: Axis) -> None:
    """Raise DescriptionError for a location error that a linear axis does not have (conventions, Errors)."""
    if name.kind != "location" or axis.rotary:
        return
    along = 3 + letter_direction(axis.letter)
    if name.angular and name.component != along:
        return
    possible = joined([f"{COMPONENTS[c]}0{axis.name}" for c in range(3, 6) if c != along])
    what = "a linear axis has no location error {name}: only two turns of its direction show"
    remedy = "The location errors of the linear axis {axis} are {possible}; a constant roll is part of {roll}"
    roll = f"E{COMPONENTS[along]}{axis.name}"
    raise DescriptionError(what, remedy, name=name.name, axis=axis.name, possible=possible, roll=roll)


_ALL = frozenset(ErrorTable.model_fields)
_CONSTANT = frozenset({"std", "band"})
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


def _check_keys(name: Error, key: str, table: ErrorTable) -> None:
    """Raise DescriptionError unless the keys of an entry fit each other and the kind of error.  key : as it is named"""
    given = [key for key in ErrorTable.model_fields if key in table.model_fields_set]
    for one, other, remedy in (
        ("std", "band", later("Keep one of them: the band is four standard deviations")),
        ("knots", "spacing", later("Keep one of them: one gives the other")),
    ):
        if one in given and other in given:
            raise DescriptionError("both {one} and {other} are given", said(remedy), one=one, other=other)
    if "std" not in given and "band" not in given:
        raise DescriptionError("neither std nor band is given", 'Add how large the error may be, such as std = "10 um"')
    curved = name.kind == "motion" or (name.kind == "reversal" and {"knots", "spacing"} & {*given})
    allowed, remedy = _KEYS[shape_of(name) if curved else name.kind]  # a reversal value with knots is a curve
    for each in given:
        value, error = shown(getattr(table, each)), key.partition("_")[0]
        if each not in allowed:
            what = "{key} = {value}: {name} has no {key}"
            raise DescriptionError(what, said(remedy, error=error), key=each, value=value, name=key)
        if not name.sides and isinstance(getattr(table, each), tuple):
            what = "{key} = {value}: {name} is an error of one axis"
            remedy = "Write one value; two belong to an error of two axes, such as EZXY"
            raise DescriptionError(what, remedy, key=each, value=value, name=key)
    for knots in table.knots if isinstance(table.knots, tuple) else (table.knots,):
        if knots is not None and not 2 <= knots <= MOST_KNOTS:
            text, remedy = shown(table.knots), "Write 2 to {most}"
            raise DescriptionError("knots = {text} is not possible", remedy, text=text, most=MOST_KNOTS)


def _of_one(name: Error, stated: Stated[ErrorTable], axis: Axis) -> tuple[Error, Error]:
    """Return the prior of an error of one axis, with as many knots as a smooth curve needs, and as a rough one does."""
    table = stated.table
    value: Dimension = "angle" if name.angular else "length"
    rest = _rest(stated, value)
    period = stated.within("period", axis.dimension, _SHORTEST, _LONGEST)
    length, shape = stated.within("length", axis.dimension, _SHORTEST, _LONGEST, 0), shape_of(name)
    free = (
        name.kind == "motion"
        and shape == "curve"
        and length is not None
        and table.knots is None
        and table.spacing is None
    )
    error = Error(
        name.name,
        _std(stated, value),
        _knot_count(name, stated, axis, 0, length),
        length,
        rest,
        stated.within("scale", "angle", 0.0, _LARGEST_SCALE),
        period,
        _harmonics(table, axis, period) if shape == "pitch" else 0,
        table.sure,
        smoothness=_smoothness(table, averaged=True),
        joints=_joints(stated, axis) if shape == "step" else (),
        learnt_rest=rest is None and table.rest is not None,
        free_knots=free,
    )
    return error, replace(error, knots=_knot_count(name, stated, axis, 0, length, fine=True)) if free else error


def _of_two(name: Error, stated: Stated[ErrorTable], axes: list[Axis]) -> Error:
    """Return the prior of what two axes do together; its size may be zero where there is a rest."""
    value: Dimension = "angle" if name.angular else "length"
    rest = _rest(stated, value)
    std = _std(stated, value, SMALLEST_ERROR if rest is None else 0.0)
    first, second = (_side(name, stated, axis, k) for k, axis in enumerate(axes))
    count = first.count * second.count
    if std and count > MOST_PRODUCTS:
        remedy = "At most {most} are possible; give knots, spacing or length accordingly"
        raise DescriptionError("{count} knots in the plane are too many", remedy, count=count, most=MOST_PRODUCTS)
    learnt = rest is None and stated.table.rest is not None
    return Error(name.name, std, rest=rest, learnt_rest=learnt, sides=(first, second))


def _side(name: Error, stated: Stated[ErrorTable], axis: Axis, index: int) -> Error:
    """Return what is known along one of two axes: an error of std 1; one value for both counts for each."""
    length = stated.within("length", axis.dimension, _SHORTEST, _LONGEST, index)
    knots = _knot_count(name, stated, axis, index, length)
    smoothness = _smoothness(stated.table, averaged=False)
    return Error(side_name(name.component, axis.name), 1.0, knots, length, smoothness=smoothness)


def _knot_count(
    name: Error, stated: Stated[ErrorTable], axis: Axis, index: int, length: float | None, fine: bool = False
) -> int | None:
    """Return the number of equidistant knots over the travel, both ends included; None of one number or a shape.

    `knots` as written. `spacing`: the fewest intervals not longer than it. Neither: at least four intervals, not
    longer than half the correlation length (a quarter for `fine` or a rough curve). Without a correlation length:
    7 knots, as in the paper (B&H section V).
    Raises DescriptionError when that is not between 2 and 400 (a full turn needs 4 for a periodic curve).
    """
    table, knots = stated.table, stated.table.knots
    spacing = stated.within("spacing", axis.dimension, _SHORTEST, _LONGEST, index)
    if name.kind == "location" or shape_of(name) in ("pitch", "step"):
        return None
    if name.kind == "reversal" and knots is None and spacing is None:
        return None
    if knots is not None:
        count: float = knots[index] if isinstance(knots, tuple) else knots
    elif spacing is not None:
        count = 1 + max(1, _intervals(axis.length, spacing))
    elif length is not None:
        parts = _FINE if fine or table.smoothness not in (None, SMOOTH) else _COARSE
        count = 1 + max(FEWEST_INTERVALS, _intervals(axis.length, length / parts))
    else:
        count = USUAL_KNOTS
    fewest = FEWEST_CYCLIC_KNOTS if axis.cyclic else 2
    if not fewest <= count <= MOST_KNOTS:
        what = "{error}: {count:.0f} knots are too few"
        what = what if count < fewest else "{error}: {count:.0f} knots are too many"
        remedy = "Between {least} and {most} knots are possible; give knots, spacing or length accordingly"
        raise DescriptionError(what, remedy, error=name.name, count=count, least=fewest, most=MOST_KNOTS)
    return int(count)


def _intervals(travel: float, longest: float) -> int:
    """Return how many equal intervals, none longer than `longest`, fill the travel."""
    return math.ceil(travel / longest - 1e-9)


def _std(stated: Stated[ErrorTable], dimension: Dimension, least: float = SMALLEST_ERROR) -> float:
    """Return the prior standard deviation, m or rad; a band is four of them."""
    std, band = (stated.within(key, dimension, least, LARGEST_ERROR) for key in ("std", "band"))
    return (band or 0.0) / 4 if std is None else std


def _rest(stated: Stated[ErrorTable], dimension: Dimension) -> float | None:
    """Return the standard deviation of the rest, m or rad; None when there is none or it is to be estimated."""
    if (stated.table.rest or "").strip() == AVERAGED:
        return None
    return stated.within("rest", dimension, SMALLEST_ERROR, LARGEST_ERROR)


def _smoothness(table: ErrorTable, averaged: bool) -> float:
    """Return how smooth a curve is; raises DescriptionError for a smoothness that there is not.

    averaged : it may also be "estimate", as older files say: a smooth curve, on knots as close as for a rough one
    """
    if table.smoothness is None:
        return SMOOTH
    if table.smoothness not in (SMOOTH, ROUGH) and not (averaged and table.smoothness == AVERAGED):
        remedy = "Write {smooth} for a smooth curve, {rough} for one that may have kinks"
        what, smooth = "smoothness = {text} is not possible", str(SMOOTH)
        text, rough = shown(table.smoothness), str(ROUGH)
        raise DescriptionError(what, remedy, text=text, smooth=smooth, rough=rough)
    if table.length is None:
        what = "smoothness = {text} is said of an error without a correlation length"
        remedy = 'Add over which distance it changes, such as length = "150 mm"'
        raise DescriptionError(what, remedy, text=shown(table.smoothness))
    return SMOOTH if table.smoothness == AVERAGED else float(table.smoothness)


def _harmonics(table: ErrorTable, axis: Axis, period: float | None) -> int:
    if period is None:
        raise DescriptionError("the period is missing", 'Add the pitch of the screw or of the scale: period = "10 mm"')
    harmonics, turns = 1 if table.harmonics is None else table.harmonics, axis.length / period
    if not 1 <= harmonics <= MOST_HARMONICS:
        remedy = "Write 1 to {most}"
        raise DescriptionError("harmonics = {text} is not possible", remedy, text=shown(harmonics), most=MOST_HARMONICS)
    if turns * WAVE_KNOTS * harmonics > MOST_BREAKS:
        what = "{waves:.0f} waves over the travel of {axis} are too many"
        remedy, most = "At most {most}; fewer harmonics, or a longer period", MOST_BREAKS // WAVE_KNOTS
        raise DescriptionError(what, remedy, waves=turns * harmonics, axis=axis.name, most=most)
    if axis.cyclic and abs(turns - round(turns)) > _TURN * turns:
        remedy = "A period that repeats in every turn"
        raise DescriptionError("{turns:.6g} periods make no whole turn", remedy, turns=turns)
    return harmonics


def _joints(stated: Stated[ErrorTable], axis: Axis) -> tuple[float, ...]:
    texts = stated.table.at
    if not texts or len(texts) > _MOST_JOINTS:
        remedy = 'Name 1 to {most} places: at = ["500 mm", "1000 mm"]'
        raise DescriptionError("it is not said where the pieces of the scale meet", remedy, most=_MOST_JOINTS)
    if axis.cyclic:
        remedy = "Give EXX_step to an axis that does not turn round"
        raise DescriptionError("a scale around {axis} closes", remedy, axis=axis.name)
    places = stated.each("at", axis.dimension, -_LONGEST, _LONGEST)
    low, high = axis.travel
    if any(after - before < 2 * JOINT for before, after in pairwise([low, *places, high])):
        what = "{places}: joints lie within the travel, one after the other"
        remedy, shown_places = "{axis} goes from {travel}; leave 2 mm between them", ", ".join(map(shown, texts))
        raise DescriptionError(what, remedy, places=shown_places, axis=axis.name, travel=travel_text(axis))
    return places
