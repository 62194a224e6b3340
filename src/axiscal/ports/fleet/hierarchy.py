"""How machines of one type are taken to differ, before any of them has been read.

In units of the stated prior (C₀f = F_f F_fᵀ for each error f) machine j is a_j = F (μ + d_j):

    μ_f ~ N(0, c_f ω_f I)                          common to all
    d_j ~ N(0, D^½ (I + B Bᵀ) D^½)                 its own, D = diag(c_f (1 − ω_f))

    log c_f ~ N(log c, 0.5²), log c ~ N(0, 0.9²)   how wrong the stated variance is
    ω_f ~ Beta(4 m, 4 (1 − m)), m ~ U(0, 1)        the share in common; one m for each kind of error
    B_ir ~ N(0, τ²), τ² ~ InvGamma(2, 0.1)         B (n, r), directions in which sisters differ, over all errors at once

The units are a = T x with x ~ N(0, I), without directions in which no error goes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.model import ErrorModel
from axiscal.errors.term import Term
from axiscal.numerics import Array
from axiscal_core.eigen import settled

SPREAD, LEVEL = 0.5, 0.9
"""Standard deviations of log c_f about log c, and of log c about 0: a stated std is right within a factor of 2.5."""
CERTAINTY = 4.0
"""Sisters' worth of what is believed of the share in common; with 1 or 10 it would be looser, or firmer."""
SHAPE, SCALE = 2.0, 0.1
"""Of the inverse gamma of τ²: directions matter little unless sisters show them."""
MEANS = np.linspace(0.02, 0.98, 49)
"""The values that m may take: as fine as it matters."""


@dataclass(frozen=True, slots=True)
class ErrorBlock:
    """An error, or as much of it as is of one coarseness: its name and kind, and where its unknowns stand.

    weight : share of the stated variance of the error that it holds
    """

    name: str
    kind: str
    columns: slice
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class Hierarchy:
    """parts : of all unknowns, one after another; directions : r in which sisters may differ together"""

    parts: tuple[ErrorBlock, ...]
    directions: int

    @property
    def unknowns(self) -> int:
        """Number of unknowns of one machine."""
        return int(self.parts[-1].columns.stop)

    @cached_property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of errors that there are."""
        return tuple(dict.fromkeys(part.kind for part in self.parts))

    @cached_property
    def sizes(self) -> Array:
        """Number of unknowns of each error, (f,)."""
        return np.array([part.columns.stop - part.columns.start for part in self.parts], dtype=float)

    @cached_property
    def owner(self) -> NDArray[np.intp]:
        """Index of the error of each unknown, (n,)."""
        return np.repeat(np.arange(len(self.parts)), self.sizes.astype(np.intp))

    @cached_property
    def kind_of(self) -> NDArray[np.intp]:
        """Index of the kind of each error, (f,)."""
        return np.array([self.kinds.index(part.kind) for part in self.parts], dtype=np.intp)

    @cached_property
    def constants(self) -> Array:
        """log B(4 m, 4 (1 − m)) of every value of m, (k,)."""
        each = [
            math.lgamma(CERTAINTY * m) + math.lgamma(CERTAINTY * (1 - m)) - math.lgamma(CERTAINTY)
            for m in MEANS.tolist()
        ]
        return np.array(each)

    def summed(self, values: Array) -> Array:
        """Return the sum over the unknowns of each error, (f,).  values : (n,)"""
        starts = [part.columns.start for part in self.parts]
        return np.add.reduceat(values, starts)


@dataclass(frozen=True, eq=False, slots=True)
class Sisters:
    """One state of everything that is not known of N sisters.

    scales : (f,) c; shares : (f,) ω; level : log c; means : (k,) m of each kind; common : (n,) μ; own : (s, n) d
    together : (n, r) B; along : (s, r) how far each sister lies along the directions; width : τ²
    """

    scales: Array
    shares: Array
    level: float
    means: Array
    common: Array
    own: Array
    together: Array
    along: Array
    width: float


def usual(hierarchy: Hierarchy, count: int, rng: np.random.Generator) -> Sisters:
    """Return where the sampler begins: scales as stated, half of it common, hardly any direction."""
    errors, size, directions = len(hierarchy.parts), hierarchy.unknowns, hierarchy.directions
    return Sisters(
        np.ones(errors),
        np.full(errors, 0.5),
        0.0,
        np.full(len(hierarchy.kinds), 0.5),
        np.zeros(size),
        np.zeros((count, size)),
        0.1 * rng.standard_normal((size, directions)),
        np.zeros((count, directions)),
        SCALE,
    )


def blocks_of(named: Sequence[tuple[str, str, int, float]]) -> tuple[ErrorBlock, ...]:
    """Return the blocks of errors one after another.  named : name, kind, number of unknowns and weight of each"""
    parts, start = list[ErrorBlock](), 0
    for name, kind, size, weight in named:
        parts.append(ErrorBlock(name, kind, slice(start, start + size), weight))
        start += size
    return tuple(parts)


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
    if len(term.axes) > 1:
        return "plane"
    if term.kind != "motion":
        return term.kind
    return "angle" if term.angular else "length"
