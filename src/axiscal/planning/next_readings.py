"""The readings to come: what the planner is asked for while a campaign is under way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.accuracy.criterion import Root, joint_root
from axiscal.belief import Belief
from axiscal.description.target import Target
from axiscal.design.plan.order import in_order
from axiscal.design.plan.plan import Plan, make_plan
from axiscal.design.plan.renewal import renewed
from axiscal.design.plan.task import Limits, Task
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.timed import Timed, timed
from axiscal.estimation.uncertain import as_standard
from axiscal.exceptions import PlanError
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Place, Places
from axiscal.measurement.reading import Reading
from axiscal.planning.both_sides import with_both_sides
from axiscal.planning.by_rows import rows_root, settled
from axiscal.planning.overrun import with_room
from axiscal.planning.plan_basis import at_gap, in_gap
from axiscal.planning.plane_start import plane_start
from axiscal.planning.promise import FEW
from axiscal.record.events import Gap

_CANDIDATES = 2000
_AT_ONCE = 150
_GROWTH = 1.5
"""From one number of readings that is tried to the next: at most a third of them is too many."""
_SMALL = 120
"""Unknowns up to which readings are climbed off the lattice: beyond, a person at the machine would wait too long."""


def planned_places(
    case: Case, knowledge: Knowledge, readings: Sequence[Reading], gaps: Sequence[Gap], left: Sequence[Place] = ()
) -> tuple[Place, ...]:
    """Return the readings to come, chosen together, in the order of a short way; none where nothing is allowed.

    readings : so far; gaps : places that could not be read, which are planned around
    left : of an earlier plan, to begin with
    """
    task = posed(case, knowledge, gaps, readings)
    limits = limits_left(_standard(case, knowledge), len(readings), timed(case, readings, Timed()).seconds)
    if not len(task.lattice):
        return ()
    if case.description.target.lines:
        limits = enough_for_rows(case, knowledge, task, limits, readings, left)
    elif promised_already(limits, case, knowledge):
        limits = few_more(limits, len(left))
    if begin := _first(case, task, readings, gaps):
        return begin
    patience = 0.0 if gaps else _patience(task.observation)  # off the lattice a way might lead into a gap
    coming = _columns(case, [place for place in left if not in_gap(case, place, gaps)])
    if len(coming):
        coming = renewed(task, limits, coming, patience)
    if not len(coming):
        coming = _begun(task, limits, patience, case.description.usual)
    places = with_both_sides(case, readings, with_rooms(case, coming))
    return tuple(place for place in places if not in_gap(case, place, gaps))


def _first(case: Case, task: Task, readings: Sequence[Reading], gaps: Sequence[Gap]) -> tuple[Place, ...]:
    """Return the readings with which a plane begins whose scales are to be learnt, where they can be read."""
    start = plane_start(case, readings)
    if not len(start):
        return ()
    places = with_rooms(case, in_order(task, start))
    return tuple(place for place in places if not in_gap(case, place, gaps))


def _begun(task: Task, limits: Limits, patience: float, shake: bool) -> Places:
    """Return the readings of a new plan."""
    try:
        return make_plan(task, limits, patience=patience, bounded=False, shake=shake).places
    except PlanError:  # the time that is left is too short for any reading: the campaign says so of the best one
        return make_plan(task, Limits(1), patience=patience, bounded=False).places


def _patience(observation: Observation) -> float:
    """Return how long readings may be climbed off the lattice: without end, or not at all. Never by the clock, so that
    the same campaign asks for the same readings on any machine.
    """
    return math.inf if observation.size <= _SMALL else 0.0


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


def _columns(case: Case, places: Sequence[Place]) -> Places:
    none = Places.none(len(case.description.machine.axes))
    rows = [(case.index(p.setup), np.array(p.pose), np.array(p.approach, dtype=float)) for p in places]
    return Places.joined([none, *(Places.one(*row) for row in rows)])


def posed(
    case: Case,
    knowledge: Knowledge,
    gaps: Sequence[Gap] = (),
    readings: Sequence[Reading] = (),
    candidates: int = _CANDIDATES,
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
        read=_columns(case, [reading.place for reading in readings]),
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
    """Return whether the likely sizes reach an accuracy that is asked for: where it is planned on, all do not."""
    return limits.accurate and limits.met(case.yardstick.measure(knowledge.belief))


def few_more(limits: Limits, least: int = 0) -> Limits:
    """Return limits of a few readings for what the likely sizes reach.  least : at least so many"""
    few = FEW if limits.readings is None else min(FEW, limits.readings)
    return replace(limits, readings=max(few, least), rms=None, worst=None)


def limits_left(target: Target, taken: int, seconds: float) -> Limits:
    """Return what is left of a target's limits: a plan of so many readings at once at the most.

    Under `worst` the pose that counts moves with every reading, so one is planned at a time.
    """
    at_once = 1 if target.criterion == "worst" else _AT_ONCE
    left = at_once if target.readings is None else min(at_once, max(target.readings - taken, 1))
    budget = None if target.budget is None else max(target.budget - seconds, 0.0)
    return Limits(left, target.rms, target.worst, budget)


def root_of(case: Case, belief: Belief) -> Root:
    """Return V of the target's criterion, W = VᵀV."""
    name = case.description.target.criterion
    if name == "joint":
        return joint_root(case.errors)
    if name == "rows":
        return rows_root(case)
    return case.yardstick.root if name == "volume" else case.yardstick.worst_root(belief)
