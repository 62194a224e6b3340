"""The exact step along lines: the largest ratio N/D over many intervals at once, whatever N and D are (B&H eq. 27).

Three steps keep rounding errors negligible here, which the paper could not ensure. The search halves intervals over
which the denominator spans decades, or that the series does not follow. It leaves out intervals that provably hold no
better value. It evaluates every value returned afresh at its position.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal.numerics.chebyshev import check_forms, maximise_ratio, nodes, resampled
from axiscal.numerics.ties import TIE, first_best_each

Forms = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]
"""(positions (b, k), interval (b,)) -> numerator and denominator there, each (b, k); denominator positive."""

_EPS = float(np.finfo(np.float64).eps)
_SPAN = 1e4
"""Largest ratio of the denominator within one interval before it is halved: keeps ten digits in N'D - ND'."""
_MISFIT = 1e-10
"""Largest relative difference of series and fresh value before an interval is halved."""
_HALVINGS = 60
"""An interval that is halved so often is one float64, but beside zero; there the best of its nodes stands."""
_WITHIN = 1 - 1e-11
"""An end is looked at from inside, where the forms may jump: beyond it another interval begins."""


def maximise_along(
    forms: Forms,
    left: Array,
    right: Array,
    count: int,
    group: NDArray[np.intp] | None = None,
    known: Array | None = None,
) -> tuple[Array, Array]:
    """Return the best position and value of N/D found in each interval: (b,), (b,) (B&H eq. 27).

    forms : evaluates N and D afresh; smooth on each interval up to its ends (where two intervals meet, the index says
        from which side the position is meant)
    left, right : (b,) ends of the intervals, in the unit of position
    count : nodes per interval: degree + 1 for polynomials, `node_count` with sines
    group : (b,) which search an interval belongs to (default: all one). In each group the best interval is exact;
        in an interval that cannot hold the best of its group the best node is returned.
    known : (groups,) what some position is known to reach in each, N/D; what is no better than that may come out low
    raises ShapeError : a value that is not finite, or a denominator that is not positive
    """
    owner = np.arange(len(left))
    search = _Search.begin(forms, left, np.zeros_like(owner) if group is None else group, known)
    for _ in range(_HALVINGS):
        work = search.sample(left, right, owner, count)
        left, right, owner = search.solve(work)
        if len(owner) == 0:
            break
    return search.position, search.value


def gain_forms(rows: Array, factor: Array, weighted: Array, variance: float | Array) -> tuple[Array, Array]:
    """Return N = gᵀCWCg and D = σ² + gᵀCg, each (m,), as sums of squares, so that neither loses its small values.

    rows : (m, n), the g; factor : (n, r), F with C = F Fᵀ; weighted : (w, r), W^½ F; variance : σ², scalar or (m,)
    """
    along = rows @ factor
    reach = along @ weighted.T
    return np.einsum("ij,ij->i", reach, reach), variance + np.einsum("ij,ij->i", along, along)


@dataclass(frozen=True, slots=True)
class _Work:
    """Intervals with numerator and denominator at their nodes."""

    left: Array
    right: Array
    owner: NDArray[np.intp]
    numerator: Array
    denominator: Array

    def take(self, keep: NDArray[np.bool_]) -> _Work:
        return _Work(self.left[keep], self.right[keep], self.owner[keep], self.numerator[keep], self.denominator[keep])

    def positions(self, x: Array) -> Array:
        """Return the positions of local coordinates x (b, k), exact at the ends."""
        return self.left[:, None] * ((1 - x) / 2) + self.right[:, None] * ((1 + x) / 2)

    def halves(self, cut: NDArray[np.bool_]) -> tuple[Array, Array, NDArray[np.intp]]:
        """Return both halves of the intervals to cut; those too short to be cut are dropped."""
        left, right, owner = self.left[cut], self.right[cut], self.owner[cut]
        middle = left / 2 + right / 2
        wide = (middle > left) & (middle < right)
        left, right, owner, middle = left[wide], right[wide], owner[wide], middle[wide]
        return np.concatenate([left, middle]), np.concatenate([middle, right]), np.concatenate([owner, owner])


@dataclass(slots=True)
class _Search:
    """The best found so far, per interval and per group."""

    forms: Forms
    group: NDArray[np.intp]
    position: Array
    value: Array
    best: Array

    @classmethod
    def begin(cls, forms: Forms, left: Array, group: NDArray[np.intp], known: Array | None) -> _Search:
        best = np.full(int(group.max(initial=-1)) + 1, -np.inf) if known is None else known.copy()
        return cls(forms, group, left.copy(), np.full(len(left), -np.inf), best)

    def offer(self, position: Array, owner: NDArray[np.intp]) -> tuple[Array, Array]:
        """Evaluate afresh at positions (b, k) and keep what is better."""
        numerator, denominator = self.forms(position, owner)
        check_forms(numerator, denominator)
        ratio = numerator / denominator
        pick = np.arange(len(owner)), first_best_each(ratio, TIE)
        value, where = ratio[pick], position[pick]
        order = np.argsort(value, kind="stable")
        better = order[value[order] > self.value[owner[order]]]
        self.position[owner[better]], self.value[owner[better]] = where[better], value[better]
        np.maximum.at(self.best, self.group[owner], value)
        return numerator, denominator

    def sample(self, left: Array, right: Array, owner: NDArray[np.intp], count: int) -> _Work:
        """Evaluate at the ends and the nodes of every interval."""
        empty = np.zeros((len(left), 0))
        points = np.concatenate([[-1.0], nodes(count), [1.0]])
        numerator, denominator = self.offer(_Work(left, right, owner, empty, empty).positions(points[None, :]), owner)
        return _Work(left, right, owner, numerator[:, 1:-1], denominator[:, 1:-1])

    def solve(self, work: _Work) -> tuple[Array, Array, NDArray[np.intp]]:
        """Solve every interval that is tame, and return the halves of those that are not."""
        work = work.take(self._hopeful(work))
        wild = _span(work.denominator) > _SPAN
        tame = work.take(~wild)
        left, right, owner = work.halves(wild)
        if len(tame.owner) == 0:
            return left, right, owner
        again = tame.halves(self._misfits(tame))
        return np.concatenate([left, again[0]]), np.concatenate([right, again[1]]), np.concatenate([owner, again[2]])

    def _misfits(self, work: _Work) -> NDArray[np.bool_]:
        """Offer the stationary points of the intervals; return which of them the series did not follow."""
        x, claimed = maximise_ratio(work.numerator, work.denominator)
        numerator, denominator = self.offer(work.positions(np.clip(x, -_WITHIN, _WITHIN)[:, None]), work.owner)
        fresh = numerator[:, 0] / denominator[:, 0]
        return np.abs(fresh - claimed) > _MISFIT * np.maximum(np.abs(fresh), np.abs(claimed))

    def _hopeful(self, work: _Work) -> NDArray[np.bool_]:
        """Return which intervals may hold more than the best of their group.

        P = N - best·D is negative throughout the others. Between 4n Chebyshev nodes a polynomial of degree below n may
        exceed its largest sample. The excess is at most 1/cos(π/8) - 1 of its half range (Ehlich and Zeller 1964).
        """
        best = self.best[self.group[work.owner]][:, None]
        excess = resampled(work.numerator - best * work.denominator, 4 * work.numerator.shape[1])
        high, low = excess.max(axis=1), excess.min(axis=1)
        size = np.maximum(np.abs(work.numerator), np.abs(best) * work.denominator).max(axis=1)
        bound = high + (high - low) / 2 * (1 / math.cos(math.pi / 8) - 1)
        hopeful: NDArray[np.bool_] = bound > -64 * _EPS * size
        return hopeful


def _span(denominator: Array) -> Array:
    span: Array = denominator.max(axis=1) / denominator.min(axis=1)
    return span
