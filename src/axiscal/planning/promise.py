"""How well a machine will be known after a plan."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.accuracy.yardstick import Accuracy
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading


def promised(case: Case, knowledge: Knowledge, places: Sequence[Place]) -> Accuracy:
    """Return how well the machine would be known after readings at these places, whatever they showed."""
    values = {setup.name: INSTRUMENTS[setup.instrument].values for setup in case.description.setups}
    readings = [Reading(p.setup, p.pose, p.approach, 0.0, others=(0.0,) * (values[p.setup] - 1)) for p in places]
    return case.yardstick.measure(knowledge.read(readings).belief)
