"""Last stage: readings that are far from normal, each taken for what it says: an interval, or perhaps a chip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from axiscal.estimation.absorbed import Absorbed, absorbed
from axiscal.inference.intervals import is_odd, may_have_chips, sited
from axiscal.inference.outliers import NOTHING, Doubt, Verdict
from axiscal.measurement.reading import Reading


def displayed(known: Absorbed, readings: Sequence[Reading], implausible: Mapping[int, Doubt]) -> Absorbed:
    """Return what is known with such readings instead of normal ones, and the surprises as they were.

    known : after all readings, each as the value that was shown
    Where chips are expected no other weight doubts a reading.
    """
    observation = known.case.observation
    setups = {setup.name: setup for setup in observation.setups}
    if not any(is_odd(setup) for setup in observation.setups):
        return known
    said = known.weights(0, len(readings), {})
    pairs = zip(said, readings, strict=True)
    verdict = Verdict(known.verdict.doubts, tuple(1.0 if may_have_chips(setups[r.setup], r) else w for w, r in pairs))
    known = replace(known, verdict=verdict)
    weights = known.weights(0, len(readings), implausible)
    kept = [index for index, weight in enumerate(weights) if weight > NOTHING]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    taken = [instead.get(index, reading) for index, reading in enumerate(readings)]
    fresh = absorbed(Absorbed.nothing(known.case, known.verdict), taken, implausible)
    return replace(fresh, innovations=known.innovations)
