"""One error along its axis: mean, band, and the exact place where the next reading tells most.

curve = ac.Curve(["0 mm", "600 mm"], std="10 um", length="150 mm")
place = curve.next("0.3 um")
curve = curve.read(place, "1.7 um", "0.3 um")
mean, std = curve([0.1, 0.2])
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal.errors.prior import matern52
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.belief import Belief
from axiscal.estimation.machine_estimate import Band
from axiscal.exceptions import ShapeError
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import node_count
from axiscal.numerics.cubic import NaturalSpline, Spline, even_knots
from axiscal.numerics.exact_step import gain_forms, maximise_along
from axiscal.python.measured_case import Quantity, si
from axiscal.python.pictures import DrawnLine
from axiscal.units import to_unit

if TYPE_CHECKING:
    from axiscal.python.pictures import NotebookPicture

_DEGREE = 6
"""N and D of a reading's gain are squares of cubics between two knots (B&H eq. 23)."""
_SHOWN = 201
"""Points of a drawn line: more than a page has pixels for its bends."""


class Curve:
    """A cubic spline of which mean and covariance are known; nothing changes it, reading returns another.

    travel : its two ends; std : of its values before any reading; length : over which they are alike, None for
        independent control values; knots : how many, evenly spaced
    raises UnitError, KnotError
    """

    def __init__(
        self, travel: Sequence[Quantity], std: Quantity, length: Quantity | None = None, knots: int = 7
    ) -> None:
        start, stop = (si(end, "length") for end in travel)
        spline = NaturalSpline(even_knots(start, stop, knots))
        at, size = spline.control_positions, si(std, "length")
        apart = np.abs(at[:, None] - at)
        alike = np.eye(len(at)) if length is None else matern52(apart / si(length, "length"))
        self._hold("curve", spline, Belief(np.zeros(len(at)), size**2 * alike))

    @classmethod
    def of(
        cls, name: str, spline: Spline, belief: Belief, rest: float = 0.0, unit: str = "um", position_unit: str = "mm"
    ) -> Self:
        """Return a curve that is known already.

        belief : over the spline's control values; rest : std of what no spline follows, m or rad
        unit, position_unit : in which it is shown
        """
        curve = cls.__new__(cls)
        curve._hold(name, spline, belief, rest, unit, position_unit)
        return curve

    def _hold(
        self, name: str, spline: Spline, belief: Belief, rest: float = 0.0, unit: str = "um", position_unit: str = "mm"
    ) -> None:
        self.name, self.spline, self.belief, self.rest = name, spline, belief, rest
        self.unit, self.position_unit = unit, position_unit

    def __call__(self, t: ArrayLike) -> Band:
        """Return mean and standard deviation at positions t, m or rad: a number, or (m,)."""
        known = self.belief.predict(self.spline.rows(np.atleast_1d(np.asarray(t, dtype=np.float64))))
        return Band(known.mean, np.hypot(known.std, self.rest))

    @property
    def rms(self) -> float:
        """The root of the mean variance over the travel, rest included (B&H eq. 26), m or rad."""
        weight = self._weight
        return float(np.sqrt(np.sum((weight @ self.belief.factor) ** 2) + self.rest**2))

    def next(self, noise: Quantity) -> float:
        """Return where a reading lets the mean variance over the travel fall most, exactly (B&H eq. 27), m or rad."""
        knots, factor = self.spline.knots, self.belief.factor
        weighted, variance = self._weight @ factor, si(noise, "length") ** 2

        def forms(positions: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
            gains = gain_forms(self.spline.rows(positions.ravel()), factor, weighted, variance)
            return gains[0].reshape(positions.shape), gains[1].reshape(positions.shape)

        places, gains = maximise_along(forms, knots[:-1], knots[1:], node_count(_DEGREE))
        return float(places[np.argmax(gains)])

    def read(self, t: Quantity, value: Quantity, noise: Quantity) -> Self:
        """Return the curve after a reading at t; raises ShapeError for one of an estimate, which has its readings.

        The part that no spline can follow repeats at each place: only a whole estimate keeps it apart.
        """
        if self.rest > 0:
            raise ShapeError(f"{self.name} has a rest that readings share; give its readings to `ac.estimate`")
        row = self.spline.rows(np.array([si(t, "length")]))
        belief = self.belief.update(row, [si(value, "length")], [si(noise, "length") ** 2])
        return self.of(self.name, self.spline, belief)

    def plot(self) -> NotebookPicture:
        """Return a picture: mean, and the band that holds it with 95 %."""
        from axiscal.python.pictures import curves_picture

        return curves_picture([self.line()])

    def line(self) -> DrawnLine:
        """Return the curve as it is drawn."""
        at = np.linspace(self.spline.knots[0], self.spline.knots[-1], _SHOWN)
        mean, std = self(at)
        shown = to_unit(at, self.position_unit), to_unit(mean, self.unit), BAND * to_unit(std, self.unit)
        return DrawnLine(self.name, *shown, self.position_unit, self.unit)

    @property
    def _weight(self) -> Array:
        """V with VᵀV the mean of mᵀm over the travel."""
        low, high = self.spline.knots[0], self.spline.knots[-1]
        root: Array = np.linalg.cholesky(self.spline.gram() / (high - low)).T
        return root

    def __repr__(self) -> str:
        low, high = (to_unit(float(end), self.position_unit) for end in self.spline.knots[[0, -1]])
        size = f"known to {to_unit(self.rms, self.unit):.3g} {self.unit}"
        return f"<Curve {self.name}: from {low:g} to {high:g} {self.position_unit}, {size}>"
