"""All animals."""

from __future__ import annotations

from tests.zoo.animals import Animal
from tests.zoo.beds import BEDS
from tests.zoo.curves import CURVES, LEADS, WARM
from tests.zoo.mills import MILLS
from tests.zoo.slips import SLIPS

EVERY: tuple[Animal, ...] = (*LEADS, *WARM, *CURVES, *BEDS, *MILLS, *SLIPS)
