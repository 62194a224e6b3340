"""Readings for the minutes that there are, chosen and put in order together.

A tour begins at a random candidate of each set-up. The candidate with the most gain per second^α enters at its cheapest
place until no second is left, and 2-opt shortens the way meanwhile. Then readings leave one at a time, and what gains
most within the minutes takes their place. α and the gains are drawn anew for each of several tours. The best one moves
off the lattice within its minutes.

An accuracy is the dual of that: one tour grows until it reaches it, several share its minutes, and these are bisected
until the best one just reaches it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from axiscal.measurement.reading import Places
from axiscal.planning.plan.exchange import Minutes, relocated
from axiscal.planning.plan.greedy import Setups, of_best_size, openings, scores_among
from axiscal.planning.plan.order import seconds_along, seconds_around, set_ups_in_order
from axiscal.planning.plan.run import Ways
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Goal, Limits, Patience, Task, work_of_climb
from axiscal.planning.plan.tour import Tour
from axiscal_core.ties import ALIKE, first_best, ranked

_STARTS, _SEED = 8, 1
"""Tours that are begun for one set of set-ups; any seed: a plan is the same every time."""
_POWERS, _SHAKEN = (0.2, 1.0), 0.3
"""Between which α is drawn, and the standard deviation of the logarithm of gains: starts differ by them."""
_SWEEPS, _SETTLED, _BETTER = 20, 3e-4, 1e-7
"""Sweeps of swaps at most; share of J that one must gain to be followed by another; rounding of a gain."""
_WORTH = 1e-2
"""Share by which a swap must gain more while minutes are bisected: of speed."""
_ROUNDS = 3
"""Rounds of swaps and climbs at most: each begins where the one before left the lattice."""
_WORK, _SHARES = 1e10, 4
"""Operations after which no tour is begun, and the part of them for one round of swaps: by work, not by the clock, for
the same plan anywhere."""
_CLIMBS = 6e9
"""Operations of climbs after which no other tour is brought off the lattice: a large plan is one of them."""
_BESIDE = 6e8
"""Operations after which no other tour is begun for a target: the one that has grown to it is nearly as good."""
_GROWTH, _MORE, _POWER = 1.4, 2, 1.0
"""Times as many readings and so many more with which a growing tour is looked at, and its α."""
_FEW, _STALLED = 50, 1e-3
"""Readings from which on twice as many must bring this share of J, or an accuracy is given up; so must set-ups more."""
_SHORTER, _JUST, _TRIED = 0.03, 0.015, 12
"""Share of the minutes that is saved first, the share of them that bisection leaves open, and its steps at most."""


def toured(task: Task, limits: Limits, sets: Iterable[Setups], patience: float) -> Places:
    """Return readings for a budget in their order.

    sets : of set-ups, of which each can be mounted within the budget; patience : operations that climbs may take
    """
    coarse, first = task.coarse, dict[Setups, Tour]()

    def begun(setups: Setups) -> Callable[[int], Tour]:
        return partial(_begun, task.patience > 0, limits, *_base(coarse, setups), setups)

    def left(setups: Setups) -> float:
        first[setups] = first.get(setups) or begun(setups)(0)
        return first[setups].scores.value

    setups = of_best_size(sets, left)
    left(setups)
    if not task.patience:
        return set_ups_in_order(task, first[setups].places)
    return _climbed(task, limits, _all_begun([first[setups]], begun(setups), _WORK), patience)


def _climbed(task: Task, limits: Limits, tours: Sequence[Tour], patience: float) -> Places:
    """Return what the best of some tours become off the lattice, where the best one may not stay the best.

    tours : the best first
    """
    climb, done, found = _ROUNDS * work_of_climb(task.belief.size, task.belief.size), 0.0, list[Places]()
    for tour in tours:
        if done > _CLIMBS:
            break
        found.append(retoured(task, limits, tuple(tour.runs), tour.places, patience))
        done += climb * len(tour.places)
    return found[first_best(-np.array([task.after(each).value for each in found]), ALIKE)]


def quickest(task: Task, limits: Limits, sets: Iterable[Setups], goal: Goal, patience: float) -> Places | None:
    """Return readings in their order that reach an accuracy in the least time; None where none do within limits.

    sets : of set-ups that grow; patience : operations that climbs may take
    """
    if goal.reached(nothing := Places.none(task.lattice.poses.shape[1])):
        return nothing
    coarse = task.coarse
    longest, endless = np.inf if limits.budget is None else limits.budget, replace(limits, budget=None)
    best, short = None, np.inf
    for setups in sets:
        opened = _opened(endless, *_base(coarse, setups), setups, np.random.default_rng(_SEED))
        if opened.seconds >= longest:
            break
        found = _grown(opened, goal, longest)
        if found is None:
            before, short = short, opened.scores.value
            if not limits.rows and before - short <= _STALLED * short:
                break  # a row may need a set-up that hardly lowers J
        elif found.seconds < longest:
            best, longest = found, found.seconds
    if best is None:
        return None
    if not task.patience:
        return set_ups_in_order(task, best.places)
    setups = tuple(best.runs)
    begun = partial(_begun, True, replace(limits, budget=longest), *_base(coarse, setups), setups)
    tour, *_ = _all_begun([best], begun, _BESIDE)
    tour = _shortest(tour, goal, partial(_settled, better=_WORTH)) if goal.reached(tour.places) else best
    return retoured(task, limits, setups, tour.places, patience, goal=goal)


def grown(task: Task, limits: Limits, setups: Setups, left: Places, goal: Goal, longest: float) -> Places | None:
    """Return readings that begin with those of another plan and reach an accuracy; None where none do within limits.

    longest : seconds
    """
    tour = _grown(Tour.through(*_base(task, setups), setups, limits, left), goal, longest)
    return None if tour is None else tour.places


def retoured(
    task: Task,
    limits: Limits,
    setups: Setups,
    left: Places,
    patience: float,
    better: float = _BETTER,
    goal: Goal | None = None,
) -> Places:
    """Return readings for a budget in their order that begin with those of another plan.

    left : in their order; better : share by which what takes their place must gain more
    goal : an accuracy that they reach, or nearly do: of the least time then
    """
    task, (ways, scores) = task.among(setups), _base(task, setups)
    patient, through = Patience(patience), partial(Tour.through, ways)
    tour, settle = through(scores.fork(), setups, limits, left), partial(_settled, better=better)
    tour.cut()
    if goal is not None:
        tour = _grown(tour, goal, tour.budget) or tour
        tour.budget = tour.seconds
    kept = goal.reached if goal is not None and goal.reached(tour.places) else None
    for _ in range(_ROUNDS):
        before, settled = tour.scores.value, tour.within(tour.budget)
        settle(settled)
        if kept is None or kept(settled.places):  # a swap that lowers J may lose a row
            tour = settled
        if patient.spent or not len(tour.scores.places):
            break
        patient.take(work_of_climb(task.belief.size, task.belief.size) * len(tour.scores.places))
        moved = relocated(task, tour.places, Minutes(tour.budget, partial(seconds_around, task)))
        climbed = through(scores.fork(), setups, replace(limits, budget=tour.budget), moved)
        fits = climbed.left >= 0 and (goal is None or goal.reached(climbed.places))
        if fits:
            tour = (tour, climbed)[first_best(-np.array([each.scores.value for each in (tour, climbed)]), ALIKE)]
        if before - tour.scores.value <= _SETTLED * before:
            break
    if goal is not None:
        tour = _shortest(tour, goal, partial(_settled, better=max(better, _WORTH)))
    hard = tour.budget if goal is None else np.inf if limits.budget is None else limits.budget
    while len(tour.scores.places) > 1 and seconds_along(task, tour.places) > hard:  # ways may lead aside
        tour.drop()
    return set_ups_in_order(task, tour.places)


def stretched(task: Task, setups: Setups, left: Places, most: int, budgets: Sequence[float]) -> Iterator[Places]:
    """Yield readings for each budget that begin with those of another plan: fewer of them, or more, none exchanged.

    left : in their order; most : readings; budgets : rising
    """
    whole = tour = Tour.through(*_base(task, setups), setups, Limits(most), left)
    cut = {budget: (tour := tour.within(budget)) for budget in reversed(budgets)}  # each from the longer one
    for budget, shorter in reversed(cut.items()):
        other = whole.within(budget) if len(shorter.scores.places) == len(left) else shorter
        other.fill(np.random.default_rng(_SEED), _POWER, 0.0)
        whole = other if other is not shorter else whole
        yield other.places


def _base(task: Task, setups: Setups) -> tuple[Ways, Scores]:
    scores, whole = scores_among(task, setups), np.sort(task.lattice.setups)
    return Ways(task, scores.lattice, np.isin(whole, setups)), scores


def _all_begun(tried: list[Tour], begun: Callable[[int], Tour], work: float) -> list[Tour]:
    """Return tours and further ones, the best first.  begun : the one of a number; work : after which none is"""
    while len(tried) < _STARTS and sum(tour.work for tour in tried) < work:
        tried.append(begun(len(tried)))
    return [tried[k] for k in ranked(-np.array([tour.scores.value for tour in tried]), ALIKE)]


def _begun(settled: bool, limits: Limits, ways: Ways, scores: Scores, setups: Setups, number: int) -> Tour:
    """Return a tour that began at random candidates.

    settled : with swaps, from drawn gains; else what enters gains most per second
    scores : before the first; number : of the start
    """
    rng = np.random.default_rng([_SEED, number])
    power, shaken = (float(rng.uniform(*_POWERS)), _SHAKEN) if settled else (_POWER, 0.0)
    tour = _opened(limits, ways, scores, setups, rng)
    tour.fill(rng, power, shaken)
    if settled:
        _settle(tour, rng, power, shaken, _BETTER)
    return tour


def _opened(limits: Limits, ways: Ways, scores: Scores, setups: Setups, rng: np.random.Generator) -> Tour:
    """Return a tour of a random candidate of each set-up, and of those that open what these leave open."""
    tour = Tour(ways, scores.fork(), setups, limits)
    for setup in setups[: tour.most]:
        tour.enter(int(rng.choice(ways.of[setup])))
    _, opened = openings(tour.scores, setups, tour.most - len(tour.scores.places))
    for index in opened:
        tour.enter(index)
    tour.cut()
    return tour


def _grown(tour: Tour, goal: Goal, longest: float) -> Tour | None:
    """Return a tour that goes on until it reaches an accuracy; None where it cannot within longest seconds."""
    rng, most, earlier = np.random.default_rng(_SEED), tour.most, dict[int, float]()
    tour.budget = longest
    while not goal.reached(tour.places):
        count, value = len(tour.scores.places), tour.scores.value
        half = max((before for before in earlier if 2 * before <= count), default=None)
        if half is not None and count > _FEW and earlier[half] - value <= _STALLED * value:
            return None
        earlier[count] = value
        tour.most = min(int(_GROWTH * count) + _MORE, most)
        tour.fill(rng, _POWER, 0.0)
        tour.most = most
        if len(tour.scores.places) == count:
            return None
    return _shortest(tour, Goal(goal.reached, goal.reached), _as_cut) if earlier else tour


def _as_cut(tour: Tour) -> None:
    """Leave a tour as it is."""


def _shortest(tour: Tour, goal: Goal, settle: Callable[[Tour], None]) -> Tour:
    """Return the tour of the least time that surely reaches an accuracy, by bisection; the same where none does.

    settle : makes the most of less time
    """
    if not goal.surely(tour.places):
        return tour
    mounted = sum(run.mounting for run in tour.runs.values() if len(run.slots))
    low, high, saved = 0.0, tour.seconds - mounted, _SHORTER
    for _ in range(_TRIED):
        if high - low <= _JUST * high:
            break
        middle, saved = (low + high) / 2 if low else (1 - saved) * high, min(2 * saved, 0.5)
        shorter = tour.within(mounted + middle)
        settle(shorter)
        if len(shorter.scores.places) and goal.surely(shorter.places):
            tour, high = shorter, min(shorter.seconds - mounted, middle)
        else:
            low = middle
    tour.budget = min(tour.budget, tour.seconds)
    return tour


def _settled(tour: Tour, better: float = _BETTER) -> None:
    _settle(tour, np.random.default_rng(_SEED), 1.0, 0.0, better)


def _settle(tour: Tour, rng: np.random.Generator, power: float, shaken: float, better: float) -> None:
    """Swap and fill until a sweep gains little, or there was much to do."""
    most = tour.work + _WORK / _SHARES
    for _ in range(_SWEEPS):
        before = tour.scores.value
        if better < np.inf:
            tour.swap(better, most)
        tour.shorten()
        tour.fill(rng, power, shaken)
        if before - tour.scores.value <= _SETTLED * before or tour.work > most:
            return
