"""The readings to come: answers of the planner while a campaign is under way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.description.target import Target
from axiscal.estimation.accuracy.criterion import Root, joint_root
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import as_standard
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.timed import timed
from axiscal.exceptions import PlanError
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Place, Places
from axiscal.measurement.reading import Reading
from axiscal.planning.both_sides import with_both_sides
from axiscal.planning.by_rows import rows_root, settled
from axiscal.planning.drift_markers import planned_with_markers
from axiscal.planning.overrun import with_room
from axiscal.planning.plan.order import in_order, seconds_along
from axiscal.planning.plan.patience import PATIENCE
from axiscal.planning.plan.plan import Plan, Progress, make_plan
from axiscal.planning.plan.renewal import renewed
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.plan_basis import at_gap, in_gap
from axiscal.planning.plane_start import plane_start
from axiscal.planning.promise import FEW
from axiscal.record.events import Gap

CANDIDATES = 2000
"""Places that a plan chooses from; beyond, readings are brought to the best places between them anyway."""
_AT_ONCE = 150
_GROWTH = 1.5
"""From one number of readings that is tried to the next: at most a third of them is too many."""
_SMALL = 120
"""Unknowns up to which what is left of a plan is climbed off the lattice: beyond, a person at the machine would wait
too long."""


def planned_places(
    case: Case,
    task: Task,
    limits: Limits,
    readings: Sequence[Reading] = (),
    gaps: Sequence[Gap] = (),
    left: Sequence[Place] = (),
    progress: Progress = lambda _: None,
) -> tuple[Place, ...]:
    """Return the readings to come, chosen together, in the order of a short way.  Raises PlanError.

    task, limits : what is to be planned after the readings so far, and when it ends; gaps : places that could not be
    read, which are planned around; left : of an earlier plan, to begin with
    """
    if begin := first_places(case, task, limits, readings, gaps):
        return begin

    def planned(within: Limits) -> tuple[Place, ...]:
        coming = _chosen(case, task, within, [place for place in left if not in_gap(case, place, gaps)], gaps, progress)
        places = with_both_sides(case, readings, with_rooms(case, coming))
        return tuple(place for place in places if not in_gap(case, place, gaps))

    return planned_with_markers(case, readings, gaps, limits, planned)


def first_places(
    case: Case, task: Task, limits: Limits, readings: Sequence[Reading] = (), gaps: Sequence[Gap] = ()
) -> tuple[Place, ...]:
    """Return the readings with which a plane begins whose scales are to be learnt, where there is time for them."""
    start = in_order(task, plane_start(case, readings, limits.readings))
    if limits.budget is not None and seconds_along(task, start) > limits.budget:
        return ()
    return tuple(place for place in with_rooms(case, start) if not in_gap(case, place, gaps))


def _chosen(
    case: Case, task: Task, limits: Limits, left: Sequence[Place], gaps: Sequence[Gap], progress: Progress
) -> Places:
    """Return the readings of a plan that goes on with those that are left, or of a new one."""
    shake, coming = case.description.usual, columns_of(case, left)
    if len(coming):  # climbing would bring places that were shaken back to their regular distances
        on = 0.0 if gaps or shake or task.observation.size > _SMALL else math.inf
        coming = renewed(task, limits, coming, on)
    if len(coming):
        return coming
    patience = 0.0 if gaps else PATIENCE  # off the lattice a way might lead into a gap
    return make_plan(task, limits, patience=patience, bounded=False, shake=shake, progress=progress).places


def placed(case: Case, plan: Plan) -> tuple[Place, ...]:
    """Return the places of a plan, each with room to come to it from its side."""
    return with_rooms(case, plan.places)


def with_rooms(case: Case, places: Places) -> tuple[Place, ...]:
    """Return places, each with room to come to it from its side."""
    rows = zip(places.setups.tolist(), places.poses.tolist(), places.approaches.astype(int).tolist(), strict=True)
    setups, found = case.description.setups, list[Place]()
    for setup, pose, approach in rows:
        found.append(Place(setups[setup].name, *with_room(case.errors, setups[setup], tuple(pose), tuple(approach))))
    return tuple(found)


def columns_of(case: Case, places: Sequence[Place]) -> Places:
    """Return places as the search holds them."""
    none = Places.none(len(case.description.machine.axes))
    rows = [(case.index(p.setup), np.array(p.pose), np.array(p.approach, dtype=float)) for p in places]
    return Places.joined([none, *(Places.one(*row) for row in rows)])


def posed(
    case: Case,
    knowledge: Knowledge,
    gaps: Sequence[Gap] = (),
    readings: Sequence[Reading] = (),
    candidates: int = CANDIDATES,
) -> Task:
    """Return what is to be planned: the belief so far, and candidates outside the gaps."""
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
        read=columns_of(case, [reading.place for reading in readings]),
    )


def refuse_lacking(case: Case) -> None:
    """Raise PlanError for a set-up that does not say where it can be read: no reading of it can be asked for."""
    lacking = [(setup.name, *setup.lacks) for setup in case.description.setups if setup.lacks is not None]
    if not lacking:
        return
    (name, what, remedy), *others = lacking
    remedies = [f'In "{name}": {remedy[0].lower()}{remedy[1:]}'] if others else [remedy]
    remedies += [f'in "{each}": {remedy[0].lower()}{remedy[1:]}' for each, _, remedy in others]
    raise PlanError(what, ". ".join(each[0].upper() + each[1:] for each in remedies))


def _standard(case: Case, knowledge: Knowledge) -> Target:
    """Return the target with the RMS that an expanded uncertainty asks for, by what is known now."""
    target = case.description.target
    if target.expanded is None:
        return target
    return replace(target, rms=max(target.rms or 0.0, as_standard(case, knowledge, target.expanded)))


def enough_for_rows(
    case: Case,
    knowledge: Knowledge,
    task: Task,
    limits: Limits,
    readings: Sequence[Reading] = (),
    left: Sequence[Place] = (),
) -> Limits:
    """Return limits of as many readings as reach all rows with a limit, or take away what they can; of no accuracy.

    readings : so far; left : of an earlier plan
    """
    most = _AT_ONCE if limits.readings is None else limits.readings
    if left and settled(case, knowledge, readings, left):
        return Limits(min(len(left), most), budget=limits.budget)
    count = min(FEW, most)
    while count < most:
        made = make_plan(task, Limits(count, budget=limits.budget), patience=0.0, bounded=False)
        if settled(case, knowledge, readings, placed(case, made)):
            break
        count = min(math.ceil(_GROWTH * count), most)
    return Limits(count, budget=limits.budget)


def promised_already(limits: Limits, case: Case, knowledge: Knowledge) -> bool:
    """Return whether the likely sizes reach the target accuracy: if the plan goes on, not all sizes do."""
    return limits.accurate and limits.met(case.yardstick.measure(knowledge.belief))


def few_more(limits: Limits, least: int = 0) -> Limits:
    """Return limits of a few readings for what the likely sizes reach.  least : at least so many"""
    few = FEW if limits.readings is None else min(FEW, limits.readings)
    return replace(limits, readings=max(few, least), rms=None, worst=None)


def limits_left(
    case: Case, knowledge: Knowledge, task: Task, readings: Sequence[Reading], left: Sequence[Place]
) -> Limits:
    """Return the rest of a campaign's limits, for a plan of at most `_AT_ONCE` readings.

    readings : so far, which are known; left : of an earlier plan
    """
    target, taken = _standard(case, knowledge), len(readings)
    most = _AT_ONCE if target.readings is None else min(_AT_ONCE, max(target.readings - taken, 1))
    budget = None if target.budget is None else max(target.budget - timed(case, readings).seconds, 0.0)
    limits = Limits(most, target.rms, target.worst, budget)
    if target.lines:
        return enough_for_rows(case, knowledge, task, limits, readings, left)
    return few_more(limits, len(left)) if promised_already(limits, case, knowledge) else limits


def root_of(case: Case, belief: Belief) -> Root:
    """Return V of the target's criterion, W = VᵀV."""
    name = case.description.target.criterion
    if name == "joint":
        return joint_root(case.errors)
    if name == "rows":
        return rows_root(case)
    return case.yardstick.root if name == "volume" else case.yardstick.worst_root(belief)
