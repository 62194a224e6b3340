"""How good the machine is known to be: the figures a campaign reports and stops by.

The covariance C of the belief splits into what readings could still tell, C − C_∞, and what no allowed reading tells,
C_∞. A constant shift of the TCP that lies in the second part is a matter of where the workpiece zero is set, and is
not counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from axiscal.belief import Belief
from axiscal.design import criterion
from axiscal.design.lattice import corners, even_points
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.volume import Box, VolumeMoments
from axiscal.numerics import Array

_INNER_POINTS = 400


class Accuracy(NamedTuple):
    """What is known of the TCP over the volume, all in m.

    rms, worst : RMS and largest standard deviation; seen, worst_seen : the same without what no allowed reading sees
    """

    rms: float
    worst: float
    seen: float
    worst_seen: float


@dataclass(frozen=True, eq=False)
class Yardstick:
    """Measures a belief against the working volume.

    moments : over the volume; unseen : (errors.size, r) factor of C_∞, the machine's own errors
    """

    errors: ErrorModel
    box: Box
    moments: VolumeMoments
    unseen: Array

    @cached_property
    def root(self) -> Array:
        """V (n, n) with E[HᵀH] = VᵀV."""
        return criterion.volume_root(self.moments)

    @cached_property
    def _shift(self) -> float:
        """Variance of the constant shift that no reading sees, m²."""
        return float(np.sum((self.moments.mean @ self.unseen) ** 2))

    @cached_property
    def unseen_rms(self) -> float:
        """RMS over the volume of what no allowed reading sees, m."""
        return float(np.sqrt(max(self._unseen_total - self._shift, 0.0)))

    @cached_property
    def _unseen_total(self) -> float:
        """tr(V C_∞ Vᵀ), m²."""
        return float(np.sum((self.root @ self.unseen) ** 2))

    def measure(self, belief: Belief) -> Accuracy:
        """Return the figures of a belief."""
        return self.figures(criterion.value(belief, self.root), self.variances(belief.factor))

    def figures(self, total: float, variances: Array) -> Accuracy:
        """Return the figures for tr(V C Vᵀ) and the TCP variances at the yardstick's poses, m²."""
        seen = total - self._unseen_total
        variance = max(total - self._shift, 0.0) + self.moments.rest
        worst = max(float(np.max(variances)), variance)
        worst_seen = float(np.max(variances + self._hidden))
        figures = variance, worst, max(seen, 0.0) + self.moments.rest, worst_seen
        return Accuracy(*(float(np.sqrt(max(figure, 0.0))) for figure in figures))

    def rms_of(self, total: float) -> float:
        """Return the RMS over the volume that belongs to J = tr(V C Vᵀ), m."""
        return float(np.sqrt(max(total - self._shift, 0.0) + self.moments.rest))

    def worst_rows(self, belief: Belief) -> Array:
        """Return H (3, size) at the pose where the TCP is known least."""
        pose, approach = (x[self.variances(belief.factor).argmax()][None] for x in self._poses)
        rows: Array = self.errors.rows(pose, approach)[0]
        return rows

    @cached_property
    def _poses(self) -> tuple[Array, Array]:
        low, high = np.array(self.box).T
        inner = low + (high - low) * even_points(_INNER_POINTS, len(self.box))
        poses = np.concatenate([corners(self.box), inner])
        if not any(f.kind == "reversal" for f in self.errors.functions):
            return poses, np.ones_like(poses)
        return np.concatenate([poses, poses]), np.concatenate([np.ones_like(poses), -np.ones_like(poses)])

    @cached_property
    def rows(self) -> Array:
        """H at each pose of the yardstick, (m, 3, size)."""
        return self.errors.rows(*self._poses)

    @cached_property
    def _here(self) -> Array:
        """What no allowed reading sees, at each pose: (m, 3, r)."""
        here = self.rows.reshape(-1, self.errors.size) @ self.unseen
        return here.reshape(len(self.rows), 3, -1)

    @cached_property
    def _hidden(self) -> Array:
        """What takes the unseen part, its constant shift not counted, off the variances, m²."""
        centred: Array = np.sum((self._here - self.moments.mean @ self.unseen) ** 2, axis=(1, 2))
        return -centred

    @cached_property
    def _correction(self) -> Array:
        """What the constant shift takes off the variance at each pose, and what the rest adds, m²."""
        rests = np.array([f.rest / (2 if f.kind == "reversal" else 1) for f in self.errors.functions])
        added = np.sum((self.errors.levers(self._poses[0]) * rests[:, None, None]) ** 2, axis=(0, 2))
        result: Array = added - np.sum(self._here**2, axis=(1, 2)) - self._hidden
        return result

    def variances(self, factor: Array) -> Array:
        """Return the TCP variance at each pose of the yardstick, (m,) m².  factor : F (n, r) with C = F Fᵀ."""
        own = factor[: self.errors.size]
        if own.shape[1] > own.shape[0]:  # columns of rests and set-ups: fold them into as many as there are errors
            own = np.linalg.qr(own.T).R.T
        seen = self.rows.reshape(-1, self.errors.size) @ own
        spread: Array = np.einsum("ij,ij->i", seen, seen).reshape(-1, 3).sum(axis=1) + self._correction
        return spread
