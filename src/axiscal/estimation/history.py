"""How a campaign went, seen when it is over: which readings are bad is known from the first one on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from axiscal.accuracy.yardstick import Accuracy
from axiscal.belief import Innovations
from axiscal.estimation.absorbed import Absorbed
from axiscal.estimation.bands import banded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.learnt import counts_to_learn_from, learnt
from axiscal.estimation.located import located
from axiscal.estimation.updating import blocks
from axiscal.inference.fit import Fit
from axiscal.numerics.stages import counted
from axiscal.numerics.threads import one_thread


class Moment(NamedTuple):
    """What is known after a reading, its innovations (None before the first), and after how many seconds."""

    accuracy: Accuracy
    innovations: Innovations | None
    seconds: float


@one_thread()
def path(final: Estimation) -> list[Moment]:
    """Return what was known before the first reading and after each.

    final : a concluded one
    How much each reading counts and where readings are linearised is what all of them show. Scales are learnt as
    readings come, and what the last one taught is known already.
    """
    found = _as_learnt(final) if final.stated.variable else _as_found(final)
    return [Moment(*each, end) for each, end in zip(found, (0.0, *final.stages.timed.ends), strict=True)]


_Known = tuple[Accuracy, Innovations | None]


def _as_found(final: Estimation) -> list[_Known]:
    """Return what was known with stated scales, from one pass through the readings."""
    as_shown = final.stages.absorbed
    known = Absorbed.nothing(final.stated.linear_as(as_shown.case), as_shown.verdict)
    return [(_accuracy(known, None), None), *_together(final, known, None, len(final.readings))]


def _as_learnt(final: Estimation) -> list[_Known]:
    """Return what was known with scales learnt so far: readings between two counts of them are taken in together."""
    known, fit = Absorbed.nothing(final.stated, final.stages.absorbed.verdict), None
    found: list[_Known] = [(_accuracy(known, fit), None)]
    readings, implausible = final.readings, final.stages.judged.implausible
    last = max(len(readings) - 1, 0)
    dues = list(counts_to_learn_from(final.stated, last))
    for due in counted("how it went, reading by reading", dues, len(dues)):
        found += _together(final, known, fit, due - 1)
        scales = learnt(final.stated, readings[:due], implausible)
        known, fit = located(scales, readings[:due], implausible), scales.fit
        found.append((_accuracy(known, fit), known.innovations[-1]))
    found += _together(final, known, fit, last)
    if last < len(readings):
        found.append((final.accuracy, final.innovations[-1]))
    return found


def _together(final: Estimation, known: Absorbed, fit: Fit | None, stop: int) -> Iterator[_Known]:
    """Yield what is known after each reading since, up to a count."""
    start = len(known.innovations)
    weights = known.weights(start, stop, final.stages.judged.implausible)
    for case, part in blocks(known.case, known.knowledge, final.readings[start:stop], weights):
        wide, before = banded(case, part.before, fit)
        yield from zip(replace(part, before=before).accuracies(wide.yardstick), part.innovations, strict=True)


def _accuracy(known: Absorbed, fit: Fit | None) -> Accuracy:
    case, knowledge = banded(known.case, known.knowledge, fit)
    return case.yardstick.measure(knowledge.belief)
