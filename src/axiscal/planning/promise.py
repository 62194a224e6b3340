"""How well a machine will be known after a plan, and at best."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.accuracy.yardstick import Accuracy
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.place import Place
from axiscal.measurement.reading_rows import blank_readings


def promised(case: Case, knowledge: Knowledge, places: Sequence[Place]) -> Accuracy:
    """Return how well the machine would be known after readings at these places, whatever they showed."""
    return case.yardstick.measure(knowledge.read(blank_readings(case.description.setups, places)).belief)


def reachable_rms(case: Case) -> float:
    """Return the RMS over the volume that endless readings would leave, m."""
    return case.yardstick.floors[0]
