"""All readings as one covariance of the sizes θ: y ~ N(0, K(θ)), K(θ) = H P(θ) Hᵀ + Σ_c exp(2 θ_c) B_c.

P is the prior of the unknowns, B_c the kernel of a cause. Causes of type B take part neither in the mean nor in the
sizes (Schmidt's consider form; GUM 4.3): with G the gain and B what one standard deviation of each does to the numbers,

    m = G y,    Var[F u] = F C Fᵀ + Σ_j (F G b_j - f_j)²

f_j is what the cause does to the figure itself. Whether readings agree is judged with K + BBᵀ.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.causes import kernels
from axiscal_core.errors import Curved
from axiscal_core.model import Model
from axiscal_core.normal import Normal
from axiscal_core.places import Readings
from axiscal_core.refusals import Array, InputError
from axiscal_core.sizes import sizes_of
from axiscal_core.splines import distances, matern_by_length

NUGGET = 1e-9  # on correlations of a curve: long lengths make knots nearly equal, and Cholesky needs more than rounding
MOST = 1500  # numbers: the covariance of more, and its derivative by every size, would fill the memory


class Problem:
    """Readings of a case.  about : (size,) the unknowns at which they are linear, None for zero"""

    def __init__(self, case: Model, readings: Readings, about: Array | None = None) -> None:
        values = case.values(readings, "Case.estimate")
        if len(values) > MOST:
            raise InputError("Case.estimate", "readings", f"hold {len(values)} numbers", f"Give {MOST} at most")
        self.case, self.readings, self.about, self.sizes = case, readings, about, sizes_of(case)
        self.n = n = case.numbers(readings, about)
        self.values = values - n.shown + (0.0 if about is None else n.rows @ about)
        self.clock = clock_of(case, readings)
        self.fixed = np.zeros((len(values),) * 2)
        self.kernels = dict[int, Array]()
        for kind, owner, kernel in kernels(case, readings.places, n, self.clock):
            self._add(self.sizes.index(kind, owner), kernel)
        for i, name in enumerate(case.setups):
            exact = readings.std is not None
            self._add(
                -1 if exact else self.sizes.index("noise", name), np.diag(np.where(n.setup == i, n.noise**2, 0.0))
            )

    def _add(self, size: int, kernel: Array) -> None:
        if size < 0:
            self.fixed += kernel
        else:
            self.kernels[size] = self.kernels.get(size, 0.0) + kernel

    def prior(self, theta: Array) -> Array:
        """Return P, (size, size).  theta : (k,)"""
        result, grown = self.case.prior.covariance.copy(), np.exp(2 * np.append(theta, 0.0))
        for term, columns in self._curves():
            std, _, scale = self._sizes_of(term)
            result[columns, columns] = grown[std] * self._own(term, theta)
            if term.ramp is not None:
                result[columns, columns] += grown[scale] * np.outer(term.ramp, term.ramp)
        return result

    def covariance(self, theta: Array) -> Array:
        """Return K, (n, n).  theta : (k,)"""
        result = self.fixed + self.n.rows @ self.prior(theta) @ self.n.rows.T
        for size, kernel in self.kernels.items():
            result += np.exp(2 * theta[size]) * kernel
        return result

    def slopes(self, theta: Array) -> Array:
        """Return the derivative of K by each size, (k, n, n)."""
        result, grown = np.zeros((len(theta), *self.fixed.shape)), np.exp(2 * np.append(theta, 0.0))
        for size, kernel in self.kernels.items():
            result[size] += 2 * grown[size] * kernel
        for term, columns in self._curves():
            rows, (std, length, scale) = self.n.rows[:, columns], self._sizes_of(term)
            if std >= 0:
                result[std] += 2 * grown[std] * rows @ self._own(term, theta) @ rows.T
            if length >= 0 and term.length is not None:
                scaled = distances(term.spline) / (term.length * np.exp(theta[length]))
                result[length] += grown[std] * term.std**2 * rows @ matern_by_length(scaled) @ rows.T
            if scale >= 0 and term.ramp is not None:
                along = rows @ term.ramp
                result[scale] += 2 * grown[scale] * np.outer(along, along)
        return result

    def _curves(self) -> list[tuple[Curved, slice]]:
        return [(term, self.case.machine.columns[i]) for i, term in self.case.machine.curves]

    def _sizes_of(self, term: Curved) -> tuple[int, int, int]:
        """Return the numbers of the sizes of std, length and scale; -1 where one is exact."""
        std = self.sizes.index("reversal" if term.error.kind == "reversal" else "std", term.name)
        return std, self.sizes.index("length", term.name), self.sizes.index("scale", term.name)

    def _own(self, term: Curved, theta: Array) -> Array:
        """Return the prior of a curve at its length, (n, n), its size as stated, without the scale."""
        length = self.sizes.index("length", term.name)
        alike = term.correlation(float(np.exp(theta[length])) if length >= 0 else 1.0)
        nugget = NUGGET if term.length is not None else 0.0
        result: Array = term.std**2 * (alike + nugget * np.eye(len(alike)))
        return result


def clock_of(case: Model, readings: Readings) -> Array:
    """Return when each reading was taken, (m,) s: one after another where nobody looked at a clock."""
    if readings.time is not None:
        return readings.time
    costs = dict(zip(case.setups, (each.costs for each in case.instruments), strict=True))
    return np.cumsum([costs[name] for name in readings.places.instruments])


class Given:
    """Everything at one θ (k,).  value : log p(y), up to a constant"""

    def __init__(self, problem: Problem, theta: Array) -> None:
        self.problem, self.theta, self.k = problem, theta, problem.covariance(theta)
        self.root = np.linalg.cholesky(self.k)
        self.weighted = self.solved(problem.values)
        self.value = float(-0.5 * problem.values @ self.weighted - np.log(np.diagonal(self.root)).sum())

    def solved(self, right: Array) -> Array:
        """Return K⁻¹ X.  right : X (n, ...)"""
        from scipy.linalg import cho_solve

        return np.asarray(cho_solve((self.root, True), right))

    def slope(self) -> tuple[Array, Array]:
        """Return gradient (k,) and Fisher's information (k, k) of the value."""
        slopes = self.problem.slopes(self.theta)
        pulls = np.array([self.solved(each) for each in slopes]).reshape(slopes.shape)
        squares = np.einsum("i,kij,j->k", self.weighted, slopes, self.weighted, optimize=True)
        flat, turned = pulls.reshape(len(pulls), -1), pulls.swapaxes(1, 2).reshape(len(pulls), -1)
        return 0.5 * (squares - np.trace(pulls, axis1=1, axis2=2)), 0.5 * flat @ turned.T

    def posterior(self) -> Normal:
        """Return what readings make known of the unknowns, without causes of type B (eq. 31-33)."""
        prior = self.problem.prior(self.theta)
        reach = self.problem.n.rows @ prior
        return Normal(reach.T @ self.weighted, prior - reach.T @ self.solved(reach))

    def moved(self, causes: Array) -> Array:
        """Return G B, by what causes of type B move the mean, (size, c).  causes : B (n, c)"""
        reach = self.problem.n.rows @ self.problem.prior(self.theta)
        return np.asarray(reach.T @ self.solved(causes))
