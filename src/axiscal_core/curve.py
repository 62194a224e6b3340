"""One error as a curve: the whole method of the paper in three methods, for an error alone.

Figure 4 of the paper, where seven readings settle seven control points, each taken where it serves most (eq. 27):

    >>> curve = Curve((0, 10), std=1.0, knots=7)
    >>> for _ in range(7):
    ...     t = curve.next(noise=0.1)
    ...     curve = curve.read(t, np.sin(t), noise=0.1)
    >>> f"J falls from 8.44 to {curve.J:.4f}"
    'J falls from 8.44 to 0.1963'
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy as np

from axiscal_core.normal import Normal
from axiscal_core.refusals import Array, InputError, whole, within
from axiscal_core.roots import largest, node_count
from axiscal_core.splines import NaturalSpline, Spline, distances, even_knots, matern
from axiscal_core.units import EITHER, Of, Quantity, quantities, si


class Curve:
    """A cubic spline of which mean and covariance are known.  Nothing changes it: reading returns another.

    travel : its two ends; std : of its values before any reading; knots : how many, evenly spaced
    length : over which they are alike, None for control values that are independent (eq. 16)
    """

    spline: Spline
    known: Normal
    along: Of = EITHER  # what a position is

    def __init__(
        self, travel: Sequence[Quantity] | Array, std: Quantity, knots: int = 7, length: Quantity | None = None
    ) -> None:
        start, stop = quantities(travel, "Curve", "travel", (2,))
        if start >= stop:
            raise InputError("Curve", "travel", f"goes from {start:g} to {stop:g}", "Give the lower end first")
        self.spline = NaturalSpline(even_knots(float(start), float(stop), whole("Curve", "knots", knots, 2)))
        size = within("Curve", "std", si(std, "Curve", "std"), 0.0, open_end=True)
        alike = np.eye(knots)
        if length is not None:
            over = within("Curve", "length", si(length, "Curve", "length"), 0.0, open_end=True)
            alike = matern(distances(self.spline) / over)
        self.known = Normal(np.zeros(knots), size**2 * alike)

    @classmethod
    def of(cls, spline: Spline, known: Normal, along: Of = EITHER) -> Self:
        """Return the curve of a spline whose control values are known."""
        curve = cls.__new__(cls)
        curve.spline, curve.known, curve.along = spline, known, along
        return curve

    def __call__(self, t: Quantity | Sequence[Quantity] | Array) -> Normal:
        """Return what is known at positions t (eq. 18, 20): a normal over them, (m,)."""
        at = quantities(np.atleast_1d(np.array(t, object)), "Curve", "t", (None,), [self.along], posed=True)
        self._refuse_outside("Curve", at)
        return self.known.through(self.spline.rows(at))

    @property
    def J(self) -> float:  # noqa: N802 (the paper's letter)
        """The integral of the variance over the travel (B&H eq. 24-26)."""
        root = self.known.factor
        return float(np.sum(self.spline.gram() @ root * root))

    @property
    def rms(self) -> float:
        """The root of the mean variance over the travel."""
        return float(np.sqrt(self.J / np.ptp(self.spline.knots)))

    def next(self, noise: Quantity) -> float:
        """Return where a reading lets J fall most, exactly (B&H eq. 27)."""
        variance = within("Curve.next", "noise", si(noise, "Curve.next", "noise"), 0.0, open_end=True) ** 2
        root, weight = self.known.factor, self.spline.gram()

        def forms(t: Array) -> tuple[Array, Array]:
            seen = self.spline.rows(t) @ root
            reach = seen @ root.T
            return np.sum(reach @ weight * reach, axis=1), variance + np.sum(seen**2, axis=1)

        found = largest(forms, self.spline.knots, node_count(6))  # N and D are squares of cubics (eq. 23)
        assert found is not None, "a spline is a cubic between its knots"
        return found[0]

    def read(self, t: Quantity, value: Quantity, noise: Quantity) -> Curve:
        """Return the curve after a reading at t (eq. 21-23)."""
        at, y = si(t, "Curve.read", "t", self.along), si(value, "Curve.read", "value")
        variance = within("Curve.read", "noise", si(noise, "Curve.read", "noise"), 0.0, open_end=True) ** 2
        self._refuse_outside("Curve.read", np.array([at]))
        return Curve.of(self.spline, self.known.read(self.spline.rows(at), [y], [variance]), self.along)

    def _refuse_outside(self, function: str, t: Array) -> None:
        start, stop = self.spline.knots[[0, -1]]
        for place in np.flatnonzero((t < start) | (t > stop)).tolist():
            what = f"= {t[place]:g} is outside the travel"
            raise InputError(function, "t", what, f"It goes from {start:g} to {stop:g}", place)

    def __repr__(self) -> str:
        start, stop = self.spline.knots[[0, -1]]
        return f"<Curve from {start:g} to {stop:g}, {self.spline.size} control values, known to {self.rms:.3g} RMS>"
