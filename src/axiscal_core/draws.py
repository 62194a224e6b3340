"""The most probable sizes, and draws about them, weighed by the readings.

Fisher scoring climbs from the sizes as stated. A size stays as stated if readings say less of it than its prior and
do not contradict it. A size that a single number decides would grow with that number, and the uncertainty with it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal_core.points import even_points
from axiscal_core.problem import Given, Problem
from axiscal_core.refusals import Array

_COUNT = 64  # with 512 the RMS of six golden campaigns is 0.93 to 1.17 times as large
_EACH = 16  # one draw of so many is of the prior: the far tail has its own witness
_WIDE = 1.2  # a proposal that is too wide costs draws, one that is too narrow costs truth
_STEPS, _LONGEST, _SETTLED = 30, 1.5, 0.03  # scores, longest step in standard deviations, gain that is not worth one
_DAMPED, _MORE, _LESS = 1e-3, 20.0, 0.2  # Levenberg and Marquardt; any factor of a few does


class Draws(NamedTuple):
    """given : everything at each draw; weights : their probabilities, (d,)"""

    given: list[Given]
    weights: Array

    @property
    def thetas(self) -> Array:
        """θ of each, (d, k)."""
        return np.array([each.theta for each in self.given]).reshape(len(self.given), -1)


def drawn(problem: Problem, count: int = _COUNT) -> Draws:
    """Return draws of the sizes: a normal about the mode, one in sixteen of the prior."""
    from scipy.special import ndtri

    x, taught, covariance = mode(problem)
    if not len(taught):
        return Draws([Given(problem, problem.sizes.theta(x)[0])], np.ones(1))
    root = np.linalg.cholesky(covariance) * _WIDE
    z = ndtri(np.clip(even_points(count, len(taught)), 1e-9, 1 - 1e-9))
    of_prior = np.arange(count) % _EACH == _EACH // 2
    points = np.where(of_prior[:, None], z, x[taught] + z @ root.T)
    apart = np.linalg.solve(root, (points - x[taught]).T)
    share, own = 1 / _EACH, -0.5 * np.sum(apart**2, axis=0) - np.log(np.diagonal(root)).sum()
    log_proposal = np.logaddexp(np.log1p(-share) + own + 0.5 * np.sum(points**2, axis=1), np.log(share))
    every = np.tile(x, (count, 1))
    every[:, taught] = points
    given = [Given(problem, theta) for theta in problem.sizes.theta(every)[0]]
    logs = np.array([each.value for each in given]) - log_proposal
    weights = np.exp(logs - logs.max())
    # one draw in a far tail would decide alone (Ionides 2008)
    weights = np.minimum(weights, weights.mean() * np.sqrt(count))
    kept = np.flatnonzero(weights > 1e-6 * weights.sum())
    return Draws([given[i] for i in kept], weights[kept] / weights[kept].sum())


def mode(problem: Problem) -> tuple[Array, NDArray[np.intp], Array]:
    """Return x at the most probable sizes (k,), which of them are taught (t,), and their covariance (t, t)."""
    x, damped = problem.sizes.stated.copy(), _DAMPED
    if not len(x):
        return x, np.zeros(0, dtype=np.intp), np.zeros((0, 0))
    value, gradient, information = _pull(problem, x)
    told = np.diagonal(information)
    taught = np.flatnonzero((told > 2) | (0.5 * (gradient + x) ** 2 / told > 1))
    among = np.ix_(taught, taught)
    for _ in range(_STEPS if len(taught) else 0):
        step, scaled = np.zeros(len(x)), np.diag(np.diagonal(information)[taught])
        step[taught] = np.linalg.solve(information[among] + damped * scaled, gradient[taught])
        step *= _LONGEST / max(_LONGEST, float(np.abs(step).max()))
        if gradient @ step < _SETTLED:
            break
        there = x + step
        if Given(problem, problem.sizes.theta(there)[0]).value - 0.5 * there @ there > value:
            x, damped = there, damped * _LESS
            value, gradient, information = _pull(problem, x)
        else:
            damped = max(_MORE * damped, 0.05)
    return x, taught, np.asarray(np.linalg.inv(information[among]), dtype=np.float64)


def _pull(problem: Problem, x: Array) -> tuple[float, Array, Array]:
    """Return log p(y) φ(x), its gradient and its information."""
    theta, by = problem.sizes.theta(x)
    given = Given(problem, theta)
    gradient, information = given.slope()
    pulled = information * by[:, None] * by + np.eye(len(x))
    return given.value - 0.5 * float(x @ x), gradient * by - x, pulled
