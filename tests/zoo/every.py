"""All animals."""

from __future__ import annotations

from tests.zoo.animals import Animal
from tests.zoo.axes import LEADS

EVERY: tuple[Animal, ...] = (*LEADS,)
