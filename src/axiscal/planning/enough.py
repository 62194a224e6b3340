"""When readings are enough: a plan ends where all that a result counts reaches what is asked for.

J leaves out what no choice of places changes much: type B errors, and zeros that wander meanwhile. So a search asks of
each plan that it tries what a result would say after it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

from axiscal.estimation.accuracy.expanded import asked, known_to
from axiscal.estimation.accuracy.yardstick import attainable
from axiscal.estimation.case import Case, Knowledge
from axiscal.estimation.known_rows import known_rows
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Place, Places, Reading
from axiscal.measurement.reading_rows import blank_readings
from axiscal.planning.other_readings import put_among, with_both_sides, with_rooms
from axiscal.planning.plan.order import interleaved, set_ups_in_order
from axiscal.planning.plan.task import Goal, Limits, Task
from axiscal.planning.promise import FEW, foreseen


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
    wanted = asked(limits, case.yardstick)
    found = (known_to(each.name, case.yardstick, known.belief) <= attainable(*each[1:]) for each in wanted)
    if wanted and not any(found):
        return False
    rows = known_rows(case, known, readings) if limits.rows else ()
    return all(row.settled for row in rows if row.row.kind != "volume")


_LARGER, _MANY = 1.4, 300
"""Times as many places as before that are tried next, and so many at most: of time."""


def evenly_until_reached(case: Case, readings: Sequence[Reading], most: int) -> int:
    """Return about how many places, spread evenly over all set-ups, reach the target after readings; at most `most`.

    0 where none of up to 300 does: then nobody knows how many would, if any.
    """
    limits, described, count = Limits.of(case.description.target), case.description, FEW
    while count < min(most, _MANY):
        places = with_rooms(case, spread(described.machine, described.setups, count))
        if reached_by(case, limits, places, readings):
            return min(len(places), most)
        count = math.ceil(_LARGER * count)
    return most if most <= _MANY else 0


def few_more(limits: Limits) -> Limits:
    """Return limits of a few readings for what the likely sizes reach."""
    return Limits(FEW if limits.readings is None else min(FEW, limits.readings), budget=limits.budget)


def enough(case: Case, limits: Limits, readings: Sequence[Reading] = ()) -> Limits:
    """Return limits, or those of a few readings where readings so far, or likely sizes, reach them already."""
    if limits.accurate and (readings or len(case.sizes)) and reached_by(case, limits, (), readings):
        return few_more(limits)
    return limits


def goal_of(
    case: Case,
    task: Task,
    limits: Limits,
    readings: Sequence[Reading] = (),
    believed: Sequence[Reading] = (),
    unsure: float = 1.0,
    checks: Sequence[Place] = (),
) -> Goal | None:
    """Return what readings to come are to reach; None where limits ask for no accuracy.

    readings : so far; believed : of these; unsure : factor by which what is foreseen may yet become larger
    checks : that are read among them
    """
    if not limits.accurate:
        return None

    def reached_at(within: Limits, places: Places) -> bool:
        order = set_ups_in_order(task, places)  # the machine grows between one set-up and the next
        order = interleaved(task, limits, order) if case.description.usual else order
        planned = with_both_sides(case, readings, with_rooms(case, order))
        return reached_by(case, within, put_among(case, task, planned, checks), believed)

    return Goal(partial(reached_at, limits), partial(reached_at, limits.times(1 / unsure)))
