"""Readings that the others contradict: a slip of a hand, a chip, a wrong line.

The others expect it to be off by N(0, S), S = ((K⁻¹)_ii)⁻¹ (Rasmussen and Williams 2006, eq. 5.12). One reading of a
hundred is bad, and then off by thirty noises. Sizes as stated are one draw more: a slip hides behind the noise that it
teaches.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.draws import Weighed
from axiscal_core.problem import Factored, Given, Problem
from axiscal_core.refusals import Array

_ODDS, _OFF = 0.01 / 0.99, 30.0
MOST = 0.2  # of the readings: where more are bad, none can say which


def doubted(problem: Problem, draws: Weighed[Given]) -> tuple[Array, Array]:
    """Return log odds that each reading is bad, (m,), and how far it is from what is expected, in noises, (m,)."""
    each = [*draws.given, draws.drawn.stated]
    ratios, z = (np.array(found) for found in zip(*(_judged(problem, given) for given in each), strict=True))
    logs = np.append(np.log(draws.weights), draws.log_stated)[:, None]
    odds = np.log(_ODDS) + np.logaddexp.reduce(ratios + logs) - np.logaddexp(0.0, draws.log_stated)
    return odds, draws.weights @ z[:-1]


def _judged(problem: Problem, given: Given) -> tuple[Array, Array]:
    """Return log ratios of bad over good, and distances, (m,) each, at one draw."""
    n, causes = problem.n, problem.n.type_b
    # two instruments may differ by their scales, which is no slip of either
    factor = Factored(given.factor.root, np.hstack([problem.open, causes]))
    inverse = factor.solved(np.eye(len(problem.values)))
    weighted = inverse @ problem.values
    count = len(problem.readings)
    noise, ratios, z = n.noise**2, np.zeros(count), np.zeros(count)
    grown = np.array([problem.sizes.index("noise", name) for name in problem.case.setups])[n.setup]
    noise = noise * np.exp(2 * np.append(given.theta, 0.0)[grown])
    for i in range(count):
        at = np.flatnonzero(n.place == i)
        expected = np.linalg.inv(inverse[np.ix_(at, at)])
        wide = expected + _OFF**2 * np.diag(noise[at])
        left = expected @ weighted[at]
        good, bad = left @ np.linalg.solve(expected, left), left @ np.linalg.solve(wide, left)
        ratios[i] = 0.5 * (good - bad + np.linalg.slogdet(expected)[1] - np.linalg.slogdet(wide)[1])
        z[i] = np.sqrt(good / len(at))
    return ratios, z
