"""What proves a bound: a matrix Z, and how much every plan must leave because of it.

A plan of k numbers has whitened rows b_i (of Σ^-½ G F). With any estimate X = Σ l_i b_iᵀ of Φ = V F it leaves

    J = min over l of |Φ − X|² + Σ |l_i|²   with   |l_i|² ≥ 2 l_iᵀZb_i − |Z b_i|²  for any Z,  so
    J ≥ min over X of |Φ − X|² + 2 <Z, X> − Σ |Z b_i|² = |Φ|² − |Φ − Z|²_k − Σ |Z b_i|²

where X has at most rank k and |.|²_k is the sum of the k largest squared singular values (Eckart and Young 1936). The
general equivalence theorem (Kiefer and Wolfowitz 1960) has Z = Φ (I + Σ x_i b_i b_iᵀ)⁻¹, optimal weights x, and all
singular values. Weyl (1912) has Z = 0. A share of the first Z is better than both.

Of the readings of a set-up one is spent on its zero, as far as that is open: every reading may show it alike, c τ/σ in
whitened rows. The estimate X = Σ l_i b_iᵀ then has c τ/σ Σ l_i in that column. Its other columns are Σ l_i (b_i − b̄)ᵀ,
of one rank less, plus (Σ l_i) b̄ᵀ. The last part is of rank one, and the zero's column bounds its length. So k numbers
with t zeros have only k − t directions that count in full. Another t count by a share that is small where the zeros are
wide.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance, unexplained

_MARGIN = 1e-12
"""Rounding, with room: what a proof gives away for float64 is a millionth of a millionth of J."""
_GOLDEN = (np.sqrt(5.0) - 1) / 2
"""Mathematics: the golden section."""
_STEPS = 24
"""Steps of the golden section: the multiplier to 1e-5, and any multiplier proves a bound."""
_MOST = 2.5
"""The largest multiplier that is tried; any proves a bound, and the best is near one."""
_PARTS = (0.0, 0.3, 0.6, 0.8, 0.9, 0.97)
"""Shares that are tried: each proves a bound, and the best is taken."""


@dataclass(frozen=True, eq=False)
class Dual:
    """state : of the prior, with the cells of all rows that Z was made from; z : Z (w, r)."""

    state: Covariance
    z: Array

    @classmethod
    def from_rows(cls, state: Covariance, scaled: Array) -> Dual:
        """Return Φ (I + BᵀB)⁻¹.  scaled : B (m, r), rows of unit noise under the state's factor."""
        target = state.weighted
        if not len(scaled):
            return cls(state, target)
        return cls(state, unexplained(target, scaled))

    @cached_property
    def reach(self) -> Array:
        """F Zᵀ (n, w): a row g of noise σ has |Z b|² = |gᵀ F Zᵀ|²/σ²."""
        return self.state.factor @ self.z.T

    @cached_property
    def value(self) -> float:
        """J of the weights that Z was made from, <Φ, Z>."""
        return float(np.sum(self.state.weighted * self.z))

    @property
    def whole(self) -> float:
        """|Φ|² − |Φ − Z|²."""
        return 2 * self.value - float(np.sum(self.z**2))

    def floor(self, spent: float, numbers: int, zeros: Zeros | None = None) -> float:
        """Return the best bound on J of plans of so many numbers that a share of Z proves.

        spent : what Σ |Z b_i|² of a plan may come to at most; zeros : that all of these plans must find out
        """
        target, z, lost, count = self.state.weighted, self.z, 0.0, 0
        if zeros is not None:
            count = len(zeros.columns)
            lost = float(np.sum(z[:, zeros.columns] ** 2))
            target, z = np.delete(target, zeros.columns, axis=1), np.delete(z, zeros.columns, axis=1)
        own, cross, other = target @ target.T, target @ z.T, z @ z.T
        cross, weight = cross + cross.T, float(np.trace(other)) + spent

        def bound(share: float) -> float:
            values = np.linalg.eigvalsh(own - share * cross + share**2 * other)[::-1]
            left = float(np.sum(np.maximum(values[numbers:], 0.0))) + share * (2 * self.value - share * weight)
            if zeros is None:
                return left
            half = float(np.sum(np.maximum(values[max(numbers - count, 0) : numbers], 0.0)))
            return left + max(_kept(zeros.stiffness, part) * half - share**2 * lost / (1 - part) for part in _PARTS)

        best = max(_largest(bound), bound(1.0))
        return max(best - _MARGIN * float(np.trace(own)), 0.0) * (1 - _MARGIN)


def _kept(stiffness: float, part: float) -> float:
    """Return the share that stays of a direction whose removal costs `stiffness` times its square."""
    return stiffness * part / (1 + stiffness * part)


def rank_bound(state: Covariance, readings: int) -> float:
    """Return what so many scalar readings must leave, wherever they are taken and however good they are.

    A reading takes away a covariance of rank one, so at least the smaller eigenvalues of V C₀ Vᵀ stay (Weyl 1912).
    """
    target = state.weighted
    values = np.linalg.eigvalsh(target @ target.T)[::-1]
    return float(max(np.sum(values[readings:]), 0.0)) * (1 - _MARGIN)


def _largest(concave: Callable[[float], float]) -> float:
    """Return the largest value on [0, 2.5] by golden section."""
    low, high = 0.0, _MOST
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_left, at_right = concave(left), concave(right)
    for _ in range(_STEPS):
        if at_left >= at_right:
            high, right, at_right = right, left, at_left
            left = high - _GOLDEN * (high - low)
            at_left = concave(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + _GOLDEN * (high - low)
            at_right = concave(right)
    return max(at_left, at_right)


_MANY = 3
"""With more set-ups all ways to share are not tried; the bound holds, only less tight."""


_ROUNDING = 1e-12
"""Share of what a reading shows that its parts are not known to; more of it makes a bound less tight, never wrong."""
ZerosEach = Mapping[int, list[tuple[int, float]]]
"""By set-up: the whitened column of each zero, and its variance over the largest of what else a reading shows."""


@dataclass(frozen=True, eq=False, slots=True)
class Zeros:
    """Zeros that a plan must find out.

    columns : of the whitened rows, (t,); stiffness : how many times |(Σ l_i) b̄ᵀ|² what stands in the columns is, at
    least, shared between them
    """

    columns: NDArray[np.intp]
    stiffness: float


def groups(setups: NDArray[np.intp], readings: int) -> list[tuple[int, ...]]:
    """Return the sets of set-ups that a plan may use, all of them first; only that one where there are many."""
    used = [int(s) for s in np.unique(setups)]
    if len(used) > _MANY:
        return []
    return [g for count in range(min(len(used), readings), 0, -1) for g in combinations(used, count)]


def zeros_each(state: Covariance, lattice: Places) -> ZerosEach:
    """Return the zeros of each set-up, as far as they are apart from what else is known before."""
    return {setup: _of_setup(state, lattice, setup) for setup in map(int, np.unique(lattice.setups))}


def zeros_of(each: ZerosEach, group: tuple[int, ...]) -> Zeros | None:
    """Return the zeros of set-ups that are all used.  each : of every set-up"""
    found: dict[int, float] = {}
    for column, ratio in (zero for setup in group for zero in each[setup]):
        found[column] = min(ratio, found.get(column, ratio))  # set-ups that share a zero spend one reading on it
    if not found:
        return None
    return Zeros(np.array(list(found)), min(found.values()) / len(found))


def _of_setup(state: Covariance, lattice: Places, setup: int) -> list[tuple[int, float]]:
    """Return the zeros of a set-up, as in `ZerosEach`."""
    observation, found = state.observation, list[tuple[int, float]]()
    poses, approaches = lattice.in_setup(setup)
    if not len(poses):
        return found
    ways = observation.rows_each(setup, poses, approaches)
    columns = observation.unknowns_of(setup).tolist()
    for number, seen in enumerate(ways):
        for column in columns:
            others = [way.rows[:, column] for k, way in enumerate(ways) if k != number]
            own, place = seen.rows[:, column], _apart(state.factor, column)
            if place is not None and own[0] != 0 and np.ptp(own) == 0 and not np.any(others):
                variance = float(own[0] * state.factor[column, place]) ** 2
                total = np.sum((seen.rows @ state.factor) ** 2, axis=1) + seen.variances
                else_shown = total - variance - observation.setups[setup].noise ** 2
                found.append((place, variance / float(np.max(else_shown + _ROUNDING * total))))
                break
    return found


def _apart(factor: Array, column: int) -> int | None:
    """Return the column of F that is an unknown's alone, and holds all of it; None where there is none."""
    places = np.flatnonzero(factor[column])
    alone = len(places) == 1 and len(np.flatnonzero(factor[:, places[0]])) == 1
    return int(places[0]) if alone else None
