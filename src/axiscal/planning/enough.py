"""How many readings are enough: a plan ends where all that a result counts reaches what is asked for.

J leaves out what no choice of places changes much: type B errors, and zeros that wander meanwhile. So a search is told
how much a result counts beside its own figures, from a plan that was found before.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from axiscal.estimation.accuracy.expanded import expanded, expanded_floor
from axiscal.estimation.accuracy.yardstick import Accuracy, attainable
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.known_rows import known_rows
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.other_readings import with_both_sides, with_rooms
from axiscal.planning.plan.greedy import chosen_setups, picked, sets_within
from axiscal.planning.plan.order import in_order
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal.planning.plan.tour import retoured
from axiscal.planning.promise import FEW, foreseen, promised

AT_ONCE = 150
"""Readings of a plan at most: what is known by then plans the others."""
_GROWTH = 1.5
"""From one number of readings that is tried to the next; then the middle: at most a fifth of them is too many."""
_ROUNDS = 4
"""Plans that are made to find what a result counts beside J: it changes little."""
_NEAR, _AIM, _JUST = 0.96, 0.99, 1.05
"""Of a limit: a plan that comes nearer has too many readings; what is aimed at, as the plan then has other places; a
plan that comes so near ends just short of it."""


def reached_by(case: Case, limits: Limits, places: Sequence[Place], readings: Sequence[Reading] = ()) -> bool:
    """Return whether readings at these places reach limits, whatever they show, with all that a result counts.

    readings : so far
    """
    taken = [*readings, *blank_readings(case.description.setups, places)]
    return reached(case, limits, foreseen(case, readings, places), taken)


def reached(case: Case, limits: Limits, known: Knowledge, readings: Sequence[Reading] = ()) -> bool:
    """Return whether limits are reached by what is known; where no reading can, whether what they take away is.

    readings : so far: they say where rows are read
    """
    now = case.yardstick.measure(known.belief)
    volume = now.meets(limits.rms, limits.worst) or _within(case, known, limits)
    if not volume and limits.of_volume:
        return False
    rows = known_rows(case, known, readings) if limits.rows else ()
    return all(row.settled for row in rows if row.row.kind != "volume")


def _within(case: Case, known: Knowledge, limits: Limits) -> bool:
    """Return whether U of the volume is reached."""
    if limits.expanded is None:
        return False
    floor = expanded_floor(case.yardstick).space
    return expanded(case.yardstick, known.belief).space <= attainable(limits.expanded, floor)


def going_on(
    case: Case, task: Task, limits: Limits, heeded: Limits, places: Sequence[Place], readings: Sequence[Reading] = ()
) -> Limits | None:
    """Return limits that a search heeds to go on from the places of a plan just short of limits; None where it stays.

    heeded : by the search that found the places; readings : so far
    A plan stays that reaches the limits, misses a volume by more, or has as many readings as there may be.
    """
    if not limits.accurate or len(places) >= (limits.readings or AT_ONCE):
        return None
    known, taken = foreseen(case, readings, places), [*readings, *blank_readings(case.description.setups, places)]
    near = not limits.of_volume or reached(case, limits.times(_JUST), known, taken)
    if not near or reached(case, limits, known, taken):
        return None
    if not heeded.accurate:
        return None if heeded.readings is None else replace(heeded, readings=heeded.readings + 1)
    return _searched(case, known, promised(case, Knowledge(task.observation, task.belief), places), limits)


def few_more(limits: Limits, least: int = 0) -> Limits:
    """Return limits of a few readings for what the likely sizes reach.  least : at least so many"""
    few = FEW if limits.readings is None else min(FEW, limits.readings)
    return Limits(max(few, least), budget=limits.budget)


def enough(
    case: Case, task: Task, limits: Limits, readings: Sequence[Reading] = (), left: Sequence[Place] = ()
) -> Limits:
    """Return limits that a search heeds, such that its plan reaches what these limits ask for.

    readings : so far, as the task has them; left : of an earlier plan, with which the search begins
    """
    if not limits.accurate:
        return limits
    if (readings or len(case.sizes)) and reached_by(case, limits, (), readings):
        return few_more(limits, len(left))
    found = _for_rows if limits.rows else _for_volume
    return found(case, task, limits, readings, left)


def _for_rows(case: Case, task: Task, limits: Limits, readings: Sequence[Reading], left: Sequence[Place]) -> Limits:
    """Return limits of as many readings as reach everything; of no accuracy."""
    most = AT_ONCE if limits.readings is None else limits.readings
    if left and reached_by(case, limits, left, readings):
        return Limits(min(len(left), most), budget=limits.budget)

    def enough_are(count: int) -> bool:
        made = make_plan(few, Limits(count, budget=limits.budget), patience=0.0, bounded=False)
        return reached_by(case, limits, with_both_sides(case, readings, with_rooms(case, made.places)), readings)

    few, short, count = task.coarse, 0, min(FEW, most)
    while count < most and not enough_are(count):
        short, count = count, min(math.ceil(_GROWTH * count), most)
    middle = (short + count) // 2
    return Limits(middle if short and enough_are(middle) else count, budget=limits.budget)


def _for_volume(case: Case, task: Task, limits: Limits, readings: Sequence[Reading], left: Sequence[Place]) -> Limits:
    """Return limits of an accuracy with what a result counts beside."""
    now, known, places = Knowledge(task.observation, task.belief), foreseen(case, readings, left), left
    found, searched = None, _searched(case, known, promised(case, now, places), limits)
    for _ in range(0 if left else _ROUNDS):
        places = roughly(case, task, searched)
        known = foreseen(case, readings, places)
        met = reached(case, limits, known)
        found = searched if met else found
        if (met and not reached(case, limits.times(_NEAR), known)) or len(places) == limits.readings:
            break
        searched = _searched(case, known, promised(case, now, places), limits)
    return found or searched


def roughly(case: Case, task: Task, limits: Limits) -> tuple[Place, ...]:
    """Return about as many readings as a plan has, from some hundred candidates."""
    coarse = task.coarse
    if limits.budget is not None and not limits.accurate:
        none = Places.none(len(case.description.machine.axes))
        return with_rooms(case, retoured(coarse, limits, max(sets_within(coarse, limits), key=len), none, 0.0))
    return with_rooms(case, in_order(task, picked(coarse, limits, chosen_setups(task, limits))))


def _searched(case: Case, known: Knowledge, own: Accuracy, limits: Limits) -> Limits:
    """Return what a search heeds.  known : with all that a result counts; own : by J, of the same places"""
    counted, rms = case.yardstick.measure(known.belief), limits.rms
    if limits.expanded is not None:
        factor = expanded(case.yardstick, known.belief).factor(counted.rms)
        rms = max(rms or 0.0, limits.expanded / factor)
    beside = counted.rms**2 - own.rms**2, counted.worst**2 - own.worst**2
    return replace(limits.times(_AIM), rms=None if rms is None else _AIM * rms, expanded=None, beside=beside)
