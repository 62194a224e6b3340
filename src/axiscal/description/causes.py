"""What usually goes wrong: one table, a row a cause. Adding a cause is adding a row and what it does to readings.

Given the logarithms θ of the sizes all causes are Gaussian, y ~ N(0, K(θ)) with K(θ) = Σ_c s_c(θ)² B_c. A size is the
default, or what somebody stated, times exp(θ); θ is Student-t of four degrees with the row's factor as its scale.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from axiscal.machine.entry import Sure

SURE: dict[Sure, float] = {"roughly": 3.0, "well": 1.5, "exactly": 1.0}
"""The factor within which stated size and length are known."""


@dataclass(frozen=True, slots=True)
class Cause:
    """One row of the table.

    name : as reports call it
    kernel : correlation, in words
    size : default standard deviation, in `unit`
    unit : what the default is a multiple of
    factor : one standard deviation of the logarithm of the size is log(factor); 1 for a size that is exact
    source : where the default comes from
    """

    name: str
    kernel: str
    size: float
    unit: str
    factor: float
    source: str

    @property
    def spread(self) -> float:
        """Scale of the logarithm of the size."""
        return math.log(self.factor)


SMOOTH = Cause(
    "error, smooth", "Matérn-5/2 by a spline on knots", 1.0, "std as stated", SURE["roughly"],
    "learnt over stated std: 1.05, 1.35, 1.61 at 16, 50, 84 % of 38 measured curves",
)  # fmt: skip
LENGTH = Cause(
    "length of an error", "-", 1.0, "length as stated", 2.5,
    "0.09, 0.25, 0.76 of the travel at 16, 50, 84 % of the same curves",
)  # fmt: skip
ROUGH = Cause(
    "error, rough", "cells of 2 % of the travel, half of the variance in cells of 6 %", 0.085,
    "std of the error", 3.0, "0.048, 0.085, 0.20 of the same curves; maps 0.066, 0.096, 0.13",
)  # fmt: skip
REST = Cause(
    "rest", "white", 0.03, "std of the error", 4.0, "0.018, 0.030, 0.067 of the same curves",
)  # fmt: skip
REVERSAL = Cause("reversal", "constant", 1.0, "std as stated", 3.0, "as the errors' own factor")
"""The factor is that of errors; nobody has measured another."""
WAY = Cause(
    "reversal that needs a way", "side times exp(-d/100 mm), d the way since the axis turned", 0.06,
    "std of the reversal", 6.0, "assumption",
)  # fmt: skip
"""Assumption: a slide winds up like a spring over a hand's breadth: little of most backlashes, and most of some."""
PITCH = Cause("pitch", "one sine for each stated period", 0.02, "std of the error", 4.0, "assumption")
"""Assumption: a fiftieth of the error."""
TOGETHER = Cause(
    "two linear axes together", "product of Matérn-5/2, 0.3 of each travel", 0.15,
    "larger std of both axes' errors", 6.0, "14 beds and plates: a fifth less is missed than with 3.0 and half",
)  # fmt: skip
DRIFT = Cause(
    "drift of a zero", "linear and Brownian in time", 2.0, "noise, each over the set-up's time", 4.0,
    "nine ISO 230-2 tests: spread of run means over noise 0.9 to 12, median 2",
)  # fmt: skip
CYCLE = Cause("cycle of a zero", "Matérn-1/2 in time, 6 min", 0.5, "noise", 4.0, "assumption")
"""Assumption: an air conditioning that switches every six minutes moves a zero by half the noise."""
GROWTH = Cause(
    "growth of an axis meanwhile", "coordinate times Matérn-3/2 in time, 0.4 of the set-up's time", 2.0,
    "noise per travel", 4.0, "slopes of ISO 230-2 runs 0.4 to 1.9 noise",
)  # fmt: skip
NOISE = Cause("noise", "white", 1.0, "noise as stated", 2.0, "seating again scatters 3 to 7 still noises")
"""Factor: a stated noise is rarely off by more, and repeats tell it."""
BAD = Cause(
    "bad reading", "one reading", 30.0, "noise", 1.0, "assumption: 1 of 100 readings",
)  # fmt: skip
