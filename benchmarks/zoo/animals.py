"""What an animal of the zoo is: a job as a stranger describes it, what is read, and what is true."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from benchmarks.zoo.answers import Answer

KEPT, INSIDE = 0.95, 0.85
"""Least share of a slope that a table keeps, and of the truth that lies inside U, of one kind of animal."""


@dataclass(frozen=True, slots=True)
class Job:
    """What a person gives `axiscal init`, and which lines of its files they change then.

    machine : a built-in machine, or the text of a LinuxCNC's INI file
    stated : pairs of a text in campaign.toml and what stands there instead; ("", line) puts a line at the head
    errors : the only errors that machine.toml keeps; all of them where none is named
    """

    machine: str
    instruments: tuple[str, ...]
    target: str
    stated: tuple[tuple[str, str], ...] = ()
    errors: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Slope:
    """table, read : the slope of the table and of the readings; std : what noise gives to that of the readings"""

    table: float
    read: float
    std: float

    @property
    def share(self) -> float:
        """The share that is kept."""
        return self.table / self.read

    @property
    def holds(self) -> bool:
        """Whether enough is kept; half a standard deviation is nobody's fault."""
        return abs(self.table - self.read) <= (1 - KEPT) * abs(self.read) + 0.5 * self.std


class Truth(ABC):
    """What is true of a machine."""

    @abstractmethod
    def left(self, answer: Answer) -> Array:
        """Return how far off the tool is where the answer is put to use, (p,) um, all places counting alike."""

    def promised(self, answer: Answer) -> float:
        """Return the U that is printed for it, um: with the tables, unless said otherwise."""
        return answer.expanded_with_tables()

    def kept(self, _: Answer) -> Slope | None:
        """Return what the table keeps of the slope that was read; None without a slope."""
        return None


@dataclass(frozen=True, slots=True)
class Met:
    """One animal met: the text of the file of readings, the truth, and the file's name."""

    readings: str
    truth: Truth
    file: str = "readings.csv"


@dataclass(frozen=True, slots=True)
class Animal:
    """A kind of truth.

    name : with its kind before the colon
    meet : from a seed to readings and truth
    cause : what an answer says that names the cause or asks for it; "" where only right figures will do
    asked : nothing but the name of the cause will do
    """

    name: str
    job: Job
    meet: Callable[[int], Met]
    cause: str = ""
    asked: bool = False

    @property
    def kind(self) -> str:
        """The family of animals that are averaged."""
        return self.name.partition(":")[0]

    def named_in(self, text: str) -> bool:
        """Return whether a text names the cause."""
        return bool(self.cause) and re.search(self.cause, " ".join(text.split()), re.IGNORECASE) is not None


@dataclass(frozen=True, slots=True)
class Interval:
    """How ± `half` about what is said does.

    half, far : um, and where 95 % of the truth lie; inside : share of the truth within
    """

    half: float
    far: float
    inside: float

    @classmethod
    def about(cls, left: Array, half: float) -> Interval:
        """Return how it does.  left : truth beside what is said, (p,) um"""
        size = np.abs(left)
        return cls(half, float(np.quantile(size, 0.95)), float(np.mean(size <= half)))


@dataclass(frozen=True, slots=True)
class Judged:
    """What became of one animal.

    interval : how U does, None where none is printed; kept : what the table keeps of the slope, None without one
    named : whether the cause is named; said : all that a person is told
    """

    animal: Animal
    seed: int
    interval: Interval | None
    kept: Slope | None
    named: bool
    said: str = ""

    @property
    def holds(self) -> bool:
        """Whether the figures are right, or the cause is named."""
        return self.named or (not self.animal.asked and self.figures_hold)

    @property
    def figures_hold(self) -> bool:
        """Whether a U is printed, the truth lies inside it, and the table keeps the slope."""
        slope = self.kept is None or self.kept.holds
        return self.interval is not None and self.interval.inside >= INSIDE and slope
