"""The answer that a campaign gives, as plain data: what was asked for, whether it is reached, the rows; in um, urad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

from axiscal.description.wants import Kind

Verdict = Literal["measured", "reached", "more", "unreachable", "contradict", "nothing"]
"""Nothing was asked for; it is reached; more readings would; none would; readings contradict; none was taken."""


@dataclass(frozen=True, slots=True)
class AnswerLine:
    """Where a row holds: the axis that moves, from where to where, and the pose in which the others stand, mm or deg.

    plus, minus, both : number of places read from either side, and from both; setup : by which, "" for none
    """

    setup: str
    axis: str
    low: float
    high: float
    at: Mapping[str, float]
    plus: int
    minus: int
    both: int


@dataclass(frozen=True, slots=True)
class AnswerRow:
    """A row, in `unit`: fields as of `answer.rows.AnsweredRow`."""

    kind: Kind
    axes: Sequence[str]
    name: str
    unit: str
    found: float
    largest: float
    known: float
    before: float
    floor: float
    left: Mapping[str, float]
    limit: float | None
    reached: bool | None
    measured: bool
    lines: Sequence[AnswerLine]
    then: float | None = None


class Aim(NamedTuple):
    """What is asked for, in `unit`: name is "rms", "worst" or "U" of the volume, or that of a row.

    now : how well it is known; reachable : whether endless readings would reach it
    unread : lines that nobody has read, without which it is not measured
    """

    name: str
    now: float
    limit: float
    floor: float
    measured: bool = True
    reachable: bool = True
    unread: int = 0
    unit: str = "um"

    @property
    def reached(self) -> bool:
        """Whether it is known as well as asked for."""
        return self.measured and self.now <= self.limit


@dataclass(frozen=True, slots=True)
class ResultAnswer:
    """aims : what is asked for, the accuracies of the volume first

    more : readings that would reach it, and more_minutes their machine time; 0 where none are missing
    minutes : of the clock where clocked, else of the plan
    """

    verdict: Verdict
    rows: Sequence[AnswerRow]
    aims: Sequence[Aim]
    more: int
    more_minutes: float
    minutes: float
    clocked: bool
