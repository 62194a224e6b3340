"""What to read next: from what is known to the readings to come, while a campaign is under way.

A plan stands as long as what it rests on; it has no places where no reading can be had.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.case import Case, Knowledge, timed
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.judged import Doubt
from axiscal.estimation.known_rows import known_row
from axiscal.exceptions import PlanError
from axiscal.language.spoken import listed, said
from axiscal.language.stages import stage
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import places_of
from axiscal.numerics import Array
from axiscal.planning.enough import enough, goal_of
from axiscal.planning.other_readings import (
    planned_with_markers,
    with_both_sides,
    with_checks,
    with_rooms,
    without_markers,
)
from axiscal.planning.plan.greedy import worth_most
from axiscal.planning.plan.order import seconds_along
from axiscal.planning.plan.plan import MANY, Plan, make_plan, renewed
from axiscal.planning.plan.task import Goal, Limits, Task
from axiscal.record.events import Asked, Gap
from axiscal_core.criterion import joint, root_of_gram
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread

CANDIDATES = 2000
"""Places that a plan chooses from; beyond, readings are brought to the best places between them anyway."""
FEW_CANDIDATES = 500
"""The same, where figures alone are wanted."""
_SMALL = 120
"""Unknowns up to which what replaces a plan is climbed off the lattice: beyond, a person at the machine would wait too
long."""
_VOLUME = 0.5
"""Of U before the first reading: a volume without a limit weighs as a row without one."""


def planned_places(
    case: Case,
    task: Task,
    limits: Limits,
    readings: Sequence[Reading] = (),
    gaps: Sequence[Gap] = (),
    left: Sequence[Place] = (),
    believed: Sequence[Reading] = (),
    checks: Sequence[Place] = (),
) -> tuple[Place, ...]:
    """Return the readings to come, chosen together, in the order of a short way.  Raises PlanError.

    task, limits : what is to be planned after the readings so far, and when it ends; believed : of these readings
    gaps : places that could not be read, which are planned around
    left : of an earlier plan and in no gap, to begin with; checks : that are read beside those to come
    """
    unsure = 1 + 1 / math.sqrt(2 * len(readings)) if len(case.sizes) and readings and left else 1.0
    task = replace(task, beside=places_of(case.description.setups, checks))
    goal = goal_of(case, task, limits, readings, believed, unsure, checks)

    def planned(within: Limits, left: Sequence[Place]) -> tuple[Place, ...]:
        coming = _chosen(case, task, within, goal, left, gaps)
        places = with_both_sides(case, readings, with_rooms(case, coming))
        return tuple(place for place in places if not in_gap(case, place, gaps))

    return planned_with_markers(case, readings, gaps, limits, left, planned)


def reaching(
    case: Case,
    task: Task,
    limits: Limits,
    heeded: Limits,
    readings: Sequence[Reading] = (),
    believed: Sequence[Reading] = (),
    gaps: Sequence[Gap] = (),
    left: Sequence[Place] = (),
) -> tuple[Place, ...]:
    """Return the readings to come that reach limits, checks among them; arguments as of `planned_places`.

    heeded : limits that a search heeds for them
    """

    def beside(among: Task, within: Limits, left: Sequence[Place], checks: Sequence[Place]) -> tuple[Place, ...]:
        most = [each for each in (heeded.readings, within.readings) if each is not None]
        search = replace(heeded, readings=min(most, default=None), budget=within.budget)
        return planned_places(case, among, search, readings, gaps, left, believed, checks)

    return with_checks(case, task, limits, readings, left, beside)


def _chosen(
    case: Case, task: Task, limits: Limits, goal: Goal | None, left: Sequence[Place], gaps: Sequence[Gap]
) -> Places:
    """Return the readings of a plan that goes on with those that are left, or of a new one.

    The quicker one where both reach an accuracy: what was chosen by other sizes holds on to places that tell little.
    """
    usual, coming = case.description.usual, places_of(case.description.setups, left)
    long = task.belief.size > _SMALL
    if len(coming):  # climbing would bring places that were shaken back to their regular distances
        patience = 0.0 if gaps or usual or long else math.inf
        coming = renewed(task, limits, coming, patience, goal, usual)
    if len(coming) and (goal is None or not task.patience or not _quicker(task, limits, goal, usual, coming)):
        return coming
    # off the lattice a way might lead into a gap
    patience = 0.0 if gaps or (long and len(left)) else task.patience
    anew = make_plan(task, limits, goal=goal, patience=patience, usual=usual).places
    return anew if goal is None or not len(coming) or _earlier(task, goal, anew, coming) else coming


def _quicker(task: Task, limits: Limits, goal: Goal, usual: bool, coming: Places) -> bool:
    """Return whether readings chosen anew on the lattice alone would be a quicker plan."""
    anew = make_plan(replace(task, patience=0.0), limits, goal=goal, patience=0.0, usual=usual).places
    return _earlier(task, goal, anew, coming)


def _earlier(task: Task, goal: Goal, anew: Places, coming: Places) -> bool:
    """Return whether readings reach an accuracy in less time than others take."""
    return seconds_along(task, anew) < seconds_along(task, coming) and goal.reached(anew)


def placed(case: Case, plan: Plan) -> tuple[Place, ...]:
    """Return the places of a plan, each with room to come to it from its side."""
    places = enumerate(with_rooms(case, plan.places))
    return tuple(replace(place, check=index in plan.checks) for index, place in places)


def posed(
    case: Case,
    knowledge: Knowledge,
    gaps: Sequence[Gap] = (),
    readings: Sequence[Reading] = (),
    candidates: int = CANDIDATES,
) -> Task:
    """Return what is to be planned: the belief so far, and candidates outside the gaps.

    candidates : how many
    """
    refuse_lacking(case)
    machine, setups, here = case.description.machine, case.description.setups, None
    if readings:
        last = readings[-1]
        here = Places.one(case.index(last.setup), np.array(last.pose), np.zeros(len(last.pose)))
    lattice = spread(machine, setups, candidates)
    keep = np.ones(len(lattice), dtype=bool)
    for setup in np.unique(lattice.setups):
        mine = lattice.setups == setup
        keep[mine] = ~at_gap(case, int(setup), lattice.poses[mine], gaps)
    return Task(
        knowledge.observation,
        knowledge.belief,
        root_of(case, knowledge.belief),
        case.yardstick,
        lattice.within(keep),
        here,
        cells=knowledge.cells,
    )


def refuse_lacking(case: Case) -> None:
    """Raise PlanError for a set-up that does not say where it can be read: no reading of it can be asked for."""
    lacking = [(setup.name, *setup.lacks) for setup in case.description.setups if setup.lacks is not None]
    remedies = [said('In "{setup}": {remedy}', setup=name, remedy=remedy) for name, _, remedy in lacking]
    if lacking:
        raise PlanError(lacking[0][1], lacking[0][2] if len(lacking) == 1 else listed(". ", remedies))


def limits_left(case: Case, readings: Sequence[Reading]) -> Limits:
    """Return the rest of a campaign's limits, for a plan of at most `MANY` readings.  readings : so far"""
    limits = Limits.of(case.description.target)
    most = MANY if limits.readings is None else min(MANY, max(limits.readings - len(readings), 1))
    budget = None if limits.budget is None else max(limits.budget - timed(case, readings).seconds, 0.0)
    return replace(limits, readings=most, budget=budget)


def root_of(case: Case, belief: Normal) -> Array:
    """Return V of the target's criterion, W = VᵀV."""
    name = case.description.target.criterion
    if name == "joint":
        return joint(case.errors, case.errors.size).root
    if name == "rows":
        return rows_root(case)
    return case.yardstick.root if name == "volume" else case.yardstick.worst_root(belief)


def rows_root(case: Case) -> Array:
    """Return V of J = Σ v / g², v the mean variance of a row and g its standard deviation where it is as wanted."""
    parts = [np.zeros((0, case.errors.size))]
    for asked in asked_rows(case.description, (), whole=True):
        row = known_row(asked, case, case.prior, read=False)
        goal = row.goal if asked.map is not None else min(row.goal, _VOLUME * row.before)
        if goal > 0:
            parts.append(_own(asked, case) * BAND / goal)
    stacked = np.concatenate(parts)
    return root_of_gram(stacked.T @ stacked)


def _own(asked: AskedRow, case: Case) -> Array:
    """Return V of the mean variance of a row, (k, size)."""
    if asked.map is None:
        return case.yardstick.root
    scaled: Array = asked.map.rows(case.errors) / np.sqrt(len(asked.map.weights) / asked.map.dimensions)
    return scaled


@one_thread()
@stage("the plan of the readings to come")
def next_places(
    case: Case,
    knowledge: Knowledge,
    readings: Sequence[Reading],
    outliers: Sequence[Doubt] = (),
    gaps: Sequence[Gap] = (),
    left: Sequence[Place] = (),
    *,
    rough: bool = False,
) -> tuple[Place, ...]:
    """Return the readings to come, none in a gap, in the order of a short way; none where nothing is left to measure.

    knowledge : after the readings, which have their times; outliers : those of them that are not believed
    gaps : where a reading could not be taken; left : of an earlier plan, to begin with
    rough : for figures only, at places of the lattice
    """
    closed = *gaps, *twice_rejected(case, readings, outliers)
    begin = tuple(place for place in without_markers(case, readings, left) if not in_gap(case, place, closed))
    task = posed(case, knowledge, closed, readings, FEW_CANDIDATES if rough else CANDIDATES)
    task = replace(task, patience=0.0) if rough else task
    if not len(task.lattice):
        return ()
    limits, bad = limits_left(case, readings), {doubt.reading for doubt in outliers}
    if len(readings) >= (case.description.target.readings or math.inf):  # one more is wanted than was planned
        task = replace(task, lattice=task.lattice.within(task.lattice.setups == worth_most(task)))
    believed = [reading for index, reading in enumerate(readings) if index not in bad]
    try:
        heeded = enough(case, limits, believed)
        return reaching(case, task, limits, heeded, readings, believed, closed, begin)
    except PlanError:  # the time that is left is too short for any reading: the campaign says so of the best one
        return planned_places(case, task, Limits(1), readings, closed)


_NEAR = 0.01
"""Places within this share of each axis' travel are one place."""


def twice_rejected(case: Case, readings: Sequence[Reading], doubts: Sequence[Doubt]) -> tuple[Gap, ...]:
    """Return the places at which a second reading was rejected as well: asking for a third would be no use."""
    rejected = [readings[index] for index in sorted(doubt.reading for doubt in doubts)]
    places = [reading.place for reading in rejected]
    found = []
    for number, place in enumerate(places):
        gap = Gap(Asked(0, place), "two readings were rejected here")
        if any(in_gap(case, earlier, [gap]) for earlier in places[:number]):
            found.append(gap)
    return tuple(found)


def in_gap(case: Case, place: Place, gaps: Sequence[Gap]) -> bool:
    """Return whether a place is where a reading could not be taken."""
    return bool(at_gap(case, case.index(place.setup), np.array([place.pose]), gaps)[0])


def at_gap(case: Case, setup: int, poses: Array, gaps: Sequence[Gap]) -> NDArray[np.bool_]:
    """Return which poses (m, q) of a set-up are where a reading could not be taken."""
    lengths = np.array([axis.length for axis in case.description.machine.axes])
    result = np.zeros(len(poses), dtype=bool)
    for gap in gaps:
        if case.index(gap.place.setup) == setup:
            result |= gap.whole | np.all(np.abs(poses - np.array(gap.place.pose)) < _NEAR * lengths, axis=1)
    return result
