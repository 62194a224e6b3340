"""Readings taken into what is known, many at once, which is the same as one by one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.belief import Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.inference.intervals import is_odd, sited
from axiscal.estimation.inference.outliers import NOTHING, Doubt, Verdict
from axiscal.estimation.knowledge import AT_ONCE, Block, Knowledge, block
from axiscal.estimation.learnt import UNDISPUTED
from axiscal.measurement.reading import Reading


@dataclass(frozen=True, eq=False, slots=True, weakref_slot=True)
class Absorbed:
    """case : with the set-ups that were read from other sides than they say; verdict : how much the readings count

    innovations : of each reading in the knowledge
    weights : how much each counts; an implausible one, whose value may be of any size, not at all
    """

    case: Case
    verdict: Verdict
    knowledge: Knowledge
    innovations: tuple[Innovations, ...]
    weights: tuple[float, ...]


def absorbed(
    case: Case, readings: Sequence[Reading], implausible: Mapping[int, Doubt], verdict: Verdict = UNDISPUTED
) -> Absorbed:
    """Return what is known after readings."""
    said = verdict.weights or (1.0,) * len(readings)
    weights = tuple(0.0 if index in implausible else weight for index, weight in enumerate(said))
    knowledge, innovations = case.knowledge, list[Innovations]()
    for after, part in blocks(case, knowledge, readings, weights):
        case, knowledge = after, part.after
        innovations += part.innovations
    return Absorbed(case, verdict, knowledge, tuple(innovations), weights)


def blocks(
    case: Case, knowledge: Knowledge, readings: Sequence[Reading], weights: Sequence[float]
) -> Iterator[tuple[Case, Block]]:
    """Yield what readings make of case and knowledge, some hundreds at a time.

    weights : how much each counts; 0 is predicted and not used
    """
    for after, start, stop in _parts(case, readings):
        part = block(knowledge, readings[start:stop], np.array(weights[start:stop]))
        knowledge = part.after
        yield after, part


def _parts(case: Case, readings: Sequence[Reading]) -> Iterator[tuple[Case, int, int]]:
    """Yield parts of the readings through which the case stays the same: the case, and from which to before which.

    It changes where a reading came from a side that its set-up does not allow.
    """
    start = 0
    for index, reading in enumerate(readings):
        after = _widened(case, reading)
        if index > start and (after is not case or index - start == AT_ONCE):
            yield case, start, index
            start = index
        case = after
    if start < len(readings):
        yield case, start, len(readings)


def _widened(case: Case, reading: Reading) -> Case:
    """Return the case after a reading: it may have come from a side that nobody said its set-up allows."""
    if reading.setup in case.both or case.came_as_allowed(reading):
        return case
    return replace(case, both=case.both | {reading.setup})


def displayed(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known with such readings instead of normal ones, and the surprises as they were.

    known : after all readings, each as the value that was shown
    """
    taken = taken_as_normal(known, readings)
    if taken is readings:
        return known
    fresh = absorbed(known.case, taken, implausible, known.verdict)
    return replace(fresh, innovations=known.innovations)


def taken_as_normal(known: Absorbed, readings: Sequence[Reading]) -> Sequence[Reading]:
    """Return the readings with normal ones in the place of those that are far from normal; themselves if none is."""
    observation = known.case.observation
    if not any(is_odd(setup) for setup in observation.setups):
        return readings
    kept = [index for index, weight in enumerate(known.weights) if weight > NOTHING]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    return [instead.get(index, reading) for index, reading in enumerate(readings)]
