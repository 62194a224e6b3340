"""What a bad reading does that the others do not contradict: it is believed, and the curve bends to it.

A bad reading is a departure like any other, b = 1 at its numbers and φ = 0. With v the variance of its number where all
others say what to expect, I = 1/v, and J rises by L = |e|² v without it:

    D² = need L/(κ² − 1)

No promise is held against it, for readings are rarely bad, and any one of many would have to be: where it does much, it
is said which reading has nothing beside it that contradicts it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.accuracy.damage import Harm
from axiscal.measurement.reading import Reading


@dataclass(frozen=True, slots=True)
class Slip:
    """What one bad reading may do.

    reading, index : which does most; size : m or rad, up to which it may not be shown; no more than is considered
    damages : (m,) what each of them does when it is just seen, m
    """

    reading: Reading
    index: int
    size: float
    damages: Sequence[float]

    def believed(self, least: float) -> int:
        """Return how many of them do more than so much, m."""
        return sum(each > least for each in self.damages)


def slipped(readings: Sequence[Reading], harms: Sequence[Harm]) -> Slip:
    """Return what one bad reading may do.  harms : of each reading as a bad one"""
    damages = [each.damage for each in harms]
    index = int(np.argmax(damages))
    return Slip(readings[index], index, min(harms[index].seen_from, harms[index].most), damages)
