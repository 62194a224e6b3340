"""Readings that are not believed, and how much each reading counts."""

from __future__ import annotations

from typing import NamedTuple

NOTHING = 1e-9
"""Weight of a reading that does not count: small enough to be none, large enough to divide by."""


class Doubt(NamedTuple):
    """A reading that stands out: its index from 0, standard deviations from what the others predict, and its weight.

    implausible : no error of about the stated size could make it; the standard deviations are then those of the prior
    """

    reading: int
    surprise: float
    weight: float
    implausible: bool = False

    @property
    def rejected(self) -> bool:
        """Whether the reading is not used at all."""
        return self.weight <= NOTHING


class Verdict(NamedTuple):
    """doubts : the readings that stand out, those that are not used first; weights : of all readings, up to 1."""

    doubts: tuple[Doubt, ...]
    weights: tuple[float, ...]
