"""An axis as it is described, and what somebody knows of it who knows every size.

Truth: a Matérn curve (5/2), a lead error, a backlash, all Gaussian of known size; the posterior is one linear solve
(Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, (2.22) to (2.24)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from tests.zoo.animals import Interval, Met
from tests.zoo.axes import LASER, LENGTH, AxisTruth, Curve, Places, Visits, written

CURVE, SMOOTH, BACKLASH, LEAD = 10.0, 200.0, 3.0, 0.03
"""Standard deviations of curve and reversal, um; the curve's length, mm; that of the lead error, um per mm."""
STRAIN = 1e-3 * float(np.linalg.norm([11.7, 1.0, 1.0, 0.74]))
"""What 1 K, the laser's scale, expansion and air are together, um per mm."""
_ZERO = 1000.0
_X = np.linspace(0.0, LENGTH, 101)
_PLACES = Visits(np.tile(_X, 2), np.repeat([1.0, -1.0], len(_X)))
_DRAWS = 400


@dataclass(frozen=True, slots=True)
class Right:
    """A machine as it is described.

    curve : the truth; visits, shown : what is read, um; strain : standard deviation of its scale, um per mm
    """

    curve: Curve
    visits: Visits
    shown: Array
    strain: float

    @property
    def met(self) -> Met:
        """What a person has of it."""
        return Met(written(LASER, self.visits, self.shown), AxisTruth(self.curve))

    def oracle(self) -> Interval:
        """Return what somebody knows of it who knows all sizes."""
        across, among = _covariance(_PLACES, self.visits), _covariance(self.visits, self.visits)
        x = self.visits.x
        among = among + self.strain**2 * np.outer(x, x) + _ZERO**2 + LASER.noise**2 * np.eye(len(x))
        gain = np.linalg.solve(among, across.T).T
        left = _centred(self.curve(_PLACES.x, _PLACES.sides) - gain @ self.shown)
        roots, ways = np.linalg.eigh(_covariance(_PLACES, _PLACES) - gain @ across.T)
        draws = np.random.default_rng(1).standard_normal((_DRAWS, len(roots))) * np.sqrt(np.maximum(roots, 0.0))
        return Interval.about(left, float(np.quantile(np.abs(_centred(draws @ ways.T)), 0.95)))


def right(seed: int, places: Places, strain: float) -> Right:
    """Return a machine that is drawn as it is described.  strain : standard deviation of what its scale is off"""
    rng = np.random.default_rng((seed, 10))
    visits = places(rng)
    bow = np.linalg.cholesky(_matern(_X, _X) + 1e-9 * np.eye(len(_X))) @ rng.standard_normal(len(_X))
    slope, back, off = rng.standard_normal(3) * [LEAD, BACKLASH, strain]

    def curve(x: Array, side: Array) -> Array:
        found: Array = np.interp(x, _X, bow) + slope * x + back / 2 * side
        return found

    shown = curve(visits.x, visits.sides) + off * visits.x + rng.normal(0, LASER.noise, len(visits.x))
    return Right(curve, visits, shown - shown[0], strain)


def _centred(values: Array) -> Array:
    """Return values with their mean over the places taken off: a zero does not count."""
    found: Array = values - values.mean(axis=-1, keepdims=True)
    return found


def _matern(a: Array, b: Array) -> Array:
    """Return the covariance of the curve between places, (m, n) um²."""
    far = np.sqrt(5) * np.abs(a[:, None] - b) / SMOOTH
    covariance: Array = CURVE**2 * (1 + far + far**2 / 3) * np.exp(-far)
    return covariance


def _covariance(a: Visits, b: Visits) -> Array:
    """Return the covariance of the deviation at 20 degC between places, (m, n) um²."""
    sides = BACKLASH**2 / 4 * np.outer(a.sides, b.sides)
    covariance: Array = _matern(a.x, b.x) + LEAD**2 * np.outer(a.x, b.x) + sides
    return covariance
