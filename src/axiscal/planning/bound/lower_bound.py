"""How good any plan can be: a lower bound on J for all plans from a lattice, by convex relaxation.

The weights of `relaxation` and the matrix of `dual` bound every plan whose costs sum to no more than a limit. The
largest slope is looked for over the whole lattice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.criterion import Root
from axiscal.measurement.observation import directions_of
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.planning.bound.certificate import Dual, groups, rank_bound, zeros_each, zeros_of
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance

_ROUNDS = 60
"""Any round proves a bound, and rounds end where the gap is closed; this only ends what would go on."""
_CLOSE = 2e-3
_ROUGHLY, _CLOSELY, _OF_GAP = 1e-2, 1e-5, 0.03
"""Share of J by which weights may be off at first and at last, and of the gap between: of time, any round proves."""
_TURNS = 9
"""Turns over all candidates: of time. The bound rises by less and less."""
_OF_DISTANCE = 0.05
"""Where the weights of all are sought, what the bound could still rise by, as a share of how far off the plan is."""
_WIDE = 400
"""Directions of the target up to which all count: of time."""
_DROPPED = 1e-4
"""Share of the J of a plan that others may make: the bound is lower by that at most, and weights are rougher."""
_NOUGHT = 1e-300
"""No division by nought."""


@dataclass(frozen=True, eq=False, slots=True)
class Bound:
    """No plan has a smaller J.

    value : the bound; everywhere : whether it holds for any readings whatever, not only for those of the lattice
    """

    value: float
    everywhere: bool


def lower_bound(pool: Pool, state: Covariance, places: Places, costs: Array, limit: float) -> Bound:
    """Return the bound on J for plans from the pool and from `places` whose costs sum to no more than the limit.

    state : before the first reading; places : a good plan to begin with; costs : (M + places,), 1 each where readings
    are counted, or seconds
    """
    if not limit > 0:  # nothing is read
        return Bound(state.value, True)
    numbers = most_numbers(state, pool.lattice.setups, int(limit / costs.min() + 1e-9))
    by_rank = rank_bound(state, numbers)
    reached = state.after_readings(places).value if len(places) else 0.0
    relaxation = Relaxation(pool, with_main_directions(state, _DROPPED * reached), places, costs, limit)
    steps = list(settling(relaxation, reached))
    best = max(0.0, *(step.bound(numbers) for step in steps), _by_groups(relaxation, steps[-1], reached))
    return Bound(by_rank, True) if by_rank >= best else Bound(best, False)


def with_main_directions(state: Covariance, dropped: float, most: int = _WIDE) -> Covariance:
    """Return a state whose J counts fewer directions of the target: it is at most so much lower, and never higher.

    dropped : what J before the first reading may fall by, m²; most : directions up to which all are kept
    J is a sum over the rows of Uᵀ V F with any rotation U; those of the least singular values are left out.
    """
    target = state.weighted
    if len(target) <= most:
        return state
    values, turn = np.linalg.eigh(target @ target.T)
    kept = np.cumsum(np.maximum(values, 0.0)) > dropped
    return replace(state, root=Root(turn[:, kept].T @ state.root.matrix))


def _by_groups(whole: Relaxation, last: Round, plan: float) -> float:
    """Return the least of the bounds for plans that use all set-ups, and for those that use only some, with zeros.

    plan : J of a good one
    """
    everything, readings = whole.everything, int(whole.limit / whole.costs.min() + 1e-9)
    least, each = np.inf, zeros_each(whole.state, everything)
    for group in groups(everything.setups, readings):
        mine = np.isin(everything.setups, group)
        count = most_numbers(whole.state, group, int(whole.limit / whole.costs[mine].min() + 1e-9))
        zeros = zeros_of(each, group)
        if np.all(mine):
            least = last.dual.floor(last.spent, count, zeros)
            continue
        best = 0.0
        for step in _settling_of_some(whole, mine, plan):
            best = max(best, step.dual.floor(step.spent, count, zeros))
            if best >= least:
                break
        least = min(least, best)
    return least if np.isfinite(least) else 0.0


def _settling_of_some(whole: Relaxation, mine: NDArray[np.bool_], plan: float) -> Iterator[Round]:
    """Yield what the weights that some have in the whole prove for plans from these alone, then bring their own.

    Plans that use only some set-ups are mostly so much worse that the first is enough.
    """
    some = whole.within(mine)
    dual = some.weighted_as(whole, mine).dual()
    yield Round(dual, _slopes(some, dual)[1], last=True)
    yield from settling(some, plan)


class Round(NamedTuple):
    """A step towards the optimal weights.  spent : what Σ |Z b|² of a plan comes to at most; last : whether it is."""

    dual: Dual
    spent: float
    last: bool

    def bound(self, numbers: int) -> float:
        """Return the bound that it proves; only in the last step with a share of Z, and the rank of a plan."""
        return self.dual.floor(self.spent, numbers) if self.last else self.dual.whole - self.spent


def settling(relaxation: Relaxation, plan: float | None = None) -> Iterator[Round]:
    """Bring the weights to the optimum over all candidates, step by step.

    plan : J of a plan for which a bound is wanted, no matter by which weights, or 0; None where weights are wanted
    """
    closed, reached, close = 0.0, np.inf, _ROUGHLY
    for number in range(1, _ROUNDS + 1):
        dual = relaxation.solved(close)
        slopes, spent = _slopes(relaxation, dual)
        closed, reached = max(closed, dual.whole - spent), min(reached, dual.value)
        near = reached <= closed * (1 + _CLOSE) or number == _ROUNDS
        last = near or not relaxation.grow(slopes) or relaxation.largest
        if plan is not None and not near and relaxation.dear:
            yield Round(dual, spent, last=False)
            yield _over_all(relaxation, dual, slopes, plan)
            return
        if last and close > _CLOSELY:
            dual = relaxation.solved(_CLOSELY)
            _, spent = _slopes(relaxation, dual)
        yield Round(dual, spent, last)
        if last:
            return
        close = min(max(_OF_GAP * (reached / max(closed, _NOUGHT) - 1), _CLOSELY), _ROUGHLY)


def _over_all(relaxation: Relaxation, best: Dual, slopes: Array, plan: float) -> Round:
    """Return the best that weights of all candidates prove, in so few turns as the distance to a plan asks for."""
    closed, reached = -np.inf, np.inf
    for _, turn in zip(range(_TURNS), relaxation.over_all(slopes), strict=False):
        largest = float((turn.slopes / relaxation.costs[relaxation.support]).max())
        proven, reached = turn.dual.whole - relaxation.limit * largest, min(reached, turn.dual.value)
        if proven > closed:
            best, closed = turn.dual, proven
        if reached - closed <= max(_CLOSE * closed, _OF_DISTANCE * (plan - reached)):
            break
    _, spent = _slopes(relaxation, best)
    return Round(best, spent, last=True)


def _slopes(relaxation: Relaxation, dual: Dual) -> tuple[Array, float]:
    """Return the slopes of all candidates, and what Σ |Z b|² of a plan comes to at most."""
    slopes = relaxation.slopes(dual)
    return slopes, relaxation.limit * float((slopes / relaxation.costs).max())


def most_numbers(state: Covariance, setups: Iterable[int], readings: int) -> int:
    """Return how many numbers so many readings of some set-ups bring at most."""
    each = [len(directions_of(state.observation.setups[setup])) for setup in set(setups)]
    return readings * max(each, default=1)
