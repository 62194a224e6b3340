"""What becomes of a plan where one of its readings is not taken."""

from __future__ import annotations

from typing import NamedTuple

from axiscal.design.gains.three_values import SharedReadings
from axiscal.numerics import Array


class LeftOver(NamedTuple):
    """What a reading leaves that is not taken.

    above, below, joint : as of `Scores`; eta, omega : (k, k) of the change of the covariance
    cross, reach : (numbers, k) G_c C Hᵀ and G_c C W C Hᵀ with its rows H
    """

    above: Array
    below: Array
    joint: SharedReadings
    eta: Array
    omega: Array
    cross: Array
    reach: Array


class Leaving(NamedTuple):
    """What a reading does that leaves.  grown, omega : E and Ω (k, k); least : eigenvalue of E⁻¹, m²"""

    grown: Array
    omega: Array
    least: float
