"""What is known while a machine is read: the map to readings and the belief over its unknowns, in one object.

A reading opens the rest of each cell that it meets as a separate unknown. So reading there again does not average the
rest away. Map and belief grow together, and neither can be forgotten.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, seen, visited
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread


@dataclass(frozen=True, eq=False, slots=True)
class Knowledge:
    """observation : with columns for the rests of visited cells; belief : over all its columns"""

    observation: Observation
    belief: Normal

    @one_thread()
    def read(self, readings: Sequence[Reading]) -> Knowledge:
        """Return what is known after readings."""
        wider = visited(self.observation, places_of(self.observation.setups, readings))
        belief, numbers = self.belief.wider(np.sqrt(self.observation.rest_variances(wider))), seen(wider, readings)
        return Knowledge(wider, belief.read(numbers.rows, numbers.values, numbers.variances))
