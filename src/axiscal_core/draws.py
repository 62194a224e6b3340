"""The most probable sizes, and draws of those that readings leave possible.

A size stays as stated if the information of the places is below the prior's and the readings do not contradict it.
Otherwise a size that one number decides would make U larger with it. This is asked where the climb begins and again
where it ends: a zero's drift shows once the noise turns out to be a fifth of what is stated.

The prior of x is standard normal. Fisher scoring climbs to the mode: (J I J + 1) step = J g − x, J = dθ/dx. About the
mode q is a normal with two halves along each principal axis. Two likelihoods measure the width of each (as INLA does).
All 64 evenly spread points, four of them of the prior, carry the weights

    w ∝ L(θ) φ(x) / (15/16 q(x) + 1/16 φ(x)),    Σ w = 1,    effective number 1/Σ w²

none above √n times their mean (Ionides 2008): one draw in a far tail would decide alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from axiscal_core.eigen import settled
from axiscal_core.from_scipy import normal_quantile, normal_share
from axiscal_core.points import even_points
from axiscal_core.problem import Problem
from axiscal_core.refusals import Array
from axiscal_core.spaces import Given, Slope
from axiscal_core.theta import Sizes
from axiscal_core.unknowns import Space, space_of

COUNT = 64
"""With 64 the RMS was 0.69 to 1.17 of that of 512 draws, with 32 down to 0.66 (120 to 900 readings)."""
_EACH = 16  # one draw of so many is of the prior
_TAUGHT = 1.0  # of the prior's information; with 0.5 to 5 the attacked axis is covered alike
_SAID = 1.0  # gain of log L times prior by one size alone, from which on it is learnt: that of a parameter by Akaike
_STEPS = 30  # of Fisher scoring, which settles in about ten; more would not be a maximum either
_LONGEST = 1.5  # standard deviations of the prior in a step: the information is that of where the step begins
_SETTLED = 0.3  # gain of log L times prior that a further step promises: draws do not mind less
_DAMPED, _MORE, _LESS = 1e-3, 20.0, 0.2  # Levenberg and Marquardt; any small start, and any factor of a few, do
_TOLD = 0.3  # standard deviation from which on an axis is worth two likelihoods: of a smaller one the normal is enough
_NARROWEST, _WIDEST = 0.5, 2.0  # a wing is no wider or narrower than by so much: two likelihoods do not tell more
_WIDE = 1.2  # a proposal that is too wide costs draws, one that is too narrow costs truth
_EDGE = 1e-9  # a share of less has a quantile of six, and is rounding
_ENOUGH = 12.0  # draws that have to count where others are drawn about them
_ROUND = 0.01  # added to their covariance: twelve draws of ten sizes lie in a plane, nearly


@dataclass(frozen=True, eq=False)
class Mode:
    """x : (k,) most probable, as stated of sizes that stay so; taught : (t,) which do not

    covariance : (t, t) of the normal there; value : log L φ; stated : everything at the sizes as stated
    """

    x: Array
    taught: NDArray[np.intp]
    covariance: Array
    value: float
    stated: Given


@dataclass(frozen=True, eq=False)
class Draws:
    """x : (n, k); log_proposal : (n + 1,) of the mixture that they are drawn from, over φ(x), the last one as stated

    stated : everything at the sizes as stated
    """

    sizes: Sizes
    x: Array
    log_proposal: Array
    stated: Given

    @property
    def thetas(self) -> Array:
        """θ of each draw, (n, k)."""
        return self.sizes.theta(self.x)[0]


@dataclass(frozen=True, eq=False)
class Weighed:
    """Draws with their weights by some readings; those without any weight are left out.

    thetas : (n, k); weights : (n,), their sum is 1; given : of each; log_evidence : log p(y), up to a constant
    drawn : all draws; every : weights of all of them, those that are left out among them
    log_stated : log weight of the sizes as stated if they are one draw more, over that of all others
    """

    thetas: Array
    weights: Array
    given: tuple[Given, ...]
    log_evidence: float
    every: Array
    drawn: Draws
    log_stated: float

    @property
    def effective(self) -> float:
        """Effective number of draws."""
        return float(1 / np.sum(self.weights**2))


def _density(space: Space, x: Array) -> float:
    """Return log L(θ) φ(x) up to a constant."""
    found = space.given(space.sizes.theta(x)[0])
    return -np.inf if found is None else found.value - 0.5 * float(x @ x)


def as_stated(space: Space) -> Given:
    """Return everything at the sizes as stated."""
    found = space.given(np.zeros(len(space.sizes)))
    assert found is not None, "a covariance with noise is positive definite"
    return found


def mode(space: Space) -> Mode:
    """Return the most probable sizes, climbing from those that are stated."""
    sizes = space.sizes
    x, found, taught = sizes.stated, as_stated(space), np.zeros(0, dtype=np.intp)
    if not len(x):
        return Mode(x, taught, np.zeros((0, 0)), found.value, found)
    here = _pull(sizes, found, x)
    while len(more := np.union1d(taught, _taught(here, x))) > len(taught):
        taught = more
        x, here = _climbed(space, taught, x, here)
    among = np.ix_(taught, taught)
    return Mode(x, taught, np.asarray(np.linalg.inv(here.information[among]), dtype=float), here.value, found)


def _taught(here: Slope, x: Array) -> NDArray[np.intp]:
    """Return the sizes that readings teach.  here : at x, the prior included"""
    told = np.diagonal(here.information)
    return np.flatnonzero((told > 1 + _TAUGHT) | (0.5 * (here.gradient + x) ** 2 / told > _SAID))


def _climbed(space: Space, taught: NDArray[np.intp], x: Array, here: Slope) -> tuple[Array, Slope]:
    """Return where log L φ is highest by some sizes, and its slope there.  here : at x"""
    sizes, damped, among = space.sizes, _DAMPED, np.ix_(taught, taught)
    for _ in range(_STEPS):
        information = here.information[among]
        step = np.zeros(len(x))
        step[taught] = np.linalg.solve(information + damped * np.diag(np.diagonal(information)), here.gradient[taught])
        step *= _LONGEST / max(_LONGEST, float(np.max(np.abs(step))))
        if float(here.gradient @ step) < _SETTLED * 0.1:
            break
        there = space.given(sizes.theta(moved := x + step)[0])
        if there is not None and there.value - 0.5 * float(moved @ moved) > here.value:
            x, damped = moved, damped * _LESS
            here = _pull(sizes, there, x)
        else:
            damped = max(_MORE * damped, 0.05)
    return x, here


def _pull(sizes: Sizes, found: Given, x: Array) -> Slope:
    """Return log L φ, its gradient and its information by x.  found : at the sizes of x"""
    by, slope = sizes.theta(x)[1], found.slope()
    information = slope.information * by[:, None] * by + np.eye(len(x))
    return Slope(slope.value - 0.5 * float(x @ x), slope.gradient * by - x, information)


def draws(space: Space, best: Mode, count: int = COUNT) -> Draws:
    """Return draws about the mode."""
    k = len(best.taught)
    if k == 0:
        return Draws(space.sizes, best.x[None], np.zeros(2), best.stated)
    values, vectors = np.linalg.eigh(best.covariance)
    axes = settled(values, vectors)
    widths = np.sqrt(np.maximum(values, 0.0))
    wings = _WIDE * _wings(space, best, widths, axes)
    # one in so many is of the prior: the first ones would all lie on one side, of a single size
    of_prior = np.arange(count) % _EACH == _EACH // 2
    points = normal_quantile(np.clip(even_points(count, k), _EDGE, 1 - _EDGE))
    centre = best.x[best.taught]
    own = np.where(of_prior[:, None], points, centre + _halved(points, wings) @ axes.T)
    every = np.vstack([own, space.sizes.stated[best.taught]])
    apart = (every - centre) @ axes
    scaled = apart / np.where(apart > 0, wings[1], wings[0])
    proposal = -0.5 * np.sum(scaled**2, axis=1) - np.log(wings.mean(axis=0)).sum() + 0.5 * np.sum(every**2, axis=1)
    share = float(of_prior.mean())
    mixed = np.logaddexp(np.log1p(-share) + proposal, np.log(share))
    x = np.tile(best.x, (count, 1))
    x[:, best.taught] = own
    return Draws(space.sizes, x, mixed, best.stated)


def redrawn(space: Space, drawn: Draws, best: Mode, found: Weighed, count: int = 2 * COUNT) -> Draws:
    """Return more draws about those that carry weight, where few of the first ones did.  best : their mode

    Their mean and covariance are taken with weights raised to a power, such that enough of them count.
    """
    power, spread = 1.0, found.every
    while 1 / np.sum((spread / spread.sum()) ** 2) < _ENOUGH and power > _EDGE:
        power /= 2
        spread = found.every**power
    weights = spread / spread.sum()
    centre = weights @ drawn.x
    apart = (drawn.x - centre)[:, best.taught]
    covariance = (apart.T * weights) @ apart + _ROUND * np.eye(len(best.taught))
    about = replace(best, x=centre, covariance=covariance, value=_density(space, centre))
    return draws(space, about, count)


def _wings(space: Space, best: Mode, widths: Array, axes: Array) -> Array:
    """Return the widths below and above the mode along each principal axis, (2, k)."""
    wings = np.stack([widths, widths])
    for j in np.flatnonzero(widths > _TOLD).tolist():
        along = np.zeros(len(best.x))
        along[best.taught] = axes[:, j]
        for half, sign in enumerate((-1.0, 1.0)):
            drop = best.value - _density(space, best.x + sign * np.sqrt(2.0) * widths[j] * along)
            wings[half, j] *= float(np.clip(1 / np.sqrt(max(drop, _EDGE)), _NARROWEST, _WIDEST))
    return wings


def _halved(points: Array, wings: Array) -> Array:
    """Return standard normal points as ones whose halves have their own widths, (n, k)."""
    upper = wings[1] / wings.sum(axis=0)
    share = normal_share(points)
    above = share > 1 - upper
    high = normal_quantile(np.clip(0.5 + 0.5 * (share - 1 + upper) / upper, 0.0, 1 - _EDGE))
    low = normal_quantile(np.clip(0.5 * share / (1 - upper), _EDGE, 1.0))
    return np.asarray(np.where(above, high * wings[1], low * wings[0]))


_NOTHING = 1e-6  # weight of a draw that moves no digit that is printed


def weighed(space: Space, drawn: Draws) -> Weighed:
    """Return the draws with their weights by the readings of a space."""
    thetas = drawn.thetas
    given = [space.given(theta) for theta in thetas]
    logs = np.array([-np.inf if each is None else each.value for each in given]) - drawn.log_proposal[:-1]
    weights = np.exp(logs - logs.max())
    evidence = float(logs.max() + np.log(weights.mean()))
    weights = np.minimum(weights, weights.mean() * np.sqrt(len(weights)))
    weights /= weights.sum()
    kept = np.flatnonzero(weights > _NOTHING)
    found = tuple(each for each in (given[i] for i in kept) if each is not None)
    own = weights[kept] / weights[kept].sum()
    log_stated = drawn.stated.value - float(drawn.log_proposal[-1] + np.log(len(weights))) - evidence
    return Weighed(thetas[kept], own, found, evidence, weights, drawn, log_stated)


_RENEWED = 10.0  # effective number of draws below which they are drawn anew


def sized(problem: Problem, before: Draws | None = None) -> Weighed:
    """Return draws of the sizes of a problem, with their weights by its readings.

    before : draws for nearly the same readings, which are weighed anew while enough of them count
    """
    space = space_of(problem)
    if before is not None:
        again = weighed(space, replace(before, stated=as_stated(space)))
        if again.effective >= _RENEWED:
            return again
    best = mode(space)
    drawn = draws(space, best)
    found = weighed(space, drawn)
    return found if found.effective >= _RENEWED else weighed(space, redrawn(space, drawn, best, found))
