"""The accuracy that is predicted while readings enter a plan."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from axiscal.estimation.accuracy.yardstick import Accuracy, Yardstick
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance, LowRank

_TOGETHER = 80
"""Readings that are taken in at once: of speed, not of the result."""


@dataclass(frozen=True, eq=False, slots=True)
class RunningAccuracy:
    """total : tr(V C Vᵀ) of the volume, m²; variances : of the TCP at the yardstick's poses, (m,) m²."""

    yardstick: Yardstick
    total: float
    variances: Array

    @classmethod
    def of(cls, yardstick: Yardstick, factor: Array) -> RunningAccuracy:
        """Return the accuracy of a covariance C = F Fᵀ.  factor : F (n, r)."""
        return cls(yardstick, yardstick.root.value(factor), yardstick.variances(factor))

    def after(self, change: LowRank) -> RunningAccuracy:
        """Return the accuracy after a change C ← C − H η Hᵀ."""
        root, rows = self.yardstick.root, self.yardstick.rows
        reach, seen = root.of(change.h), rows @ change.h[: rows.shape[2]]
        total = self.total - float(np.sum(reach @ change.eta * reach))
        variances = self.variances - np.sum(seen @ change.eta * seen, axis=(1, 2))
        return RunningAccuracy(self.yardstick, total, variances)

    @property
    def accuracy(self) -> Accuracy:
        """The figures."""
        return self.yardstick.figures(self.total, self.variances)


def along(state: Covariance, yardstick: Yardstick, order: Places) -> Iterator[tuple[float, Accuracy]]:
    """Yield J and the accuracy after each of many readings.  state : before the first"""
    for start in range(0, len(order), _TOGETHER):
        part = order.within(slice(start, start + _TOGETHER))
        state = state.opened(part)
        losses, owner = state.losses(part)
        ends = np.searchsorted(owner, np.arange(len(part)), side="right")
        values = state.value - np.cumsum(np.sum(state.root.of(losses.T) ** 2, axis=0))[ends - 1]
        yield from zip(values.tolist(), yardstick.along(state.factor, losses, ends), strict=True)
        state = state.after_readings(part)
