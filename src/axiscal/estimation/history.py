"""How a campaign went, seen when it is over: which readings are bad, and the sizes, are known from the first one on."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Innovations
from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.updating import blocks
from axiscal.numerics.threads import one_thread


class Moment(NamedTuple):
    """What is known after a reading, its innovations (None before the first), and after how many seconds."""

    accuracy: Accuracy
    innovations: Innovations | None
    seconds: float


@one_thread()
def path(final: Estimation) -> list[Moment]:
    """Return what was known before the first reading and after each, in one pass with the sizes known at the end.

    final : a concluded one. Its last figures are those of the posterior, with the sizes averaged over.
    """
    as_shown, readings = final.stages.absorbed, final.readings
    known = Absorbed.nothing(as_shown.case, as_shown.verdict)
    found: list[tuple[Accuracy, Innovations | None]] = [(known.case.yardstick.measure(known.knowledge.belief), None)]
    weights = known.weights(0, len(readings), final.stages.judged.implausible)
    for case, part in blocks(known.case, known.knowledge, readings, weights):
        found += zip(part.accuracies(case.yardstick), part.innovations, strict=True)
    if readings:
        found[-1] = final.accuracy, found[-1][1]
    return [Moment(*each, end) for each, end in zip(found, (0.0, *final.stages.timed.ends), strict=True)]
