"""The problems that all are given: stacked natural splines on [0, 10], C0 = I, scalar readings.

Nothing here knows axiscal, so that a rival's own environment can load it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CriterionName = Literal["joint", "volume"]

CRITERIA: tuple[CriterionName, ...] = ("joint", "volume")
TRAVEL = 10.0
CANDIDATES = 2000
"""So many fixed candidates are given to those that choose from a list."""


class Stacked(NamedTuple):
    """Stacked natural splines on [0, 10], C0 = I, scalar readings with the standard deviation `noise`."""

    letter: str
    title: str
    axes: int
    knots: int
    noise: float
    readings: int

    @property
    def name(self) -> str:
        """The letter and what it stands for."""
        return f"({self.letter}) {self.title}"

    @property
    def size(self) -> int:
        """The number of control values."""
        return self.axes * self.knots


CASES = (
    Stacked("a", "one spline, 7 knots", 1, 7, 0.1, 10),
    Stacked("b", "three stacked, 7 knots", 3, 7, 0.01, 20),
    Stacked("c", "five joints, 20 knots", 5, 20, 0.01, 20),
)


@dataclass(frozen=True, slots=True)
class Posed:
    """A case under a criterion.

    `joint` : the variances of all splines, integrated; `volume` : the mean variance of their sum
    """

    case: Stacked
    criterion: CriterionName

    @property
    def candidates(self) -> Array:
        """The fixed candidates, (2000, q), the same for all."""
        return np.random.default_rng(2000).uniform(0.0, TRAVEL, (CANDIDATES, self.case.axes))


def case_of(letter: str) -> Stacked:
    """Return a case by its letter."""
    return next(case for case in CASES if case.letter == letter)
