"""Readings as weights: the optimal weights, and the matrix that proves how much they leave.

J(x) = tr(W (C₀⁻¹ + Σ x_i G_iᵀG_i/σ_i²)⁻¹) is convex in x. Its slope −∂J/∂x_i = d_i is the sum of gᵀSWSg/σ_i² over the
rows of G_i, one for each number of a reading. An interior point method brings x to the optimum on a support. The
support grows by the candidates that violate optimality most; where it grows large, all candidates get weights at once.
The rests of the cells that the support lies in are unknowns like all others: weight in one cell does not average its
rest away. Those of other cells are known no better than before, so that no slope d contains them.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.numerics.gaussian import lower_root
from axiscal.planning.bound.certificate import Dual
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance, informed
from axiscal_core.from_scipy import solution_of_product

_ADDED, _PART = 40, 2
"""So many candidates enter at once, or this part of the support: more make fewer, longer rounds to the same weights."""
_GONE = 1e-7
"""A weight of this share is none; it can enter again."""
_IDLE = 20.0
"""A weight of so many times what a loose optimum leaves to the idle ones is one of them; it can enter again too."""
_FIRST = 200
"""Candidates that begin with a weight; the others enter where they are worth it."""
_DEAR = 240
"""Candidates with a weight beyond which a turn over all of them is cheaper than a step of Newton: of time."""
_ABLE, _MOST = 0.5, 4000
"""Candidates that get a weight then: whose slope is at least this share of the level, at most so many, of memory."""
_LARGEST = 500
"""Candidates with a weight beyond which a step of Newton takes minutes; the bound of the others is kept."""
_SHARE = 0.3
"""Of Newton's step: a tenth and a half lead to the same, more slowly and by longer ways round."""
_DAMPED = 0.25
"""Of that share, after a turn by which J rose."""
_POWER = 0.4
"""Up to a half no turn overshoots; a little below it, since shares of steps are given beside it."""
_NOUGHT = 1e-300
"""No division by nought."""
_NEWTON = 60
"""Steps of Newton, which end where the weights settle; what is left early costs another round."""
CLOSE = 1e-6
"""Share of J by which weights may be off unless said otherwise: far below what a bound is closed to."""
_RESIDUAL = 10.0
"""Times that share by which slopes may be off: they enter the bound by their products with weights."""
_WITHIN = 0.95
"""Share of the way to where a weight would vanish; any below one."""
_ROUNDING = float(np.finfo(float).eps)
"""Of what bends, in each number: readings that say the same do not bend between themselves, and neither do their duals
when they have gone."""


class Relaxation:
    """Weights x on a support of candidates; indices beyond the pool are the given places.

    everything : the candidates of the pool, then the given places; support : indices of those with weights
    rests : whether those of cells are unknowns; otherwise they are taken as known, which can only lower J
    """

    def __init__(
        self, pool: Pool, state: Covariance, places: Places, costs: Array, limit: float, rests: bool = True
    ) -> None:
        self.rests = rests
        self.pool, self.state, self.costs, self.limit = pool, state, costs, limit
        self._close = CLOSE
        self.places, self.everything = places, Places.joined([pool.lattice, places])
        self.noise = np.array([setup.noise**2 for setup in state.observation.setups])[self.everything.setups]
        count = len(places)
        chosen = np.unique(np.linspace(0, max(count - 1, 0), min(count, _FIRST)).astype(np.intp))
        self.support = len(pool) + chosen
        self.weights: Array = np.full(len(chosen), limit / max(costs[self.support].sum(), 1e-300))
        if not count:
            self.support, self.weights = self._first()

    def _first(self) -> tuple[NDArray[np.intp], Array]:
        slopes = self.slopes(Dual.from_rows(self.state, np.zeros((0, self.state.factor.shape[1]))))
        best = int((slopes / self.costs).argmax())
        return np.array([best]), np.array([self.limit / self.costs[best]])

    def within(self, kept: NDArray[np.bool_]) -> Relaxation:
        """Return the same of some candidates and places, (M + places,)."""
        count = len(self.pool)
        pool = Pool(self.state.observation, self.pool.lattice.within(kept[:count]))
        places = self.places.within(kept[count:])
        return Relaxation(pool, self.state, places, self.costs[kept], self.limit, self.rests)

    def weighted_as(self, whole: Relaxation, kept: NDArray[np.bool_]) -> Relaxation:
        """Return the same, of `kept` (M + places,) of a whole, with the weights that they have there, scaled up.

        It begins as it does alone if all of them are zero.
        """
        other, mine = copy(self), kept[whole.support] & (whole.weights > 0)
        if mine.any():
            other.support = (np.cumsum(kept) - 1)[whole.support[mine]]
            other.weights = whole.weights[mine]
            other.weights = other.weights * (self.limit / float(other.costs[other.support] @ other.weights))
        return other

    def dual(self) -> Dual:
        """Return the matrix that the weights lead to as they stand."""
        state, along, owner = self._rows()
        return Dual.from_rows(state, along * np.sqrt(self.weights[owner])[:, None])

    def begin_everywhere(self) -> None:
        """Begin with the same weight on every candidate of the pool."""
        self.support = np.arange(len(self.pool))
        self.weights = np.full(len(self.pool), self.limit / float(self.costs[: len(self.pool)].sum()))

    @property
    def largest(self) -> bool:
        """Whether the support is as large as can be afforded."""
        return len(self.support) > _LARGEST

    @property
    def dear(self) -> bool:
        """Whether the support is large enough to give all candidates a weight."""
        return len(self.support) > _DEAR

    @property
    def weighty(self) -> Places:
        """The candidates of the support that have weight."""
        return self.everything.within(self.support[self.weights * self.costs[self.support] > _GONE * self.limit])

    @property
    def setups(self) -> NDArray[np.intp]:
        """The set-up of each candidate of the support."""
        return self.everything.setups[self.support]

    def solved(self, close: float = CLOSE) -> Dual:
        """Bring the weights to the optimum on the support.  close : share of J by which they may be off"""
        state, along, owner = self._rows()
        costs, self._close = self.costs[self.support], close
        self.weights = optimal_weights(along, owner, state.weighted, self.weights, costs, self.limit, close)
        return Dual.from_rows(state, along * np.sqrt(self.weights[owner])[:, None])

    def over_all(self, slopes: Array) -> Iterator[Turn]:
        """Let every candidate have a weight that may want one, and bring them to the optimum turn by turn.

        slopes : d of all candidates and places, (M + places,)
        """
        level = float((slopes[self.support] @ self.weights) / self.limit)
        rates = slopes[: len(self.pool)] / self.costs[: len(self.pool)]
        able = np.setdiff1d(np.flatnonzero(rates > _ABLE * level), self.support)
        able = able[np.argsort(-rates[able], kind="stable")[:_MOST]]
        self.support = np.concatenate([self.support, able])
        self.weights = np.concatenate([self.weights, np.zeros(len(able))])
        state, along, owner = self._rows()
        for turn in turns(state, along, owner, self.weights, self.costs[self.support], self.limit):
            self.weights = turn.weights
            yield turn

    def value_if(self, shares: Array) -> float:
        """Return J were each candidate of the support read with its weight times a share, (s,)."""
        state, along, owner = self._rows()
        return Dual.from_rows(state, along * np.sqrt((self.weights * shares)[owner])[:, None]).value

    def _rows(self) -> tuple[Covariance, Array, NDArray[np.intp]]:
        """Return the state with the cells of the support, its rows R^-½ G F (m, r), and whose each is (m,)."""
        places = self.everything.within(self.support)
        state = self.state.opened(places) if self.rests else self.state
        rows, _, owner = state.rows(places)
        return state, (rows / np.sqrt(self.noise[self.support[owner]])[:, None]) @ state.factor, owner

    def slopes(self, dual: Dual) -> Array:
        """Return d of all candidates and places, (M + places,)."""
        inside = self.pool.squares(dual.state.observation, dual.reach)
        rows, _, owner = dual.state.rows(self.places)
        given = np.bincount(owner, np.sum((rows @ dual.reach) ** 2, axis=1), len(self.places))
        slopes: Array = np.concatenate([inside, given]) / self.noise
        return slopes

    def grow(self, slopes: Array) -> bool:
        """Drop what has no weight, add the worst violators that stand apart; return whether any was added."""
        gone = max(_GONE, _IDLE * self._close / len(self.support))
        level = float((slopes[self.support] @ self.weights) / self.limit)
        kept = (self.weights * self.costs[self.support] > gone * self.limit) | self._missed(slopes, level)
        added = self._violators(slopes / self.costs, level, self.support[kept])
        start = np.full(len(added), 1e-3 * self.limit) / np.maximum(self.costs[added], 1e-300) / max(len(added), 1)
        self.support = np.concatenate([self.support[kept], added])
        self.weights = np.concatenate([self.weights[kept], start])
        total = float(self.costs[self.support] @ self.weights)
        self.weights = self.weights * (self.limit / total)
        return len(added) > 0

    def _missed(self, slopes: Array, level: float) -> NDArray[np.bool_]:
        """Return which of the support would be worth more than the others without their weight, (s,).

        Without x_i the slope d_i is d_i / (1 − x_i k_i)² at most, k_i = tr(B_i S B_iᵀ). Little weight of a reading with
        little noise can be much information.
        """
        _, along, owner = self._rows()
        seen = informed(along, along * np.sqrt(self.weights[owner])[:, None])
        told = np.bincount(owner, np.sum(seen**2, axis=1), len(self.weights))
        alone = np.maximum(1.0 - self.weights * told, 0.0) ** 2
        return slopes[self.support] > alone * level * self.costs[self.support]

    def _violators(self, slopes: Array, level: float, support: NDArray[np.intp]) -> NDArray[np.intp]:
        order = np.argsort(-slopes, kind="stable")[: 20 * max(_ADDED, len(support) // _PART)]
        order = order[(slopes[order] > level * (1 + 1e-6)) & ~np.isin(order, support) & (order < len(self.pool))]
        lattice, most = self.pool.lattice.within(order), max(_ADDED, len(support) // _PART)
        spans = np.array([axis.length for axis in self.state.observation.machine.axes])
        able, chosen = np.ones(len(order), dtype=bool), list[int]()
        while len(chosen) < most and able.any():
            steepest = int(able.argmax())
            chosen.append(int(order[steepest]))
            near = np.all(np.abs(lattice.poses - lattice.poses[steepest]) / spans <= self._apart, axis=1)
            alike = np.all(lattice.approaches == lattice.approaches[steepest], axis=1)
            able &= ~(near & alike & (lattice.setups == lattice.setups[steepest]))
        return np.array(chosen, dtype=np.intp)

    @property
    def _apart(self) -> float:
        """Candidates of one round stand at least a few lattice spacings apart."""
        axes = max(len(setup.moves) for setup in self.state.observation.setups)
        return float(2.0 / max(len(self.pool), 2) ** (1.0 / axes))


class Turn(NamedTuple):
    """weights : (s,); dual : the matrix they lead to; slopes : d (s,) with it"""

    weights: Array
    dual: Dual
    slopes: Array


def turns(
    state: Covariance, along: Array, owner: NDArray[np.intp], weights: Array, costs: Array, limit: float
) -> Iterator[Turn]:
    """Yield weights turn by turn, as they stand first; m r² operations each, and no second derivative.

    A slope d_i above its level λ c_i wants more weight. Newton's step of that weight alone, while the others stay, is
    (1 − λ c_i/d_i)/(2 k_i). Here k_i = tr(B_i S B_iᵀ) with its whitened rows B_i and the current covariance S.
    Neighbours want the same and all get it, so a share of it is given, less after a turn by which J rose. A slope below
    its level loses, x_i ← x_i (d_i/λ c_i)^p (the multiplicative algorithm: Yu 2010). Any weights prove a bound.
    along : R^-½ G F (m, r); owner : (m,) to which reading each number belongs, in order; weights, costs : (s,)
    """
    first = np.searchsorted(owner, np.arange(len(weights)))
    seen = informed(along, along * np.sqrt(weights[owner])[:, None])
    spread = np.maximum(np.add.reduceat(np.sum(seen**2, axis=1), first), _NOUGHT)
    best, share = None, _SHARE
    while True:
        dual = Dual.from_rows(state, along * np.sqrt(weights[owner])[:, None])
        if best is None or dual.value <= best.dual.value:
            best = Turn(weights, dual, np.add.reduceat(np.sum((along @ dual.z.T) ** 2, axis=1), first))
        else:  # too far: as many neighbours as there are take part
            share *= _DAMPED
        yield best
        above = np.maximum(best.slopes / (costs * float(best.slopes @ best.weights) / limit), _NOUGHT)
        scaled = best.weights * above**_POWER
        grown = best.weights + share * (1 - 1 / above) / (2 * spread)
        weights = np.where(above > 1, np.maximum(scaled, grown), scaled)
        weights = weights * (limit / float(costs @ weights))


def optimal_weights(
    along: Array,
    owner: NDArray[np.intp],
    weighted: Array,
    weights: Array,
    costs: Array,
    limit: float,
    close: float = CLOSE,
) -> Array:
    """Return the weights (s,) that minimise J over costs·x = limit, x ≥ 0, by a primal-dual interior point method.

    along : R^-½ G F (m, r); owner : (m,) to which reading each number belongs, in order; weighted : V F (w, r)
    close : share of J by which they may be off
    Each step looks ahead without the barrier first, which says how far the barrier may sink (Mehrotra 1992): what a
    step costs is the second derivative, and with it both directions come from one factor.
    ∂²J = 2 (G S Gᵀ) ∘ (G S W S Gᵀ), summed over the rows of each reading, positive semidefinite as a product of such.
    """
    scale = limit / costs
    along = along * np.sqrt(scale[owner])[:, None]
    if along.shape[1] > len(along):  # what no reading sees does not matter
        basis = np.linalg.qr(along.T)[0]
        along, weighted = along @ basis, weighted @ basis
    x = np.maximum(weights / scale, 1e-6 / len(weights))
    x /= x.sum()
    slopes, bend = _curvatures(along, owner, weighted, x)
    level = float(slopes @ x)
    if not level > 0:  # nothing that may be read tells anything
        return weights
    dual = np.maximum(level - slopes, 0.05 * level)
    for _ in range(_NEWTON):
        residual = slopes - level + dual
        move, shift, dual_move = _step(bend, x, dual, residual)
        share = min(1.0, _WITHIN * _room(x, move), _WITHIN * _room(dual, dual_move))
        x, dual, level = x + share * move, dual + share * dual_move, level + share * shift
        x /= x.sum()
        slopes, bend = _curvatures(along, owner, weighted, x)
        residual = slopes - level + dual
        if x @ dual < close * abs(level) and np.abs(residual).max() < _RESIDUAL * close * abs(level):
            break
    return x * scale


def _step(bend: Array, x: Array, dual: Array, residual: Array) -> tuple[Array, float, Array]:
    """Return how weights, their level and duals move."""
    system = bend.copy()
    system[np.diag_indices(len(x))] += np.maximum(dual / x, _ROUNDING * len(x) * np.trace(bend))
    lower = lower_root(system)
    ones = solution_of_product(lower, np.ones(len(x)))

    def moves(pushed: Array) -> tuple[Array, float, Array]:
        solved = solution_of_product(lower, residual - dual + pushed)
        shift = float(solved.sum() / ones.sum())
        move = solved - shift * ones
        return move, shift, pushed - dual - dual / x * move

    ahead, _, dual_ahead = moves(np.zeros(len(x)))
    share = min(1.0, _room(x, ahead), _room(dual, dual_ahead))
    gap = float(x @ dual)
    left = float((x + share * ahead) @ (dual + share * dual_ahead)) / gap
    return moves((left**3 * gap / len(x) - ahead * dual_ahead) / x)


def _curvatures(along: Array, owner: NDArray[np.intp], weighted: Array, x: Array) -> tuple[Array, Array]:
    """Return d = −∂J/∂x (s,) and ∂²J (s, s).  along : G F (m, r); owner : (m,) in 0…s−1; weighted : V F (w, r)."""
    scaled = along * np.sqrt(x[owner])[:, None]
    both = informed(np.vstack([along, weighted]), scaled)
    seen, reach = both[: len(along)], both[len(along) :]
    reached = seen @ reach.T
    target = reached @ reached.T
    slopes: Array = np.diagonal(target).copy()
    bend: Array = seen @ seen.T
    bend *= target
    bend *= 2
    if len(x) < len(along):
        first = np.searchsorted(owner, np.arange(len(x)))
        slopes = np.add.reduceat(slopes, first)
        bend = np.add.reduceat(np.add.reduceat(bend, first, axis=0), first, axis=1)
    return slopes, bend


def _room(x: Array, move: Array) -> float:
    """Return how far x may go along a move before an entry vanishes."""
    falling = move < 0
    return float((x[falling] / -move[falling]).min(initial=1e300))
