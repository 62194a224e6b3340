"""One reading: what an instrument said at one position of the machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.measurement.place import Place

LARGEST = 1e3
"""m or rad: no machine deviates by a kilometre; any bound between a machine's size and this would do."""


@dataclass(frozen=True, slots=True)
class Reading:
    """A deviation, actual minus commanded, of the TCP relative to the workpiece along (about) the set-up's direction.

    setup : name of the set-up
    pose : (n_axes,) m or rad, in chain order
    approach : (n_axes,) +1 or -1 where the direction of the last motion is known, else 0
    value : m or rad; along x where an instrument reads three directions
    others : its values along y and z
    time : when it was taken, s since the campaign began; None where nobody looked at a clock
    std : standard deviation of this reading in the unit of the value; None takes the set-up's noise
    line : line of the file it came from, if it came from one
    accepted : somebody vouches for it, however much it surprises
    number : under which a campaign knows it for life, from 1; None outside of a campaign
    """

    setup: str
    pose: tuple[float, ...]
    approach: tuple[int, ...]
    value: float
    std: float | None = None
    line: int | None = None
    accepted: bool = False
    others: tuple[float, ...] = ()
    time: float | None = None
    number: int | None = None

    @property
    def place(self) -> Place:
        """Where it was taken."""
        return Place(self.setup, self.pose, self.approach)

    def numbered(self, index: int) -> int:
        """Return its number; where no campaign gave one, that of its place in the list of readings, from 1."""
        return index + 1 if self.number is None else self.number

    def under(self, number: int) -> Reading:
        """Return the same reading under the number by which a campaign knows it."""
        of_value = self.value, self.std, self.line, self.accepted, self.others, self.time
        return Reading(self.setup, self.pose, self.approach, *of_value, number)

    @property
    def values(self) -> tuple[float, ...]:
        """All numbers of the reading, m or rad."""
        return (self.value, *self.others)


def drawn(readings: Sequence[Reading], most: int) -> list[Reading]:
    """Return all readings, or `most` of them, drawn the same way each time."""
    if len(readings) <= most:
        return list(readings)
    chosen = np.sort(np.random.default_rng(0).choice(len(readings), most, replace=False))
    return [readings[int(i)] for i in chosen]
