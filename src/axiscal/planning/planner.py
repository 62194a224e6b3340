"""What to read next: from what is known to the readings to come."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.inference.outliers import Doubt
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics.threads import one_thread
from axiscal.planning.drift_markers import planned_with_markers, without_markers
from axiscal.planning.next_readings import planned_places
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
    begin = without_markers(case, readings, left)

    def planned(smaller: Case) -> tuple[Place, ...]:
        return planned_places(smaller, knowledge, readings, closed, begin)

    return planned_with_markers(case, readings, closed, planned)
