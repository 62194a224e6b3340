"""The readings to come: answers of the planner while a campaign is under way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from axiscal.estimation.accuracy.criterion import Gram, Root, joint_root
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.belief import Belief
from axiscal.estimation.case import Case
from axiscal.estimation.functionals.asked import AskedRow, asked_rows
from axiscal.estimation.functionals.known import known_row
from axiscal.estimation.inference.outliers import Doubt
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.timed import timed
from axiscal.exceptions import PlanError
from axiscal.language.spoken import listed, said
from axiscal.measurement.candidates import spread
from axiscal.measurement.place import Place, Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.both_sides import with_both_sides
from axiscal.planning.drift_markers import planned_with_markers
from axiscal.planning.enough import AT_ONCE, enough
from axiscal.planning.overrun import with_rooms
from axiscal.planning.plan.order import in_order, seconds_along
from axiscal.planning.plan.patience import PATIENCE
from axiscal.planning.plan.plan import Plan, Progress, make_plan
from axiscal.planning.plan.renewal import renewed
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.plan_basis import at_gap, in_gap
from axiscal.planning.plane_start import plane_start
from axiscal.record.events import Gap

CANDIDATES = 2000
"""Places that a plan chooses from; beyond, readings are brought to the best places between them anyway."""
_SMALL = 120
"""Unknowns up to which what is left of a plan is climbed off the lattice: beyond, a person at the machine would wait
too long."""
_VOLUME = 0.5
"""Of U before the first reading: a volume without a limit weighs as a row without one."""


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
    remedies = [said('In "{setup}": {remedy}', setup=name, remedy=remedy) for name, _, remedy in lacking]
    if lacking:
        raise PlanError(lacking[0][1], lacking[0][2] if len(lacking) == 1 else listed(". ", remedies))


def limits_left(
    case: Case, task: Task, readings: Sequence[Reading], left: Sequence[Place], outliers: Sequence[Doubt]
) -> Limits:
    """Return the rest of a campaign's limits, for a plan of at most `AT_ONCE` readings.

    readings : so far, which are known; left : of an earlier plan; outliers : those of the readings not believed
    """
    limits, bad = Limits.of(case.description.target), {doubt.reading for doubt in outliers}
    most = AT_ONCE if limits.readings is None else min(AT_ONCE, max(limits.readings - len(readings), 1))
    budget = None if limits.budget is None else max(limits.budget - timed(case, readings).seconds, 0.0)
    believed = [reading for index, reading in enumerate(readings) if index not in bad]
    return enough(case, task, replace(limits, readings=most, budget=budget), believed, left)


def root_of(case: Case, belief: Belief) -> Root:
    """Return V of the target's criterion, W = VᵀV."""
    name = case.description.target.criterion
    if name == "joint":
        return joint_root(case.errors)
    if name == "rows":
        return rows_root(case)
    return case.yardstick.root if name == "volume" else case.yardstick.worst_root(belief)


def rows_root(case: Case) -> Root:
    """Return V of J = Σ v / g², v the mean variance of a row and g its standard deviation where it is as wanted."""
    parts = [np.zeros((0, case.errors.size))]
    for asked in asked_rows(case.description, (), whole=True):
        row = known_row(asked, case, case.prior, read=False)
        goal = row.goal if asked.map is not None else min(row.goal, _VOLUME * row.before)
        if goal > 0:
            parts.append(_own(asked, case) * BAND / goal)
    stacked = np.concatenate(parts)
    return Gram(stacked.T @ stacked).root


def _own(asked: AskedRow, case: Case) -> Array:
    """Return V of the mean variance of a row, (k, size)."""
    if asked.map is None:
        return case.yardstick.root.matrix
    scaled: Array = asked.map.rows(case.errors) / np.sqrt(len(asked.map.weights) / asked.map.dimensions)
    return scaled
