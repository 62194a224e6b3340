"""Readings chosen together: greedy among candidates, exchanged one for one, then moved off the candidates.

A greedy choice takes what serves most now and is never sorry. An exchange takes each reading out in turn and puts in
what then serves most, until nothing changes (Fedorov 1972). Several starts find several ends; the best one climbs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal_core.criterion import Criterion, Goal
from axiscal_core.from_scipy import chi_square_quantile
from axiscal_core.gains import Gains, own_numbers
from axiscal_core.model import Model, Numbers
from axiscal_core.places import Places, Readings
from axiscal_core.rank_bound import rank_bound, worth_saying
from axiscal_core.refusals import Array, InputError, whole, within
from axiscal_core.state import State, joined
from axiscal_core.step import begun, climbed, gains_of
from axiscal_core.threads import one_thread
from axiscal_core.units import METRES, Quantity, in_minutes, si

_STARTS = 12  # beside the greedy one: with 3 J of eight drawn plans is up to 1.3 times as large, with 24 up to 8 % less
_CLIMBED = 3  # of what they end in: the best on the candidates is not always the best off them
_EXCHANGES, _CLIMBS = 8, 4  # rounds, at most: most searches end before
_MANY = 100  # readings in minutes that are exchanged and moved, and to which others are added: of time
_MOST = 400  # readings: who needs more has another problem
_SHARE, _NOTHING = 0.95, 1e-9  # of U; of J: rounding
_ROUNDING = 1e-9  # of a gain that is kept up to date


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What readings make known.

    J : by the criterion; rms : of the tool point over the volume, m; U : which that RMS exceeds in 5 % of machines, m
    U counts causes of type B, J and rms do not
    minutes : set-ups and readings, without ways
    bound : RMS that no plan of as many readings can beat, m; None where it is below half of this one's
    """

    J: float
    rms: float
    U: float
    minutes: float
    bound: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan(Evaluation):
    """Readings that serve best together, and what they make known.

    places : where, set-up after set-up; course : (n,) J after each reading
    """

    places: Places
    course: Array

    def __len__(self) -> int:
        return len(self.places)

    def __repr__(self) -> str:
        return f"<Plan of {len(self)} readings, {self.minutes:.1f} min: {self.rms:.3g} m RMS over the volume>"


@one_thread()
def planned(
    case: Model, readings: int | None, minutes: Quantity | None, rms: Quantity | None, criterion: Criterion,
    candidates: Places | int, after: Readings | Places | None, keep: Places | None,
) -> Plan:  # fmt: skip
    """Return a plan; arguments are those of `Case.plan`."""
    where = "Case.plan"
    if readings is None and minutes is None and rms is None:
        raise InputError(where, "readings", "is not said, nor minutes, nor rms", "Say when the plan ends")
    count = None if readings is None else whole(where, "readings", readings, 1)
    if count is not None and count > _MOST:
        raise InputError(where, "readings", f"= {count} are too many to choose", f"Give {_MOST} at most")
    limit = None if minutes is None else in_minutes(minutes, where, "minutes")
    target = None if rms is None else within(where, "rms", si(rms, where, "rms", METRES), 0.0, open_end=True)
    lattice = candidates if isinstance(candidates, Places) else case.lattice(whole(where, "candidates", candidates, 1))
    if not len(case.checked(lattice, where, "candidates")):
        raise InputError(where, "candidates", "are none", "Give one place or more")
    kept = lattice.at([]) if keep is None else case.checked(keep, where, "keep")
    if count is not None and len(kept) > count:
        raise InputError(where, "keep", f"holds {len(kept)} places of {count} readings", "Keep no more")
    search = _Search(case, case.goal(criterion, where), lattice, case.taken(after, where), kept)
    if search.goal.function is not None:  # one that rises would be searched for as long as any
        search.refuse_idle(search.state.value)
    return _told(case, search, _ended(search, count, limit, target, isinstance(candidates, int)), after)


def _ended(search: _Search, count: int | None, limit: float | None, target: float | None, free: bool) -> Places:
    """Return the places of a plan that ends where it is to.  free : places may move off the candidates"""
    if limit is None:
        return search.best(count or _MOST if target is None else search.fewest(target, count), free)
    chosen = search.starts(count or _MOST, limit, target)[0]
    if not chosen and not len(search.kept):
        raise InputError("Case.plan", "minutes", f"= {limit:g} are too few for one reading", "Give more")
    found = search.moved(chosen[:_MANY], free)
    if len(chosen) <= _MANY:
        return found
    longer = _Search(search.case, search.goal, search.lattice, search.taken, found)
    return longer.moved(longer.grown([], count or _MOST, limit, target), free=False)


def _told(case: Model, search: _Search, places: Places, after: Readings | Places | None) -> Plan:
    order = sorted(range(len(places)), key=lambda i: (case.setups.index(places.instruments[i]), *places.poses[i]))
    sorted_places = places.at(order)
    n = case.numbers(sorted_places)
    known, course = search.state, list[float]()
    for i in range(len(places)):
        known = known.after(n.at(n.place == i))
        course.append(known.value)
    found = evaluated(case, sorted_places, after, search.goal)
    search.refuse_idle(found.J)
    return Plan(**vars(found), places=sorted_places, course=np.array(course))


@one_thread()
def evaluated(
    case: Model, places: Places | Readings, after: Readings | Places | None, criterion: Criterion | Goal
) -> Evaluation:  # fmt: skip
    """Return what readings at places would make known; arguments are those of `Case.evaluate`."""
    where = "Case.evaluate"
    wanted = criterion if isinstance(criterion, Goal) else case.goal(criterion, where)
    found = case.checked(places, where)
    before = case.taken(after, where)
    root, first = case.volume.root, begun(case, wanted).after(before)
    state = first.after(case.taken(places, where))
    spread, start = (root @ each.covariance @ root.T for each in (state, first))
    rms, moved = float(np.sqrt(np.trace(spread))), root @ state.moved
    most = max(len(each.names) for each in case.instruments)
    bound = worth_saying(float(np.sqrt(rank_bound(start, most * len(found)))), rms)
    each = dict(zip(case.setups, case.instruments, strict=True))
    seconds = sum(each[name].begins for name in {*found.instruments})
    seconds += sum(each[name].costs for name in found.instruments)
    return Evaluation(state.value, rms, expanded(spread + moved @ moved.T), seconds / 60, bound)


def expanded(spread: Array) -> float:
    """Return what the RMS of a normal of this covariance exceeds in 5 % (a χ² as broad: Welch and Satterthwaite)."""
    total, square = float(np.trace(spread)), float(np.sum(spread**2))
    if total <= 0:
        return 0.0
    degrees = np.array([total**2 / square])
    return float(np.sqrt(total * chi_square_quantile(degrees, _SHARE) / degrees)[0])


class _Search:
    """The search for a plan.  taken : numbers of readings that are there; kept : places that are in every plan"""

    def __init__(self, case: Model, goal: Goal, lattice: Places, taken: Numbers, kept: Places) -> None:
        self.case, self.goal, self.lattice, self.kept, self.taken = case, goal, lattice, kept, taken
        self.places = kept + lattice
        self.state = begun(case, goal).after(taken)
        self.n = case.numbers(self.places)
        self.own = [np.flatnonzero(self.n.place == p) for p in range(len(self.places))]
        self.fixed = list(range(len(kept)))
        self.setup = np.array([case.setups.index(name) for name in self.places.instruments], dtype=np.intp)
        self.costs, self.begins = np.array([(each.costs, each.begins) for each in case.instruments]).T / 60

    @cached_property
    def _begun(self) -> Gains:
        return self._with(Gains(self.state, self.n, own_numbers(self.n.place, len(self.places))), self.fixed)

    def _with(self, gains: Gains, chosen: Sequence[int]) -> Gains:
        for i in chosen:
            gains.enter(i)
        return gains

    def refuse_idle(self, found: float) -> None:
        """Raise InputError where neither a plan nor a reading at every candidate lets J fall.  found : J of the plan"""
        least = self.state.value - _NOTHING * abs(self.state.value)
        if least <= found and least <= self.after(range(len(self.fixed), len(self.own))).value:
            what = "falls by no reading: what it asks for moves none of the instruments, or grows where more is known"
            remedy = "Mount others, a tool that the errors move, or give a function that falls"
            raise InputError("Case.plan", "criterion", what, remedy)

    def _gains(self, chosen: Sequence[int], kept: Gains, slot: int | None = None) -> Array:
        """Return what each candidate gains beside others, (candidates,).  slot : of what does not count of them"""
        if self.goal.function is not None:
            others = [i for j, i in enumerate(chosen) if j != slot]
            result = self.after(others).fallen(self.n, self.own)
        else:
            result = kept.gains.copy() if slot is None else kept.without(len(self.fixed) + slot)[0]
        result[self.fixed] = -np.inf
        return result

    def grown(self, chosen: Sequence[int], count: int, limit: float | None, target: float | None) -> list[int]:
        """Return candidates with others added that gain most, per minute of a limit, until one of the ends."""
        found, kept = list(chosen), self._with(self._begun.fork(), chosen)
        while len(found) + len(self.fixed) < count and (target is None or self.rms(found) > target):
            gains = self._gains(found, kept)
            if limit is not None:
                more = self._more(found, limit)
                gains = np.where(more < np.inf, gains, -np.inf) / np.clip(more, 1e-6, 1e99)
            if not np.isfinite(gains.max()):
                break
            found.append(int(np.argmax(gains)))
            kept.enter(found[-1])
        return found

    def exchanged(self, chosen: Sequence[int], limit: float | None = None) -> list[int]:
        """Return candidates of which none can be exchanged for a better one.  limit : minutes"""
        found, kept = list(chosen), self._with(self._begun.fork(), chosen)
        for _ in range(_EXCHANGES):
            before = list(found)
            for j in range(len(found)):
                gains, others = self._gains(found, kept, j), found[:j] + found[j + 1 :]
                allowed = gains if limit is None else np.where(np.isfinite(self._more(others, limit)), gains, -np.inf)
                best = int(np.argmax(allowed))
                if gains[best] > gains[found[j]] * (1 + _ROUNDING):
                    found[j] = best
                    kept.exchange(len(self.fixed) + j, best)
            if found == before:
                break
        return found

    def starts(self, count: int, limit: float | None = None, target: float | None = None) -> list[list[int]]:
        """Return what several starts end in, the best first: plans of so many candidates, or of so many minutes.

        A greedy choice alone may never begin with an instrument whose zero is unknown: one reading of it tells nothing.
        """
        generator, free = np.random.default_rng(0), np.arange(len(self.fixed), len(self.own))
        if limit is None:
            sizes = [min((count - len(self.fixed)) // (1 + i % 2), len(free)) for i in range(_STARTS)]  # all, or half
            drawn = [generator.choice(free, size, replace=False).tolist() for size in sizes]
        else:
            most = [min(1 + i % len(self.begins), count - len(self.fixed)) for i in range(_STARTS)]
            drawn = [self._mounted(generator.permutation(free), each, limit) for each in most]
        tried = self._best_first([self.grown(each, count, limit, target) for each in ([], *drawn)])
        best, size = (tried, None) if limit is None else (tried[:_CLIMBED], _MANY)
        return self._best_first([self.grown(self.exchanged(each[:size], limit), count, limit, target) for each in best])

    def _best_first(self, tried: list[list[int]]) -> list[list[int]]:
        return sorted(tried, key=lambda each: self.after(each).value)

    def best(self, count: int, free: bool) -> Places:
        """Return the best plan of so many readings that several starts find.  free : it may leave the candidates"""
        moved = [self.moved(each, free) for each in self.starts(count)[:_CLIMBED]]
        return min(moved, key=lambda each: self.state.after(self.case.numbers(each)).value)

    def moved(self, chosen: Sequence[int], free: bool) -> Places:
        """Return the places of candidates, moved off them where that serves; kept places stay."""
        places = [self.places.at([i]) for i in (*self.fixed, *chosen)]
        numbers = [self.case.numbers(each) for each in places]
        for _ in range(_CLIMBS if free else 0):
            gained, before = 0.0, self.state.after(joined([self.case.none, *numbers[: len(self.fixed)]]))
            for j in range(len(self.fixed), len(places)):
                state = before.after(joined([self.case.none, *numbers[j + 1 :]]))
                start = float(gains_of(self.case, state, places[j])[0])
                there, gain = climbed(self.case, state, places[j])
                gained += (gain - start) / max(state.value, 1e-300)
                places[j], numbers[j] = there, self.case.numbers(there)
                before = before.after(numbers[j])
            if gained < 1e-4:
                break
        return sum(places[1:], places[0])

    def fewest(self, target: float, count: int | None) -> int:
        """Return how many readings, or `count`, reach an RMS over the volume, m; raises InputError where none do."""
        most, low, read = count or _MOST, len(self.fixed), "one reading at every candidate leaves"
        high, left = min(max(2 * low, 1), most), self.rms(range(low, len(self.own)))
        if left <= target:
            while (left := self.rms(self.starts(high)[0])) > target and high < most:
                low, high = high, min(2 * high, most)
            read, left = f"{high} readings leave", left if count is None else target  # so many are an end, too
        if left > target:
            what = f"= {target:g} is out of reach: {read} {left:.3g}"
            raise InputError("Case.plan", "rms", what, "Ask for a larger one, or give other instruments")
        while high - low > 1:
            middle = (low + high) // 2
            reached = self.rms(self.starts(middle)[0]) <= target
            low, high = (low, middle) if reached else (middle, high)
        return high

    def rms(self, chosen: Sequence[int]) -> float:
        """Return the RMS over the volume after candidates, m."""
        return float(np.sqrt(self.case.volume.value(self.after(chosen).known)))

    def _mounted(self, drawn: NDArray[np.intp], most: int, limit: float) -> list[int]:
        """Return the first candidate of each of so many set-ups, as far as they fit into so many minutes."""
        found = list[int]()
        for i in drawn[np.sort(np.unique(self.setup[drawn], return_index=True)[1])][:most].tolist():
            found += [i] if np.isfinite(self._more(found, limit)[i]) else []
        return found

    def _more(self, chosen: Sequence[int], limit: float) -> Array:
        """Return the minutes of each candidate beside others, infinite where they are too many, (candidates,)."""
        setups = self.setup[[*self.fixed, *chosen]]
        spent = self.costs[setups].sum() + self.begins[np.unique(setups)].sum()
        more = (self.costs + np.where(np.isin(np.arange(len(self.begins)), setups), 0.0, self.begins))[self.setup]
        return np.where(spent + more <= limit + 1e-9, more, np.inf)

    def after(self, chosen: Sequence[int]) -> State:
        """Return what is known after readings that are there, those of kept places, and of candidates."""
        return self.state.after(joined([self.case.none, *(self.n.at(self.own[i]) for i in (*self.fixed, *chosen))]))
