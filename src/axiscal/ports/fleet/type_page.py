"""A learnt type in words and on a page: the errors that machines share, their sizes, and when that saves nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from axiscal.answers.digits import numbers
from axiscal.errors.iso230 import words
from axiscal.errors.model import ErrorFunction, ErrorModel
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.type_prior import TypePrior
from axiscal.numerics import Array
from axiscal.ports.fleet.type_learning import FEW
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


_RIGHT = 1.25
"""A size within a quarter is as stated."""
_SHARED, _OWN = 0.5, 0.25
"""Shares from which a thing is mostly common, and below which it hardly is; a matter of taste."""
_LOUD, _NAMED = 0.5, 4
"""Part of the largest load from which an error is named with a direction, and how many are; a matter of taste."""
_DIRECTION = 0.5
"""Variance along a direction, of which all else has 1, from which it is worth a sentence."""


class ErrorLine(NamedTuple):
    """One error as its type knows it.

    stated, known : RMS standard deviation before, and by the type, m or rad; factor : of the size, √c; share : ω
    """

    name: str
    words: str
    angular: bool
    stated: float
    known: float
    factor: float
    share: float
    share_std: float


def error_lines(prior: TypePrior) -> list[ErrorLine]:
    """Return a line for each error, in the order of the machine."""
    lines, variances = list[ErrorLine](), np.diagonal(prior.covariance)
    for term in ErrorModel(prior.machine).terms:
        learned = prior.learned[term.name]
        stated, known = (
            float(np.sqrt(np.mean(each))) for each in (np.diagonal(term.covariance), variances[term.columns])
        )
        factor = float(np.sqrt(learned.scale))
        said = words(term.name) if len(term.axes) == 1 else f"what {term.name[-2]} and {term.name[-1]} do together"
        lines.append(ErrorLine(term.name, said, term.angular, stated, known, factor, learned.share, learned.share_std))
    return lines


def summary_sentences(prior: TypePrior) -> list[str]:
    """Return what was learnt, in sentences."""
    return [*_sources(prior), *_sizes(prior), *_common(prior), *_directions(prior), *_doubts(prior)]


def _sources(prior: TypePrior) -> Iterator[str]:
    counted = len(prior.counted)
    readings = sum(record.readings for record in prior.counted)
    said = f"Learnt from {counted} machine{'s' * (counted != 1)}, {readings} readings"
    left = [record for record in prior.records if record.left_out]
    yield said + (f"; {len(left)} record{'s' * (len(left) != 1)} left out." if left else ".")
    for record in left:
        yield f"Left out: {record.file}: {record.left_out}."


def _size(prior: TypePrior) -> float:
    """Return how many times as large as stated the machines are, the geometric mean over their errors."""
    return float(np.exp(0.5 * np.mean([np.log(each.scale) for each in prior.learned.values()])))


def _sizes(prior: TypePrior) -> Iterator[str]:
    size = _size(prior)
    if 1 / _RIGHT <= size <= _RIGHT:
        yield f"The stated sizes are about right: the machines show {size:.2g} times as much."
    elif size < 1:
        yield f"The stated sizes are too large: the machines show {size:.2g} times as much."
    else:
        yield (
            f"The stated sizes are too small: the machines show {size:.2g} times as much. What was measured with them "
            "promised too much; more readings are needed, and rightly."
        )


def _common(prior: TypePrior) -> Iterator[str]:
    shares = {name: each.share for name, each in prior.learned.items()}
    most = sorted((name for name, share in shares.items() if share >= _SHARED), key=lambda name: -shares[name])
    if most:
        named = ", ".join(f"{name} {shares[name]:.0%}" for name in most[:_NAMED])
        more = f" and {len(most) - _NAMED} more" if len(most) > _NAMED else ""
        yield f"All have in common, as a share of the variance: {named}{more}."
    else:
        yield "No error is mostly common to all."


def _directions(prior: TypePrior) -> Iterator[str]:
    """Say in which errors sisters differ together, by the correlations of their own parts."""
    for number, named in enumerate(directions_named(prior), start=1):
        yield f"Sisters differ together ({number}): {', '.join(named)}."


def directions_named(prior: TypePrior) -> list[list[str]]:
    """Return the errors that go together in each direction in which sisters differ by more than by chance."""
    if prior.directions == 0:
        return []
    scale = np.sqrt(np.maximum(np.diagonal(prior.own), np.finfo(float).tiny))
    terms = ErrorModel(prior.machine).terms
    correlation = prior.own / scale[:, None] / scale
    for term in terms:
        correlation[term.columns, term.columns] = np.eye(term.columns.stop - term.columns.start)
    values, vectors = np.linalg.eigh(correlation)
    found = []
    for value, vector in list(zip(values[::-1], vectors.T[::-1], strict=True))[: prior.directions]:
        loads = {term.name: float(np.linalg.norm(vector[term.columns])) for term in terms}
        loud = [name for name, load in loads.items() if load > _LOUD * max(loads.values())]
        if value - 1 > _DIRECTION and len(loud) > 1:
            found.append(sorted(loud, key=lambda name: -loads[name])[:_NAMED])
    return found


def _doubts(prior: TypePrior) -> Iterator[str]:
    counted, right = len(prior.counted), 1 / _RIGHT <= _size(prior) <= _RIGHT
    if counted < FEW and right:
        yield f"Fewer than {FEW} machines of a type whose stated sizes are right save nothing."
    elif right and np.mean([each.share for each in prior.learned.values()]) < _OWN:
        yield "They share next to nothing, and the stated sizes are right: this saves next to nothing."
    yield (
        f"That a machine is no sister is believed with {prior.doubt:.0%} before it is measured; "
        "the readings decide, and the band holds for strangers too."
    )
