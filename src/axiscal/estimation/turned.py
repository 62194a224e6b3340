"""Before readings are doubted: how trackers are turned that were set down by eye."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import seen

_ROUNDS = 12
"""Rounds end where the turn stays; this only ends what would go round."""


def turned(case: Case, readings: Sequence[Reading], implausible: Collection[int]) -> Case:
    """Return the case about the turns of trackers that its plausible readings show.

    A reading is linear only about the turn that its tracker is taken to have: about none, 20 mrad make good ones bad.
    """
    kept = [reading for index, reading in enumerate(readings) if index not in implausible]
    for _ in range(_ROUNDS if case.turned and kept else 0):
        shown = seen(case.observation, kept)
        found = case.located(case.prior.update(shown.rows, shown.values, shown.variances).mean)
        if found is None:
            break
        case = found
    return case
