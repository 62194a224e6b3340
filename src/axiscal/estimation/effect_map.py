"""How readings become curves, and what a departure that their model does not hold makes of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from axiscal.accuracy.damage import Harm
from axiscal.accuracy.yardstick import Yardstick
from axiscal.error_model.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.departed_volume import field
from axiscal.estimation.statements import LeftOpen
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.departures import Departure, Family
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import transposed_solution
from axiscal.numerics.gaussian import eigen_root

_OF_SETUPS: frozenset[Family] = frozenset({"drift", "levelling", "excursion"})
"""Families whose size is what a zero moves by in the course of a set-up."""
LARGEST_SHIFT = 20e-6
"""m or rad over one set-up, straight or levelling off; as much of a zero that comes and goes in it, of a growth over
the travel, and of a bad reading: means of runs of ISO tests at hand move by 6, 44 and 50 um (docs/conventions.md).
"""
_LARGEST_PITCH = 5e-6
"""m or rad: a ground screw of usual make goes wrong by less in a turn (an assumption)."""
_REVERSALS = 2.0
"""Standard deviations of a reversal by which it may vary along its axis."""
TOGETHER = 0.5
"""Standard deviations of the curves of two axes by which they may act together where no error of both is described."""


class EffectMap:
    """How readings become curves: what one column b, and one shape φ, leave over the volume.

    The covariance K of the readings is kept as R with RᵀR = K, by QR of what K is the square of: a zero that is open by
    a millimetre beside noise of half a micrometre costs no digits.

    features : (m, k) Φ, the covariance of the numbers without noise as Φ Φᵀ; std : (m,) of their noise
    weighted : (w, k) V F, what the same k independent unknowns do over the volume
    remaining : J = tr(V C Vᵀ) after these readings, m²
    """

    def __init__(self, yardstick: Yardstick, features: Array, std: Array, weighted: Array) -> None:
        self._yardstick = yardstick
        self._upper: Array = np.asarray(np.linalg.qr(np.vstack([np.diag(std), features.T]), mode="r"))
        self._white: Array = transposed_solution(self._upper, features)  # R⁻ᵀ Φ
        self._kept = weighted @ self._white.T  # V C Gᵀ R⁻¹
        self.remaining = float(np.sum(weighted**2) - np.sum(self._kept**2))

    @classmethod
    def of(cls, case: Case, readings: Sequence[Reading]) -> EffectMap:
        """Return the effects of readings of a case, on what is known before the first of them."""
        return cls.of_numbers(case, ReadingSet(case.observation, readings), prior_root(case))

    @classmethod
    def of_numbers(cls, case: Case, numbers: ReadingSet, root: Array) -> EffectMap:
        """Return the same of their numbers.  root : (size, r) of the errors before the first reading"""
        features = numbers.features(root)
        weighted = np.zeros((len(case.yardstick.root.matrix), features.shape[1]))
        weighted[:, : root.shape[1]] = case.yardstick.root.of(root)
        return cls(case.yardstick, features, np.sqrt(numbers.noise + numbers.extra_variance), weighted)

    def each(self, several: Sequence[Departure]) -> list[Harm]:
        """Return what departures of size 1 do, of drifts over the whole set-up, from one solution with all columns."""
        white = transposed_solution(self._upper, np.hstack([_of_size_one(each) for each in several]))
        cuts = np.cumsum([each.columns.shape[1] for each in several])[:-1]
        seen, left = np.split(white, cuts, axis=1), np.split(-(self._kept @ white), cuts, axis=1)
        return [self._harm(*part) for part in zip(several, seen, left, strict=True)]

    def _harm(self, departure: Departure, white: Array, left: Array) -> Harm:
        """Return what a departure does.  white : (m, r) R⁻ᵀ b; left : (w, r) −V x, x what the estimate makes of b"""
        beside = 0.0
        if departure.function is not None:
            followed, beside = field(self._yardstick, departure)
            left = left + followed
        wrong = (float(np.sum(left**2)) + beside) / departure.columns.shape[1]
        return Harm(white.T @ white, wrong, largest(self._yardstick.errors, departure))

    def left_open(self, columns: Array, root: Array, own: Array) -> LeftOpen:
        """Return what readings leave of unknowns and of all else, over the volume but for a constant shift.

        columns : (m, s) what one standard deviation of each adds to the numbers; own : (size, s) to the errors
        root : (size, r) of the errors before the first reading, with which the features begin
        """
        white, followed = transposed_solution(self._upper, columns), self._white[:, : root.shape[1]]
        steady = self._yardstick.steady
        over = steady.of(root)
        kept, fields = over @ followed.T, steady.of(own) - over @ (followed.T @ white)
        return LeftOpen(fields, over @ over.T - kept @ kept.T - fields @ fields.T, white.T @ white)


def _of_size_one(departure: Departure) -> Array:
    """Return b of a departure of size 1, (m, r): of a zero that moves by 1 over its set-up, 0 of what no time shows."""
    moved = float(np.ptp(departure.columns)) if departure.family in _OF_SETUPS else 1.0
    return departure.columns / (moved or 1.0)


def largest(errors: ErrorModel, departure: Departure) -> float:
    """Return the largest size that is considered, m or rad."""
    if departure.function is None:
        return LARGEST_SHIFT
    entry = errors.machine.errors[departure.function]
    if departure.family == "reversal":
        return _REVERSALS * entry.std
    if departure.family == "together":
        return TOGETHER * entry.std
    return min(entry.std, _LARGEST_PITCH) if departure.family == "pitch" else entry.std


def prior_root(case: Case) -> Array:
    """Return F (size, r) with F Fᵀ the covariance of the errors before the first reading."""
    return case.errors.prior_root() if case.inherited is None else eigen_root(case.inherited.covariance)
