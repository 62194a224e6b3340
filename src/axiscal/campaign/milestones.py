"""Where a campaign stands, and how it came there."""

from __future__ import annotations

from dataclasses import dataclass

from axiscal.accuracy.yardstick import Accuracy
from axiscal.measurement.reading import Reading
from axiscal.record.events import State


@dataclass(frozen=True, slots=True)
class Status:
    """Where the campaign stands: seconds of machine time used, and why it would stop now, if it would.

    verdict, verdict_words : of one that has ended, its word and a sentence; "" of others, and where the report has none
    """

    state: State
    accuracy: Accuracy
    seconds: float
    reached: str | None
    verdict: str = ""
    verdict_words: str = ""


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
