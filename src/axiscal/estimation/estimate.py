"""All stages one after the other: readings timed, judged, learnt from, located, reviewed.

    known = estimated(case, readings)
    known = estimated(case, more_readings, known)
    known = concluded(case, all_readings)

Each stage follows from the readings alone; what an estimation of the first ones has found already is used again.
"""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.bands import banded
from axiscal.estimation.case import Case
from axiscal.estimation.displayed import displayed
from axiscal.estimation.estimation import Estimation, Stages
from axiscal.estimation.judged import Judged, judged, judged_at_once
from axiscal.estimation.learnt import Learnt, counts_to_learn_from, learnt
from axiscal.estimation.located import bent, located
from axiscal.estimation.mirrors import refuse_mirrors
from axiscal.estimation.reviewed import reviewed
from axiscal.estimation.timed import Timed, timed
from axiscal.measurement.reading import Reading
from axiscal.numerics.threads import one_thread


@one_thread()
def estimated(stated: Case, readings: Sequence[Reading], before: Estimation | None = None) -> Estimation:
    """Return what readings make known while others are to follow: bad ones as they show, scales as readings grow.

    before : of the first readings, or of others, which is then not used
    """
    first = _nothing(stated)
    if before is not None and before.stated is stated and before.stages.timed.begins(readings):
        if len(before.readings) == len(readings):
            return before
        first = before.stages
    times = timed(stated, readings, first.timed)
    plausible = judged(times.readings, first.judged)
    known, scales = first.absorbed, first.learnt
    due = max(counts_to_learn_from(stated, len(readings)), default=0)
    if due != scales.count:
        scales = learnt(stated, times.readings[:due], plausible.implausible)
        known = located(scales, times.readings[:due], plausible.implausible)
    known = reviewed(known, times.readings, plausible.implausible)
    return _estimation(stated, Stages(times, plausible, scales, known))


@one_thread()
def concluded(stated: Case, readings: Sequence[Reading]) -> Estimation:
    """Return what readings make known if none is to follow: bad ones found, scales and places learnt from all.

    Raises AmbiguityError where a station may as well stand elsewhere.
    """
    times = timed(stated, readings, Timed())
    plausible = judged_at_once(stated, times.readings)
    scales = learnt(stated, times.readings, plausible.implausible)
    known = located(scales, times.readings, plausible.implausible)
    known = bent(known, times.readings, plausible.implausible)
    refuse_mirrors(known, times.readings, [*plausible.implausible])
    return _estimation(stated, Stages(times, plausible, scales, known))


def _nothing(stated: Case) -> Stages:
    return Stages(Timed(), Judged.none(stated), Learnt(stated), Absorbed.nothing(stated))


def _estimation(stated: Case, stages: Stages) -> Estimation:
    times, plausible, scales, as_shown = stages
    known = displayed(as_shown, times.readings, plausible.implausible)
    wide = banded(known.case, known.knowledge, scales.fit)
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
    )
