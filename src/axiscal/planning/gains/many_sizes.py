"""Gains where sizes and lengths of errors are not known: each of several draws has its own J, and logarithms count.

With J_k of each draw a search makes J = exp(mean log J_k) small. A reading of gain g_k in each draw has the gain

    J − J' = J (1 − exp(mean log(1 − g_k/J_k)))

So a draw with large errors counts no more than one with small ones, and no plan trusts one length.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Self

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance, middle
from axiscal.planning.gains.running_gains import Scores

_MOST = 1 - 1e-12
"""Share of J that a reading may gain: rounding."""
_NOUGHT = 1e-300
"""No division by nought, where no error moves the tool point."""


class ManyScores(Scores):
    """The gains of the candidates for several draws of the sizes at once, with the same readings in each."""

    def __init__(self, pool: Pool, states: Sequence[Covariance]) -> None:
        super().__init__(pool.at(states[0].observation), states[0])
        self._others = [Scores(pool.at(state.observation), state) for state in states[1:]]
        self.begun = tuple(states)

    def fork(self) -> Self:
        """Return a copy that goes its own way."""
        other = super().fork()
        other._others = [each.fork() for each in self._others]
        return other

    def among(self, setups: Collection[int]) -> Self:
        """Return a copy that has the candidates of some set-ups alone, and goes its own way."""
        other = super().among(setups)
        other._others = [each.among(setups) for each in self._others]
        return other

    @property
    def value(self) -> float:
        """J, the geometric mean."""
        return middle(self._values)

    @property
    def gains(self) -> Array:
        """The gain of every candidate, (M,)."""
        each = [super().gains, *(other.gains for other in self._others)]
        return self._fallen(self._values, each)

    def enter(self, what: int | Places) -> float:
        """Take a candidate, or a reading at another single place, into the plan, and return by how much J falls."""
        before, _ = self.value, super().enter(what)
        for each in self._others:
            each.enter(what)
        return before - self.value

    def exchange(self, slot: int, what: int | Places) -> float:
        """Put a candidate, or a reading at another single place, where another stands; return by how much J falls."""
        before, _ = self.value, super().exchange(slot, what)
        for each in self._others:
            each.exchange(slot, what)
        return before - self.value

    def enter_all(self, places: Places) -> float:
        """Take readings into the plan together, after those that it has, and return by how much J falls."""
        before, _ = self.value, super().enter_all(places)
        for each in self._others:
            each.enter_all(places)
        return before - self.value

    def leave(self, slot: int) -> float:
        """Take a reading out of the plan, and return by how much J rises."""
        before, _ = self.value, super().leave(slot)
        for each in self._others:
            each.leave(slot)
        return self.value - before

    def without(self, slot: int) -> tuple[Array, float]:
        """Return the gains (M,) of the candidates were a reading not taken, and that of the reading itself."""
        found = [super().without(slot), *(each.without(slot) for each in self._others)]
        before = self._values + np.array([own for _, own in found])
        return self._fallen(before, [gains for gains, _ in found]), middle(before) - self.value

    def losses(self) -> Array:
        """Return by how much J would rise were each reading of the plan not taken, (N,)."""
        each = np.array([super().losses(), *(other.losses() for other in self._others)])
        risen: Array = np.expm1(np.log1p(each / np.maximum(self._values, _NOUGHT)[:, None]).mean(axis=0))
        return self.value * risen

    def held_alone(self, slot: int) -> bool:
        """Whether unknowns would open beyond the digits of a double without a reading of several numbers, in a draw."""
        return super().held_alone(slot) or any(each.held_alone(slot) for each in self._others)

    @property
    def _values(self) -> Array:
        """J of each draw, (K,)."""
        return np.array([self.state.value, *(each.state.value for each in self._others)])

    @staticmethod
    def _fallen(values: Array, gains: Sequence[Array]) -> Array:
        """Return the gains of all draws together, (M,).  values : J of each before, (K,); gains : (M,) of each"""
        shares = np.minimum(np.array(gains) / np.maximum(values, _NOUGHT)[:, None], _MOST)
        fallen: Array = -np.expm1(np.log1p(-shares).mean(axis=0))
        return middle(values) * fallen
