"""Readings that are not used."""

from __future__ import annotations

from typing import NamedTuple


class Doubt(NamedTuple):
    """A reading that is not used: its index from 0, and standard deviations from what the others predict.

    implausible : no error of about the stated size could make it; the standard deviations are then those of the prior
    """

    reading: int
    surprise: float
    implausible: bool = False
