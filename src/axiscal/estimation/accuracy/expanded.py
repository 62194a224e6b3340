"""Expanded uncertainty of the tool point: U such that the deviation lies within ±U, or no farther than U, with 95 %.

At a pose the deviation left is normal with covariance Σ, its squared length Σλ_i z_i² with λ the eigenvalues of Σ and z
standard normal. By three moments (Hall 1983; Buckley and Eagleson 1988), with κ₁ = Σλ, κ₂ = 2Σλ², κ₃ = 8Σλ³:

    P(Σλ_i z_i² ≤ q) = P(χ²_ν ≤ (q − κ₁) √(2ν/κ₂) + ν),    ν = 8 κ₂³/κ₃²

U in space solves mean over the poses of P(U²) = 0.95, U along an axis mean of 2Φ(U/σ) − 1 = 0.95.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import EVERY_WAY, Counted
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.estimation.belief import Belief
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import chi_square_share

LEVEL = 0.95
"""Probability of every band and every expanded uncertainty."""
BAND = 1.96
"""Standard deviations of a normal to the edge of a band of that probability."""
_WORST = 10
"""Poses of the largest trace among which the worst place is looked for: their U differ by 20 % at most."""
_FARTHEST, _HALVINGS = 12.0, 44
"""No U is farther than so many roots of the largest trace; halved so often, its bracket is rounding."""


@dataclass(frozen=True, slots=True)
class Expanded:
    """Expanded uncertainties of 95 % over a volume, m.

    space : of the distance, along the directions that count; axes : along x, y, z of the workpiece frame, each of them
    worst : of the distance at the worst place
    """

    space: float
    axes: tuple[float, float, float]
    worst: float

    def factor(self, rms: float) -> float:
        """Return k, the expanded uncertainty in space over the standard uncertainty `rms`, m."""
        return self.space / rms if rms > 0 else BAND


def expanded(yardstick: Yardstick, belief: Belief) -> Expanded:
    """Return the expanded uncertainties of a belief over the yardstick's volume, shifts not counted taken off."""
    return expanded_of(yardstick.covariances(belief.factor), yardstick.evenly, yardstick.counted)


def expanded_floor(yardstick: Yardstick) -> Expanded:
    """Return the expanded uncertainties that endless readings would leave."""
    return expanded_of(yardstick.covariances(yardstick.left), yardstick.evenly, yardstick.counted)


def expanded_of(covariances: Array, evenly: NDArray[np.bool_], counted: Counted = EVERY_WAY) -> Expanded:
    """Return the expanded uncertainties where the deviation has these covariances.

    covariances : (m, 3, 3) Σ at poses, m²; evenly : (m,) which of the poses stand for the volume; the others are places
    where it may be worst; counted : the directions whose distance counts
    """
    counts = np.flatnonzero(counted)
    spectra = np.maximum(np.linalg.eigvalsh(covariances[:, counts[:, None], counts]), 0.0)
    variances = np.maximum(np.einsum("pcc->pc", covariances)[evenly], 0.0)
    worst = np.argsort(spectra.sum(axis=1))[-_WORST:]
    x, y, z = (reach(variances[:, [axis]]) for axis in range(3))
    return Expanded(reach(spectra[evenly]), (x, y, z), _largest(spectra[worst]))


def _largest(spectra: Array) -> float:
    """Return the largest distance of single poses."""
    return float(_bisected(spectra, shares(spectra), len(spectra)).max())


def reach(spectra: Array) -> float:
    """Return U, m, with P(Σλ z² ≤ U²) of 95 % in the mean over the rows.  spectra : (m, d) λ, m²"""
    at_each = shares(spectra)
    return float(_bisected(spectra, lambda squares: np.mean(at_each(squares), keepdims=True), 1)[0])


def _bisected(spectra: Array, share: Callable[[Array], Array], count: int) -> Array:
    """Return the distances, (count,) m, whose squares share gives the level.  spectra : (m, d), for where to look"""
    low = np.zeros(count)
    high = np.full(count, _FARTHEST * float(np.sqrt(spectra.sum(axis=1).max(initial=0.0))))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        short = share(middle**2) < LEVEL
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return high


def shares(spectra: Array) -> Callable[[Array], Array]:
    """Return what gives P(Σλ z² ≤ square) at each pose, (m,), of squares, (m,) or (1,); 1 where nothing varies."""
    largest = spectra.max(axis=1, initial=0.0)
    still, scale = largest == 0, np.where(largest > 0, largest, 1.0)
    relative = np.where(still[:, None], 1.0, spectra / scale[:, None])
    first, second, third = (np.sum(relative**n, axis=1) for n in (1, 2, 3))
    return lambda squares: np.where(still, 1.0, _by_moments(first, second, third, squares / scale))


def _by_moments(first: Array, second: Array, third: Array, squares: Array) -> Array:
    """Return P(Σλz² ≤ square) by Σλ, Σλ² and Σλ³."""
    degrees = second**3 / third**2
    at = (squares - first) * np.sqrt(degrees / second) + degrees
    return chi_square_share(degrees, np.maximum(at, 0.0))
