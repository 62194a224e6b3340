"""A learnt type in words: the errors that machines share, their sizes, and when that saves nothing."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.description.type_text import TypePrior
from axiscal.errors.model import ErrorModel
from axiscal.language.spoken import counted, joined, listed, put, said
from axiscal.ports.fleet.type_learning import FEW

_RIGHT = 1.25
"""A size within a quarter is as stated."""
_SHARED, _OWN = 0.5, 0.25
"""Shares from which a thing is mostly common, and below which it hardly is; a matter of taste."""
_LOUD, _NAMED = 0.5, 4
"""Part of the largest load from which an error is named with a direction, and how many are; a matter of taste."""
_DIRECTION = 0.5
"""Variance along a direction, of which all else has 1, from which it is worth a sentence."""


def summary_sentences(prior: TypePrior) -> list[str]:
    """Return what was learnt, in sentences."""
    return [*_sources(prior), *_sizes(prior), *_common(prior), *_directions(prior), *_doubts(prior)]


def _sources(prior: TypePrior) -> Iterator[str]:
    readings, left = sum(record.readings for record in prior.counted), len(prior.records) - len(prior.counted)
    one, many = "Learnt from {count} machine, {readings} readings", "Learnt from {count} machines, {readings} readings"
    out = [counted("{count} record left out", "{count} records left out", left)] if left else []
    yield put("{learnt}.", learnt=listed("; ", [counted(one, many, len(prior.counted), readings=readings), *out]))
    for record in (each for each in prior.records if each.left_out):
        yield said("Left out: {file}: {why}.", file=record.file, why=record.left_out)


def _size(prior: TypePrior) -> float:
    """Return how many times as large as stated the machines are, the geometric mean over their errors."""
    return float(np.exp(0.5 * np.mean([np.log(each.scale) for each in prior.learned.values()])))


def _sizes(prior: TypePrior) -> Iterator[str]:
    size = _size(prior)
    what = "The stated sizes are about right: the machines show {size:.2g} times as much."
    if size < 1 / _RIGHT:
        what = "The stated sizes are too large: the machines show {size:.2g} times as much."
    elif size > _RIGHT:
        what = (
            "The stated sizes are too small: the machines show {size:.2g} times as much. What was measured with them "
            "promised too much; more readings are needed, and rightly."
        )
    yield said(what, size=size)


def _common(prior: TypePrior) -> Iterator[str]:
    shares = {name: each.share for name, each in prior.learned.items()}
    most = sorted((name for name, share in shares.items() if share >= _SHARED), key=lambda name: -shares[name])
    named = joined([put("{name} {share:.0%}", name=name, share=shares[name]) for name in most], _NAMED)
    what = "All have in common, as a share of the variance: {named}." if most else "No error is mostly common to all."
    yield said(what, named=named)


def _directions(prior: TypePrior) -> Iterator[str]:
    """Say in which errors sisters differ together, by the correlations of their own parts."""
    for number, named in enumerate(directions_named(prior), start=1):
        yield said("Sisters differ together ({number}): {named}.", number=number, named=", ".join(named))


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
    right = 1 / _RIGHT <= _size(prior) <= _RIGHT
    if len(prior.counted) < FEW and right:
        yield said("Fewer than {few} machines of a type whose stated sizes are right save nothing.", few=FEW)
    elif right and np.mean([each.share for each in prior.learned.values()]) < _OWN:
        yield said("They share next to nothing, and the stated sizes are right: this saves next to nothing.")
    yield said(
        "That a machine is no sister is believed with {doubt:.0%} before it is measured; the readings decide, and the "
        "band holds for strangers too.",
        doubt=prior.doubt,
    )
