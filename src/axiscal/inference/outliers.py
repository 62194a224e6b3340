"""Readings that the others do not believe: every noise is Student-t, and what stands out altogether is not used.

The noise of a reading is normal with a variance that is itself uncertain, as Student's t of ν = `FREEDOM` degrees, so
that a bad reading cannot bend a curve. Expectation-maximisation (Dempster, Laird and Rubin 1980) gives it the weight

    w = min(1, (ν + k) / (ν + Σ (e² + v) / σ²))

over its k numbers, e what the estimate leaves of them and v the variance of the estimate there. A weight is one at the
most: a reading that happens to fit does not count for more than its noise says. Without reading i the others predict it
with r = e/(1 − h) and variance v/(1 − h) + σ², h = v w/σ²; one that is more than `STANDS_OUT` of that away is not used
at all. Readings are taken out one after the other, so that a bad one does not cast doubt on its neighbours, and as bad
ones may cover each other, the few worst are each tried as the next. By the chain rule the squares of what is taken out
add up to what the readings that stay gain in likelihood; what all explanations refuse that come near the best one is
refused, so where two readings contradict each other and nobody can say which is wrong, both stay. Readings that would
be refused and agree with their neighbour are a fact about the curve: they stay, at full weight.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from axiscal.inference.neighbours import Neighbours
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array

FREEDOM = 4.0
SURPRISING = 3.5
STANDS_OUT = 4.0
"""So many standard deviations, of what the others predict, are taken for a mistake and not for chance."""
NOTHING = 1e-9
"""Weight of a reading that does not count: small enough to be none, large enough to divide by."""
FEWEST = 5
_MOST_PART = 0.2
_ALIKE = 0.9
_WORST, _BRANCHES, _AHEAD = 3, 6, 5
"""So many readings are tried as the next, so many explanations followed, by so many readings that explain no more."""
_CERTAIN = 9.0
"""By so much more an explanation has to explain than another, in squared standard deviations: odds of ninety to one."""
_WIDENED = 1.25
"""By so much a reading may widen the measure that it is held against."""
_ROUNDS, _SETTLED = 100, 1e-4
"""Rounds end where the weights settle to less than a reading could show."""


class Doubt(NamedTuple):
    """A reading that stands out: its index from 0, standard deviations from what the others predict, and its weight.

    implausible : no error of about the stated size could make it; the standard deviations are then those of the prior
    """

    reading: int
    surprise: float
    weight: float
    implausible: bool = False

    @property
    def rejected(self) -> bool:
        """Whether the reading is not used at all."""
        return self.weight <= NOTHING


class Verdict(NamedTuple):
    """doubts : the readings that stand out, those that are not used first; weights : of all readings, up to 1."""

    doubts: tuple[Doubt, ...]
    weights: tuple[float, ...]

    @property
    def fates(self) -> frozenset[tuple[int, bool]]:
        """Which readings stand out, and whether they are not used."""
        return frozenset((doubt.reading, doubt.rejected) for doubt in self.doubts)


def verdict(observation: Observation, readings: Sequence[Reading], prior: tuple[Array, Array] | None = None) -> Verdict:
    """Return how much each reading counts; readings that somebody vouches for are believed.

    prior : mean and covariance of the errors, where it is not the stated one
    """
    if len(readings) < FEWEST:
        return Verdict((), tuple(1.0 for _ in readings))
    return _OutlierSearch(
        Fitted.of(observation, readings, prior), readings, Neighbours(observation, readings)
    ).verdict()


class _Explanation(NamedTuple):
    """refused : readings and how far each stood out, in σ, as they were taken out
    usual : how far readings then usually are from what the others predict, in σ
    squares : what the readings that stay gain in likelihood, times two
    """

    refused: Mapping[int, float]
    usual: float
    squares: float = 0.0

    def explains(self, usual: float) -> float:
        """Return the same where readings scatter so many σ, less what refusals cost."""
        return self.squares / usual**2 - STANDS_OUT**2 * len(self.refused)


_End = tuple[_Explanation, Fitted]
"""An explanation, and the estimate without what it refuses."""


class _OutlierSearch:
    """fitted : the readings and the estimate by them; free : readings that nobody vouches for."""

    def __init__(self, fitted: Fitted, readings: Sequence[Reading], neighbours: Neighbours) -> None:
        self._neighbours = neighbours
        self._fitted, self._counts = fitted, np.bincount(fitted.reading)
        self._free = np.array([not reading.accepted for reading in readings])
        self._weights = np.ones(len(readings))
        self._refused: dict[int, float] = {}

    def verdict(self) -> Verdict:
        self._fitted.weigh(self._weights)
        self._refuse()
        usual = max(1.0, _usual(self._fitted) / _WIDENED)  # of a few readings it is not well known itself
        self._settle(usual)
        return Verdict(tuple(self._doubts(usual)), tuple(self._weights.tolist()))

    def _refuse(self) -> None:
        """Take out what all explanations refuse that come near the best one."""
        found = self._explanations()
        usual = min(each.usual for each in found)
        best = max(found, key=lambda each: each.explains(usual))
        enough = best.explains(usual) - _CERTAIN
        near = [
            each for each in found if each.explains(usual) > enough and not each.refused.keys() <= best.refused.keys()
        ]
        refused = set(best.refused).intersection(*(each.refused for each in near))
        fitted = self._fitted
        for reading in best.refused:
            fitted = fitted.without(reading)
        facts = self._neighbours.agreeing({index: self._side(fitted, index) for index in best.refused})
        self._free[list(facts)] = False
        for reading in refused - facts:
            self._refused[reading], self._weights[reading] = best.refused[reading] / usual, NOTHING
            self._fitted = self._fitted.without(reading)

    @staticmethod
    def _side(fitted: Fitted, reading: int) -> float:
        """Return how far a reading that was taken out is from what the others predict, signed, its largest number."""
        left = fitted.left[fitted.reading == reading]
        return float(left[np.argmax(np.abs(left))])

    def _explanations(self) -> list[_Explanation]:
        """Return what may be wrong: nothing, or readings taken out as long as that explains more.

        Only the explanations at the ends hold their estimates: all of them would be as large as the readings squared.
        """
        usual = _usual(self._fitted)
        ends = [(_Explanation({}, usual), self._fitted)]
        found, idle = [ends[0][0]], 0
        while ends and idle < _AHEAD and len(ends[0][0].refused) + 1 <= _MOST_PART * len(self._weights):
            ends = sorted(self._longer(ends, usual), key=lambda end: -end[0].squares)[:_BRANCHES]
            added = [each for each, _ in ends]
            found += added
            least = min(each.usual for each in found)
            best = max(found, key=lambda each: each.explains(least))
            idle = 0 if any(each is best for each in added) else idle + 1
        return found

    def _longer(self, ends: Sequence[_End], usual: float) -> Iterator[_End]:
        """Yield the explanations that refuse one more of the readings that stand out the most, each once."""
        further = dict[frozenset[int], tuple[Fitted, dict[int, float], float]]()
        for explanation, fitted in ends:
            sizes = self._surprises(fitted, explanation.refused)
            for reading in np.argsort(-sizes)[:_WORST].tolist():
                if sizes[reading] > STANDS_OUT:
                    refused = {**explanation.refused, reading: float(sizes[reading])}
                    further[frozenset(refused)] = fitted, refused, explanation.squares + refused[reading] ** 2
        for fitted, refused, squares in further.values():
            without = fitted.without(next(reversed(refused)))
            yield _Explanation(refused, min(usual, _WIDENED * _usual(without)), squares), without

    def _settle(self, usual: float) -> None:
        """Bring weights and estimate into agreement.  usual : so many σ the readings scatter, whatever the reason."""
        fitted = self._fitted
        for _ in range(_ROUNDS):
            squares = (fitted.left**2 + fitted.spread) / (usual**2 * fitted.noise)
            total = np.bincount(fitted.reading, weights=squares)
            weights = np.minimum((FREEDOM + self._counts) / (FREEDOM + total), 1.0)
            weights[~self._free], weights[list(self._refused)] = 1.0, NOTHING
            change, self._weights = float(np.max(np.abs(weights - self._weights))), weights
            if change < _SETTLED:
                return
            fitted.weigh(weights)

    def _surprises(self, fitted: Fitted, refused: Mapping[int, float]) -> Array:
        """Return how far each reading is from what the others predict, in standard deviations; 0 for those refused."""
        sizes = np.zeros(len(self._weights))
        np.maximum.at(sizes, fitted.reading, np.abs(fitted.surprise))
        sizes[~self._free] = 0.0
        sizes[list(refused)] = 0.0
        return sizes

    def _doubts(self, usual: float) -> list[Doubt]:
        found = [Doubt(reading, size, NOTHING) for reading, size in self._refused.items()]
        sizes = self._surprises(self._fitted, self._refused) / usual
        alone = [int(i) for i in np.argsort(-sizes) if sizes[i] > SURPRISING and not _has_twin(sizes, int(i))]
        return found + [Doubt(i, float(sizes[i]), float(self._weights[i])) for i in alone]


def _usual(fitted: Fitted) -> float:
    """Return how far readings usually are from what the others predict, at least 1."""
    return max(1.0, 1.4826 * float(np.median(np.abs(fitted.surprise))))


def _has_twin(sizes: Array, worst: int) -> bool:
    """Whether another reading stands out as far, so that nobody can say which of the two is wrong."""
    others = np.delete(sizes, worst)
    return bool(len(others)) and float(others.max()) > max(_ALIKE * float(sizes[worst]), SURPRISING)
