"""How good the machine is known to be: the figures a campaign reports and stops by.

The covariance C of the belief splits into what readings could still tell, C − C_∞, and what no allowed reading tells,
C_∞. An unobservable constant shift of the TCP does not count: setting the workpiece zero removes it. Along a direction
in which C_∞ has most of the shift, its part in C − C_∞ does not count either. Everything else does. The floor is what
endless readings would leave of it.

What a reading is to make small is J = tr(W C) = tr(V C Vᵀ), by a root V of its Gram matrix, W = VᵀV.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.errors.volume import Counted, Volume
from axiscal.numerics import Array
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal


class Accuracy(NamedTuple):
    """Accuracy to which the TCP is known over the volume, m: RMS and largest standard deviation."""

    rms: float
    worst: float


_NEAR = 1.1
"""A choice: nearer to the floor each reading takes away less and less."""


def attainable(limit: float, floor: float) -> float:
    """Return what readings can be held to: a limit, or where its floor is above it a tenth more than the floor."""
    return limit if floor <= limit else _NEAR * floor


def _summed(parts: Array) -> Array:
    """Return the sums of the first 0, 1, 2, ... parts."""
    return np.concatenate([np.zeros_like(parts[:1]), np.cumsum(parts, axis=0)])


def _squared(parts: Array) -> Array:
    """Return S Sᵀ at each pose, (m, 3, 3).  parts : (m, 3, r)"""
    return parts @ parts.transpose(0, 2, 1)


@dataclass(frozen=True, eq=False)
class Yardstick:
    """Measures a belief against the working volume.

    volume : whose errors may be of other sizes; unseen : (errors.size, r) factor of C_∞, the machine's own errors
    left : (errors.size, s) factor of what endless readings leave, what instruments are off by with it
    zeroed : directions x, y, z of the workpiece frame in which a constant shift is not counted
    """

    volume: Volume
    errors: Machine
    unseen: Array
    left: Array
    zeroed: tuple[bool, bool, bool] = (False, False, False)

    @property
    def counted(self) -> Counted:
        """Directions x, y, z of the workpiece frame along which deviations count: of a printer's bed the height."""
        return self.volume.counted

    @cached_property
    def _counts(self) -> Array:
        """1 in the directions that count, (3, 1)."""
        return np.array(self.counted, dtype=float)[:, None]

    @cached_property
    def _shift(self) -> Array:
        """E[H] in the directions in which the constant shift is not counted, else zero, (3, size)."""
        return np.asarray(self.volume.moments.mean * np.array(self.zeroed, dtype=float)[:, None])

    @property
    def root(self) -> Array:
        """V (r, size) with VᵀV = E[HᵀH], less E[H]ᵀE[H] where the constant shift is not counted."""
        return self.volume.root(self.zeroed)

    def total(self, factor: Array) -> float:
        """Return J = tr(V C Vᵀ) of C = F Fᵀ, m².  factor : F (n, r) or a vector (n,)"""
        return float(np.sum((self.root @ factor[: self.errors.size]) ** 2))

    @property
    def rest(self) -> float:
        """The share of rests in the mean square of the TCP over the volume, m²."""
        return float(self.errors.rests**2 @ self.volume.moments.squares)

    @cached_property
    def unseen_rms(self) -> float:
        """RMS over the volume of what no allowed reading sees, m."""
        return float(np.sqrt(max(self.total(self.unseen) - self._unseen_shift, 0.0)))

    @cached_property
    def floors(self) -> tuple[float, float]:
        """RMS over the volume and largest standard deviation that endless readings would leave, m."""
        return self.rms_floor, max(float(np.sqrt(self.variances(self.left).max())), self.rms_floor)

    @cached_property
    def rms_floor(self) -> float:
        """The first of them, for which no place has to be looked at."""
        return self.rms_of(self.total(self.left))

    @cached_property
    def _unseen_shift(self) -> float:
        """The part of tr(V C_∞ Vᵀ) that is a constant shift in the other directions, m²."""
        return float(np.sum((self._counts * (self.volume.moments.mean - self._shift) @ self.unseen) ** 2))

    def measure(self, belief: Normal) -> Accuracy:
        """Return the figures of a belief."""
        return self.measure_factor(belief.factor)

    def measure_factor(self, factor: Array) -> Accuracy:
        """Return the figures of a covariance C = F Fᵀ.  factor : F (n, r)"""
        return self.figures(self.total(factor), self.variances(factor))

    def accuracies(self, factor: Array, losses: Array, ends: NDArray[np.intp]) -> list[Accuracy]:
        """Return the figures after each of many readings.

        factor : F (n, r) before them; losses : (m, n) what each number takes off the covariance, d dᵀ
        ends : how many numbers there were after each reading
        """
        own = losses[:, : self.errors.size]
        variances = self.variances(factor)
        totals = self.total(factor) - _summed(np.sum((own @ self.root.T) ** 2, axis=1))[ends]
        lost = (own @ self.rows.reshape(-1, self.errors.size).T).reshape(len(own), -1, 3)
        left = variances - _summed(np.einsum("ipc,ipc->ip", lost, lost))[ends]
        return [self.figures(float(each), spread) for each, spread in zip(totals, left, strict=True)]

    def figures(self, total: float, variances: Array) -> Accuracy:
        """Return the figures for tr(V C Vᵀ) and the TCP variances at the yardstick's poses, m²."""
        rms = self.rms_of(total)
        return Accuracy(rms, float(np.sqrt(max(np.max(variances), rms**2))))

    def rms_of(self, total: float) -> float:
        """Return the RMS over the volume that belongs to J = tr(V C Vᵀ), m."""
        return float(np.sqrt(max(total - self._unseen_shift, 0.0) + self.rest))

    def worst_root(self, belief: Normal) -> Array:
        """Return H (3, size), less the shift not counted, at the pose where the TCP is known least."""
        return np.asarray(self.rows[self.variances(belief.factor).argmax()])

    @cached_property
    def rows(self) -> Array:
        """H at each pose, less the shift that is not counted, (m, 3, size); zero where none counts."""
        return self._every_row if all(self.counted) else self._every_row * self._counts

    @cached_property
    def _every_row(self) -> Array:
        """The same in every direction, counted or not."""
        return self.volume.rows - self._shift if any(self.zeroed) else self.volume.rows

    def covariances(self, factor: Array) -> Array:
        """Return the covariance of the TCP deviation at each pose, (m, 3, 3) m²: traces `variances` where all counts.

        factor : F (n, r) with C = F Fᵀ
        """
        return _squared(self._seen(factor, self._every_row).reshape(len(self.rows), 3, -1)) + self._anyway

    @cached_property
    def _anyway(self) -> Array:
        """What rests add, and shifts that are not counted take off, at each pose, (m, 3, 3), m²."""
        here = self._every_row @ self.unseen  # what allowed readings cannot see
        hidden = here - (self.volume.moments.mean - self._shift) @ self.unseen
        return _squared(self.volume.levers * self.errors.rests) + _squared(hidden) - _squared(here)

    def variances(self, factor: Array) -> Array:
        """Return the TCP variance at each pose of the volume, (m,) m².  factor : F (n, r) with C = F Fᵀ."""
        seen = self._seen(factor, self.rows)
        anyway = np.einsum("pcc->pc", self._anyway)[:, list(self.counted)].sum(axis=1)
        return np.asarray(np.einsum("ij,ij->i", seen, seen).reshape(-1, 3).sum(axis=1) + anyway)

    def _seen(self, factor: Array, rows: Array) -> Array:
        """Return H F at each pose, (3 m, r), r no more than the errors have coefficients.

        factor : F (n, r); rows : H (m, 3, size)
        """
        own = factor[: self.errors.size]
        if own.shape[1] > own.shape[0]:  # columns of rests and set-ups: fold them into as many as there are errors
            own = np.asarray(np.linalg.qr(own.T, mode="r")).T
        return rows.reshape(-1, self.errors.size) @ own
