"""The [errors] table: what is known beforehand about each error, checked against the axes.

Sizes must lie within what a machine can have.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, Faults, InputError
from axiscal.language.spoken import joined, later, said
from axiscal.machine.axis import Axis, letter_direction
from axiscal.machine.entry import MOST_KNOTS, ROUGH, SMOOTH, ErrorEntry, shaped
from axiscal.machine.limits import Keys, within
from axiscal.machine.machine_schema import ErrorTable
from axiscal.machine.names import COMPONENTS, ErrorName, parse_error_name, parse_plane_name
from axiscal.units import Dimension

Value = TypeVar("Value", int, str)


def error_entries(
    document: Document, tables: dict[str, ErrorTable], axes: dict[str, Axis], described: set[str], faults: Faults
) -> tuple[ErrorEntry, ...]:
    """Return the prior of every error; each error is there once, whatever its spelling.  What is wrong is noted.

    described : axes that have a table; those not among `axes` have a faulty table; their errors are passed over
    """
    if not tables:
        remedy = 'Name at least one, such as EXX = { std = "10 um" }; an error that is not named is taken to be zero'
        faults.found.append(document.fault(DescriptionError("no error is named", remedy), "errors"))
    entries: dict[str, ErrorEntry] = {}
    for key, table in tables.items():
        if parse_plane_name(key) is not None:
            continue
        with faults.noted():
            if _of_wrong_axis(key, described - axes.keys()):
                continue
            _add(document, key, table, axes, entries)
    return tuple(entries.values())


def _of_wrong_axis(key: str, wrong: set[str]) -> bool:
    try:
        name = parse_error_name(key)
    except InputError:
        return False
    return name.axis in wrong or name.reference in wrong


def _add(
    document: Document, key: str, table: ErrorTable, axes: dict[str, Axis], entries: dict[str, ErrorEntry]
) -> None:
    """Add an entry; raises DescriptionError for one that is there already."""
    entry = _entry(document, key, table, axes)
    if (first := entries.get(entry.name)) is not None:
        what, name = "{key} is {name}, which is there already in line {earlier}", entry.name
        fault = DescriptionError(what, "Keep one of them", key=key, name=name, earlier=first.line)
        raise document.fault(fault, "errors", key)
    entries[entry.name] = entry


def _entry(document: Document, key: str, table: ErrorTable, axes: dict[str, Axis]) -> ErrorEntry:
    keys: Keys = ("errors", key)
    try:
        name, axis = _checked_name(key, table, axes)
        entry = _prior(document, keys, table, name, axis)
        entry.knot_count(axis)
    except InputError as fault:
        raise fault if fault.file is not None else document.fault(fault, *keys) from None
    return entry


def _checked_name(key: str, table: ErrorTable, axes: dict[str, Axis]) -> tuple[ErrorName, Axis]:
    """Return the name taken apart and its axis; raises DescriptionError when the keys of the entry do not fit it."""
    name = parse_error_name(key)
    axis = _axis_of(name, axes)
    _check_location(name, axis)
    _check_keys(name, table)
    return name, axis


def _prior(document: Document, keys: Keys, table: ErrorTable, name: ErrorName, axis: Axis) -> ErrorEntry:
    """Return the entry with its quantities in SI units."""
    value: Dimension = "angle" if name.angular else "length"
    position: Dimension = axis.dimension
    spacing, length, period = (
        None if text is None else within(document, (*keys, of), text, position, 1e-6, 1e4)
        for of, text in (("spacing", _one(table.spacing)), ("length", _one(table.length)), ("period", table.period))
    )
    std, rest = _std(document, keys, table, value), rest_of(document, keys, table, value)
    estimated = rest is None and table.rest is not None
    line = document.line(*keys)
    knots, smoothness = _one(table.knots), smoothness_of(table, averaged=True)
    shape = shaped(document, keys, table, name, axis)
    entry = ErrorEntry(name.canonical, std, knots, spacing, length, rest, estimated, line, period, smoothness, *shape)
    return replace(entry, smoothness_averaged=table.smoothness == AVERAGED, sure=table.sure)


def _one(value: Value | tuple[Value, Value] | None) -> Value | None:
    """Return the value of an error of one axis."""
    return value[0] if isinstance(value, tuple) else value


def _axis_of(name: ErrorName, axes: dict[str, Axis]) -> Axis:
    """Return the axis that an error belongs to; it, and the axis it is measured from, must be in the chain."""
    for wanted in (name.axis, name.reference):
        if wanted is not None and wanted not in axes:
            what = "there is no axis {text} in the chain"
            raise DescriptionError(what, "The axes are {known}", text=shown(wanted), known=", ".join(axes))
    if name.reference == name.axis:
        raise DescriptionError("{axis} cannot be its own reference", "Name another axis behind the 0", axis=name.axis)
    return axes[name.axis]


def _check_location(name: ErrorName, axis: Axis) -> None:
    """Raise DescriptionError for a location error that a linear axis does not have (conventions, Errors)."""
    if name.kind != "location" or axis.rotary:
        return
    along = 3 + letter_direction(axis.letter)
    if name.angular and name.component != along:
        return
    possible = joined([f"{COMPONENTS[c]}0{axis.name}" for c in range(3, 6) if c != along])
    remedy = "The location errors of the linear axis {axis} are {possible}"
    if name.component == along:
        what = "a turn about {axis}'s own direction does not change its direction of travel"
        remedy = "The location errors of the linear axis {axis} are {possible}; a constant roll is part of {error}"
        error = f"E{COMPONENTS[along]}{axis.name}"
        raise DescriptionError(what, remedy, axis=axis.name, possible=possible, error=error)
    what = "a linear axis has no location error {name}: shifting it shifts only its zero"
    raise DescriptionError(what, remedy, name=name.canonical, axis=axis.name, possible=possible)


def _check_keys(name: ErrorName, table: ErrorTable) -> None:
    """Raise DescriptionError unless the keys of an entry fit each other and the kind of error."""
    given = [key for key, value in table if value is not None]
    for one, other, remedy in (
        ("std", "band", later("Keep one of them: the band is four standard deviations")),
        ("knots", "spacing", later("Keep one of them: one gives the other")),
    ):
        if one in given and other in given:
            raise DescriptionError("both {one} and {other} are given", said(remedy), one=one, other=other)
    if "std" not in given and "band" not in given:
        raise DescriptionError("neither std nor band is given", 'Add how large the error may be, such as std = "10 um"')
    extra = [key for key in given if key not in ("std", "band")]
    curve = name.kind == "motion" or (name.kind == "reversal" and ("knots" in given or "spacing" in given))
    if extra and not curve:
        remedy = "Take it out, or give knots as well" if name.kind == "reversal" else "It has only std or band"
        what = "{key} = {value}: {name} is a constant"
        raise DescriptionError(what, remedy, key=extra[0], value=shown(getattr(table, extra[0])), name=name.canonical)
    for key in ("knots", "spacing", "length"):
        if isinstance(getattr(table, key), tuple):
            what = "{key} = {value}: {name} is an error of one axis"
            remedy = "Write one value; two belong to an error of two axes, such as EZXY"
            raise DescriptionError(what, remedy, key=key, value=shown(list(getattr(table, key))), name=name.canonical)
    if table.knots is not None and not 2 <= (_one(table.knots) or 0) <= MOST_KNOTS:
        remedy = "Write 2 to {most}"
        raise DescriptionError("knots = {text} is not possible", remedy, text=shown(table.knots), most=MOST_KNOTS)


def _std(document: Document, keys: Keys, table: ErrorTable, dimension: Dimension) -> float:
    """Return the prior standard deviation, m or rad; a band is four of them."""
    if table.std is not None:
        return error_size(document, (*keys, "std"), table.std, dimension)
    return error_size(document, (*keys, "band"), table.band or "", dimension) / 4


LARGEST_ERROR, SMALLEST_ERROR = 1.0, 1e-12
"""m or rad."""


AVERAGED = "estimate"
"""What is said of a smoothness that is to be averaged over."""


def rest_of(document: Document, keys: Keys, table: ErrorTable, dimension: Dimension) -> float | None:
    """Return the standard deviation of the rest, m or rad; None when there is none or it is to be estimated."""
    if table.rest is None or table.rest.strip() == "estimate":
        return None
    try:
        return error_size(document, (*keys, "rest"), table.rest, dimension)
    except InputError as fault:
        remedy = said('{remedy}; or "estimate" to learn it from the readings', remedy=fault.remedy)
        raise type(fault)(fault.what, remedy, fault.file, fault.line) from None


def error_size(document: Document, keys: Keys, text: str, dimension: Dimension) -> float:
    """Return how large an error may be, m or rad; raises UnitError, or DescriptionError when it is not possible."""
    return within(document, keys, text, dimension, SMALLEST_ERROR, LARGEST_ERROR)


def smoothness_of(table: ErrorTable, averaged: bool = False) -> float:
    """Return how smooth a curve is; raises DescriptionError for a smoothness that there is not.

    averaged : it may also be averaged over, "estimate"; it begins as a smooth one then
    """
    if table.smoothness is None:
        return SMOOTH
    if table.smoothness not in (SMOOTH, ROUGH) and not (averaged and table.smoothness == AVERAGED):
        remedy = "Write {smooth} for a smooth curve, {rough} for one that may have kinks"
        if averaged:
            remedy = (
                'Write {smooth} for a smooth curve, {rough} for one that may have kinks, "{both}" to average over both'
            )
        what, smooth = "smoothness = {text} is not possible", str(SMOOTH)
        text, rough = shown(table.smoothness), str(ROUGH)
        raise DescriptionError(what, remedy, text=text, smooth=smooth, rough=rough, both=AVERAGED)
    if table.length is None:
        what = "smoothness = {text} is said of an error without a correlation length"
        remedy = 'Add over which distance it changes, such as length = "150 mm"'
        raise DescriptionError(what, remedy, text=shown(table.smoothness))
    return SMOOTH if table.smoothness == AVERAGED else float(table.smoothness)
