"""All readings as one covariance of the sizes θ: y ~ N(0, K(θ) + U Uᵀ), K(θ) = H P(θ) Hᵀ + Σ_c exp(2 θ_c) B_c.

P is the prior of the machine's coefficients, B_c the kernel of a cause. U is what one standard deviation of each
unknown of an instrument does.

Causes of type B take part neither in the mean nor in the sizes (Schmidt's consider form; GUM 4.3: knowledge from
elsewhere, which readings cannot improve). G is the gain, B what one standard deviation of each does to the numbers:

    m = G y,    Var[F u] = F C Fᵀ + Σ_j (F G b_j - f_j)²

f_j is what the cause does to the figure itself. Whether readings agree is judged with K + BBᵀ.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.causes import kernels
from axiscal_core.draws import Slope
from axiscal_core.errors import Curved
from axiscal_core.from_scipy import back_solution, solution
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
        self.rows, own = np.split(n.rows, [case.machine.size], axis=1)
        self.stds = case.prior.std[case.machine.size :]
        self.open = own * self.stds
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

    def given(self, theta: Array) -> Given:
        """Return everything at sizes θ.  theta : (k,)"""
        return Given(self, theta)

    def prior(self, theta: Array) -> Array:
        """Return P, (coefficients, coefficients).  theta : (k,)"""
        size = self.case.machine.size
        result, grown = self.case.prior.covariance[:size, :size].copy(), np.exp(2 * np.append(theta, 0.0))
        for term, columns in self._curves():
            std, _, scale = self._sizes_of(term)
            result[columns, columns] = grown[std] * self._own(term, theta)
            if term.ramp is not None:
                result[columns, columns] += grown[scale] * np.outer(term.ramp, term.ramp)
        return result

    def covariance(self, theta: Array) -> Array:
        """Return K, (n, n), without U Uᵀ.  theta : (k,)"""
        result = self.fixed + self.rows @ self.prior(theta) @ self.rows.T
        for size, kernel in self.kernels.items():
            result += np.exp(2 * theta[size]) * kernel
        return result

    def slopes(self, theta: Array) -> Array:
        """Return the derivative of K by each size, (k, n, n)."""
        result, grown = np.zeros((len(theta), *self.fixed.shape)), np.exp(2 * np.append(theta, 0.0))
        for size, kernel in self.kernels.items():
            result[size] += 2 * grown[size] * kernel
        for term, columns in self._curves():
            rows, (std, length, scale) = self.rows[:, columns], self._sizes_of(term)
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


class Factored:
    """K + U Uᵀ as a factor.

    An unknown zero of 1 mm stands beside a noise of 0.3 um, and K + U Uᵀ itself would lose seven digits. So U is kept
    apart (Woodbury; Rasmussen and Williams 2006, eq. 2.42):   (K + U Uᵀ)⁻¹ = K⁻¹ - K⁻¹ U (1 + Uᵀ K⁻¹ U)⁻¹ Uᵀ K⁻¹

    root : (n, n) lower, of K; wide : U (n, u)
    """

    def __init__(self, root: Array, wide: Array) -> None:
        self.root, self.half = root, solution(root, wide)
        self.inner = _root(np.eye(wide.shape[1]) + self.half.T @ self.half)

    @property
    def log_root(self) -> float:
        """Half of the logarithm of the determinant."""
        return float(sum(np.log(np.diagonal(each)).sum() for each in (self.root, self.inner)))

    def opened(self, right: Array) -> Array:
        """Return Uᵀ (K + U Uᵀ)⁻¹ X, (u, ...): what X makes known of unknowns of variance one.  right : X (n, ...)"""
        return back_solution(self.inner, solution(self.inner, self.half.T @ solution(self.root, right)))

    def solved(self, right: Array) -> Array:
        """Return (K + U Uᵀ)⁻¹ X, (n, ...).  right : X (n, ...)"""
        return back_solution(self.root, solution(self.root, right) - self.half @ self.opened(right))


def _root(square: Array) -> Array:
    """Return the lower Cholesky factor."""
    return np.asarray(np.linalg.cholesky(square), dtype=np.float64)


class Given:
    """Everything at one θ (k,).  value : log p(y), up to a constant; weighted : (K + U Uᵀ)⁻¹ y, (n,)"""

    def __init__(self, problem: Problem, theta: Array) -> None:
        self.problem, self.theta, self.prior = problem, theta, problem.prior(theta)
        self.factor = Factored(_root(problem.covariance(theta)), problem.open)
        self.weighted = self.factor.solved(problem.values)
        self.value = float(-0.5 * problem.values @ self.weighted - self.factor.log_root)
        self.reach = problem.rows @ self.prior

    def slope(self) -> Slope:
        """Return the value, its gradient and Fisher's information."""
        slopes = self.problem.slopes(self.theta)
        pulls = np.array([self.factor.solved(each) for each in slopes]).reshape(slopes.shape)
        squares = np.einsum("i,kij,j->k", self.weighted, slopes, self.weighted, optimize=True)
        flat, turned = pulls.reshape(len(pulls), -1), pulls.swapaxes(1, 2).reshape(len(pulls), -1)
        return Slope(self.value, 0.5 * (squares - np.trace(pulls, axis1=1, axis2=2)), 0.5 * flat @ turned.T)

    def gain(self, right: Array) -> Array:
        """Return G X, (size, ...): by what X moves the mean.  right : X (n, ...)"""
        own = self.factor.opened(right)
        stds = self.problem.stds.reshape(-1, *[1] * (own.ndim - 1))
        return np.concatenate([self.reach.T @ self.factor.solved(right), stds * own])

    def posterior(self) -> Normal:
        """Return what readings make known of the unknowns, without causes of type B (eq. 31-33)."""
        stds, inner = self.problem.stds, self.factor.inner
        machine = self.prior - self.reach.T @ self.factor.solved(self.reach)
        both = -self.factor.opened(self.reach).T * stds
        half = solution(inner, np.diag(stds))
        return Normal(self.gain(self.problem.values), np.block([[machine, both], [both.T, half.T @ half]]))
