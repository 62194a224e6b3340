"""The errors of a machine in units of their stated prior: a = T x with x ~ N(0, I)."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from axiscal.errors.model import ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.numerics import Array
from axiscal.numerics.gaussian import settled
from axiscal.ports.fleet.sisters.hierarchy import ErrorBlock, blocks_of

_CUT = 1e-4
"""Share of the variance of an error that the directions left out hold together: no reading would show it."""


_BANDS = (0.8, 0.98)
"""Shares of the variance that the coarse, and with it the less coarse, directions of an error hold."""


class PriorUnits(NamedTuple):
    """root : (size, n) T; cut : (size, size) covariance of what is left out

    blocks : of x, up to three for each error, from coarse to fine: sisters may be smoother than stated, or rougher
    """

    root: Array
    cut: Array
    blocks: tuple[ErrorBlock, ...]


def prior_units(errors: ErrorModel) -> PriorUnits:
    """Return the units of a model's stated prior, without directions in which no error goes."""
    roots, cut, sizes = list[Array](), np.zeros((errors.size, errors.size)), list[tuple[str, str, int, float]]()
    for term in errors.terms:
        values, vectors = np.linalg.eigh(term.covariance)
        values, vectors = np.maximum(values[::-1], 0.0), settled(values, vectors)[:, ::-1]
        kept = 1 + int(np.searchsorted(np.cumsum(values), (1 - _CUT) * values.sum()))
        column = np.zeros((errors.size, kept))
        column[term.columns] = vectors[:, :kept] * np.sqrt(values[:kept])
        roots.append(column)
        cut[term.columns, term.columns] = (vectors[:, kept:] * values[kept:]) @ vectors[:, kept:].T
        sizes += [(term.name, kind_in_common(term), *band) for band in _bands(values[:kept])]
    return PriorUnits(np.hstack(roots), cut, blocks_of(sizes))


def _bands(values: Array) -> list[tuple[int, float]]:
    """Return how many of the directions each band holds, and its share of the variance.  values : (k,) falling"""
    held = np.cumsum(values) / values.sum()
    ends = [0, *(1 + int(np.searchsorted(held, share)) for share in _BANDS), len(values)]
    pairs = [(start, min(stop, len(values))) for start, stop in pairwise(ends) if start < min(stop, len(values))]
    return [(stop - start, float(values[start:stop].sum() / values.sum())) for start, stop in pairs]


def kind_in_common(term: Term) -> str:
    """Return among which errors the share in common is alike: a plane, a location, a reversal, an angle, a length."""
    if isinstance(term, PlaneError):
        return "plane"
    if term.kind != "motion":
        return term.kind
    return "angle" if term.angular else "length"
