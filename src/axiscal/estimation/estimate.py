"""From readings to what is known: timed, judged, averaged over sizes, linearised where the machine is.

    known = estimated(case, readings)
    known = concluded(case, readings)

Both are the same for readings that are linear enough, as nearly all are. `concluded` also tests whether a station may
as well stand elsewhere. It uses rows at the machine as found where those of the nominal one mislead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from axiscal.estimation.absorbed import displayed, taken_as_normal
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Banded, Estimation, Stages, banded
from axiscal.estimation.judged import judged
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.learnt import learnt, posterior_of
from axiscal.estimation.located import bent, located
from axiscal.estimation.membership import Membership, membership
from axiscal.estimation.mirrors import refuse_mirrors
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
    scales = learnt(case, times.readings, implausible)
    stages = Stages(times, implausible, scales, located(scales, times.readings, implausible))
    return _posed_again(case, stages)


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
    return stages if known is stages.absorbed else _posed_again(case, stages._replace(absorbed=known))


def _posed_again(case: Case, stages: Stages) -> Stages:
    """Return stages with the posterior of readings as they are linearised and taken as normal there."""
    known, readings = stages.absorbed, stages.timed.readings
    if not readings:
        return stages
    taken, at = taken_as_normal(known, readings), case.linear_as(known.case)
    if taken is readings and at.observation.about == case.observation.about and at.description == case.description:
        return stages
    return stages._replace(learnt=replace(stages.learnt, found=posterior_of(at, taken, stages.implausible)))


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
    times, implausible, scales, as_shown = stages
    known = displayed(as_shown, times.readings)
    if member is None:
        wide = banded(known.case, known.knowledge, scales.found)
    else:
        wide = Banded(known.case, Knowledge(known.knowledge.observation, member.belief))
    return Estimation(
        stated,
        known.case,
        known.knowledge,
        times.readings,
        times.seconds,
        known.innovations,
        (*implausible.values(), *scales.doubts.values()),
        wide,
        wide.case.yardstick.measure(wide.knowledge.belief),
        stages,
        membership=member,
        side=side,
    )
