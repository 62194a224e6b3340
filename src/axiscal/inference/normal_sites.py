"""Normal readings in the place of those that are not: value and variance, and what is assumed of chips."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.numerics import Array

WIDEST = 1e8
"""Times the noise: so wide a site says nothing."""
SHARE = 0.02
"""Share of the readings that chips or burrs shift: an assumption."""


class Sites(NamedTuple):
    """Normal readings in the place of others.  values, variances : (m,)"""

    values: Array
    variances: Array
