"""What the zeros of set-ups cost a plan: of the readings of a set-up one is spent on its zero, as far as that is open.

Every reading of a set-up may show its zero alike, c τ/σ in whitened rows. The estimate X = Σ l_i b_iᵀ of `dual` then
has c τ/σ Σ l_i in that column. Its other columns are Σ l_i (b_i − b̄)ᵀ, of one rank less, plus (Σ l_i) b̄ᵀ. The last
part is of rank one, and the zero's column bounds its length. So k numbers with t zeros have only k − t directions that
count in full. Another t count by a share that is small where the zeros are wide.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance

_MANY = 3
"""With more set-ups all ways to share are not tried; the bound holds, only less tight."""


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
    poses, approaches = lattice.of(setup)
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
                found.append((place, variance / float(else_shown.max())))
                break
    return found


def _apart(factor: Array, column: int) -> int | None:
    """Return the column of F that is an unknown's alone, and holds all of it; None where there is none."""
    places = np.flatnonzero(factor[column])
    alone = len(places) == 1 and len(np.flatnonzero(factor[:, places[0]])) == 1
    return int(places[0]) if alone else None
