"""What is promised of the tool point, and whether the readings agree with each other, in display units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """Expanded uncertainties of the tool point over the volume, 95 %, um.

    space : of the distance; axes : along x, y, z of the workpiece frame; worst : of the distance at the worst place
    factor : k, `space` over the standard uncertainty; conditions : what it was evaluated for, in words
    along : the directions whose distance `space` and `worst` are, such as "z" of a bed; all of them where it is "xyz"
    """

    space: float
    axes: tuple[float, float, float]
    worst: float
    factor: float
    conditions: str = ""
    along: str = "xyz"


@dataclass(frozen=True, slots=True)
class Linear:
    """How linear machine and readings are.

    bound_um : no machine within the bands differs by more from its first order; index : the largest ν of a reading
    words : the same in a sentence
    """

    bound_um: float
    index: float
    words: str


@dataclass(frozen=True, slots=True)
class NamedMistake:
    """A mistake that explains readings that contradict: its kind, its odds, the set-ups it is about, and in words."""

    mistake: str
    odds: float
    setups: Sequence[str]
    words: str


@dataclass(frozen=True, slots=True)
class ReadingAgreement:
    """Whether the readings agree with each other.

    count : readings that were compared; agreeing : those that agree with the others; c2 : mean square of what they are
    off, in standard deviations; p : probability of readings that agree no better; contradict : p is too small
    explained : mistakes that are named, the likeliest first; words : all that in a sentence, "" before the first
    """

    count: int = 0
    agreeing: int = 0
    c2: float = 1.0
    p: float = 1.0
    contradict: bool = False
    explained: Sequence[NamedMistake] = ()
    words: str = ""

    @property
    def sentences(self) -> Sequence[str]:
        """The words with their full stop, none before the first reading."""
        return [f"{self.words}."] if self.words else []

    @property
    def mark(self) -> str:
        """What stands on each page of a report whose readings contradict; else ""."""
        return self.words if self.contradict else ""


NOTHING_READ = ReadingAgreement()
