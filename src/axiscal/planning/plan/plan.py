"""A plan: which set-ups, which readings in each, in which order, how long, and how good.

    plan = make_plan(task, Limits(readings=40))
    plan.places.poses[0], plan.accuracy.rms, plan.seconds

Tours of `minutes` plan for a budget, and for an accuracy in the fewest minutes. For so many readings exchange chooses
them together. It improves a greedy, a space-filling and an evenly spaced design; the best result is the plan. So no
such plan is worse than one of these.

While measuring, `renewed` plans the rest: from the readings that are still open, by what exchanges still help. Readings
of linear instruments sharpen a belief by their places, not by their values. So the rest of a plan is still the plan, as
long as each reading is accepted at its planned place. Otherwise the search here begins with it, so that the renewed
plan is no worse than the old one, and little has to be looked at.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.exceptions import PlanError
from axiscal.language.stages import stage
from axiscal.measurement.reading import Places
from axiscal.measurement.travel import reading_seconds
from axiscal.planning.plan.beginnings import plain_designs
from axiscal.planning.plan.exchange import ROUNDS, SWEEPS, exchange, polish
from axiscal.planning.plan.greedy import Setups, chosen_setups, filled, scores_among, sets_within
from axiscal.planning.plan.irregular import irregular
from axiscal.planning.plan.minutes import grown, quickest, retoured, toured
from axiscal.planning.plan.order import arriving, in_order, interleaved, seconds_along, seconds_each
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import PATIENCE, Goal, Limits, Patience, Task, clock
from axiscal.planning.promise import FEW
from axiscal_core.normal import condition
from axiscal_core.rank_bound import rank_bound, worth_saying
from axiscal_core.threads import one_thread
from axiscal_core.ties import ALIKE, first_best, ranked

_SWEEPS = 3
_WORTH = 0.01
"""An exchange must bring a hundredth more than the reading it replaces: less is not worth another way."""
_ROUNDS_OF_RENEWAL = 2
_FAR = 40
"""Readings more that are tried before a plan of other set-ups, or for as long as mounting these takes."""


def renewed(
    task: Task, limits: Limits, left: Places, patience: float = 0.0, goal: Goal | None = None, usual: bool = False
) -> Places:
    """Return the readings to come in their order, from those that are left of a plan and within its set-ups.

    limits : what is left of them; patience : operations that climbing off the lattice may take
    goal : an accuracy to reach; usual : with what usually goes wrong: what is new is interleaved with the rest
    None are returned where there is no time for any of these set-ups, or they fall short by much and others do not.
    """
    left = _mountable(task, limits, left)
    mounted = [] if task.here is None else task.here.setups.tolist()
    setups, order = tuple(sorted({*mounted, *left.setups.tolist()})), left
    within = tuple(setup for setup in setups if setup in task.lattice.setups)
    if not within:
        return replace(order, approaches=arriving(task, order))
    reaching = None if goal is None else _reaching(task, limits, within, left, goal)
    if reaching is None and goal is not None and _others_reach(task, limits, within, goal):
        return Places.none(left.poses.shape[1])
    hurried = _hurried(task, limits)
    if reaching is not None:
        found = retoured(task, limits, _those_of(reaching), reaching, patience, _WORTH, goal)
        order = _ordered(task, limits, found, left, usual)
    elif not hurried:
        few = None if goal is None else max(len(left), FEW)  # sizes are learnt anew by then
        most = min((each for each in (few, limits.readings) if each is not None), default=None)
        places = _renewed(task, Limits(most), setups, left, patience)
        order = _ordered(task, limits, in_order(task, places), left, usual)
    if reaching is None and (hurried or _too_long(task, limits, order)):
        order = _ordered(task, limits, retoured(task, limits, within, left, patience, _WORTH), left, usual)
    return replace(order, approaches=arriving(task, order))


def _reaching(task: Task, limits: Limits, setups: Setups, left: Places, goal: Goal) -> Places | None:
    """Return readings of these set-ups that reach an accuracy; None where they fall short and others may not.

    Those of the set-up that is mounted do alone where that takes less time.
    """
    others, longest = np.setdiff1d(task.lattice.setups, setups), np.inf if limits.budget is None else limits.budget
    if len(others):
        times, spent = clock(task), seconds_along(task, left)
        mounted = float((times.mounting(others) + times.reading(others)).max())
        longest = min(longest, spent + max(mounted, _FAR * float(times.reading(setups).min())))
    reached = goal.reached(left) and seconds_along(task, left) <= longest
    found = left if reached else grown(task, limits, setups, left, goal, longest)
    here: Setups = () if task.here is None else (int(task.here.setups[0]),)
    if here == setups or not np.isin(here, setups).any():
        return found
    longest = longest if found is None else seconds_along(task, found)
    alone = grown(task, limits, here, left.within(np.isin(left.setups, here)), goal, longest)
    return alone if alone is not None and seconds_along(task, alone) < longest else found


def _others_reach(task: Task, limits: Limits, setups: Setups, goal: Goal) -> bool:
    """Return whether all set-ups together reach an accuracy that these do not."""
    everything = tuple(np.unique(task.lattice.setups).tolist())
    if set(everything) <= set(setups):
        return False
    none = Places.none(task.lattice.poses.shape[1])
    return grown(task.coarse, limits, everything, none, goal, np.inf) is not None


def _those_of(places: Places) -> Setups:
    return tuple(np.unique(places.setups).tolist())


def _renewed(task: Task, limits: Limits, setups: Setups, left: Places, patience: float) -> Places:
    """Return as many readings to come of these set-ups as there may be, in any order."""
    scores = scores_among(task, setups)
    scores.put_all(left)
    most = len(left) if limits.readings is None else limits.readings
    while len(scores.places) > most:
        scores.leave(first_best(-scores.losses(), ALIKE))
    scores = filled(scores, most, setups)
    exchange(scores, _SWEEPS, _WORTH)
    polish(scores, _ROUNDS_OF_RENEWAL, Patience(patience))
    return scores.places


def _hurried(task: Task, limits: Limits) -> bool:
    """Return whether minutes decide: there is no other limit, or no time for as many readings as there may be."""
    if limits.budget is None:
        return False
    quickest = min(reading_seconds(setup) for setup in task.observation.setups)
    return limits.readings is None or limits.readings * quickest > limits.budget


def _too_long(task: Task, limits: Limits, order: Places) -> bool:
    return limits.budget is not None and seconds_along(task, order) > limits.budget


def _ordered(task: Task, limits: Limits, order: Places, left: Places, usual: bool) -> Places:
    """Return readings in their order: as it was where it holds the same ones, and a way out and back takes no less."""
    same = order.same_as(left)
    if same and (usual or seconds_along(task, left) <= seconds_along(task, order)):
        return left
    return interleaved(task, limits, order) if usual else order


def _mountable(task: Task, limits: Limits, left: Places) -> Places:
    """Return the readings of the set-ups that there is time to mount, one after another."""
    first, spent, kept = first_seconds(task), 0.0, set[int]()
    for setup in dict.fromkeys(left.setups.tolist()):
        if limits.budget is None or spent + first.get(setup, 0.0) <= limits.budget:
            spent += first.get(setup, 0.0)
            kept.add(setup)
    return left.within(np.isin(left.setups, list(kept)))


MANY = 150
"""Readings of a plan at most that nothing else ends: what is known by then plans the others."""
_MUCH = 1e9
"""Operations of exchange from which on only the best beginning is swept, or goes on after its first sweep."""


@dataclass(frozen=True, eq=False, slots=True)
class PlannedReading:
    """Accuracy and elapsed seconds after a reading of a plan.  value : J"""

    value: float
    accuracy: Accuracy
    seconds: float


@dataclass(frozen=True, eq=False, slots=True)
class Plan:
    """Readings in the order of a short way, set-up by set-up.

    places : from the sides from which the machine comes to them; readings : what each of them leaves
    value : J after the last; before : the accuracy now
    bound : RMS that no plan of as many readings can beat, m; None where it is below half of this one's
    checks : indices of readings that were drawn at random
    """

    places: Places
    readings: tuple[PlannedReading, ...]
    value: float
    before: Accuracy
    bound: float | None
    checks: frozenset[int] = frozenset()

    @property
    def accuracy(self) -> Accuracy:
        """The figures after the last reading."""
        return self.readings[-1].accuracy if self.readings else self.before

    @property
    def seconds(self) -> float:
        """The time of the whole plan."""
        return self.readings[-1].seconds if self.readings else 0.0


@one_thread()
def make_plan(
    task: Task,
    limits: Limits,
    *,
    goal: Goal | None = None,
    patience: float = PATIENCE,
    usual: bool = False,
) -> Plan:
    """Return a plan that ends at the first limit it reaches. Raises PlanError.

    goal : the accuracy that limits ask for; it is reached in the fewest minutes
    patience : operations that climbing off the lattice may take; the same plan on any machine, and under any load
    usual : with what usually goes wrong: places keep no regular distances, and their order is interleaved
    """
    refuse_unplannable(task, limits)
    order = None if goal is None else _in_minutes(task, limits, patience, usual, goal)
    if order is None and limits.readings is limits.budget is None:
        limits = replace(limits, readings=MANY)
    if order is None and not _hurried(task, limits) and (task.patience or not limits.timed):
        order = _any_time(task, limits, patience, usual)
    if order is None or _too_long(task, limits, order):
        order = _in_minutes(task, limits, patience, usual)
    places = Places.none(task.lattice.poses.shape[1]) if order is None else order
    return judged(task, replace(places, approaches=arriving(task, places)))


def _any_time(task: Task, within: Limits, patience: float, usual: bool) -> Places:
    """Return as many readings as there may be in their order, however long they take.

    They are interleaved within a budget.
    """
    limits = replace(within, budget=None)
    with stage("which set-ups"):
        setups = chosen_setups(task, limits)
    task = task.among(setups)
    with stage("readings chosen together"):
        scores = _together(task, within.readings or MANY, setups)
    with stage("places between the steps"):
        polish(scores, ROUNDS, Patience(patience))
    order = in_order(task, irregular(task, limits, scores.places) if usual and len(scores.places) else scores.places)
    return interleaved(task, within, order) if usual else order


def _in_minutes(task: Task, limits: Limits, patience: float, usual: bool, goal: Goal | None = None) -> Places | None:
    """Return readings in their order that a budget has time for, or of the least time to an accuracy.

    None where no readings within limits reach it.
    """
    with stage("which set-ups"):
        sets = sets_within(task, limits)
    with stage("readings chosen together"):
        order = toured(task, limits, sets, patience) if goal is None else quickest(task, limits, sets, goal, patience)
        if not usual or order is None or not len(order):
            return order
        task = task.among(_those_of(order))
        return interleaved(task, limits, irregular(task, limits, order, goal))


def refuse_unplannable(task: Task, limits: Limits) -> None:
    """Raise PlanError for limits within which nothing can be planned: none, no place, too short a budget."""
    if limits == Limits():
        raise PlanError("nothing would ever end this plan", "Say how many readings, which accuracy or how much time")
    if not len(task.lattice):
        raise PlanError("there is no place where a reading may be taken", "Allow an axis to move, or add a set-up")
    first = first_seconds(task)
    quickest = min(first, key=lambda setup: first[setup])
    if limits.budget is not None and limits.budget < first[quickest]:
        what = '{given:.3g} min is less than the {needed:.3g} min that the first reading takes with "{setup}"'
        remedy = "Allow more time, or give a set-up that is mounted faster"
        setup = task.observation.setups[quickest].name
        raise PlanError(what, remedy, given=limits.budget / 60, needed=first[quickest] / 60, setup=setup)


def _together(task: Task, readings: int, setups: Setups) -> Scores:
    """Return the best of what exchange makes of several beginnings with the same number of readings per set-up."""
    base = scores_among(task, setups)
    tried = [filled(base.fork(), readings, setups)]
    if not task.patience:
        exchange(tried[0], 1)
        return tried[0]
    counts = [(s, int(np.sum(tried[0].places.setups == s))) for s in setups]
    tried += [base.fork().put_all(begun) for begun in plain_designs(task, counts)]
    done = 0.0
    for sweeps in (1, SWEEPS):
        for place, scores in enumerate(_best_first(tried)):
            if place == 0 or done < _MUCH:
                done += exchange(scores, sweeps)
    return _best_first(tried)[0]


def _best_first(tried: Sequence[Scores]) -> list[Scores]:
    return [tried[k] for k in ranked(-np.array([scores.value for scores in tried]), ALIKE)]


def judged(task: Task, places: Places) -> Plan:
    """Return the plan of readings in their order: what each leaves, and what no plan could beat."""
    state = task.state
    before = task.yardstick.measure_factor(state.known)
    ends = np.cumsum(seconds_each(task, places)).tolist()
    known = zip(_after_each(task, places), ends, strict=True)
    readings = tuple(PlannedReading(value, accuracy, seconds) for (value, accuracy), seconds in known)
    value = readings[-1].value if readings else state.value
    seen = task.yardstick.root @ state.known[: task.yardstick.errors.size]
    numbers = len(places) * max(len(setup.names) for setup in task.observation.setups)
    bound = task.yardstick.rms_of(rank_bound(seen @ seen.T, numbers))
    rms = readings[-1].accuracy.rms if readings else before.rms
    return Plan(places, readings, value, before, worth_saying(bound, rms))


_TOGETHER = 80
"""Readings that are taken in at once: of speed, not of the result."""


def _after_each(task: Task, order: Places) -> Iterator[tuple[float, Accuracy]]:
    """Yield J and the accuracy after each of many readings."""
    state = task.state
    for start in range(0, len(order), _TOGETHER):
        part = order.within(slice(start, start + _TOGETHER))
        n = task.numbers(part)
        state = state.opened(n)
        rows, none = state.wide(n), np.zeros(len(n.rows), dtype=np.intp)
        root, *_, losses = condition(state.root, np.zeros(len(state.root)), rows, np.zeros(len(rows)), n.noise**2, none)
        ends = np.searchsorted(n.place, np.arange(len(part)), side="right")
        values = state.value - np.cumsum(np.sum((task.root @ losses.T[: task.root.shape[1]]) ** 2, axis=0))[ends - 1]
        yield from zip(values.tolist(), task.yardstick.accuracies(state.root, losses, ends), strict=True)
        state = state.opened(n)
        state.root = root
