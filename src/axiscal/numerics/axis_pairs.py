"""A quadratic form of a sum over axes, held as one table per axis and one per pair of axes.

|v_0 + Σ_k v_k(t_k)|² = constant + Σ_k single_k[t_k] + Σ_{k<l} double_kl[t_k, t_l]
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array


@dataclass(frozen=True, eq=False, slots=True)
class Pairs:
    """The form on a tensor lattice: constant, per axis (p_k,), per pair k < l (p_k, p_l)."""

    constant: float
    single: list[Array]
    double: dict[tuple[int, int], Array]

    @classmethod
    def of(cls, fixed: Array, rows: list[Array], parts: list[Array]) -> Pairs:
        """Return the tables for v_0 = fixed (x,) and v_k = rows_k (p_k, c_k) parts_k (c_k, x)."""
        axes = range(len(rows))
        single = [_quadratic(r, p @ p.T) + 2 * r @ (p @ fixed) for r, p in zip(rows, parts, strict=True)]
        double = {(k, m): 2 * rows[k] @ (parts[k] @ parts[m].T) @ rows[m].T for k in axes for m in axes if k < m}
        return cls(float(fixed @ fixed), single, double)

    def plus(self, constant: float, single: list[Array]) -> Pairs:
        """Return the form with a constant and a term per axis added."""
        return Pairs(self.constant + constant, [a + b for a, b in zip(self.single, single, strict=True)], self.double)

    def everywhere(self) -> Array:
        """Return the form at all points of the tensor lattice, (p_1, p_2, …)."""
        axes = range(len(self.single))
        result = np.full((1,) * len(axes), self.constant)
        for (k, m), table in self.double.items():
            result = result + table.reshape([len(self.single[i]) if i in (k, m) else 1 for i in axes])
        for k, values in enumerate(self.single):
            result = result + values.reshape([-1 if i == k else 1 for i in axes])
        return result

    def along(self, axis: int, points: NDArray[np.intp]) -> Array:
        """Return the form at every lattice position of one axis, (n, p_axis).  points : (n, axes), lattice indices."""
        rest = np.full(len(points), self.constant)
        result = np.tile(self.single[axis], (len(points), 1))
        for k, values in enumerate(self.single):
            if k != axis:
                rest += values[points[:, k]]
        for (k, m), table in self.double.items():
            if axis not in (k, m):
                rest += table[points[:, k], points[:, m]]
            else:
                result += table.T[points[:, m]] if k == axis else table[points[:, k]]
        result += rest[:, None]
        return result


def _quadratic(rows: Array, form: Array) -> Array:
    values: Array = np.einsum("pi,pi->p", rows @ form, rows)
    return values
