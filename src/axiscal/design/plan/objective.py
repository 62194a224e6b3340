"""What a plan is to minimise when its readings shall vouch for it: the promise, and the damages that they do not show.

    objective = (P^p + Σ_h w_h D_h^{2p})^{1/p},  P the promised variance, D the damage of each departure

Every term is positive, so that some of the departures alone give a floor of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.accuracy.damage import KAPPA, needed
from axiscal.design.plan.watch import Watch
from axiscal.numerics import Array

_SMALLEST = 1e-300
"""No division by nought."""
_HOPELESS = 1e200
"""Of a power, so that sums of many stay below the largest float; a curve of millimetres went beyond it."""


class Standing(NamedTuple):
    """What readings show of each departure; of one plan, or of many at once.

    promise : P, m²; own : (..., k) information; across : (..., pairs) between the columns of a pair
    wrong : (..., k) |e|², m²
    """

    promise: Array
    own: Array
    across: Array
    wrong: Array

    def within(self, columns: NDArray[np.intp], pairs: NDArray[np.intp]) -> Standing:
        """Return the same of some columns, those of some pairs among them."""
        return Standing(self.promise, self.own[..., columns], self.across[..., pairs], self.wrong[..., columns])


@dataclass(frozen=True, eq=False, slots=True)
class Objective:
    """The objective over some departures, those of one column first.

    single : how many have one column; beside : (k,) m², of each column; most, weights : (h,) of each departure
    squarings : p is two to this power
    """

    single: int
    beside: Array
    most: Array
    weights: Array
    squarings: int

    @classmethod
    def of(cls, watched: Watch, squarings: int) -> Objective:
        """Return that of all departures that are watched for."""
        return cls(watched.single, watched.beside, watched.most, watched.weights, squarings)

    def columns(self, chosen: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the columns of departures, ascending, and the indices of the pairs among them."""
        pairs = chosen[chosen >= self.single] - self.single
        both = (self.single + 2 * pairs[:, None] + np.arange(2)).ravel()
        return np.concatenate([chosen[chosen < self.single], both]), pairs

    def within(self, chosen: NDArray[np.intp]) -> Objective:
        """Return that of some departures, whose indices ascend."""
        columns, _ = self.columns(chosen)
        single = int(np.sum(chosen < self.single))
        return replace(
            self,
            single=single,
            beside=self.beside[columns],
            most=self.most[chosen],
            weights=self.weights[chosen],
        )

    def value(self, at: Standing) -> Array:
        """Return the objective, (...), m²."""
        scale = max(float(np.min(at.promise)), _SMALLEST)
        summed = self._raised(np.maximum(at.promise, _SMALLEST) / scale)
        for damages, which in self._damages(at):
            with np.errstate(over="ignore"):  # against a promise of nothing: hopeless
                shares = damages / scale
            summed = summed + self._raised(shares) @ self.weights[which]
        total: Array = scale * summed ** (0.5**self.squarings)
        return total

    def heaviest(self, at: Standing, count: int) -> NDArray[np.intp]:
        """Return the departures of one plan that do most, at most so many, their indices ascending."""
        each = np.concatenate([self.weights[which] * damages**2 for damages, which in self._damages(at)])
        found: NDArray[np.intp] = np.sort(np.argsort(-each, kind="stable")[:count])
        return found

    def after_several(self, standing: Standing, inverse: Array, above: Array, beta: Array, pi: Array) -> Standing:
        """Return what readings show after one of several numbers, or after each of many.

        inverse : (..., r, r) M⁻¹, with M = R + G C Gᵀ; of one that leaves (G C Gᵀ − R)⁻¹
        above : (..., r, r) G C W C Gᵀ; beta, pi : (..., r, k)
        """
        solved = inverse @ beta
        across = np.sum(self._pair(beta)[0] * self._pair(solved)[1], axis=-2)
        wrong = standing.wrong - 2 * np.sum(solved * pi, axis=-2) + np.sum(solved * (above @ solved), axis=-2)
        return Standing(
            standing.promise - np.sum(inverse * above, axis=(-2, -1)),
            standing.own + np.sum(beta * solved, axis=-2),
            standing.across + across,
            np.maximum(wrong, self.beside),
        )

    def after_one(self, standing: Standing, below: Array, above: Array, beta: Array, pi: Array) -> Array:
        """Return the objective after each of many readings, (m,).  below : v; above : N; beta, pi : (m, k)"""
        eta = (1.0 / below)[:, None]
        first, second = self._pair(beta)
        scaled = eta * beta
        wrong = scaled * above[:, None]  # in place from here: these tables are what a search spends its time on
        wrong -= 2 * pi
        wrong *= scaled
        wrong += standing.wrong
        np.maximum(wrong, self.beside, out=wrong)
        across = standing.across + eta * first * second
        scaled *= beta
        scaled += standing.own
        return self.value(Standing(standing.promise - above / below, scaled, across, wrong))

    def _pair(self, beta: Array) -> tuple[Array, Array]:
        """Return the first and the second columns of departures that have two."""
        pairs = beta[..., self.single :]
        return pairs[..., 0::2], pairs[..., 1::2]

    def _damages(self, at: Standing) -> tuple[tuple[Array, slice], tuple[Array, slice]]:
        """Return D² of the departures of one column and of those of two, each (..., h), and which they are."""
        singles, pairs = slice(0, self.single), slice(self.single, None)
        one = self._damage(at.own[..., singles], at.wrong[..., singles], singles, 1)
        (own, other), (near, far) = self._pair(at.own), self._pair(at.wrong)
        least = (own + other) / 2 - np.sqrt(((own - other) / 2) ** 2 + at.across**2)
        two = self._damage(np.maximum(least, 0.0), (near + far) / 2, pairs, 2)
        return (one, singles), (two, pairs)

    def _damage(self, information: Array, wrong: Array, which: slice, degrees: int) -> Array:
        """Return D² of departures.  information, wrong : (..., h), of those of one column or of two"""
        damages = needed(degrees) / (KAPPA**2 - 1) / np.maximum(information, _SMALLEST)
        np.minimum(damages, self.most[which] ** 2, out=damages)
        damages *= wrong
        result: Array = damages
        return result

    def _raised(self, values: Array) -> Array:
        """Return values to the power p; hopeless ones are as hopeless as a float can say."""
        values = np.minimum(values, _HOPELESS ** (0.5**self.squarings))
        for _ in range(self.squarings):
            values = np.square(values)
        return values
