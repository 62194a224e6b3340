"""Whether first order is enough, in words: beside the accuracy, and as a warning where it is not."""

from __future__ import annotations

from collections.abc import Iterator

from axiscal.estimation.linearity import Linearity
from axiscal.language.spoken import said
from axiscal.report.promises import Linear
from axiscal.report.summary import Finding
from axiscal.units import said_quantity, to_unit


def linear_of(found: Linearity, where: str) -> Linear:
    """Return the same for people.  where : "in space", or along which directions"""
    bound = to_unit(found.bound, "um")
    words = "Linear to {size} {where}: the first order is off at the tool by no more, for a machine within these bands."
    return Linear(bound, found.largest, said(words, size=said_quantity(found.bound, "um", 2), where=where))


def not_gaussian(found: Linearity) -> Iterator[Finding]:
    """Yield a warning where a reading is so far from linear that the posterior is no Gaussian."""
    if found.gaussian or found.reading is None:
        return
    text = (
        "Reading {reading} is not linear within what is left open: its second order is {times:.2g} times its noise, "
        "so the bands are only about right. State stations or location errors nearer to the truth, or read more."
    )
    yield Finding("not-gaussian", None, said(text, reading=found.reading, times=float(found.largest)))
