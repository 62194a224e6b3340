"""The planner that a campaign has unless it is given another."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.case import Case
from axiscal.estimation.judged import Doubt
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.numerics.stages import stage
from axiscal.record.events import Gap


@stage("the plan of the readings to come")
def plan_ahead(
    case: Case,
    known: Knowledge,
    taken: Sequence[Reading],
    doubts: Sequence[Doubt],
    gaps: Sequence[Gap],
    left: Sequence[Place],
) -> tuple[Place, ...]:
    """Return what `next_places` plans; planning is loaded for it, which a plan that stands need not wait for."""
    from axiscal.planning.next_readings import next_places

    return next_places(case, known, taken, doubts, gaps, left)
