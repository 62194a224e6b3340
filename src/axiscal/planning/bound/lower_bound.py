"""How good any plan can be: a lower bound on J for all plans from a lattice, by convex relaxation.

The weights of `relaxation` and the matrix of `dual` bound every plan whose costs sum to no more than a limit. The
largest slope is looked for over the whole lattice.

`prove` bounds J for readings anywhere, not only on a lattice. The matrix Z of `certificate` bounds every plan once Σ |Z
b|² over its readings is bounded. Between knots |Z b(t)|² is a polynomial of where a reading is taken, along axes and
charts alike (`ground`); boxes with its Bernstein coefficients enclose the largest (`largest_value`). The hills found on
the way join the weighted plan, until no place is worth more than those that have weight. The rests of cells are taken
as known: that can only lower the bound. In floating point, with a margin for rounding, without intervals.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.yardstick import Root
from axiscal.language.stages import stage
from axiscal.measurement.instrument import values_of
from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.numerics.bernstein import Heights, largest_value, patches
from axiscal.planning.bound.boxes import by_boxes
from axiscal.planning.bound.certificate import Dual, groups, rank_bound, zeros_each, zeros_of
from axiscal.planning.bound.relaxation import Relaxation
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.step.ground import Region, regions
from axiscal_core.threads import one_thread

_ROUNDS = 60
"""Any round proves a bound, and rounds end where the gap is closed; this only ends what would go on."""
_CLOSE = 2e-3
_ROUGHLY, _CLOSELY, _OF_GAP = 1e-2, 1e-5, 0.03
"""Share of J by which weights may be off at first and at last, and of the gap between: of time, any round proves."""
_TURNS = 30
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
    return Covariance.from_factor(state.observation, state.factor, Root(turn[:, kept].T @ state.root.matrix))


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
    each = [values_of(state.observation.setups[setup]) for setup in set(setups)]
    return readings * max(each, default=1)


GAP = 1e-2
_ROUNDS_OF_PROOF = 40
"""Any round proves a bound, and rounds end where the gap is closed; this only ends what would go on."""
_PATIENCE, _CLOSED = 4, 0.9
"""The search ends where so many rounds leave more than this share of the gap open: more would not close it."""
_GONE = 1e-5
"""A weight of this share is none; it can enter again."""
_NOTHING = 1e-9
"""Share of the largest singular value: its square is rounding."""
_HIGH, _TRIED = 0.8, 200
"""Hills are climbed from nodes of at least this share of the level, so many at most; the bound is the same."""
_FINER, _FINEST = 3.0, 8
"""Hills are climbed on grids of three by three, each so much finer: in the end to a thousandth of a box."""
_ADDED = 24
"""Places that enter at once: more make fewer, longer rounds to the same weights."""
_NEAR = 0.01
"""Shares of the travel: places nearer than this enter one after the other."""


@dataclass(frozen=True, eq=False, slots=True)
class Proof:
    """A bound on J for readings anywhere in the travels, and the share of it at which closing the gap stopped."""

    bound: Bound
    gap: float


@one_thread()
@stage("the proof")
def prove(state: Covariance, lattice: Places, places: Places, gap: float = GAP) -> Proof:
    """Return the bound for as many readings as a plan has of all set-ups of a lattice, wherever they are taken.

    Along one coordinate boxes close what weights leave open between the bound and the plan.
    state : before the first; lattice : candidates to begin with; places : a good plan; gap : share of J to stop at
    Raises PlanError where readings of a set-up cannot be cut into boxes.
    """
    setups, count = [int(s) for s in np.unique(lattice.setups)], len(places)
    everywhere = [region for setup in setups for region in regions(state.observation, setup)]
    if not count:
        return Proof(Bound(state.value, True), 0.0)
    best, closed, reached, numbers = 0.0, 0.0, np.inf, most_numbers(state, setups, count)
    open_ones: list[float] = []
    lattice = _begun(state, lattice, places)
    for _ in range(_ROUNDS_OF_PROOF):
        relaxation = _everywhere(state, lattice, count)
        dual = relaxation.solved()
        level = float(relaxation.slopes(dual) @ relaxation.weights) / count
        kept = relaxation.pool.lattice.within(relaxation.weights > _GONE * count)
        found = [largest_seen(region, dual.reach, level, gap) for region in everywhere]
        spent = count * max(each.upper for each in found)
        best = max(best, dual.floor(spent, numbers))
        closed, reached = max(closed, dual.whole - spent), min(reached, dual.value)
        left = reached / closed - 1 if closed > 0 else np.inf
        steeper = Places.joined([each.places for each in found])
        open_ones.append(left)
        stalled = len(open_ones) > _PATIENCE and left > _CLOSED * open_ones[-1 - _PATIENCE]
        if left <= gap or not len(steeper) or stalled:
            break
        lattice = Places.joined([kept, steeper])
    if all(len(region.degree) == 1 for region in everywhere):
        known = state.after_readings(places).value
        if best * (1 + gap) < known:
            best = max(best, by_boxes(state, everywhere, places, known / (1 + gap), numbers))
        left = known / max(best, _NOUGHT) - 1
    return Proof(Bound(best, True), max(left, 0.0))


def _begun(state: Covariance, lattice: Places, places: Places) -> Places:
    """Return the candidates that have weight where only those of a lattice, and a plan, may be taken."""
    pool, count = Pool(state.observation, lattice), len(places)
    relaxation = Relaxation(pool, state, places, np.ones(len(pool) + count), float(count), rests=False)
    for _ in settling(relaxation):
        pass
    return relaxation.weighty


def _everywhere(state: Covariance, lattice: Places, count: int) -> Relaxation:
    pool = Pool(state.observation, lattice)
    relaxation = Relaxation(pool, state, lattice.within(slice(0, 0)), np.ones(len(lattice)), float(count), rests=False)
    relaxation.begin_everywhere()
    return relaxation


class Largest(NamedTuple):
    """No |g reach|² is above upper; places : hills of it above a level, the highest first."""

    upper: float
    places: Places


def largest_seen(region: Region, reach: Array, level: float, gap: float) -> Largest:
    """Enclose the largest |g reach|² of readings over a region, all their numbers together, over their variance.

    reach : (n, w); level, gap : what is not above the level by a quarter of the gap is not followed
    """
    observation, setup = region.ground.observation, region.ground.setup
    short = _short(reach / observation.setups[setup].noise)

    def heights(places: Array) -> Array:
        return np.asarray(np.sum((region.rows(places) @ short) ** 2, axis=(1, 2)))

    whole = patches(heights, region.low, region.high, region.degree)
    order = np.argsort(-whole.heights, kind="stable")[:_TRIED]
    order = order[whole.heights[order] > _HIGH * level]
    tops, lengths = _climbed(heights, whole.places[order], whole.low[order], whole.high[order])
    known = max(level, float(lengths.max(initial=0.0)))
    found = largest_value(whole, known, max(gap, known / level - 1) / 4)
    if found.lower > known:
        tops, lengths = np.vstack([tops, found.place]), np.append(lengths, found.lower)
    highest = np.argsort(-lengths, kind="stable")[: int(np.sum(lengths > level * (1 + gap / 8)))]
    poses, approaches = region.as_poses(tops)
    spans = np.array([axis.length for axis in observation.machine.axes])
    chosen = scattered(np.hstack([poses / spans, approaches]), highest, _ADDED, _NEAR)
    return Largest(found.upper, Places.of_setup(setup, poses[chosen], approaches[chosen]))


def scattered(places: Array, order: NDArray[np.intp], most: int, apart: float) -> list[int]:
    """Return the first places of an order that are no neighbours of each other; `most` at the most.

    places : (m, k); apart : neighbours are no further from each other than that along any coordinate
    """
    chosen = list[int]()
    for i in order.tolist():
        if len(chosen) == most:
            break
        if np.all(np.abs(places[chosen] - places[i]).max(axis=1, initial=0.0) > apart):
            chosen.append(i)
    return chosen


def _short(reach: Array) -> Array:
    """Return a matrix (n, r) along which all rows are as long to rounding, with no more columns than it takes."""
    turned, sizes, _ = np.linalg.svd(reach, full_matrices=False)
    kept = sizes > _NOTHING * sizes[0]
    short: Array = turned[:, kept] * sizes[kept]
    return short


def _climbed(heights: Heights, places: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Return the hills of boxes near places (m, size), and how high they are, (m,).  low, high : (m, size) of boxes"""
    moves = np.array(list(product((0.0, -1.0, 1.0), repeat=places.shape[1])))
    step = (high - low) / 2
    for _ in range(_FINEST):
        step = step / _FINER
        tried = np.clip(places[:, None] + moves * step[:, None], low[:, None], high[:, None])
        best = heights(tried.reshape(-1, places.shape[1])).reshape(len(places), len(moves)).argmax(axis=1)
        places = tried[np.arange(len(places)), best]
    return places, heights(places)
