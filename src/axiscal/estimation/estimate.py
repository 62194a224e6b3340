"""From readings to what is known: timed, judged, averaged over sizes, linearised where the machine is.

    known = estimated(case, readings)
    known = concluded(case, readings)

Both are the same for readings that are linear enough, as nearly all are. `concluded` also tests whether a station may
as well stand elsewhere. It uses rows at the machine as found where those of the nominal one mislead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from axiscal.estimation.absorbed import absorbed, displayed, taken_as_normal
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation, Stages, printed
from axiscal.estimation.judged import Doubt, judged
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.learnt import posterior_of, turned, without_bad
from axiscal.estimation.located import bent, located
from axiscal.estimation.membership import Membership, membership
from axiscal.estimation.mirrors import refuse_mirrors
from axiscal.estimation.promise.posterior import Sorted
from axiscal.estimation.stations import progressed
from axiscal.estimation.timed import timed
from axiscal.measurement.reading import Reading
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread


@one_thread()
@stage("what the readings make known")
def estimated(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known while others are to follow."""
    return _of_likeliest(stated, lambda side: _staged(stated.sides[side], readings), 0)


def _staged(case: Case, readings: Sequence[Reading]) -> Stages:
    """Return the posterior of readings, linearised about the machine that they show."""
    times = timed(case, readings)
    implausible = judged(case, times.readings)
    if not times.readings:
        return Stages(times, implausible, {}, absorbed(case, ()))
    case = progressed(case, times.readings, implausible)
    kept = without_bad(case, times.readings, implausible)
    bad = {index: Doubt(index, each.z) for index, each in kept.bad.items()}
    known = located(case.rescaled(kept.sizes), times.readings, [*implausible, *bad])
    return _answered(case, Stages(times, implausible, bad, known), kept)


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading], so_far: Estimation | None = None) -> Estimation:
    """Return what readings make known if none is to follow.

    so_far : what the same readings make known while others are to follow
    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    before = so_far or estimated(stated, readings)
    last = _finished(stated.sides[before.side], before.stages)
    if last is before.stages:
        return before

    def stages(side: int) -> Stages:
        return last if side == before.side else _finished(stated.sides[side], _staged(stated.sides[side], readings))

    return _of_likeliest(stated, stages, before.side)


def _finished(case: Case, stages: Stages) -> Stages:
    """Return the stages of readings if none is to follow; themselves where that changes nothing."""
    readings, implausible = stages.timed.readings, stages.implausible
    known = bent(stages.absorbed, readings)
    refuse_mirrors(known, readings, [*implausible])
    return stages if known is stages.absorbed else _answered(case, stages._replace(absorbed=known))


def _answered(case: Case, stages: Stages, kept: Sorted | None = None) -> Stages:
    """Return stages with the posterior of readings as they are linearised and taken as normal there.

    kept : what is sorted out of the same readings where `case` has them linear
    """
    known, readings = stages.absorbed, stages.timed.readings
    taken, at = taken_as_normal(known, readings), case.linear_as(known.case)
    if taken is readings and at.observation.about == case.observation.about and at.description == case.description:
        found = stages.found if kept is None else kept.posterior(turned(case, readings))
    else:
        found = posterior_of(at, taken, stages.implausible)
    return stages._replace(found=found)


def _of_likeliest(stated: Case, stages: Callable[[int], Stages], first: int) -> Estimation:
    """Return the estimation by the likeliest of the rival beliefs, where there are any.

    stages : of one of them, by its index; first : the one to begin with
    """
    if not stated.rivals:
        return _estimation(stated, stages(0))
    tried, side = dict[int, Estimation](), first
    while side not in tried:
        found = stages(side)
        member = membership(stated, found.absorbed, found.timed.readings, found.implausible)
        tried[side] = _estimation(stated, found, member, side)
        side = member.likeliest
    return tried[side]


def _estimation(stated: Case, stages: Stages, member: Membership | None = None, side: int = 0) -> Estimation:
    times, implausible, bad, as_shown, found = stages
    known = displayed(as_shown, times.readings)
    of_rivals = None if member is None else Knowledge(known.knowledge.observation, member.belief)
    return Estimation(
        stated,
        known.case,
        known.knowledge,
        times.readings,
        times.seconds,
        known.innovations,
        (*implausible.values(), *bad.values()),
        of_rivals or printed(known.knowledge, found),
        stages,
        membership=member,
        side=side,
    )
