"""How a campaign went, seen when it is over: which readings are bad, and the sizes, are known from the first one on."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.estimation.belief import Innovations
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import blocks
from axiscal.numerics.threads import one_thread


class Moment(NamedTuple):
    """The accuracy after a reading, its innovations (None before the first), and its time in seconds."""

    accuracy: Accuracy
    innovations: Innovations | None
    seconds: float


@one_thread()
def path(final: Estimation) -> list[Moment]:
    """Return what was known before the first reading and after each, in one pass with the sizes known at the end.

    final : a concluded one. Its last figures are those of the posterior, with the sizes averaged over.
    """
    as_shown, readings = final.stages.absorbed, final.readings
    start = as_shown.case
    found: list[tuple[Accuracy, Innovations | None]] = [(start.yardstick.measure(start.prior), None)]
    for part in blocks(start.knowledge, readings, as_shown.left_out):
        found += zip(part.accuracies(start.yardstick), part.innovations, strict=True)
    if readings:
        found[-1] = final.accuracy, found[-1][1]
    return [Moment(*each, end) for each, end in zip(found, (0.0, *final.stages.timed.ends), strict=True)]
