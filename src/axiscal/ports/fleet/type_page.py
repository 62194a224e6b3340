"""The page of a learnt type: the common errors, and each curve as stated and as its type knows it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from axiscal.answers.digits import numbers
from axiscal.errors.model import ErrorFunction, ErrorModel
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.type_prior import TypePrior
from axiscal.numerics import Array
from axiscal.ports.fleet.type_words import ErrorLine, error_lines, summary_sentences
from axiscal.present.drawing.shown import shown
from axiscal.present.drawing.svg_picture import Figure
from axiscal.present.figures import axis_style, layout, line_trace
from axiscal.present.standalone import page_of
from axiscal.units import to_unit

_POINTS, _HEIGHT = 61, 200
"""Points of a curve, and pixels; a matter of taste."""


def render(prior: TypePrior, saved: Sequence[str] = ()) -> str:
    """Return the page as self-contained HTML.  saved : sentences on what it saves a campaign"""
    machine = prior.machine
    errors = ErrorModel(machine)
    curves = [function for function in errors.functions if function.basis.size > 1]
    pictures = [
        {"title": f.name, "svg": shown(curve_picture(prior, f), f"{f.name}, as stated and learnt")} for f in curves
    ]
    return page_of(
        "axiscal.ports.fleet",
        "type.html",
        title=f"What its sisters teach: {machine.name}",
        sentences=[*saved, *summary_sentences(prior)],
        rows=[_row(line) for line in error_lines(prior)],
        pictures=pictures,
        records=prior.records,
    )


def _row(line: ErrorLine) -> dict[str, str]:
    unit = "urad" if line.angular else "um"
    return {
        "name": line.name,
        "words": line.words,
        "unit": unit.replace("u", "µ", 1),
        "stated": f"{to_unit(line.stated, unit):.3g}",
        "known": f"{to_unit(line.known, unit):.3g}",
        "factor": f"{line.factor:.2f}",
        "share": f"{line.share:.0%} ± {line.share_std:.0%}",
        "width": f"{100 * line.share:.0f}",
    }


def curve_picture(prior: TypePrior, function: ErrorFunction) -> Figure:
    """Return one curve: mean and band by the type, and the band as stated, dotted."""
    low, high = (float(function.basis.knots[end]) for end in (0, -1))
    places = np.linspace(low, high, _POINTS)
    rows = function.rows(places)
    mean = rows @ prior.mean[function.columns]
    known, stated = (
        BAND * np.sqrt(np.einsum("ij,jk,ik->i", rows, each, rows))
        for each in (prior.covariance[function.columns, function.columns], function.covariance)
    )
    angular = function.name[-1] in "ABC"
    x = numbers([to_unit(float(at), "deg" if angular else "mm") for at in places], function.name)
    return {
        "data": list(_traces(x, mean, known, stated, "urad" if function.angular else "um", function.name)),
        "layout": layout(
            axis_style(f"{function.name[-1]}, {'deg' if angular else 'mm'}"),
            axis_style("µrad" if function.angular else "µm"),
            _HEIGHT,
        ),
    }


def _traces(x: list[float], mean: Array, known: Array, stated: Array, unit: str, name: str) -> Iterator[Figure]:
    def line(values: Array, colour: str, width: float, dash: str = "solid") -> Figure:
        return line_trace(x, numbers([to_unit(float(value), unit) for value in values], name), colour, width, dash)

    for sign in (1, -1):
        yield line(sign * stated, "var(--soft)", 1.2, "dot")
        yield line(mean + sign * known, "var(--accent)", 1.2)
    yield line(mean, "var(--accent)", 2.4)
