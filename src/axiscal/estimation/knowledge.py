"""What is known while a machine is read: the map to readings and the belief over its unknowns, in one object.

    knowledge = case.knowledge
    knowledge = knowledge.read(readings)

A reading opens the rest of each cell that it meets as a separate unknown. So reading there again does not average the
rest away. Map and belief grow together, and neither can be forgotten.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.estimation.accuracy.yardstick import Accuracy, Yardstick
from axiscal.measurement.cells import Cell
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import places_of, seen, times_of, visited
from axiscal.numerics import Array
from axiscal_core.normal import Normal, condition
from axiscal_core.threads import one_thread

AT_ONCE = 400
"""Products of matrices cost the least for some hundreds of readings at a time."""


@dataclass(frozen=True, eq=False, slots=True)
class Knowledge:
    """observation : with columns for the rests of visited cells and for drifts; belief : over all its columns"""

    observation: Observation
    belief: Normal

    def opened(self, readings: Sequence[Reading], among: Collection[Cell] | None = None) -> Knowledge:
        """Return the same with the unknowns of cells and drifts that readings will meet.

        among : cells that may have one, None for all; others count as noise
        """
        places = places_of(self.observation.setups, readings)
        wider = visited(self.observation, places, times_of(readings), among)
        return Knowledge(wider, self.belief.wider(np.sqrt(self.observation.rest_variances(wider))))

    @one_thread()
    def read(self, readings: Sequence[Reading]) -> Knowledge:
        """Return what is known after readings."""
        return taken(self, readings)[1]


class Innovations(NamedTuple):
    """By what the numbers of a reading surprised: each of them minus its prediction.

    value : (k,); std : (k,) the standard deviation that was foreseen, noise included
    """

    value: Array
    std: Array


class Block(NamedTuple):
    """Readings that were taken together.

    innovations : of each; factor : F (errors, r) of what was known of the errors before them
    losses : (m, errors) what each of their numbers took off the covariance, d dᵀ
    """

    innovations: tuple[Innovations, ...]
    factor: Array
    losses: Array

    def accuracies(self, yardstick: Yardstick) -> list[Accuracy]:
        """Return how well the machine was known after each reading."""
        return yardstick.accuracies(self.factor, self.losses, np.cumsum([len(each.value) for each in self.innovations]))


def taken(
    knowledge: Knowledge,
    readings: Sequence[Reading],
    left_out: Collection[int] = (),
    among: Collection[Cell] | None = None,
) -> tuple[tuple[Block, ...], Knowledge]:
    """Return readings, some hundreds at a time, and what is known after them.

    left_out : indices of those that are predicted and not used; among : as of `Knowledge.opened`
    """
    found = list[Block]()
    for start in range(0, len(readings), AT_ONCE):
        mine = readings[start : start + AT_ONCE]
        before = knowledge.opened(mine, among)
        belief, numbers = before.belief, seen(before.observation, mine)
        counts = ~np.isin(start + numbers.reading, [*left_out])
        used = np.where(counts, numbers.variances, np.inf)
        # numbers of one reading are predicted from what was known before the first of them
        earlier = np.append(0, np.cumsum(counts))[np.searchsorted(numbers.reading, numbers.reading)]
        done = condition(belief.factor, belief.mean, numbers.rows, numbers.values, used, earlier)
        surprise = numbers.values - done.expected, np.sqrt(done.variance + numbers.variances)
        cuts = np.searchsorted(numbers.reading, np.arange(1, len(mine)))
        innovations = zip(*(np.split(part, cuts) for part in surprise), strict=True)
        errors = before.observation.errors.size
        own = belief.factor[:errors].copy(), done.losses[:, :errors].copy()  # the rest of them is large
        found.append(Block(tuple(Innovations(*each) for each in innovations), *own))
        knowledge = Knowledge(before.observation, Normal.of_factor(done.mean, done.root))
    return tuple(found), knowledge
