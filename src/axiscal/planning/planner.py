"""What to read next: from what is known to the readings to come."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.case import Case
from axiscal.estimation.judged import Doubt
from axiscal.estimation.knowledge import Knowledge
from axiscal.exceptions import PlanError
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics.threads import one_thread
from axiscal.planning.drift_markers import without_markers
from axiscal.planning.next_readings import limits_left, planned_places, posed
from axiscal.planning.plan.task import Limits
from axiscal.planning.plan_basis import twice_rejected
from axiscal.record.events import Gap


@one_thread()
def next_places(
    case: Case,
    knowledge: Knowledge,
    readings: Sequence[Reading],
    outliers: Sequence[Doubt] = (),
    gaps: Sequence[Gap] = (),
    left: Sequence[Place] = (),
) -> tuple[Place, ...]:
    """Return the readings to come, none in a gap, in the order of a short way; none where nothing is left to measure.

    knowledge : after the readings, which have their times; outliers : those of them that are not believed
    gaps : where a reading could not be taken; left : of an earlier plan, to begin with
    """
    closed = *gaps, *twice_rejected(case, readings, outliers)
    begin, task = without_markers(case, readings, left), posed(case, knowledge, closed, readings)
    if not len(task.lattice):
        return ()
    limits = limits_left(case, task, readings, begin, outliers)
    try:
        return planned_places(case, task, limits, readings, closed, begin)
    except PlanError:  # the time that is left is too short for any reading: the campaign says so of the best one
        return planned_places(case, task, Limits(1), readings, closed)
