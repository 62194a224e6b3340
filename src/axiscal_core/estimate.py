"""From readings to what is known: linear where the machine is, sizes averaged over, slips taken out.

A reading that the others contradict is a slip of a hand, a chip, a wrong line. The others expect it to be off by
N(0, S), S = ((K⁻¹)_ii)⁻¹ (Rasmussen and Williams 2006, eq. 5.12). One reading of a hundred is bad, and then off by
thirty noises. Sizes as stated are one draw more: a slip hides behind the noise that it teaches.
"""

from __future__ import annotations

import numpy as np

from axiscal_core.draws import Weighed, sized
from axiscal_core.known import Known
from axiscal_core.model import Model
from axiscal_core.places import Readings
from axiscal_core.problem import Factored, Given, Problem
from axiscal_core.refusals import Array, InputError
from axiscal_core.threads import one_thread

_ROUNDS = 20  # of Gauss and Newton: who needs more has described another set-up
_LINEAR = 0.01  # noises


@one_thread()
def estimated(case: Model, readings: Readings) -> Known:
    """Return what readings make known."""
    case.values(readings, "Case.estimate")
    if not len(readings):
        raise InputError("Case.estimate", "readings", "are none", "Give one or more")
    bad = list[int]()
    while True:
        kept = np.setdiff1d(np.arange(len(readings)), bad)
        mine = only(case, readings, kept)
        problem = Problem(case, mine, located(case, mine))
        draws = sized(problem)
        odds, z = doubted(problem, draws)
        worst = int(np.argmax(odds))
        if odds[worst] <= 0 or len(bad) + 1 > MOST * len(readings):
            break
        bad.append(int(kept[worst]))
    mean, covariance, moved = averaged(problem, draws)
    squares = np.sqrt(draws.weights @ np.exp(2 * draws.thetas))
    sizes = {
        f"{size.kind} {owner}": float(s)
        for size, s in zip(problem.sizes.of, squares, strict=True)
        for owner in size.owners
    }
    apart = dict(zip(kept.tolist(), z.tolist(), strict=True))
    return Known(case, mean, covariance, moved, np.sqrt(draws.weights), sizes, tuple(bad), apart)


def averaged(problem: Problem, draws: Weighed[Given]) -> tuple[Array, Array, Array]:
    """Return mean (size,), covariance (size, size) without type B, and (size, c, d) what type B moves in each draw."""
    each = [given.posterior() for given in draws.given]
    mean = draws.weights @ np.array([one.mean for one in each])
    covariance = np.zeros((len(mean),) * 2)
    for weight, one in zip(draws.weights, each, strict=True):
        covariance += weight * (one.covariance + np.outer(one.mean - mean, one.mean - mean))
    moved = [np.sqrt(w) * given.gain(problem.n.type_b) for w, given in zip(draws.weights, draws.given, strict=True)]
    return mean, covariance, np.stack(moved, axis=2)


def located(case: Model, readings: Readings) -> Array | None:
    """Return the unknowns at which readings are to be linear, (size,), by Gauss-Newton; None where nominal rows do.

    An instrument 300 mm from where it is said to stand has other rows.
    """
    about: Array | None = None
    for _ in range(_ROUNDS):
        problem = Problem(case, readings, about)
        mean = Given(problem, np.zeros(len(problem.sizes))).posterior().mean
        promised = problem.n.shown + problem.n.rows @ (mean if about is None else mean - about)
        there = case.numbers(readings, mean)
        if np.abs(there.shown - promised).max(initial=0.0) < _LINEAR * there.noise.min():
            return about
        about = mean
    raise InputError(
        "Case.estimate", "readings", "fit no machine near the one described", "Say better where instruments stand"
    )


def only(case: Model, readings: Readings, kept: Array) -> Readings:
    """Return some readings.  kept : (k,) which"""
    place = case.numbers(readings).place
    std, time = (None if each is None else each[kept] for each in (readings.std, readings.time))
    return Readings(readings.places.at(kept), readings.values[np.isin(place, kept)], std, time)


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
