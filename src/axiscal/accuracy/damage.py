"""What a departure that a model does not hold does to a result when readings just show it: closed forms.

A departure of size s adds s b to the readings and s φ to the machine. With K the covariance of the readings under the
model, x = C Gᵀ K⁻¹ b what the estimate makes of b, and e = φ − H x over the volume,

    information I = bᵀ K⁻¹ b,   truth² = J + s² |e|²,   power = P(χ'²_r(s² I) > χ²_{r, 1−α})
    D² = min(need |e|²/((κ² − 1) I), s_max² |e|²),   s_κ² = (κ² − 1) J/|e|²

A departure of size s stays hidden where it makes the truth worse than κ times the promise and is not shown. Its share,
over sizes and places c, is the risk that a promise runs which nothing says anything against:

    hidden = E_c E_s 1[s² |e_c|² > (κ² − 1) J] P(χ'²_r(s² I_c) ≤ χ²_{r, 1−α}),   s normal with the std of the curve

The larger the promise, the fewer of them spoil it: the least promise that no more than a share of them does is B, what
readings can bear.

D, the damage, does not depend on J: it is the promise that readings would have to make for a departure that is just
seen, and makes the truth κ times the promise. (Baarda 1968, external reliability, with a field in place of a point.)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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
_SIZES = 24
"""Sizes of equal probability in an average over them: of 12 or 48 it is the same to 0.002."""
_SURELY = 80.0
"""Of so large a noncentrality less than one in a million stays hidden."""
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
        least = self.information[0, 0] if self.degrees == 1 else np.linalg.eigvalsh(self.information)[0]
        return max(float(least), 0.0)

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


def hidden(harms: Sequence[Harm], std: float, promise: float) -> float:
    """Return the share of departures that make the truth κ times the promise, or worse, and are not shown.

    harms : of one family, one for each place that it may be at; std : of their sizes, m or rad; promise : m
    """
    spoilt, unseen = _possible(harms, std)
    return float(np.sum(unseen[spoilt > promise])) / unseen.size


def bearable(harms: Sequence[Harm], std: float, share: float) -> float:
    """Return the least promise, m, that no more than a share of departures spoil unseen; the others as of `hidden`."""
    spoilt, unseen = _possible(harms, std)
    order = np.argsort(-spoilt)
    beyond = np.cumsum(unseen[order]) > share * unseen.size
    return float(spoilt[order[int(np.argmax(beyond))]]) if beyond[-1] else 0.0


def _possible(harms: Sequence[Harm], std: float) -> tuple[Array, Array]:
    """Return of departures alike in probability below which promise they spoil it, m, and how probably unseen."""
    squares = std**2 * _squares()
    spoilt = np.sqrt(np.array([each.wrong for each in harms])[:, None] * squares / (KAPPA**2 - 1)).ravel()
    seen = (np.array([each.least_information for each in harms])[:, None] * squares).ravel()
    unseen, some = np.zeros(seen.size), seen < _SURELY
    degrees = harms[0].degrees
    unseen[some] = noncentral_share(_limit(degrees), degrees, seen[some])
    return spoilt, unseen


@cache
def _squares() -> Array:
    """Return squares of standard normal sizes, each as probable as the others."""
    return np.array([chi_square_limit(1, (n + 0.5) / _SIZES) for n in range(_SIZES)])


@cache
def needed(degrees: int) -> float:
    """Return the noncentrality that is seen with 90 %: 15.365, 17.948, 19.796 for one, two and three degrees."""
    return noncentrality_for(_limit(degrees), degrees, 1.0 - _SEEN)


@cache
def _limit(degrees: int) -> float:
    return chi_square_limit(degrees, FALSE_ALARM)
