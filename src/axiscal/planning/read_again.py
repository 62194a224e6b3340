"""Places to be read once more, where a promise rests on a noise that nothing tells from the machine."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge
from axiscal.estimation.scatter import open_rests, scattered
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading


def to_read_again(case: Case, knowledge: Knowledge, readings: Sequence[Reading]) -> tuple[Place, ...]:
    """Return as many places as are lacking, spread over those that were read, the last first; none where readings tell.

    readings : so far, at least one
    """
    rests = open_rests(case, case.description.machine)
    if not rests:
        return ()
    found = scattered(case.observation, readings, ReadingSet(case.observation, readings), case.yardstick, rests)
    if found is None or found.bearable <= case.yardstick.measure(knowledge.belief).rms:
        return ()
    name = case.description.setups[found.setup].name
    mine = list(dict.fromkeys(reading.place for reading in reversed(readings) if reading.setup == name))
    chosen = np.linspace(0, len(mine) - 1, min(found.lacking, len(mine))).round().astype(int)
    return tuple(mine[index] for index in chosen.tolist())
