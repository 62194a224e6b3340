"""Readings that a plan has beside those that its search chooses.

Markers: where a zero may wander, its first place is read again every so often, so that the drift shows.

Both sides: where a backlash is wanted, two places at least are read from both. A model whose reversal is the same
everywhere would read one place again and again.

Checks: a fifth of all readings, 3 to 12, drawn at random, are put where they cost least time; none below 12 readings,
nor where nothing usually goes wrong. No place of one follows from what the model thinks. Others are chosen beside them;
where these hardly come from a side the checks do. Every other check stands near a reading of a dozen or fewer. Between
places far apart a curve takes what detail does (lattice and close pairs: Diggle and Lophaven 2006).

Room to come to a place from the side that was planned: at the ends of a travel there is none.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count as count_from

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.exceptions import PlanError
from axiscal.machine.motion import inward
from axiscal.measurement.candidates import distinct, drawn_places
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.measurement.setup import Setup
from axiscal.planning.plan.order import inserted, seconds_along
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.promise import EVERY
from axiscal.record.events import Gap
from axiscal.units import from_unit, to_unit
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.theta import MANY

Pose = tuple[float, ...]
Approach = tuple[int, ...]

_SLACK = 1e-6
"""Share of a step: rounding of a position that stands on the step already."""
_DIGITS = {False: ("mm", 3), True: ("deg", 4)}
"""Unit and decimals of what a person can dial in: the micrometre, a ten-thousandth of a degree."""


def with_rooms(case: Case, places: Places) -> tuple[Place, ...]:
    """Return places, each with room to come to it from its side."""
    described, each = case.description, places.listed(case.description.setups)
    rooms = ((p.setup, with_room(case.errors, described.setup(p.setup), p.pose, p.approach)) for p in each)
    return tuple(Place(setup, *room) for setup, room in rooms)


def with_room(errors: Machine, setup: Setup, pose: Pose, approach: Approach) -> tuple[Pose, Approach]:
    """Return a place near the planned one that can be approached from the planned side.

    The place moves inward by the lack of overrun if the side matters, because the axis has a reversal value. Otherwise
    the place stays and the side is left open.
    """
    if setup.chart is not None:  # its places leave room for the approach, and lie where the chart has them
        return pose, approach
    at, come = [_readable(axis, value) for axis, value in zip(errors.axes, pose, strict=True)], list(approach)
    for k, axis in enumerate(errors.axes):
        place = _with_room(axis, at[k], approach[k], setup.raster[k])
        if place != at[k] and k in errors.reversing:
            at[k] = place
        elif place != at[k]:
            come[k] = 0
    return tuple(at), tuple(come)


def _readable(axis: Axis, position: float) -> float:
    """Return a position that a person can dial in."""
    unit, digits = _DIGITS[axis.rotary]
    rounded = from_unit(round(to_unit(position, unit), digits), unit)
    return min(max(rounded, axis.travel[0]), axis.travel[1])


def _with_room(axis: Axis, position: float, side: int, raster: float) -> float:
    """Return the position, or the nearest one on the raster that leaves room for the overrun."""
    nearest = inward(axis, position, side)
    if nearest == position:
        return position
    unit, digits = _DIGITS[axis.rotary]
    step = raster if raster > 0 else from_unit(10.0**-digits, unit)
    return step * (math.ceil(nearest / step - _SLACK) if side > 0 else math.floor(nearest / step + _SLACK))


def planned_with_markers(
    case: Case,
    readings: Sequence[Reading],
    gaps: Sequence[Gap],
    limits: Limits,
    left: Sequence[Place],
    plan: Callable[[Limits, Sequence[Place]], tuple[Place, ...]],
) -> tuple[Place, ...]:
    """Return the readings to come with the markers among them, within the limits.

    readings : so far; left : of an earlier plan, to begin with and to count the markers by
    plan : the readings to come within limits, in their order, from those that are left
    """
    if all(setup.drift == 0 for setup in case.description.setups):
        return plan(limits, left)
    within = _smaller(case, limits, len(with_markers(case, readings, gaps, left)) - len(left))
    places = plan(within, left)
    marked = with_markers(case, readings, gaps, places)
    true = _smaller(case, limits, len(marked) - len(places))
    fits = limits.budget is None and len(marked) <= (limits.readings or len(marked))
    return marked if fits or true == within else with_markers(case, readings, gaps, plan(true, places))


def without_markers(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> tuple[Place, ...]:
    """Return the places of an earlier plan that were not put there to watch a drift."""
    markers, begun, found = _markers(case, readings, places), {reading.setup for reading in readings}, list[Place]()
    for place in places:
        if markers.get(place.setup) != place or place.setup not in begun:
            found.append(place)
        begun.add(place.setup)
    return tuple(found)


def with_markers(
    case: Case, readings: Sequence[Reading], gaps: Sequence[Gap], places: Sequence[Place]
) -> tuple[Place, ...]:
    """Return the places with markers before those that come more than `EVERY` after the last one."""
    markers = _markers(case, readings, places)
    last = {r.setup: r.time or 0.0 for r in readings if r.place == markers.get(r.setup)}
    now = (readings[-1].time or 0.0) if readings else 0.0
    here, found = (readings[-1].place if readings else None), list[Place]()
    for place in places:
        marker = markers.get(place.setup)
        due = marker is not None and now - last.get(place.setup, now) > EVERY
        if marker is not None and due and not any(gap.holds(marker) for gap in gaps):
            now, here = now + float(case.seconds_along(here, [marker])[0]), marker
            last[place.setup] = now
            found.append(marker)
        now, here = now + float(case.seconds_along(here, [place])[0]), place
        last.setdefault(place.setup, now)
        found.append(place)
    return tuple(found)


def _markers(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> Mapping[str, Place]:
    """Return the place of each set-up whose zero may wander that is read first."""
    wandering = {setup.name for setup in case.description.setups if setup.drift > 0}
    found: dict[str, Place] = {}
    for place in (*(reading.place for reading in readings), *places):
        if place.setup in wandering:
            found.setdefault(place.setup, place)
    return found


def _smaller(case: Case, limits: Limits, markers: int) -> Limits:
    """Return limits with room for so many markers in them."""
    readings = None if limits.readings is None else max(limits.readings - markers, 1)
    each = max(setup.settle + setup.reading_time for setup in case.description.setups if setup.drift > 0)
    budget = None if limits.budget is None else max(limits.budget - markers * each, 0.0)
    return replace(limits, readings=readings, budget=budget)


_PLACES = 2
"""Two show whether the reversal is the same along the travel, and cost one reading more than one."""
_INWARD = 0.1
"""Share of the span from an end, where there is room to come from either side."""
_SIDES = (1, -1)
"""From + and from −."""
_SAME = 1e-6
"""m or rad: two readings at one place."""


def with_both_sides(case: Case, readings: Sequence[Reading], places: Sequence[Place]) -> tuple[Place, ...]:
    """Return a plan with two places read from both sides in each set-up that a wanted backlash is read in.

    readings : so far.  Readings that repeat others move there, else single ones; a plan keeps its number.
    """
    found = tuple(places)
    for setup, axis in _wanted(case):
        taken = [reading.place for reading in readings if reading.setup == setup.name]
        found = _paired(case, setup, axis, taken, found)
    return found


def _wanted(case: Case) -> Iterator[tuple[Setup, int]]:
    """Yield the set-ups that read a wanted backlash and may come from both sides, with its axis."""
    if all(want.row.kind != "backlash" for want in case.description.target.wants):
        return
    for asked in asked_rows(case.description, (), whole=True):
        if asked.want.row.kind == "backlash" and (name := asked.lines[0].setup):
            setup = case.description.setup(name)
            if setup.approach == "both":
                yield setup, asked.lines[0].axis


def _paired(case: Case, setup: Setup, axis: int, taken: list[Place], places: tuple[Place, ...]) -> tuple[Place, ...]:
    for _ in range(_PLACES):
        own = [place for place in places if place.setup == setup.name]
        both = _from_both([*taken, *own], axis)
        leaving = _spare(places, setup)[: len(_SIDES)]
        if not own or len(both) >= _PLACES or len(leaving) < len(_SIDES):
            break
        at = max(_ends(case, setup, axis), key=lambda end: min((abs(end - other) for other in both), default=0.0))
        kept = list(places)
        for place in leaving:
            kept.remove(place)
        mine = [number for number, place in enumerate(kept) if place.setup == setup.name]
        where = min(mine, key=lambda n: abs(kept[n].pose[axis] - at), default=places.index(own[0]))
        places = (*kept[:where], *(_there(case, setup, axis, own[0], at, side) for side in _SIDES), *kept[where:])
    return places


def _from_both(places: Sequence[Place], axis: int) -> list[float]:
    """Return the positions that are read from both sides."""
    plus, minus = ([place.pose[axis] for place in places if place.approach[axis] == side] for side in _SIDES)
    return sorted({here for here in plus if any(abs(here - other) < _SAME for other in minus)})


def _spare(places: Sequence[Place], setup: Setup) -> list[Place]:
    """Return readings that may go, those of the set-up first: repeats of an earlier one, then those without a twin."""
    poses = {(place.setup, place.pose, place.approach) for place in places}
    twins = [sum((name, pose) == (place.setup, place.pose) for name, pose, _ in poses) > 1 for place in places]
    repeated = [place for number, place in enumerate(places) if place in places[:number]]
    single = [place for place, twin in zip(places, twins, strict=True) if not twin and place not in repeated]
    return sorted([*repeated, *single], key=lambda place: place.setup != setup.name)


def _ends(case: Case, setup: Setup, axis: int) -> tuple[float, float]:
    """Return two positions near the ends of where a set-up reads, on its raster."""
    low, high = setup.span(case.description.machine.axes[axis], axis)
    step, first, last = setup.raster[axis], low + _INWARD * (high - low), high - _INWARD * (high - low)
    return (first, last) if step <= 0 else (step * math.ceil(first / step), step * math.floor(last / step))


def _there(case: Case, setup: Setup, axis: int, like: Place, at: float, side: int) -> Place:
    """Return the place of a set-up at a position, come to from a side."""
    pose = tuple(at if k == axis else value for k, value in enumerate(like.pose))
    approach = tuple(side if k == axis else value for k, value in enumerate(like.approach))
    return Place(setup.name, *with_room(case.errors, setup, pose, approach))


_SHARE, _FEWEST, _MOST = 5, 3, 12
"""One of so many readings is a check, from few that tell s to many."""

_SELDOM = 0.25
"""Share of readings below which they hardly come from a side."""

_PAIR = 0.02, 0.035
"""Of a span: a pair is beyond a cell of detail apart, nearer than a curve turns, and by no round number."""

Within = Callable[[Task, Limits, Sequence[Place], Sequence[Place]], tuple[Place, ...]]
"""The readings to come of a task within limits, from those that are left of a plan, beside checks."""


def checks_among(described: CampaignDescription, readings: int) -> int:
    """Return how many of so many readings are checks."""
    if described.target.checks is not None:
        return described.target.checks
    return min(max(round(readings / _SHARE), _FEWEST), _MOST) if described.usual and readings >= MANY else 0


def with_checks(
    case: Case, task: Task, limits: Limits, readings: Sequence[Reading], left: Sequence[Place], plan: Within
) -> tuple[Place, ...]:
    """Return the readings to come with the checks among them, within the limits.  Raises PlanError.

    readings : so far; left : of an earlier plan, with its checks
    plan : knows where checks are, and leaves out what they tell. A budget holds their time as well.
    """
    described, most, count = case.description, limits.readings, _MOST
    own, known = (tuple(place for place in left if place.check is which) for which in (False, True))
    if most is not None:
        taken = sum(reading.check for reading in readings)
        count = max(min(checks_among(described, len(readings) + most) - taken, most), 0)
        limits = replace(limits, readings=most - count)
    if limits.readings == 0 and not known:
        what, remedy = "{checks} checks leave none of {readings} readings to plan", "Give fewer checks in [target]"
        raise PlanError(what, remedy, checks=described.target.checks or count, readings=most)
    checks, budget = _Checks(case, task, readings, known, distinct(task.lattice), count, limits.readings), limits.budget
    if limits.readings == 0:
        return checks.among((), checks.picked((), count))
    rough = count > 0 and task.patience > 0 and not limits.timed  # another plan follows, beside as many checks
    roughly = replace(task.coarse, patience=0.0) if rough else task
    begun = own or plan(roughly, limits, (), ())  # says how many checks belong to it, and in which set-ups
    beside = checks.picked(begun, checks.count(begun)) if budget is None else checks.for_a_fifth(begun)
    if not own and not beside and not rough:
        return begun
    if budget is not None:
        more = checks.seconds(checks.among(begun, beside)) - checks.seconds(begun)
        limits = replace(limits, budget=budget - more)
    if task.patience > 0 or own:  # else for figures only, which checks change little
        if rough:
            within = np.isin(task.lattice.setups, places_of(described.setups, begun).setups)
            task = replace(task, lattice=task.lattice.within(within))
        moved = checks.of_pairs(begun, beside)
        stay = tuple(each for each in beside if each not in moved)
        begun = plan(task, limits, without_markers(case, readings, begun if limits.timed else own), stay)
    return checks.fitting(begun, beside, budget)


@dataclass(frozen=True, eq=False)
class _Checks:
    """The checks of readings to come.

    readings : so far; known : of an earlier plan; candidates : one at each place
    most : so many at most, which so many planned readings as `full` have
    """

    case: Case
    task: Task
    readings: Sequence[Reading]
    known: tuple[Place, ...]
    candidates: Places
    most: int
    full: int | None

    def seconds(self, places: Sequence[Place]) -> float:
        """Return the time of readings in this order."""
        return seconds_along(self.task, places_of(self.case.description.setups, places))

    def count(self, places: Sequence[Place]) -> int:
        """Return how many checks belong to planned readings."""
        if len(places) == self.full:
            return self.most
        taken = sum(reading.check for reading in self.readings)
        before = len(self.readings) - taken + len(places)
        due = next(more for more in count_from(0) if checks_among(self.case.description, before + more) <= more)
        return max(min(self.most, due - taken), 0)

    def picked(self, places: Sequence[Place], count: int) -> tuple[Place, ...]:
        """Return so many checks beside planned readings: those of an earlier plan first."""
        known = self.known[:count]
        among = places_of(self.case.description.setups, places or self.known).setups
        found = drawn_places(self.candidates, among, count - len(known), len(self.readings))
        return (*known, *(replace(place, check=True) for place in with_rooms(self.case, found)))

    def among(self, places: Sequence[Place], checks: Sequence[Place]) -> tuple[Place, ...]:
        """Return planned readings with checks."""
        return put_among(self.case, self.task, places, checks)

    def for_a_fifth(self, places: Sequence[Place]) -> tuple[Place, ...]:
        """Return the checks of planned readings that take a fifth at most of what comes after the first."""
        alone = self.seconds(places)
        most = alone + (alone - self.seconds(places[:1])) / _SHARE
        fewer = (self.picked(places, count) for count in range(self.count(places), -1, -1))
        return next(each for each in fewer if self.seconds(self.among(places, each)) <= most)

    def fitting(self, places: Sequence[Place], checks: Sequence[Place], budget: float | None) -> tuple[Place, ...]:
        """Return planned readings with as many checks as there is time for, of all set-ups alike."""
        moved, others = self.of_pairs(places, checks), [*(reading.place for reading in self.readings), *places]
        rng = np.random.default_rng(len(others))
        checks = [self._near(others, each, rng.uniform(*_PAIR)) if each in moved else each for each in checks]
        checks, whole = self._from_seldom_sides(others, checks), len(checks)
        evenly = ([(i * whole + whole // 2) // count for i in range(count)] for count in range(whole, -1, -1))
        fewer = (self.among(places, [checks[i] for i in chosen]) for chosen in evenly)
        return next((each for each in fewer if budget is None or self.seconds(each) <= budget), tuple(places))

    def of_pairs(self, places: Sequence[Place], checks: Sequence[Place]) -> tuple[Place, ...]:
        """Return the checks that are to stand near a reading: every other new one where a set-up has few."""
        counts = Counter([*(reading.setup for reading in self.readings), *(place.setup for place in places)])
        new = [check for check in checks if check not in self.known]
        return tuple(check for check in new[::2] if 0 < counts[check.setup] <= MANY)

    def _near(self, places: Sequence[Place], check: Place, share: float) -> Place:
        """Return a check that far from the reading nearest to it, a share of the span.  places : of its set-up, too"""
        described, index = self.case.description, self.case.index(check.setup)
        others, moves = places_of(described.setups, places), [*described.setup(check.setup).moves]
        among = self.candidates.within(self.candidates.setups == index)
        mine, spans = others.poses[others.setups == index][:, moves], np.ptp(among.poses[:, moves], axis=0) + _SAME
        away = np.max(np.abs(mine - np.array(check.pose)[moves]) / spans, axis=1)
        apart = np.max(np.abs(among.poses[:, moves] - mine[np.argmin(away)]) / spans, axis=1)
        best = np.argmin(np.where(apart >= share, apart, np.inf))
        return replace(with_rooms(self.case, among.single(int(best)))[0], check=True)

    def _from_seldom_sides(self, places: Sequence[Place], checks: Sequence[Place]) -> tuple[Place, ...]:
        """Return checks, the new ones from the sides that the other readings hardly come from."""
        setups = self.case.description.setups
        found, others = places_of(setups, checks), places_of(setups, places)
        for index, mine in found.by_setup():
            setup, sides = setups[index], others.approaches[others.setups == index]
            free = setup.moves if setup.chart is None and len(setup.sides) > 1 and len(sides) else ()
            for k in self.case.errors.reversing & {*free}:
                rising = np.mean(sides[:, k] > 0)
                if min(rising, 1 - rising) < _SELDOM:
                    found.approaches[mine, k] = 1.0 if rising < _SELDOM else -1.0
        turned = (replace(place, check=True) for place in found.listed(setups))
        return tuple(old if old in self.known else new for old, new in zip(checks, turned, strict=True))


def put_among(case: Case, task: Task, places: Sequence[Place], checks: Sequence[Place]) -> tuple[Place, ...]:
    """Return planned readings with checks, each where it costs least time."""
    if not checks:
        return tuple(places)
    every = inserted(task, places_of(case.description.setups, places), places_of(case.description.setups, checks))
    order, added = with_rooms(case, every[0]), every[1].tolist()
    return tuple(replace(place, check=check) for place, check in zip(order, added, strict=True))
