"""One model, one posterior: the equations as they stand.

Readings are linear in unknowns, and all are Gaussian once the logarithms θ of a few sizes are known:

    y = Z u + e,    u ~ N(0, C(θ)),  e ~ N(0, N(θ)),    so  y ~ N(0, K(θ)),  K = Z C Zᵀ + N
    log L(θ) = −½ yᵀK⁻¹y − ½ log |K|                        Rasmussen and Williams 2006, eq. 2.30, less a constant
    u | y, θ ~ N(C Zᵀ K⁻¹ y,  C − C Zᵀ K⁻¹ Z C)             eq. 2.25 and 2.26

A cause b of type B is no column of Z: with m_θ = G y the covariance gains (G b)(G b)ᵀ. Readings are judged by K + B Bᵀ.

The sizes are not known, so draws of θ with weights w, Σ w = 1, stand for them:

    m = Σ w m_θ,    V = Σ w (V_θ + (m_θ − m)(m_θ − m)ᵀ)

They differ in s²_θ = tr G (V_θ + (m_θ − m)(m_θ − m)ᵀ), G of the volume. A t whose variance differs as much has degrees

    f = 4 + 2 E[s²]²/Var[s²]

The others expect reading i with mean μ and covariance S. A good one is as they say; a bad one, 1 of 100, is 30 σ wider:

    odds_i = 0.01/0.99 Σ w N(y_i; μ, S + (30 σ_i)²) / N(y_i; μ, S)

Here a reading is left out by leaving it out, and inverses are inverses: n numbers cost n³ for each question.
`axiscal_core.spaces` and `axiscal.estimation.promise.posterior` answer the same fast and are held to this file.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal.numerics import Array
from axiscal_core.left_out import OFF
from axiscal_core.problem import Problem

Normal = tuple[Array, Array]
"""Mean (k,) and covariance (k, k)."""


@dataclass(frozen=True, eq=False)
class Dense:
    """A problem in plain matrices; each number is over its noise as stated."""

    problem: Problem

    def prior_covariance(self, theta: Array) -> Array:
        """Return C(θ), (p, p): s² times correlation, block by block."""
        problem, size = self.problem, np.exp(np.append(theta, 0.0))[self.problem.size_at]
        result = np.eye(len(size))
        for curves in problem.curves:
            for columns, root in zip(curves.columns, curves.roots(theta), strict=True):
                result[np.ix_(columns, columns)] = root @ root.T
        return np.asarray(size[:, None] * result * size)

    def sigma(self, theta: Array) -> Array:
        """Return the noise of each number over its noise as stated, (m,)."""
        return np.asarray(np.exp(np.append(theta, 0.0))[self.problem.groups])

    def covariance(self, theta: Array) -> Array:
        """Return K(θ), (m, m)."""
        rows = self.problem.rows
        return np.asarray(rows @ self.prior_covariance(theta) @ rows.T + np.diag(self.sigma(theta) ** 2))

    def judging(self, theta: Array) -> Array:
        """Return K(θ) + B Bᵀ, (m, m), of causes that do not follow from what was read."""
        pairs = zip(self.problem.causes, self.problem.type_b.T, strict=True)
        apart = [column for cause, column in pairs if not cause.row.of_values]
        return np.asarray(self.covariance(theta) + sum(np.outer(each, each) for each in apart))

    def log_likelihood(self, theta: Array) -> float:
        """Return log L(θ)."""
        return log_density(self.problem.values, np.zeros(len(self.problem.values)), self.covariance(theta))

    def unknowns(self, theta: Array) -> Normal:
        """Return the posterior of the answered unknowns at θ, m and rad."""
        problem, prior = self.problem, self.prior_covariance(theta)
        seen = prior @ problem.rows.T @ np.linalg.inv(self.covariance(theta))
        # Joseph's form: a zero of a millimetre known to a tenth of a micrometre would lose the digits of a difference
        left = np.eye(len(prior)) - seen @ problem.rows
        mean, covariance = seen @ problem.values, left @ prior @ left.T + seen * self.sigma(theta) ** 2 @ seen.T
        turn, last = np.eye(len(mean)), slice(problem.first, None)
        for start, root in problem.roots:
            turn[start : start + len(root), start : start + len(root)] = root
        turn = turn[problem.own :, last]
        for number, scale in enumerate(problem.scales):
            turn[scale.part, number] = scale.ramp
        return problem.mean + turn @ mean[last], turn @ covariance[last, last] @ turn.T

    def counted(self, theta: Array) -> Normal:
        """Return the same with causes of type B: by what m moves if the values do."""
        (mean, covariance), moved = self.unknowns(theta), list[Array]()
        for cause in self.problem.type_b.T:
            other = Dense(replace(self.problem, values=self.problem.values + cause))
            moved.append(other.unknowns(theta)[0] - mean)
        return mean, covariance + sum((np.outer(each, each) for each in moved), np.zeros_like(covariance))

    def expected(self, theta: Array, reading: int) -> Normal:
        """Return what the other readings expect of one, at θ."""
        covariance, mine = self.judging(theta), self.problem.reading == reading
        beside = covariance - self.covariance(theta)
        seen = covariance[np.ix_(mine, ~mine)] @ np.linalg.inv(covariance[np.ix_(~mine, ~mine)])
        apart = np.eye(len(mine))[mine]
        apart[:, ~mine] = -seen
        left, noise = apart @ self.problem.rows, apart * self.sigma(theta)
        return seen @ self.problem.values[~mine], left @ self.prior_covariance(
            theta
        ) @ left.T + noise @ noise.T + apart @ beside @ apart.T

    def odds(self, thetas: Array, weights: Array, reading: int) -> float:
        """Return the odds that a reading is bad.  thetas : (n, k); weights : (n,)"""
        mine, total = self.problem.reading == reading, 0.0
        for theta, weight in zip(thetas, weights, strict=True):
            mean, covariance = self.expected(theta, reading)
            wide = covariance + np.diag((OFF * self.sigma(theta)[mine]) ** 2)
            values = self.problem.values[mine]
            total += weight * np.exp(log_density(values, mean, wide) - log_density(values, mean, covariance))
        return float(0.01 / 0.99 * total)


def log_density(values: Array, mean: Array, covariance: Array) -> float:
    """Return log N(values; mean, covariance), less a constant."""
    apart = values - mean
    return float(-0.5 * apart @ np.linalg.inv(covariance) @ apart - 0.5 * np.linalg.slogdet(covariance)[1])


def mixture(parts: list[Normal], weights: NDArray[np.float64]) -> Normal:
    """Return mean and covariance of a mixture of normals."""
    mean = np.sum([w * m for w, (m, _) in zip(weights, parts, strict=True)], axis=0)
    spread = [w * (c + np.outer(m - mean, m - mean)) for w, (m, c) in zip(weights, parts, strict=True)]
    return mean, np.sum(spread, axis=0)


def degrees_of(parts: list[Normal], weights: NDArray[np.float64], volume: Array) -> float:
    """Return the degrees of freedom of a mixture of normals.  volume : G (k, k)"""
    mean = mixture(parts, weights)[0]
    squares = np.array([np.trace(volume @ (c + np.outer(m - mean, m - mean))) for m, c in parts])
    middle = np.sum(weights * squares)
    return float(4 + 2 * middle**2 / np.sum(weights * (squares - middle) ** 2))
