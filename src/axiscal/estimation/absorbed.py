"""Readings taken into what is known, many at once, which is the same as one by one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.estimation.belief import Innovations
from axiscal.estimation.case import Case
from axiscal.estimation.inference.intervals import is_coarse, sited
from axiscal.estimation.knowledge import Block, Knowledge, taken
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen
from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Absorbed:
    """case : with the set-ups that were read from other sides than they say; left_out : readings that do not count

    blocks : of all readings, those left out as well
    """

    case: Case
    left_out: frozenset[int]
    knowledge: Knowledge
    blocks: tuple[Block, ...]

    @property
    def innovations(self) -> tuple[Innovations, ...]:
        """Those of each reading."""
        return tuple(each for part in self.blocks for each in part.innovations)

    def precisions(self, numbers: Seen) -> Array:
        """Return one over the variance of each number of the readings, 0 of those that are left out, (m,)."""
        precisions: Array = ~np.isin(numbers.reading, [*self.left_out]) / numbers.variances
        return precisions


def absorbed(case: Case, readings: Sequence[Reading], left_out: Iterable[int] = ()) -> Absorbed:
    """Return what is known after readings.  left_out : indices of those that do not count"""
    apart = frozenset(left_out)
    blocks, knowledge = taken(case.knowledge, readings, apart)
    return Absorbed(_widened(case, readings), apart, knowledge, blocks)


def _widened(case: Case, readings: Sequence[Reading]) -> Case:
    """Return the case with set-ups that were read from sides which nobody said they allow."""
    other = {reading.setup for reading in readings if not case.came_as_allowed(reading)}
    return replace(case, both=case.both | other) if other else case


def displayed(known: Absorbed, readings: Sequence[Reading]) -> Absorbed:
    """Return what is known with such readings instead of normal ones, and the surprises as they were.

    known : after all readings, each as the value that was shown
    """
    normal = taken_as_normal(known, readings)
    if normal is readings:
        return known
    fresh = absorbed(known.case, normal, known.left_out)
    return replace(fresh, blocks=known.blocks)


def taken_as_normal(known: Absorbed, readings: Sequence[Reading]) -> Sequence[Reading]:
    """Return the readings with normal ones in the place of those that are far from normal; themselves if none is."""
    observation = known.case.observation
    if not any(is_coarse(setup) for setup in observation.setups):
        return readings
    kept = [index for index in range(len(readings)) if index not in known.left_out]
    instead = dict(zip(kept, sited(observation, [readings[i] for i in kept], known.case.inherited), strict=True))
    return [instead.get(index, reading) for index, reading in enumerate(readings)]
