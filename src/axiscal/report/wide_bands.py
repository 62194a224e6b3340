"""Bands that came out wider than what was stated beforehand, each with the reason."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.accuracy.expanded import BAND
from axiscal.error_model.iso230 import words
from axiscal.error_model.model import ErrorFunction
from axiscal.estimation.estimation import Estimation
from axiscal.inference.fit import Fit
from axiscal.inference.mixture import POOR
from axiscal.language.spoken import said
from axiscal.report.curves import value_unit
from axiscal.report.summary import Finding
from axiscal.units import said_quantity

_WIDER, _MOSTLY, _LARGER = 1.05, 0.5, 1.2
"""Factors from which a band, a share of it and a scale are worth a sentence."""


def wide_bands(estimation: Estimation) -> Iterator[Finding]:
    """Yield a sentence for each curve whose band is wider than stated, and where bands rest on too few good draws."""
    if estimation.fit is None:
        return
    raised = 1.0 if estimation.ruling is None else estimation.ruling.raised
    for stated, function in zip(
        estimation.stated.errors.functions, estimation.banded.case.errors.functions, strict=True
    ):
        before = float(np.sqrt(stated.covariance[0, 0] + stated.rest**2))
        after = _rms(estimation, function)
        if function.kind == "motion" and after > _WIDER * raised * before:
            now, was = (said_quantity(BAND * each, value_unit(function), 2) for each in (after, before))
            text = said(
                "The band of {name} ({words}) is ±{now}, wider than the ±{was} that were stated: {reason}.",
                name=function.name,
                words=words(function.name),
                now=now,
                was=was,
                reason=_reason(estimation.fit, stated, function, after),
            )
            yield Finding("prior-misfit", function.name, text)
    if estimation.fit.widening.size < POOR:
        text = (
            "The bands average over scales by draws of which {size:.1f} count: they are rough. State more of the "
            "priors, or take more readings."
        )
        yield Finding("prior-misfit", None, said(text, size=float(estimation.fit.widening.size)))


def _rms(estimation: Estimation, function: ErrorFunction) -> float:
    """Return the RMS standard deviation of a curve over its travel, rest included, m or rad."""
    factor = estimation.banded.knowledge.belief.factor[function.columns]
    gram = function.basis.gram() / float(np.ptp(function.basis.knots))
    return float(np.sqrt(np.sum(gram * (factor @ factor.T)) + function.rest**2))


def _reason(fit: Fit, stated: ErrorFunction, function: ErrorFunction, after: float) -> str:
    unit = value_unit(function)
    if function.rest**2 > _MOSTLY * after**2:
        room = "the readings leave room for {size} of detail between them that no spline follows"
        return said(room, size=said_quantity(function.rest, unit, 2))
    std = fit.scales.value("std", function.name)
    if std is not None and std**2 > _LARGER**2 * stated.covariance[0, 0]:
        return said("the readings look like a std of {size}", size=said_quantity(std, unit, 2))
    return said("so few readings leave open how large and how smooth it is")
