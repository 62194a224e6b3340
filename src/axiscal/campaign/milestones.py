"""The status of a campaign, and the way there."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.estimation.accuracy.yardstick import Accuracy
from axiscal.estimation.promise.agreement import NOTHING_READ, Agreement
from axiscal.measurement.reading import Reading
from axiscal.record.events import State


@dataclass(frozen=True, slots=True)
class Status:
    """Where the campaign stands: seconds of machine time used, and why it would stop now, if it would.

    agreement : whether the readings agree with each other
    """

    state: State
    accuracy: Accuracy
    seconds: float
    reached: str | None
    agreement: Agreement = NOTHING_READ


@dataclass(frozen=True, slots=True)
class Milestone:
    """The last of so many readings taken (None: before the first), how well the machine was known, and the seconds."""

    taken: int
    reading: Reading | None
    accuracy: Accuracy
    seconds: float

    @property
    def number(self) -> int:
        """The number of the reading, 0 before the first."""
        return 0 if self.reading is None else self.reading.numbered(self.taken - 1)
