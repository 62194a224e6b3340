"""How good any plan can be: a lower bound on J for all plans from a lattice, by convex relaxation.

Readings become weights: J(x) = tr(W (C₀⁻¹ + Σ x_i G_iᵀG_i/σ_i²)⁻¹) is convex in x, with −∂J/∂x_i = d_i, the sum of
gᵀSWSg/σ_i² over the rows of G_i: one, or as many as a reading has numbers.
Whatever x ≥ 0, every x' ≥ 0 with Σ a_i x'_i ≤ B has  J(x') ≥ J(x) + Σ d_i x_i − B max_i d_i/a_i  (the general
equivalence theorem, Kiefer and Wolfowitz 1960). The maximum runs over the whole lattice; x is brought to the optimum by
an interior point method on a support that grows by the candidates that violate optimality most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.design.pool import Pool
from axiscal.design.state import Point, State, informed
from axiscal.measurement.observation import directions_of
from axiscal.numerics import Array

_ROUNDS = 60
_NEWTON = 60
_CLOSE = 2e-3
_BARRIER = 0.2
_ADDED = 40
_GONE = 1e-7
_FIRST = 200
_LARGEST = 320
_MARGIN = 1e-12


@dataclass(frozen=True, eq=False, slots=True)
class Bound:
    """No plan has a smaller J.

    value : the bound; everywhere : whether it holds for any readings whatever, not only for those of the lattice
    """

    value: float
    everywhere: bool


def lower_bound(pool: Pool, state: State, points: list[Point], costs: Array, limit: float) -> Bound:
    """Return the bound on J for plans from the pool and from `points` whose costs sum to no more than the limit.

    state : before the first reading; points : a good plan to begin with; costs : (M + points,), 1 each where readings
    are counted, or seconds
    The rests of cells not visited yet are taken as known: that can only lower the bound.
    """
    numbers = max((len(directions_of(setup)) for setup in state.observation.setups), default=1)
    by_rank = rank_bound(state, numbers * int(limit / costs.min() + 1e-9))
    relaxation = Relaxation(pool, state, points, costs, limit)
    best, reached = 0.0, np.inf
    for _ in range(_ROUNDS):
        value, gap, slopes = relaxation.solved()
        best, reached = max(best, value - gap), min(reached, value)
        if (
            reached <= max(by_rank, best * (1 + _CLOSE))
            or not relaxation.grow(slopes)
            or len(relaxation.support) > _LARGEST
        ):
            break
    return Bound(by_rank, True) if by_rank >= best else Bound(best * (1 - _MARGIN), False)


def rank_bound(state: State, readings: int) -> float:
    """Return what so many scalar readings must leave, wherever they are taken and however good they are.

    A reading takes away a covariance of rank one, so at least the smaller eigenvalues of V C₀ Vᵀ stay (Weyl 1912).
    """
    reach = state.weight @ state.factor[: state.weight.shape[1]]
    values = np.linalg.eigvalsh(reach @ reach.T)[::-1]
    return float(max(np.sum(values[readings:]), 0.0)) * (1 - _MARGIN)


class Relaxation:
    """Weights x on a support of candidates; indices beyond the pool are the given points."""

    def __init__(self, pool: Pool, state: State, points: list[Point], costs: Array, limit: float) -> None:
        self.pool, self.state, self.costs, self.limit = pool, state, costs, limit
        self.extra, _, self._of_extra = state.rows(points)
        self.noise = np.concatenate([pool.noise, [state.observation.setups[p.setup].noise ** 2 for p in points]])
        chosen = np.unique(np.linspace(0, max(len(points) - 1, 0), min(len(points), _FIRST)).astype(np.intp))
        self.factor = state.factor
        self.support = len(pool) + chosen
        self.weights: Array = np.full(len(chosen), limit / max(costs[self.support].sum(), 1e-300))
        if not len(points):
            self.support, self.weights = self._first()

    def _first(self) -> tuple[NDArray[np.intp], Array]:
        slopes = self._slopes(self.state.factor)
        best = int((slopes / self.costs).argmax())
        return np.array([best]), np.array([self.limit / self.costs[best]])

    def begin_everywhere(self) -> None:
        """Begin with the same weight on every candidate of the pool."""
        self.support = np.arange(len(self.pool))
        self.weights = np.full(len(self.pool), self.limit / float(self.costs[: len(self.pool)].sum()))

    def solved(self) -> tuple[float, float, Array]:
        """Bring the weights to the optimum on the support; return J, its distance to the bound, and all slopes d."""
        rows, owner = self._support_rows()
        rows = rows / np.sqrt(self.noise[self.support[owner]])[:, None]
        costs = self.costs[self.support]
        self.weights = _optimal(rows, owner, self.state, self.weights, costs, self.limit)
        scaled = (rows * np.sqrt(self.weights[owner])[:, None]) @ self.state.factor
        self.factor = informed(self.state.factor, scaled)
        slopes = self._slopes(self.factor)
        reach = self.state.weight @ self.factor[: self.state.weight.shape[1]]
        gap = self.limit * float((slopes / self.costs).max()) - float(slopes[self.support] @ self.weights)
        return float(np.sum(reach**2)), gap, slopes

    def grow(self, slopes: Array) -> bool:
        """Drop what has no weight, add the worst violators that stand apart; return whether any was added."""
        kept = self.weights * self.costs[self.support] > _GONE * self.limit
        level = float((slopes[self.support] @ self.weights) / self.limit)
        added = self._violators(slopes / self.costs, level, self.support[kept])
        start = np.full(len(added), 1e-3 * self.limit) / np.maximum(self.costs[added], 1e-300) / max(len(added), 1)
        self.support = np.concatenate([self.support[kept], added])
        self.weights = np.concatenate([self.weights[kept], start])
        total = float(self.costs[self.support] @ self.weights)
        self.weights = self.weights * (self.limit / total)
        return len(added) > 0

    def _violators(self, slopes: Array, level: float, support: NDArray[np.intp]) -> NDArray[np.intp]:
        order = np.argsort(-slopes, kind="stable")[: 20 * _ADDED]
        order = order[(slopes[order] > level * (1 + 1e-6)) & ~np.isin(order, support) & (order < len(self.pool))]
        lattice = self.pool.lattice
        spans = np.array([axis.length for axis in self.state.observation.errors.machine.axes])
        chosen: list[int] = []
        for i in order:
            here = [k for k in chosen if lattice.setups[k] == lattice.setups[i]]
            near = np.abs(lattice.poses[here] - lattice.poses[i]) / spans <= self._apart
            alike = np.all(lattice.approaches[here] == lattice.approaches[i], axis=1)
            if len(chosen) < _ADDED and not np.any(np.all(near, axis=1) & alike):
                chosen.append(int(i))
        return np.array(chosen, dtype=np.intp)

    @property
    def _apart(self) -> float:
        """Candidates of one round stand at least a few lattice spacings apart."""
        axes = max(len(setup.moves) for setup in self.state.observation.setups)
        return float(2.0 / max(len(self.pool), 2) ** (1.0 / axes))

    def _support_rows(self) -> tuple[Array, NDArray[np.intp]]:
        """Return the rows of all numbers (m, n), and which of the support each belongs to, (m,), in order."""
        inside = np.flatnonzero(self.support < len(self.pool))
        rows, _, of = self.state.rows([self.pool.point(int(i)) for i in self.support[inside]])
        parts, owners = [rows], [inside[of]]
        for place in np.flatnonzero(self.support >= len(self.pool)):
            mine = np.flatnonzero(self._of_extra == self.support[place] - len(self.pool))
            parts.append(self.extra[mine])
            owners.append(np.full(len(mine), place))
        owner = np.concatenate(owners)
        order = np.argsort(owner, kind="stable")
        return np.concatenate(parts)[order], owner[order]

    def _slopes(self, factor: Array) -> Array:
        """Return d of all candidates and points under C = F Fᵀ."""
        weighted = self.state.weight @ factor[: self.state.weight.shape[1]]
        reach = factor @ weighted.T
        inside = self.pool.squares(self.state.observation, reach)
        count = len(self.noise) - len(self.pool)
        beyond = np.bincount(self._of_extra, np.sum((self.extra @ reach) ** 2, axis=1), count)
        slopes: Array = np.concatenate([inside, beyond]) / self.noise
        return slopes


def _optimal(rows: Array, owner: NDArray[np.intp], state: State, weights: Array, costs: Array, limit: float) -> Array:
    """Return the weights (s,) that minimise J over costs·x = limit, x ≥ 0, by a primal-dual interior point method.

    rows : (m, n) divided by the noise; owner : (m,) to which reading each belongs, in order
    ∂²J = 2 (G S Gᵀ) ∘ (G S W S Gᵀ), summed over the rows of each reading, positive semidefinite as a product of such.
    """
    scale = limit / costs
    along = (rows * np.sqrt(scale[owner])[:, None]) @ state.factor
    weighted = state.weight @ state.factor[: state.weight.shape[1]]
    x = np.maximum(weights / scale, 1e-6 / len(weights))
    x /= x.sum()
    slopes = _curvatures(along, owner, weighted, x)[0]
    level = float(slopes @ x)
    dual = np.maximum(level - slopes, 0.05 * level)
    for _ in range(_NEWTON):
        slopes, bend = _curvatures(along, owner, weighted, x)
        barrier = _BARRIER * float(x @ dual) / len(x)
        residual = slopes - level + dual
        move, shift = _newton(bend + np.diag(dual / x), residual - dual + barrier / x)
        dual_move = barrier / x - dual - dual / x * move
        share = min(1.0, 0.95 * _room(x, move), 0.95 * _room(dual, dual_move))
        x, dual, level = x + share * move, dual + share * dual_move, level + share * shift
        x /= x.sum()
        if x @ dual < 1e-6 * abs(level) and np.abs(residual).max() < 1e-5 * abs(level):
            break
    result: Array = x * scale
    return result


def _curvatures(along: Array, owner: NDArray[np.intp], weighted: Array, x: Array) -> tuple[Array, Array]:
    """Return d = −∂J/∂x (s,) and ∂²J (s, s).  along : G F (m, r); owner : (m,) in 0…s−1; weighted : V F (w, r)."""
    scaled = along * np.sqrt(x[owner])[:, None]
    both = informed(np.vstack([along, weighted]), scaled)
    seen, reach = both[: len(along)], both[len(along) :]
    towards = seen @ reach.T
    target = towards @ towards.T
    slopes: Array = np.diagonal(target).copy()
    bend: Array = 2 * (seen @ seen.T) * target
    if len(x) < len(along):
        first = np.searchsorted(owner, np.arange(len(x)))
        slopes = np.add.reduceat(slopes, first)
        bend = np.add.reduceat(np.add.reduceat(bend, first, axis=0), first, axis=1)
    return slopes, bend


def _newton(system: Array, right: Array) -> tuple[Array, float]:
    """Solve system·move + shift·1 = right with Σ move = 0."""
    solved = np.linalg.solve(system, np.column_stack([right, np.ones(len(right))]))
    shift = float(solved[:, 0].sum() / solved[:, 1].sum())
    return solved[:, 0] - shift * solved[:, 1], shift


def _room(x: Array, move: Array) -> float:
    """Return how far x may go along a move before an entry vanishes."""
    falling = move < 0
    return float((x[falling] / -move[falling]).min(initial=1e300))
