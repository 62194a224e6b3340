"""A machine that runs on with the tables of its last campaign: what is left of its errors after a time.

With a' what it has after Δt (`wearing`) and ℓ what its tables could not hold on the day of the campaign, the tool point
is off by H (a' − m) + ℓ and the rests. The mean square over the volume is a closed form; how probable it is that the
worst place is farther off than a tolerance comes from machines that are drawn, the same ones for every Δt.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.estimate.problem import Inherited
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.type_prior import TypePrior
from axiscal.fleet.aging import Aging
from axiscal.fleet.tables_left import control_of, left_at, products_left
from axiscal.fleet.wearing import Wearing, Worn, found_by
from axiscal.numerics import Array
from axiscal.numerics.gaussian import positive_root

_DRAWN, _AT_ONCE = 2000, 200
"""Machines: 5 % of them are known to ± 0.5 %. So many at once keep their tool points within 10 MB."""


class WornMachine:
    """One machine and its last campaign.

    known : what that came to; aging : how machines change; renewed : axes of which nothing is as it was found
    tables : of which control; None where all that was found is taken away
    taught : by a type, where the machine was measured without
    Raises TableError where no tables can be made for the control.
    """

    def __init__(
        self,
        known: Estimation,
        aging: Aging,
        renewed: Sequence[str] = (),
        tables: str | None = None,
        taught: TypePrior | None = None,
    ) -> None:
        errors, self._root = known.case.errors, known.case.yardstick.root
        self._known, self._aging = known, aging
        self._fresh = np.zeros(errors.size, dtype=bool)
        for term in errors.terms:
            self._fresh[term.columns] = any(errors.machine.axes[axis].name in renewed for axis in term.axes)
        self._worn = Wearing.of(known, taught).worn(found_by(known))
        self._control = None if tables is None else control_of(known, tables)
        if self._control is None:
            moving = self._worn.found.mean - self._worn.stays.mean
            fields = np.array([self._root.matrix @ (moving * share) for share in (0.0, ~self._fresh, self._fresh)])
            self._products = fields @ fields.T
        else:
            self._products = products_left(known, self._control, self._fresh, self._worn.stays.mean)

    def rms(self, years: float) -> float:
        """Return the RMS over the volume after a time in years, m."""
        rho, square = self._aging.kept(years)
        once = np.array([1.0, rho - 1.0, -1.0])
        moved = once @ self._products @ once + (square - rho**2) * self._products[1, 1]
        drifted = self._root.gram.value(self._worn.covariance(rho, square, self._fresh))
        return self._known.case.yardstick.rms_of(float(drifted + moved))

    def prior(self, years: float) -> Inherited:
        """Return what is known of its errors after a time in years: what a recalibration begins with."""
        return self._worn.left(*self._aging.kept(years), self._fresh)

    def beyond(self, years: float, tolerance: float) -> float:
        """Return how probable it is that the worst place is farther off than a tolerance, m, after a time in years."""
        far = 0
        for start in range(0, _DRAWN, _AT_ONCE):
            off = self._left[..., None] + self._off(years, slice(start, start + _AT_ONCE))
            far += int(np.sum(np.max(np.sum(off**2, axis=1), axis=0) > tolerance**2))
        return far / _DRAWN

    def _off(self, years: float, some: slice) -> Array:
        """Return the tool points of some of the machines that are drawn, their rests with them, (m, 3, k) m."""
        rows, drawn = self._known.case.yardstick.rows, self._drawn
        rho = drawn.kept(years)[some]
        ages = ~self._fresh[:, None]
        kept = ages * rho
        errors = kept * drawn.errors[:, some] + (1 - kept) * drawn.stays[:, some]
        errors += np.where(ages, np.sqrt(1 - rho**2), 1.0) * drawn.new[:, some]
        moved = rows.reshape(-1, rows.shape[2]) @ (errors - self._worn.found.mean[:, None])
        off: Array = moved.reshape(len(rows), 3, -1) + self._rests[:, :, some]
        return off

    @cached_property
    def _rests(self) -> NDArray[np.float32]:
        """What the rests of each machine do at each pose of the yardstick, (m, 3, k) m: 20 MB, drawn once."""
        values, vectors = np.linalg.eigh(self._known.case.yardstick.rests)
        roots = (vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]).astype(np.float32)
        drawn = np.random.default_rng(23).standard_normal((len(roots), 3, _DRAWN), dtype=np.float32)
        rests: NDArray[np.float32] = roots @ drawn
        return rests

    @cached_property
    def _left(self) -> Array:
        """What the tables leave on the day of the campaign at each pose of the yardstick, (m, 3) m."""
        if self._control is None:
            return np.zeros((len(self._known.case.yardstick.rows), 3))
        return left_at(self._known, self._control, *self._known.case.yardstick.poses)

    @cached_property
    def _drawn(self) -> _Drawn:
        return _Drawn(self._worn, self._aging, self._fresh)


class _Drawn:
    """Machines as the campaign left them: their errors, what of them stays, and what comes anew, (n, k) each."""

    def __init__(self, worn: Worn, aging: Aging, fresh: NDArray[np.bool_]) -> None:
        rng, size = np.random.default_rng(22), len(worn.found.mean)
        self._aging, self._cells = aging, rng.choice(aging.weights.size, _DRAWN, p=aging.weights.ravel())
        joint = np.block([[worn.found.covariance, worn.link], [worn.link.T, worn.stays.covariance]])
        mean = np.concatenate([worn.found.mean, worn.stays.mean])
        both = mean[:, None] + _scattered(joint, rng)
        self.errors, self.stays = both[:size], both[size:]
        self.new = _scattered(worn.own * (fresh[:, None] == fresh), rng)

    def kept(self, years: float) -> Array:
        """Return the share of its errors that each machine keeps, (k,)."""
        kept: Array = self._aging.shares(years).ravel()[self._cells]
        return kept


def _scattered(covariance: Array, rng: np.random.Generator) -> Array:
    """Return draws of a normal about nought, (n, k)."""
    root = positive_root(covariance, np.diagonal(covariance))
    drawn: Array = root @ rng.standard_normal((root.shape[1], _DRAWN))
    return drawn
