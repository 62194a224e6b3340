"""What a departure that a model does not hold does to a result when readings just show it: closed forms.

A departure of size s adds s b to the readings and s φ to the machine. With K the covariance of the readings under the
model, x = C Gᵀ K⁻¹ b what the estimate makes of b, and e = φ − H x over the volume,

    information I = bᵀ K⁻¹ b,   truth² = J + s² |e|²,   power = P(χ'²_r(s² I) > χ²_{r, 1−α})
    D² = min(need |e|²/((κ² − 1) I), s_max² |e|²),   s_κ² = (κ² − 1) J/|e|²

D, the damage, does not depend on J: it is the promise that readings would have to make for a departure that is just
seen, and makes the truth κ times the promise. (Baarda 1968, external reliability, with a field in place of a point.)
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_limit, noncentral_share, noncentrality_for

KAPPA = 1.5
"""A truth of one and a half times the promise is what a promise must not hide."""
FALSE_ALARM = 0.05 / 6
"""Of the test for one departure: one campaign in twenty over six families."""
_SEEN = 0.9
"""Probability from which a departure counts as seen."""
_ABSURD = 100.0
"""Times the largest size considered: what only larger ones would show, rounding shows; any factor near would do."""


class Harm(NamedTuple):
    """What a departure of size 1 does.

    information : (r, r) bᵀK⁻¹b; wrong : |e|², m² per unit², the mean over its r columns; most : s_max
    """

    information: Array
    wrong: float
    most: float

    @property
    def least_information(self) -> float:
        """I: of the worst phase where the departure has two."""
        return max(float(np.linalg.eigvalsh(self.information)[0]), 0.0)

    @property
    def degrees(self) -> int:
        """How many columns it has, r."""
        return len(self.information)

    @property
    def damage(self) -> float:
        """D, m."""
        squared, seen = self.most**2 * self.wrong, (KAPPA**2 - 1) * self.least_information
        if seen > 0:
            squared = min(squared, needed(self.degrees) * self.wrong / seen)
        return math.sqrt(squared)

    @property
    def seen_from(self) -> float:
        """The size that readings show with 90 %, in the unit of the size; infinite where none that may be is shown."""
        information, size = self.least_information, math.inf
        if information > 0:
            size = math.sqrt(needed(self.degrees) / information)
        return size if size < _ABSURD * self.most else math.inf

    def power(self, promise: float) -> float:
        """Return the probability that readings show it at the size that makes the truth κ times the promise, m."""
        if not self.wrong > 0:
            return 1.0
        noncentrality = (KAPPA**2 - 1) * promise**2 / self.wrong * self.least_information
        return float(1.0 - noncentral_share(_limit(self.degrees), self.degrees, np.array(noncentrality)))


@cache
def needed(degrees: int) -> float:
    """Return the noncentrality that is seen with 90 %: 15.365, 17.948, 19.796 for one, two and three degrees."""
    return noncentrality_for(_limit(degrees), degrees, 1.0 - _SEEN)


@cache
def _limit(degrees: int) -> float:
    return chi_square_limit(degrees, FALSE_ALARM)
