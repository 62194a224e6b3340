"""Check readings: places, sides and times drawn at random, promised by all other readings.

A plan chooses its places, so that what its places hide its own readings cannot show. A random place hides nothing:
z² of a check, left out, has mean 1 if U is right. With s² the mean of z² over the checks, variances grow by max(1, s²).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_tail

AGREES = 3.0
"""Standard deviations within which a reading is as others promise it."""


class Check(NamedTuple):
    """A check reading: its index, how many numbers it has, and their root mean square in standard deviations, z.

    used : whether the estimate takes it; slip : it is not and does not count in s
    """

    reading: int
    numbers: int
    z: float
    used: bool = True
    slip: bool = False

    @property
    def kept(self) -> bool:
        """Whether it is as promised."""
        return self.used and self.z <= AGREES


@dataclass(frozen=True)
class Checks:
    """Check readings beside what is promised of them."""

    each: tuple[Check, ...] = ()

    @property
    def kept(self) -> int:
        """How many are as promised."""
        return sum(check.kept for check in self.each)

    @property
    def s(self) -> float | None:
        """Root of the mean z² of those that are no slips; None of none."""
        squares = [check.z**2 for check in self.each if not check.slip]
        return float(np.sqrt(np.mean(squares))) if squares else None

    @property
    def inflation(self) -> float:
        """What variances grow by: max(1, s²)."""
        return max(1.0, self.s or 0.0) ** 2

    @property
    def p(self) -> float:
        """Probability of checks that are this far off or more, as if independent."""
        counted = [check for check in self.each if not check.slip]
        numbers = sum(check.numbers for check in counted)
        return chi_square_tail(numbers, sum(check.numbers * check.z**2 for check in counted)) if numbers else 1.0


def checks_of(kept: Iterable[Check], bad: Sequence[Check], implausible: Iterable[Check]) -> Checks:
    """Return checks in the order of their readings.

    bad : those that other readings contradict. One is a slip; two of a few (0.1 % of 5) are what the model lacks.
    """
    alone = len(bad) == 1
    slips = [check._replace(used=False, slip=True) for check in (*implausible, *(bad if alone else ()))]
    others = [] if alone else [check._replace(used=False) for check in bad]
    return Checks(tuple(sorted([*kept, *slips, *others])))


NO_CHECKS = Checks()
"""Where no place is drawn at random."""


def surprises(residuals: Array, covariances: Array) -> Array:
    """Return z of readings of k numbers each, (r,): √(rᵀS⁻¹r/k).  residuals : (r, k); covariances : S (r, k, k)"""
    solved = np.linalg.solve(covariances, residuals[..., None])[..., 0]
    return np.asarray(np.sqrt(np.sum(residuals * solved, axis=1) / residuals.shape[1]))
