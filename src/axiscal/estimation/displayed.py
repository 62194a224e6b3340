"""Last stage: readings that are far from normal, each taken for what it says: an interval, or perhaps a chip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.inference.intervals import is_odd, sited
from axiscal.inference.outliers import NOTHING, Doubt
from axiscal.measurement.reading import Reading


def displayed(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known with such readings instead of normal ones, and the surprises as they were.

    known : after all readings, each as the value that was shown
    """
    taken = taken_as_normal(known, readings, implausible)
    if taken is readings:
        return known
    fresh = absorbed(Absorbed.nothing(known.case, known.verdict), taken, implausible)
    return replace(fresh, innovations=known.innovations)


def taken_as_normal(
    known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]
) -> Sequence[Reading]:
    """Return the readings with normal ones in the place of those that are far from normal; themselves if none is."""
    observation = known.case.observation
    if not any(is_odd(setup) for setup in observation.setups):
        return readings
    weights = known.weights(0, len(readings), implausible)
    kept = [index for index, weight in enumerate(weights) if weight > NOTHING]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    return [instead.get(index, reading) for index, reading in enumerate(readings)]
