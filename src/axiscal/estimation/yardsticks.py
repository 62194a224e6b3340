"""Yardsticks that cases made from one another share: each is found once for all that it follows from.

A case is made anew after every few readings, about another machine or with what was learnt so far, and a yardstick
looks at thousands of poses.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import NamedTuple, TypeVar

from axiscal.accuracy.alignment import Alignment
from axiscal.accuracy.yardstick import Yardstick
from axiscal.error_model.volume import VolumeMoments
from axiscal.numerics import Array

_MOST = 4
"""The case as stated, as learnt, with bands and with what explains the readings; 1,000 unknowns take 50 MB each."""
Found = TypeVar("Found")


class MeasuredVolume(NamedTuple):
    """Means over the target's volume, and of what poses; `sample` and `alignment` as of a yardstick."""

    moments: VolumeMoments
    sample: Array | None
    alignment: Alignment | None


class Yardsticks:
    """The last few yardsticks and volumes, each by what it follows from."""

    def __init__(self) -> None:
        self._yardsticks: dict[Hashable, Yardstick] = {}
        self._volumes: dict[Hashable, MeasuredVolume] = {}

    def yardstick(self, grounds: Hashable, find: Callable[[], Yardstick]) -> Yardstick:
        """Return the yardstick of these grounds.  find : it, where it is not among the last few"""
        return _among(self._yardsticks, grounds, find)

    def volume(self, grounds: Hashable, find: Callable[[], MeasuredVolume]) -> MeasuredVolume:
        """Return the volume of these grounds.  find : it, where it is not among the last few"""
        return _among(self._volumes, grounds, find)


def _among(known: dict[Hashable, Found], grounds: Hashable, find: Callable[[], Found]) -> Found:
    """Return what follows from grounds, and keep it in the place of what was not asked for the longest."""
    found = known.pop(grounds) if grounds in known else find()
    while len(known) >= _MOST:
        del known[next(iter(known))]
    known[grounds] = found
    return found
