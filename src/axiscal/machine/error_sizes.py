"""Sizes of errors as they are written in the [errors] table, within what a machine can have."""

from __future__ import annotations

from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, InputError
from axiscal.language.spoken import said
from axiscal.machine.entry import ROUGH, SMOOTH
from axiscal.machine.limits import Keys, within
from axiscal.machine.machine_schema import ErrorTable
from axiscal.units import Dimension

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
