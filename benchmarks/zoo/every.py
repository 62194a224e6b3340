"""All animals."""

from __future__ import annotations

from benchmarks.zoo.animals import Animal
from benchmarks.zoo.beds import BEDS
from benchmarks.zoo.curves import CURVES, LEADS, WARM
from benchmarks.zoo.mills import MILLS
from benchmarks.zoo.slips import SLIPS

EVERY: tuple[Animal, ...] = (*LEADS, *WARM, *CURVES, *BEDS, *MILLS, *SLIPS)
