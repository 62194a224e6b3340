"""What a bad reading does that the others do not contradict: it is believed, and the curve bends to it.

A bad reading is a departure like any other, b = 1 at one number and φ = 0. With v the variance of that number where all
others say what to expect, I = 1/v, and without it J rises by L = |e|² v:

    D² = need L/(κ² − 1)

Of several numbers it is bad in the direction that makes D largest. No promise is held against it, for readings are
rarely bad, and any one of many would have to be: where it does much, it is said which of them would be believed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.accuracy.damage import Harm
from axiscal.estimation.effect_map import EffectMap
from axiscal.measurement.reading import Reading
from axiscal.numerics.ties import ALIKE, ranked


@dataclass(frozen=True, slots=True)
class Slip:
    """What a reading does where it alone is bad.  harm : in the direction that harms most"""

    reading: Reading
    harm: Harm


def slips(readings: Sequence[Reading], effects: EffectMap) -> tuple[Slip, ...]:
    """Return what each of the readings with these effects does where it is bad, the most harmful first."""
    harms = effects.alone(np.repeat(np.arange(len(readings)), [len(each.values) for each in readings]))
    order = ranked(np.array([each.damage for each in harms]), ALIKE)
    return tuple(Slip(readings[index], harms[index]) for index in order.tolist())
