"""All stages one after the other: readings timed, judged, learnt from, located, reviewed.

    known = estimated(case, readings)
    known = estimated(case, more_readings, known)
    known = concluded(case, all_readings)

Each stage follows from the readings alone; what an estimation of the first ones has found already is used again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.bands import banded
from axiscal.estimation.case import Case
from axiscal.estimation.displayed import displayed
from axiscal.estimation.estimation import Estimation, Stages
from axiscal.estimation.judged import Judged, judged, judged_at_once
from axiscal.estimation.learnt import Learnt, counts_to_learn_from, learnt
from axiscal.estimation.located import bent, located
from axiscal.estimation.membership import Membership, membership, mixed_knowledge
from axiscal.estimation.mirrors import refuse_mirrors
from axiscal.estimation.reviewed import reviewed
from axiscal.estimation.timed import Timed, timed
from axiscal.measurement.reading import Reading
from axiscal.numerics.stages import stage
from axiscal.numerics.threads import one_thread


@one_thread()
@stage("what the readings make known")
def estimated(stated: Case, readings: Sequence[Reading], before: Estimation | None = None) -> Estimation:
    """Return what readings make known while others are to follow: bad ones as they show, scales as readings grow.

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
    known, scales = first.absorbed, first.learnt
    due = max(counts_to_learn_from(case, len(readings)), default=0)
    if due != scales.count:
        scales = learnt(case, times.readings[:due], plausible.implausible)
        known = located(scales, times.readings[:due], plausible.implausible)
    known = reviewed(known, times.readings, plausible.implausible)
    return Stages(times, plausible, scales, known)


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known if none is to follow: bad ones found, scales and places learnt from all.

    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    return _of_likeliest(stated, lambda side: _finished(stated.sides[side], readings), 0)


def _finished(case: Case, readings: Sequence[Reading]) -> Stages:
    """Return the stages of readings if none is to follow."""
    with stage("which readings can be", 1, 4):
        times = timed(case, readings, Timed())
        plausible = judged_at_once(case, times.readings)
    with stage("what the priors are", 2, 4):
        scales = learnt(case, times.readings, plausible.implausible)
    with stage("what the readings make known", 3, 4):
        known = located(scales, times.readings, plausible.implausible)
    with stage("what first order leaves out", 4, 4):
        known = bent(known, times.readings, plausible.implausible)
        refuse_mirrors(known, times.readings, [*plausible.implausible])
    return Stages(times, plausible, scales, known)


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
    whole = known.knowledge if member is None else mixed_knowledge(known, member)
    wide = banded(known.case, whole, scales.fit)
    return Estimation(
        stated,
        known.case,
        known.knowledge,
        times.readings,
        times.seconds,
        known.innovations,
        (*plausible.implausible.values(), *known.verdict.doubts),
        scales.fit,
        scales.count,
        wide,
        wide.case.yardstick.measure(wide.knowledge.belief),
        stages,
        membership=member,
        side=side,
    )
