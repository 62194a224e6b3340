"""The scales that a mixture averages over: as they were learnt, or common factors on those that are stated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.inference.averaging import Term
from axiscal.inference.contradiction import MODEL, MOST, OTHER_SCALES, common_factors
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import Fit, drawn
from axiscal.inference.scales import Scale, all_scales
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

_DRAWS = 32
"""Draws of learnt scales, those of the largest weight: departures are averaged over under each of them."""
_ROUGH, _ROUGHER = 0.25, np.log(3.0)
"""Share of a departure's weight where the errors are three times as large as stated."""
_NEVER = -np.inf


def evidence_of(
    observation: Observation, readings: Sequence[Reading], fit: Fit | None, prior: tuple[Array, Array] | None
) -> tuple[Evidence, list[Term]]:
    """Return the evidence of readings and the scales to average over, the model's own first.

    observation : with the scales as they were learnt; fit : None where none were
    """
    chosen = drawn(readings, MOST)
    if fit is not None:
        scales = tuple(
            Scale(scale.kind, scale.owner, scale.stated * factor)
            for scale, factor in zip(fit.scales.of, fit.scales.factors, strict=True)
        )
        return Evidence(observation, chosen, scales, prior), _learnt(fit)
    evidence = Evidence(observation, chosen, all_scales(observation.errors.machine, observation.setups), prior)
    return evidence, list(_stated(evidence))


def _learnt(fit: Fit) -> list[Term]:
    """Return the draws of a fit, about its most probable scales, and beside all of them those that are stated.

    Larger scales explain what a departure does as well, and where they were learnt no draw is left of those that were
    stated: a departure from these is then not compared, however much better it explains the readings.
    """
    best = np.log(np.array(fit.scales.factors))
    parts = sorted(fit.possible.parts(), key=lambda part: -part[1])[:_DRAWS]
    model = Term(np.zeros(len(best)), _NEVER, _NEVER)  # the mode gives the mean; the draws, the weights
    learnt = [Term(logs - best, float(np.log(w)), float(np.log(w))) for logs, w in parts]
    stated = fit.stated - fit.averaged
    return [model, *learnt, Term(-best, stated, stated)]


def _stated(evidence: Evidence) -> list[Term]:
    """Return common factors on noise, size and length, each by how probable it makes the readings."""
    spread = float(np.log(OTHER_SCALES / MODEL / len(common_factors(evidence))))
    found = []
    for logs in common_factors(evidence):
        likely, departed = evidence.log_likelihood(logs), _NEVER
        kinds = {scale.kind: float(each) for scale, each in zip(evidence.scales, logs, strict=True)}
        as_stated = kinds.get("noise", 0.0) == kinds.get("length", 0.0) == 0.0
        if as_stated and kinds.get("std", 0.0) in (0.0, _ROUGHER):
            departed = likely + float(np.log(_ROUGH if kinds.get("std", 0.0) else 1 - _ROUGH))
        own = not np.any(logs)
        found.append(Term(logs, likely + (float(np.logaddexp(0.0, spread)) if own else spread), departed))
    return sorted(found, key=lambda term: bool(np.any(term.logs)))
