"""Expanded uncertainty of the tool point: U such that the deviation lies within ±U, or no farther than U, with 95 %.

At a pose the deviation left is normal with covariance Σ, its squared length Σλ_i z_i² with λ the eigenvalues of Σ and z
standard normal. By three moments (Hall 1983; Buckley and Eagleson 1988), with κ₁ = Σλ, κ₂ = 2Σλ², κ₃ = 8Σλ³:

    P(Σλ_i z_i² ≤ q) = P(χ²_ν ≤ (q − κ₁) √(2ν/κ₂) + ν),    ν = 8 κ₂³/κ₃²

U in space solves mean over the poses of P(U²) = 0.95, U along an axis mean of 2Φ(U/σ) − 1 = 0.95.

A belief of f degrees of freedom is a multivariate t of the same covariance: all λ have one factor (f − 2)/χ²_f besides.
With h = 2 E[r²]²/Var[r²] of the distance r over the poses (Satterthwaite 1946)

    U_f² = U² (f − 2)/f · h F_{h,f}(0.95)/χ²_h(0.95)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import EVERY_WAY, Counted
from axiscal.estimation.accuracy.yardstick import Yardstick
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal_core.from_scipy import chi_square_quantile, chi_square_share, f_quantile
from axiscal_core.normal import Normal
from axiscal_core.threads import one_thread

LEVEL = 0.95
"""Probability of every band and every expanded uncertainty."""
BAND = 1.96
"""Standard deviations of a normal to the edge of a band of that probability."""
_WORST = 10
"""Poses of the largest trace among which the worst place is looked for: their U differ by 20 % at most."""
_STEPS, _ROUNDING = 60, 1e-13
"""About eight steps bring the share as near to its level as floats tell; halving would take 44."""


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


def expanded(yardstick: Yardstick, belief: Normal) -> Expanded:
    """Return the expanded uncertainties of a belief over the yardstick's volume, shifts not counted taken off."""
    covariances = yardstick.covariances(belief.factor)
    return expanded_of(covariances, yardstick.volume.evenly, yardstick.counted, belief.degrees, yardstick.errors.ways)


@one_thread()
def known_to(name: str, yardstick: Yardstick, belief: Normal) -> float:
    """Return how well a belief knows the volume, m.  name : "U", "rms" or "worst" """
    if name == "U":
        return expanded(yardstick, belief).space
    if name.lower() == "rms":
        return yardstick.rms_of(yardstick.total(belief.factor))
    return yardstick.measure(belief).worst


@remembered
def expanded_floor(yardstick: Yardstick) -> Expanded:
    """Return the expanded uncertainties that endless readings would leave."""
    covariances = yardstick.covariances(yardstick.left)
    return expanded_of(covariances, yardstick.volume.evenly, yardstick.counted, ways=yardstick.errors.ways)


def floor_of(name: str, yardstick: Yardstick) -> float:
    """Return what endless readings would leave of the figure of that name, m, as of `known_to`."""
    if name == "U":
        return expanded_floor(yardstick).space
    return yardstick.floors[1] if name == "worst" else yardstick.rms_floor


class Limited(Protocol):
    """Limits of accuracies of the volume, m, None for none."""

    @property
    def rms(self) -> float | None: ...
    @property
    def worst(self) -> float | None: ...
    @property
    def expanded(self) -> float | None: ...


class WantedAccuracy(NamedTuple):
    """A wanted accuracy, and its floor after endless readings, m."""

    name: str
    limit: float
    floor: float


def asked(limits: Limited, yardstick: Yardstick) -> tuple[WantedAccuracy, ...]:
    """Return the accuracies that limits ask for; a campaign ends at the first that is reached."""
    given = ("rms", limits.rms), ("worst", limits.worst), ("U", limits.expanded)
    return tuple(WantedAccuracy(name, limit, floor_of(name, yardstick)) for name, limit in given if limit is not None)


def expanded_of(
    covariances: Array,
    evenly: NDArray[np.bool_],
    counted: Counted = EVERY_WAY,
    degrees: float = np.inf,
    ways: Counted = EVERY_WAY,
) -> Expanded:
    """Return the expanded uncertainties where the deviation has these covariances.

    covariances : (m, 3, 3) Σ at poses, m²; evenly : (m,) which of the poses stand for the volume; the others are places
    where it may be worst; counted : the directions whose distance counts; degrees : of freedom of a belief
    ways : the directions in which an error moves the tool; aligning a sample of the volume turns it by a little
    """
    counts = np.flatnonzero(counted)
    spectra = np.maximum(np.linalg.eigvalsh(covariances[:, counts[:, None], counts]), 0.0)
    variances = np.maximum(np.einsum("pcc->pc", covariances)[evenly], 0.0)
    worst = np.argsort(spectra.sum(axis=1))[-_WORST:]
    x, y, z = (reach(variances[:, [axis]], degrees) if way else 0.0 for axis, way in enumerate(ways))
    return Expanded(reach(spectra[evenly], degrees), (x, y, z), max(reach(spectra[[at]], degrees) for at in worst))


def reach(spectra: Array, degrees: float = np.inf) -> float:
    """Return U, m, with P(Σλ z² ≤ U²) of 95 % in the mean over the rows.

    spectra : (m, d) λ, m²; degrees : of freedom of the belief they are of
    For a normal it lies between the least and the largest of single rows; regula falsi as Illinois finds it there.
    """
    still = 1 - np.mean(spectra.any(axis=1)) if len(spectra) else 1.0
    if still >= LEVEL:
        return 0.0
    scale, first, slope, freedom = _moments(spectra[spectra.any(axis=1)])

    def beyond(distance: float) -> float:
        at = (distance**2 / scale - first) * slope + freedom
        return float(still + (1 - still) * np.mean(chi_square_share(freedom, np.maximum(at, 0.0)))) - LEVEL

    alone = np.sqrt(scale * (first + (chi_square_quantile(freedom, LEVEL) - freedom) / slope))
    ends = [0.0 if still else float(alone.min()), float(alone.max())]
    over, kept = [beyond(end) for end in ends], -1
    for _ in range(_STEPS):
        if min(-over[0], over[1]) <= _ROUNDING:
            break
        middle = (ends[0] * over[1] - ends[1] * over[0]) / (over[1] - over[0])
        here = beyond(middle)
        side = int(here > 0)
        over[1 - side] /= 2 if side == kept else 1
        ends[side], over[side], kept = middle, here, side
    return ends[int(abs(over[1]) < abs(over[0]))] * _widening(spectra, degrees)


def _widening(spectra: Array, degrees: float) -> float:
    """Return U of a t over that of a normal.  spectra : (m, d) λ, not all noughts; degrees : of freedom, above 2"""
    if np.isinf(degrees):
        return 1.0
    squares = spectra.sum(axis=1)
    across = 2 * squares.mean() ** 2 / (2 * np.mean(np.sum(spectra**2, axis=1)) + squares.var())
    normal = float(chi_square_quantile(across, LEVEL))
    return float(np.sqrt((1 - 2 / degrees) * across * f_quantile(across, degrees, LEVEL) / normal))


def _moments(spectra: Array) -> tuple[Array, Array, Array, Array]:
    """Return the largest λ, Σλ over it, √(2ν/κ₂) and ν of each row, (m,).  spectra : (m, d), no row all noughts"""
    scale = spectra.max(axis=1)
    first, second, third = (np.sum((spectra / scale[:, None]) ** n, axis=1) for n in (1, 2, 3))
    return scale, first, second / third, second**3 / third**2
