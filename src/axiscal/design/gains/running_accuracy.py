"""The accuracy that is predicted while readings enter a plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.accuracy.yardstick import Accuracy, Yardstick
from axiscal.design.gains.covariance import LowRank
from axiscal.numerics import Array


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
