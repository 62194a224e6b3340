"""From readings to what is known: timed, judged, averaged over sizes, linearised where the machine is.

    known = estimated(case, readings)
    known = estimated(case, more_readings, known)
    known = concluded(case, all_readings)

Each stage follows from the readings alone; an earlier estimation only makes it quicker.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.bands import banded
from axiscal.estimation.case import Case
from axiscal.estimation.displayed import displayed, taken_as_normal
from axiscal.estimation.estimation import Estimation, Stages
from axiscal.estimation.judged import Judged, judged, judged_at_once
from axiscal.estimation.learnt import Learnt, learnt, posterior_of
from axiscal.estimation.located import bent, located
from axiscal.estimation.membership import Membership, membership, mixed_knowledge
from axiscal.estimation.mirrors import refuse_mirrors
from axiscal.estimation.timed import Timed, timed
from axiscal.inference.outliers import Doubt
from axiscal.measurement.reading import Reading
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread
from axiscal.promise.posterior import Posterior


@one_thread()
@stage("what the readings make known")
def estimated(stated: Case, readings: Sequence[Reading], before: Estimation | None = None) -> Estimation:
    """Return what readings make known while others are to follow.

    before : of the first readings, or of others, which is then not used
    """
    if before is not None and before.stated is stated and before.stages.timed.begins(readings):
        if len(before.readings) == len(readings):
            return before
        last = before
    else:
        last = None

    def stages(side: int) -> Stages:
        return _staged(stated.sides[side], readings, last.stages if last is not None and last.side == side else None)

    return _of_likeliest(stated, stages, 0 if last is None else last.side)


def _staged(case: Case, readings: Sequence[Reading], before: Stages | None) -> Stages:
    """Return the stages of readings while others are to follow.  before : of the first of them, by the same case"""
    first = before or _nothing(case)
    times = timed(case, readings, first.timed)
    plausible = judged(times.readings, first.judged)
    return _known(case, times, plausible, final=False)


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known if none is to follow.

    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    return _of_likeliest(stated, lambda side: _finished(stated.sides[side], readings), 0)


def _finished(case: Case, readings: Sequence[Reading]) -> Stages:
    """Return the stages of readings if none is to follow."""
    with stage("which readings can be", 1, 2):
        times = timed(case, readings, Timed())
        plausible = judged_at_once(case, times.readings)
    with stage("what the readings make known", 2, 2):
        found = _known(case, times, plausible, final=True)
        refuse_mirrors(found.absorbed, times.readings, [*plausible.implausible])
    return found


def _known(case: Case, times: Timed, plausible: Judged, *, final: bool) -> Stages:
    """Return the posterior where readings are linear enough; where they are not, about the machine that they show."""
    readings, implausible = times.readings, plausible.implausible
    scales = learnt(case, readings, implausible)
    known = located(scales, readings, implausible)
    if final:
        known = bent(known, readings, implausible)
    if scales.found is not None and (moved := _moved(case, known, readings, implausible)) is not None:
        scales = Learnt(scales.case, scales.verdict, moved)
    return Stages(times, plausible, scales, known)


def _moved(
    case: Case, known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]
) -> Posterior | None:
    """Return the posterior of readings as they are linearised and taken as normal now; None if as before."""
    taken = taken_as_normal(known, readings, implausible)
    at = case.linear_as(known.case)
    if taken is readings and at.observation.about == case.observation.about and at.description == case.description:
        return None
    return posterior_of(at, taken, implausible)


def _of_likeliest(stated: Case, stages: Callable[[int], Stages], first: int) -> Estimation:
    """Return the estimation by the likeliest of the rival beliefs, where there are any.

    stages : of one of them, by its index; first : the one to begin with
    """
    if not stated.rivals:
        return _estimation(stated, stages(0))
    tried, side = dict[int, Estimation](), first
    while side not in tried:
        found = stages(side)
        member = membership(stated, found.absorbed, found.timed.readings, found.judged.implausible)
        tried[side] = _estimation(stated, found, member, side)
        side = member.likeliest
    return tried[side]


def _nothing(stated: Case) -> Stages:
    return Stages(Timed(), Judged.none(stated), Learnt(stated), Absorbed.nothing(stated))


def _estimation(stated: Case, stages: Stages, member: Membership | None = None, side: int = 0) -> Estimation:
    times, plausible, scales, as_shown = stages
    known = displayed(as_shown, times.readings, plausible.implausible)
    if member is None:
        wide = banded(known.case, known.knowledge, scales.found)
    else:
        wide = banded(known.case, mixed_knowledge(known, member), None)
    return Estimation(
        stated,
        known.case,
        known.knowledge,
        times.readings,
        times.seconds,
        known.innovations,
        (*plausible.implausible.values(), *known.verdict.doubts),
        wide,
        wide.case.yardstick.measure(wide.knowledge.belief),
        stages,
        membership=member,
        side=side,
    )
