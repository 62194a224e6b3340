"""What explains readings best: the model, or one departure from it, compared by how probable each makes them.

    log p(y | h, s) = log N(y; 0, K) − ½ log|1 + s² M| + ½ uᵀ (s⁻² + M)⁻¹ u,    M = bᵀK⁻¹b,  u = bᵀK⁻¹y

the size of a departure normal with std s, s = 1, 2, 4 … 64 σ with falling weights, σ the noise. Under the model the
evidence ratio E = Σ π_h p(y | h)/p(y | model), Σ π_h = 1 over the departures, is a test martingale in the readings as
they come: it ever reaches 20 in at most 5 % of campaigns, however often one looks (Ville; Shafer, Shen, Vereshchagin
and Vovk 2011).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.inference.contrast import NO_CONTRAST, Contrast, contrast, explained_squares
from axiscal.inference.evidence import Evidence
from axiscal.inference.fit import drawn
from axiscal.inference.scales import Kind, all_scales
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.departures import Departure, Family, departures, every_departure
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_tail, solution
from axiscal.numerics.gaussian import lower_root
from axiscal.numerics.remembered import Itself, remembered_lately

PRIOR: Mapping[Family, float] = MappingProxyType(
    {
        "drift": 0.12,
        "levelling": 0.06,
        "excursion": 0.05,
        "growth": 0.05,
        "jump": 0.05,
        "step": 0.06,
        "pitch": 0.08,
        "bump": 0.05,
        "detail": 0.12,
        "reversal": 0.05,
        "bad": 0.06,
        "scale": 0.02,
        "together": 0.05,
    }
)
"""How probable each family is beside the model's 0.40 before any reading; shared evenly over its places."""
MODEL = 0.40
SIZES = 2.0 ** np.arange(7)
"""Standard deviations of a departure's size, in units of the noise."""
SIZE_WEIGHTS = np.array([0.26, 0.22, 0.18, 0.13, 0.10, 0.07, 0.04])
SURE = 20.0
"""Odds from which the model is taken to be contradicted: under it they are reached in one campaign of twenty."""
FITS = 1e-3
"""An explanation that makes readings so improbable explains nothing."""
OTHER_SCALES = 0.10
_FACTORS: Mapping[Kind, tuple[float, ...]] = MappingProxyType(
    {"noise": (1.0, 2.0, 5.0), "std": (1 / 3, 1.0, 3.0), "length": (0.4, 1.0, 2.5)}
)
MOST, _FEW = 300, 120
"""Readings that are compared: of time, for it grows with their cube."""
FEWEST = 3
"""Fewer readings contradict nothing."""
_MOST_LOG = 600.0
"""Below what overflows: more is certain."""


class Explanation(NamedTuple):
    """One family, owner by owner.

    odds : against the model; size, std : posterior mean and standard deviation of the size at its likeliest place
    setup : of growth the index of the set-up in the course of which it is likeliest
    """

    family: Family
    owner: str
    place: float
    odds: float
    size: float
    std: float
    setup: int | None = None


class Watched(NamedTuple):
    """explanations : the likeliest first; evalue : E after all readings; highest : the largest E after any of them."""

    explanations: tuple[Explanation, ...] = ()
    evalue: float = 1.0
    highest: float = 1.0


class _Weighed(NamedTuple):
    """What a test for the end needs beside what was watched: departures and readings, whitened.  slips : see below"""

    watched: Watched
    parts: Array
    y: Array
    slips: tuple[float, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Comparison:
    """explanations : the likeliest first; evalue : E after all readings; highest : the largest E after any of them

    scales : odds that the model's own scales are others; contrast : the test for the end
    fits : probability of a chi-square as large as the best explanation leaves, departures and other scales among them
    slips : odds that each reading is a bad one, in the order of the readings
    """

    explanations: tuple[Explanation, ...]
    evalue: float
    highest: float
    scales: float = 0.0
    contrast: Contrast = NO_CONTRAST
    fits: float = 1.0
    slips: tuple[float, ...] = ()

    @property
    def contradicted(self) -> bool:
        """Whether the readings contradict the model, at whatever time one looked, or by the test for the end."""
        return self.highest >= SURE or self.contrast.fires

    @property
    def caused(self) -> bool:
        """Whether a departure explains that better than other scales would."""
        return self.contradicted and self.explanations[0].odds > self.scales


def compared(
    observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None
) -> Comparison:
    """Return how much better than the model each departure explains readings.

    observation : before any cell is visited; prior : mean and covariance of the errors, where they are not as stated
    """
    chosen = drawn(readings, MOST)
    if len(chosen) < FEWEST:
        return Comparison((), 1.0, 1.0)
    (found, evalue, highest), parts, y, slips = _weighed(observation, tuple(chosen), Itself(prior))
    few = drawn(chosen, _FEW)
    others = Evidence(observation, few, all_scales(observation.errors.machine, observation.setups), prior)
    fits = _fit_of(parts, y)
    if fits < FITS:
        fits = max(fits, _fit_with_other_scales(others, list(departures(observation, few))))
    return Comparison(found, evalue, highest, _odds_of(others), contrast(parts, y), fits, slips)


def watched(observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None) -> Watched:
    """Return the e-value of the readings so far, and what explains them best.  Arguments as of `compared`"""
    chosen = drawn(readings, MOST)
    return Watched() if len(chosen) < FEWEST else _weighed(observation, tuple(chosen), Itself(prior)).watched


@remembered_lately
def _weighed(
    observation: Observation, chosen: tuple[Reading, ...], prior: Itself[tuple[Array, Array] | None]
) -> _Weighed:
    """Return what both are made of: a verdict and the test while measuring ask it of the same readings."""
    fitted = Fitted.of(observation, chosen, prior.part)
    lower = lower_root(fitted.covariance())
    possible = every_departure(observation, chosen)
    unit = float(np.sqrt(np.median(fitted.noise)))
    y, parts = solution(lower, fitted.values), whitened(lower, possible)
    ends = np.flatnonzero(np.diff(fitted.reading, append=-1) != 0)
    shares = _shares(possible)
    logs = _log_ratios(parts, y, unit, ends) + np.log(shares)
    highest = logs.max(axis=1)
    summed = highest + np.log(np.sum(np.exp(logs - highest[:, None]), axis=1) / np.sum(shares))
    along = np.exp(np.minimum(summed, _MOST_LOG))
    odds = np.exp(logs[-1] - max(float(highest[-1]) - _MOST_LOG, 0.0))  # beside each other right, however sure
    found = _explained(possible, parts, y, unit, odds)
    slips = tuple(float(each) for each, of in zip(odds, possible, strict=True) if of.family == "bad")
    return _Weighed(Watched(found, float(along[-1]), float(along.max())), parts, y, slips)


def _odds_of(others: Evidence) -> float:
    """Return the odds of other scales than stated: noise, size and length of all errors by common factors."""
    gained = averaged_likelihood(others) - others.log_likelihood(np.zeros(len(others.scales)))
    return OTHER_SCALES / MODEL * float(np.exp(min(gained, _MOST_LOG)))


def _fit_with_other_scales(others: Evidence, possible: Sequence[Departure]) -> float:
    """Return the probability of the chi-square at the likeliest of other scales, with the best departure or none."""
    best = max(common_factors(others), key=others.log_likelihood)
    lower = lower_root(others.covariance(best))
    return _fit_of(whitened(lower, possible), solution(lower, others.values))


def whitened(lower: Array, possible: Sequence[Departure]) -> Array:
    """Return L⁻¹ b of each departure, (m, h, 2).  lower : L (m, m)"""
    columns = np.stack([_two(each.columns) for each in possible], axis=1)
    white, second = np.zeros_like(columns), columns[:, :, 1].any(axis=0)
    white[:, :, 0] = solution(lower, columns[:, :, 0])
    if second.any():
        white[:, second, 1] = solution(lower, columns[:, second, 1])
    return white


def common_factors(evidence: Evidence) -> list[Array]:
    """Return the logarithms of the scales at common factors on noise, size and length, (27, n)."""
    every = [dict(zip(_FACTORS, factors, strict=True)) for factors in product(*_FACTORS.values())]
    return [np.array([np.log(factors.get(scale.kind, 1.0)) for scale in evidence.scales]) for factors in every]


def averaged_likelihood(evidence: Evidence) -> float:
    """Return log p(y), averaged over common factors on noise, size and length."""
    found = np.array([evidence.log_likelihood(each) for each in common_factors(evidence)])
    return float(found.max() + np.log(np.mean(np.exp(found - found.max()))))


def _fit_of(parts: Array, y: Array) -> float:
    """Return the probability of a chi-square as large as what the best departure, or none, leaves of |y|²."""
    whole = float(y @ y)
    left = whole - float(explained_squares(parts, y).max(initial=0.0))
    return max(chi_square_tail(len(y), whole), chi_square_tail(max(len(y) - parts.shape[2], 1), left))


def _two(columns: Array) -> Array:
    """Return one or two columns as two, the second one empty, (m, 2)."""
    return columns if columns.shape[1] > 1 else np.hstack([columns, np.zeros_like(columns)])


def _shares(possible: Sequence[Departure]) -> Array:
    """Return the prior probability of each departure over that of the model."""
    counts = {family: sum(each.family == family for each in possible) for family in PRIOR}
    return np.array([PRIOR[each.family] / counts[each.family] / MODEL for each in possible])


def _log_ratios(parts: Array, y: Array, unit: float, ends: NDArray[np.intp]) -> Array:
    """Return log p(y | h)/p(y | model) of each departure after each reading, averaged over sizes, (n, h).

    parts : (m, h, 2) whitened b; y : (m,) whitened; M and u are sums over the readings so far
    """
    two = parts[:, :, 1].any(axis=0)
    ratio = np.empty((len(ends), parts.shape[1]))
    ratio[:, ~two] = _of_one(parts[:, ~two, 0], y, unit, ends)
    ratio[:, two] = _of_two(parts[:, two, 0], parts[:, two, 1], y, unit, ends)
    return ratio


def _of_one(part: Array, y: Array, unit: float, ends: NDArray[np.intp]) -> Array:
    """Return the same of departures with one column, (n, h).  part : (m, h)"""
    own, pull = (np.cumsum(product, axis=0)[ends] for product in (part * part, part * y[:, None]))
    ratio = np.full_like(own, -np.inf)
    for size, weight in zip(unit * SIZES, SIZE_WEIGHTS, strict=True):
        determinant = 1 + size**2 * own
        gained = size**2 * pull**2 / determinant
        ratio = np.logaddexp(ratio, np.log(weight) + 0.5 * (gained - np.log(determinant)))
    return ratio


def _of_two(one: Array, other: Array, y: Array, unit: float, ends: NDArray[np.intp]) -> Array:
    """Return the same of departures with two, (n, h).  one, other : (m, h)"""
    own, across, others = (np.cumsum(product, axis=0)[ends] for product in (one * one, one * other, other * other))
    pull, second = (np.cumsum(part * y[:, None], axis=0)[ends] for part in (one, other))
    ratio = np.full_like(own, -np.inf)
    for size, weight in zip(unit * SIZES, SIZE_WEIGHTS, strict=True):
        a, b, c = 1 + size**2 * own, 1 + size**2 * others, size**2 * across
        determinant = a * b - c * c
        gained = size**2 * (b * pull**2 - 2 * c * pull * second + a * second**2) / determinant
        ratio = np.logaddexp(ratio, np.log(weight) + 0.5 * (gained - np.log(determinant)))
    return ratio


def _explained(
    possible: Sequence[Departure], parts: Array, y: Array, unit: float, odds: Array
) -> tuple[Explanation, ...]:
    """Return the families with what they hold, over all places of one owner."""
    groups: dict[tuple[Family, str], list[int]] = {}
    for index, each in enumerate(possible):
        groups.setdefault((each.family, each.owner), []).append(index)
    found = []
    for (family, owner), members in groups.items():
        best = max(members, key=lambda index: odds[index])
        size, std = _size(parts[:, best], y, unit)
        whole, likeliest = float(odds[members].sum()), possible[best]
        found.append(Explanation(family, owner, likeliest.place, whole, size, std, likeliest.setup))
    return tuple(sorted(found, key=lambda each: -each.odds))


def _size(part: Array, y: Array, unit: float) -> tuple[float, float]:
    """Return posterior mean and std of the size at the widest prior; of two columns the amplitude.  part : (m, 2)"""
    used = part[:, np.any(part != 0, axis=0)]
    inverse = np.linalg.inv(used.T @ used + np.eye(used.shape[1]) / (unit * SIZES[-1]) ** 2)
    mean = inverse @ (used.T @ y)
    size = float(mean[0]) if len(mean) == 1 else float(np.linalg.norm(mean))
    return size, float(np.sqrt(np.trace(inverse) / max(len(mean), 1)))
