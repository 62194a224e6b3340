"""From readings to what is known: timed, judged, averaged over sizes, linearised where the machine is.

    known = estimated(case, readings)
    known = concluded(case, readings)
    known = in_detail(case, readings)

The first two are the same for readings that are linear enough, as nearly all are. `concluded` also tests whether a
station may as well stand elsewhere. The last one also halves knots where the readings show finer detail.
"""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.case import Case, timed
from axiscal.estimation.detail import as_fine_as_shown
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.judged import Doubt, judged
from axiscal.estimation.learnt import framed, posed, turned
from axiscal.estimation.located import history, located, refuse_mirrors
from axiscal.estimation.promise.posterior import sorted_out
from axiscal.estimation.promise.sick import repeats
from axiscal.estimation.stations import progressed
from axiscal.language.stages import stage
from axiscal.measurement.reading import Reading
from axiscal_core.threads import one_thread


@one_thread()
@stage("what the readings make known")
def estimated(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known while others are to follow."""
    case = stated.shown_by(readings)
    times = timed(case, readings)
    implausible = judged(case, times.readings)
    if not times.readings:
        return Estimation(stated, times, implausible, {}, history(case, ()))
    case = progressed(case, times.readings, implausible) if case.bends else case
    sure = [index for index, reading in enumerate(times.readings) if reading.accepted]
    kept = sorted_out(posed(case, times.readings), implausible, sure)
    implausible = {index: each for index, each in implausible.items() if index not in kept.mine.problem.reading}
    bad = {index: Doubt(index, each.z) for index, each in kept.bad.items()}
    known = located(history(case.rescaled(kept.sizes), times.readings, [*implausible, *bad]))
    at, taken = case.linear_as(known.case), known.normal
    if taken is known.readings and at.about is case.about and at.description == case.description:
        at = case
    else:
        kept = kept.where(posed(at, taken))
    again = repeats(at.description.setups, taken)
    posterior = kept.posterior(turned(at, taken), framed(at, taken), again, at.about_volume)
    return Estimation(stated, times, implausible, bad, known, posterior)


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading], so_far: Estimation | None = None) -> Estimation:
    """Return what readings make known if none is to follow.

    so_far : what the same readings make known while others are to follow
    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    known = so_far or estimated(stated, readings)
    refuse_mirrors(known.history, known.implausible)
    return known


def in_detail(stated: Case, readings: Sequence[Reading], so_far: Estimation | None = None) -> Estimation:
    """Return the same with knots as close as the readings ask for; the case called stated then has them, too."""
    before = so_far or estimated(stated, readings)
    finer = as_fine_as_shown(stated, before)
    return concluded(finer, readings, before if finer is stated else None)
