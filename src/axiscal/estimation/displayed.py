"""Last stage: readings of a display whose step is coarse beside their scatter, each taken for its interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.inference.intervals import is_coarse, sited
from axiscal.inference.outliers import NOTHING, Doubt
from axiscal.measurement.reading import Reading


def displayed(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known with intervals in the place of values, and the surprises as they were.

    known : after all readings, each as the value that was shown
    """
    observation = known.case.observation
    if not any(is_coarse(setup) for setup in observation.setups):
        return known
    weights = known.weights(0, len(readings), implausible)
    kept = [index for index, weight in enumerate(weights) if weight > NOTHING]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    taken = [instead.get(index, reading) for index, reading in enumerate(readings)]
    fresh = absorbed(Absorbed.nothing(known.case, known.verdict), taken, implausible)
    return replace(fresh, innovations=known.innovations)
