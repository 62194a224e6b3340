"""What to read next: the planner that looks at what a campaign knows."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimate.calibration import Calibration
from axiscal.estimate.case import Case
from axiscal.measurement.place import Place
from axiscal.numerics.threads import one_thread
from axiscal.planning.drift_markers import planned_with_markers, without_markers
from axiscal.planning.next_readings import planned_places
from axiscal.planning.plan_basis import plan_basis, twice_rejected
from axiscal.record.events import Gap


class Planner(Calibration):
    """A calibration that says where to read next."""

    def grounds(self) -> str:
        """Return what a plan made now rests on beside where the readings were taken, in words; empty for nothing."""
        return plan_basis(self.problem, self.readings, self.doubts, self.learnt_from)

    @one_thread()
    def plan(self, gaps: Sequence[Gap], places: Sequence[Place], left: Sequence[Place] = ()) -> tuple[Place, ...]:
        """Return the readings to come, none of the gaps, in the order of a short way.

        places : that were read; left : of an earlier plan, to begin with
        """
        problem, known, seconds = self.problem, (self.observation, self.belief), self.elapsed(places)
        closed = *gaps, *twice_rejected(problem, self.readings, self.doubts)
        begin = without_markers(problem, self.readings, left)

        def planned(case: Case) -> tuple[Place, ...]:
            return planned_places(case, *known, closed, places, seconds, begin)

        return planned_with_markers(problem, self.readings, closed, planned)
