"""The errors of two axes in the [errors] table: what is known beforehand of each, checked against the axes."""

from __future__ import annotations

from dataclasses import replace

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, Faults, InputError
from axiscal.machine.axis import Axis
from axiscal.machine.entry import MOST_KNOTS, ErrorEntry
from axiscal.machine.errors_table import error_size, rest_of, smoothness_of
from axiscal.machine.limits import Keys, within
from axiscal.machine.machine_schema import ErrorTable
from axiscal.machine.names import PlaneName, parse_plane_name
from axiscal.machine.plane_entry import PlaneEntry, side_name
from axiscal.units import Dimension, parse_quantity

MOST_PRODUCTS = 1600
"""Control values of one plane: 40 x 40; an update with more takes seconds."""


def plane_entries(
    document: Document, tables: dict[str, ErrorTable], axes: dict[str, Axis], described: set[str], faults: Faults
) -> tuple[PlaneEntry, ...]:
    """Return the prior of every error of two axes; of the same two it is there once.  What is wrong is noted.

    described : axes that have a table; those not among `axes` have a faulty table; their errors are passed over
    """
    entries: dict[tuple[int, frozenset[str]], PlaneEntry] = {}
    for key, table in tables.items():
        name = parse_plane_name(key)
        if name is None or set(name.axes) & (described - axes.keys()):
            continue
        with faults.noted():
            entry = _entry(document, key, table, name, axes)
            before = entries.setdefault((name.component, frozenset(name.axes)), entry)
            if before is not entry:
                what, again = "{key} is {name}, which is there already in line {earlier}", before.name
                raise document.fault(
                    DescriptionError(what, "Keep one of them", key=key, name=again, earlier=before.line), "errors", key
                )
    return tuple(entries.values())


def _entry(document: Document, key: str, table: ErrorTable, name: PlaneName, axes: dict[str, Axis]) -> PlaneEntry:
    keys: Keys = ("errors", key)
    try:
        _check(name, table, axes)
        return _prior(document, keys, table, name, axes)
    except InputError as fault:
        raise fault if fault.file is not None else document.fault(fault, *keys) from None


def _check(name: PlaneName, table: ErrorTable, axes: dict[str, Axis]) -> None:
    """Raise DescriptionError for axes that are not there, or keys that do not fit each other."""
    for wanted in name.axes:
        if wanted not in axes:
            what = "there is no axis {text} in the chain"
            raise DescriptionError(what, "The axes are {known}", text=shown(wanted), known=", ".join(axes))
    if name.axes[0] == name.axes[1]:
        remedy = "Name the two axes that act together, such as EZXY"
        raise DescriptionError("{axis} is named twice", remedy, axis=name.axes[0])
    if table.period is not None:
        raise DescriptionError("an error of two axes has no period", "Take it out; give it to the curve of one axis")
    for one, other in (("std", "band"), ("knots", "spacing")):
        if getattr(table, one) is not None and getattr(table, other) is not None:
            raise DescriptionError("both {one} and {other} are given", "Keep one of them", one=one, other=other)
    if table.std is None and table.band is None:
        raise DescriptionError("neither std nor band is given", 'Add how large it may be, such as std = "10 um"')


def _prior(document: Document, keys: Keys, table: ErrorTable, name: PlaneName, axes: dict[str, Axis]) -> PlaneEntry:
    value: Dimension = "angle" if name.component >= 3 else "length"
    rest = rest_of(document, keys, table, value)
    std = _std(document, keys, table, value, rest is not None)
    first, second = (_side(document, keys, table, name, index, axes) for index in (0, 1))
    plane = PlaneEntry(
        str(keys[1]), name.component, std, (first, second), rest, rest is None and table.rest is not None,
        document.line(*keys),
    )  # fmt: skip
    count = first.knot_count(axes[first.axis]) * second.knot_count(axes[second.axis])
    if std and count > MOST_PRODUCTS:
        remedy = "At most {most} are possible; give knots, spacing or length accordingly"
        raise DescriptionError("{count} knots in the plane are too many", remedy, count=count, most=MOST_PRODUCTS)
    return plane


def _std(document: Document, keys: Keys, table: ErrorTable, dimension: Dimension, rest: bool) -> float:
    """Return the prior standard deviation, m or rad; zero is allowed where there is a rest."""
    if table.std is None:
        return error_size(document, (*keys, "band"), table.band or "", dimension) / 4
    if rest and parse_quantity(table.std, dimension) == 0:
        return 0.0
    return error_size(document, (*keys, "std"), table.std, dimension)


def _side(
    document: Document, keys: Keys, table: ErrorTable, name: PlaneName, index: int, axes: dict[str, Axis]
) -> ErrorEntry:
    """Return knots and correlation length along one axis; one value for both counts for each."""
    axis = axes[name.axes[index]]
    entry = ErrorEntry(side_name(name.component, axis.name), 1.0)
    if table.knots is not None:
        knots = table.knots[index] if isinstance(table.knots, tuple) else table.knots
        if not 2 <= knots <= MOST_KNOTS:
            remedy = "Write 2 to {most}"
            raise DescriptionError("knots = {text} is not possible", remedy, text=shown(table.knots), most=MOST_KNOTS)
        entry = replace(entry, knots=knots)
    spacing, length = (
        _along(document, (*keys, key), text, index, axis)
        for key, text in (("spacing", table.spacing), ("length", table.length))
    )
    entry = replace(entry, spacing=spacing, length=length, smoothness=smoothness_of(table))
    entry.knot_count(axis)
    return entry


def _along(document: Document, keys: Keys, text: str | tuple[str, str] | None, index: int, axis: Axis) -> float | None:
    """Return a quantity along one axis in SI units."""
    if text is None:
        return None
    if isinstance(text, tuple):
        return within(document, (*keys, index), text[index], axis.dimension, 1e-6, 1e4)
    return within(document, keys, text, axis.dimension, 1e-6, 1e4)
