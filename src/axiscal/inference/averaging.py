"""One mixture over the scales and over all departures: how far it moves a mean, and how much wider a band is for it.

Under scales θ, departure h and its size s ~ N(0, s_j²), with M = bᵀK⁻¹b, u = bᵀK⁻¹y and e = a − S K⁻¹b, S = P Gᵀ,

    size: mean Σu, covariance Σ = (s_j⁻² + M)⁻¹;   A: mean m_θ + e Σu, covariance C_θ + e Σ eᵀ
    weight w ∝ π_θ π_h π_j p(y|θ) |1 + s_j² M|^−½ exp ½uᵀΣu;   mean Σ w m, covariance Σ w (C + (m − mean)(…)ᵀ)

(law of total variance), a what the splines follow of the shape φ of h. What they do not follow is a rest of its error.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.inference.contradiction import MODEL, PRIOR, SIZE_WEIGHTS, SIZES, whitened
from axiscal.inference.evidence import Evidence
from axiscal.measurement.departures import Departure, Family, Followed, followed
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import solution
from axiscal.numerics.gaussian import positive_root

_KEPT = 64
"""Departures that are averaged over, the likeliest: together they hold all but a thousandth of the weight."""
_OF_TIME: frozenset[Family] = frozenset({"drift", "levelling", "excursion", "growth", "jump"})
_LARGEST, _TIMES, _RARELY = 20e-6, 3.0, 1e-3
"""Sizes beyond three times the std of the error, or beyond three times 20 um, count a thousandth: of an hour of drift,
of what levels off or comes and goes in a set-up, of a growth over the travel, of a jump. They are believed where
readings show them, and make no band wide where none could.
"""
_NOTHING = 5e-4
"""Weight of a term that counts for nothing."""
_SURELY_NOT = 1e-12
"""Below what any odds are asked for."""


class Term(NamedTuple):
    """Scales that may be.  logs : (n,) of their factors; model, departed : log weight without and with departures."""

    logs: Array
    model: float
    departed: float


@dataclass(frozen=True, eq=False, slots=True)
class Average:
    """moved : (k,) from the model's mean of errors and set-ups' unknowns to the mixture's

    about_model, about_mixture : factors (k, r) E of what is added to the model's covariance where the mean is the
    model's, or the mixture's; rests : variances that are added to the rests of errors, by name, m² or rad²
    model : the weight that the model holds, other scales among it; size : of how many terms it is worth (1/Σw²)
    """

    moved: Array
    about_model: Array
    about_mixture: Array
    rests: Mapping[str, float]
    model: float
    size: float

    @property
    def evalue(self) -> float:
        """The evidence of departures against the model, other scales among it, at all scales that are averaged over."""
        return MODEL / sum(PRIOR.values()) * (1.0 - self.model) / max(self.model, _SURELY_NOT)


class _Sizes(NamedTuple):
    """logs : (h,) log of p(y|h)/p(y|model), averaged over sizes; first : (h, 2) E[s]; second : (h, 2, 2) E[s sᵀ]."""

    logs: Array
    first: Array
    second: Array


class _UnderScales(NamedTuple):
    """How readings see departures under one set of scales.

    lower : (m, m) L; white : (m, h, 2) L⁻¹ b; values : (m,) L⁻¹ y; sizes : how large the departures are
    """

    lower: Array
    white: Array
    values: Array
    sizes: _Sizes


class _Told(NamedTuple):
    """What one set of scales says: mean, covariance, what departures add, (k, h, 2), and how large they are."""

    mean: Array
    covariance: Array
    beside: Array
    sizes: _Sizes


def average(evidence: Evidence, possible: Sequence[Departure], terms: Sequence[Term]) -> Average:
    """Return the mixture.  terms : the first one is the model, with its mean and covariance"""
    unit = float(np.sqrt(np.median(evidence.noise)))
    shares = np.log(np.array([PRIOR[each.family] / MODEL for each in possible])) - np.log(_counts(possible))
    first = _sizes(*_pulls(evidence, possible, terms[0].logs)[1:], unit, prior_sizes(evidence, possible, unit))
    kept = np.sort(np.argsort(first.logs + shares)[-_KEPT:])
    chosen, shares = [possible[int(i)] for i in kept], shares[kept]
    fields = [followed(each, evidence.functions, evidence.axes) for each in chosen]
    spread = _spread(fields, evidence.rows.shape[1])
    priors = prior_sizes(evidence, chosen, unit)
    seen = [_under_scales(evidence, chosen, each.logs, unit, priors) for each in terms]
    weights = _weights(terms, seen, shares)
    base = _told(evidence, spread, terms[0].logs, seen[0])
    parts = [
        (base if index == 0 else _told(evidence, spread, terms[index].logs, seen[index]), weights[index])
        for index in np.flatnonzero(weights.any(axis=1)).tolist()
    ]
    owners = ["" if each.function is None else evidence.functions[each.function].name for each in chosen]
    left = [(owner, field.left) for owner, field in zip(owners, fields, strict=True)]
    return _gathered(base, parts, left)


def prior_sizes(evidence: Evidence, possible: Sequence[Departure], unit: float) -> Array:
    """Return how probable each size of each departure is before any reading, (sizes, h).  unit : σ, m or rad"""
    stds = [np.inf if e.function is None else evidence.functions[e.function].covariance[0, 0] ** 0.5 for e in possible]
    drifting = [_LARGEST if each.family in _OF_TIME else np.inf for each in possible]
    most = _TIMES * np.minimum(stds, drifting)
    weights = np.array(SIZE_WEIGHTS)[:, None] * np.where(unit * SIZES[:, None] <= most, 1.0, _RARELY)
    shares: Array = weights / weights.sum(axis=0)
    return shares


def _counts(possible: Sequence[Departure]) -> Array:
    families = [each.family for each in possible]
    numbers = {family: families.count(family) for family in set(families)}
    return np.array([float(numbers[family]) for family in families])


def _weights(terms: Sequence[Term], parts: Sequence[_UnderScales], shares: Array) -> Array:
    """Return the weight of each set of scales without and with each departure, (l, 1 + h), sum 1."""
    logs = np.array(
        [
            np.concatenate([[term.model], term.departed + shares + part.sizes.logs])
            for term, part in zip(terms, parts, strict=True)
        ]
    )
    weights = np.exp(logs - logs.max())
    weights /= weights.sum()
    weights[weights < _NOTHING / 10] = 0.0
    whole: Array = weights / weights.sum()
    return whole


def _gathered(base: _Told, parts: Sequence[tuple[_Told, Array]], left: Sequence[tuple[str, Array | None]]) -> Average:
    """Return the moments of the mixture.

    base : the model; parts : what counts with its weights without and with each departure
    left : for each departure its error, and what no spline follows of it
    """
    moved, whole = np.zeros_like(base.mean), np.zeros_like(base.covariance)
    for part, (alone, *rest) in parts:
        each = np.array(rest)
        away, total = part.mean - base.mean, alone + each.sum()
        pulled = np.einsum("khr,hr,h->k", part.beside, part.sizes.first, each)
        second = np.einsum("khr,hrs,h,nhs->kn", part.beside, part.sizes.second, each, part.beside, optimize=True)
        moved += total * away + pulled
        crossed = np.outer(away, pulled)
        whole += total * (part.covariance + np.outer(away, away)) + second + crossed + crossed.T
    added, variances = whole - base.covariance, np.diag(whole)
    about = positive_root(added, variances), positive_root(added - np.outer(moved, moved), variances)
    model = float(sum(weights[0] for _, weights in parts))
    return Average(moved, *about, _rests(parts, left), model, float(1.0 / sum(np.sum(w**2) for _, w in parts)))


def _rests(parts: Sequence[tuple[_Told, Array]], left: Sequence[tuple[str, Array | None]]) -> Mapping[str, float]:
    """Return what no spline follows of the departures, as variances that are added to the rests of their errors."""
    found: dict[str, float] = {}
    for index, (owner, products) in enumerate(left):
        if products is not None:
            mine = slice(0, len(products))
            squares = (w[1 + index] * np.sum(part.sizes.second[index, mine, mine] * products) for part, w in parts)
            found[owner] = found.get(owner, 0.0) + float(sum(squares))
    return found


def _pulls(evidence: Evidence, possible: Sequence[Departure], logs: Array) -> tuple[Array, Array, Array]:
    """Return the lower root (m, m) of some scales, and columns (m, h, 2) and values (m,) that it has whitened."""
    lower = evidence.root(logs)
    return lower, whitened(lower, possible), solution(lower, evidence.values)


def _under_scales(
    evidence: Evidence, possible: Sequence[Departure], logs: Array, unit: float, priors: Array
) -> _UnderScales:
    """Return how readings see departures under one set of scales.  priors : (sizes, h)"""
    lower, white, values = _pulls(evidence, possible, logs)
    return _UnderScales(lower, white, values, _sizes(white, values, unit, priors))


def _told(evidence: Evidence, spread: Array, logs: Array, seen: _UnderScales) -> _Told:
    """Return what one set of scales says, the costliest part: of scales that count.  spread : (k, h, 2) a"""
    prior = evidence.prior(logs)
    half = solution(seen.lower, evidence.rows @ prior)
    beside = spread - np.einsum("mk,mhr->khr", half, seen.white, optimize=True)
    return _Told(half.T @ seen.values, prior - half.T @ half, beside, seen.sizes)


def _sizes(white: Array, y: Array, unit: float, priors: Array) -> _Sizes:
    """Return how probable each departure makes the readings, and its size.

    white : (m, h, 2); unit : σ, m or rad; priors : (sizes, h)
    """
    information = np.einsum("mhr,mhs->hrs", white, white, optimize=True)
    pull = np.einsum("mhr,m->hr", white, y)
    logs, firsts, seconds = [], [], []
    for size, weight in zip(unit * SIZES, priors, strict=True):
        precision = information + np.eye(2) / size**2
        covariance = np.linalg.inv(precision)
        mean = np.einsum("hrs,hs->hr", covariance, pull)
        determinant = np.linalg.det(precision) * size**4
        logs.append(np.log(weight) - 0.5 * np.log(determinant) + 0.5 * np.sum(pull * mean, axis=1))
        firsts.append(mean)
        seconds.append(covariance + mean[:, :, None] * mean[:, None, :])
    of_each = np.array(logs)
    highest = of_each.max(axis=0)
    shares = np.exp(of_each - highest)
    whole = shares.sum(axis=0)
    shares = shares / whole
    first = np.einsum("jh,jhr->hr", shares, np.array(firsts))
    return _Sizes(highest + np.log(whole), first, np.einsum("jh,jhrs->hrs", shares, np.array(seconds)))


def _spread(fields: Sequence[Followed], size: int) -> Array:
    """Return what the splines follow of each departure over all errors and unknowns, (k, h, 2)."""
    result = np.zeros((size, len(fields), 2))
    for index, field in enumerate(fields):
        if field.columns is not None and field.coefficients is not None:
            result[field.columns, index, : field.coefficients.shape[1]] = field.coefficients
    return result
