"""Random problems of one joint, the package's answer to them, and how far it falls short of the certified one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.numerics import Array
from axiscal_core.roots import largest
from axiscal_core.splines import CyclicSpline, NaturalSpline
from tests.certify.one_joint import SLACK, GainPolynomials, Problem, certified_best_gain
from tests.generators.forms import gain_forms


@dataclass(frozen=True)
class Verdict:
    """deficit : proven bound on how far the gain at the position found lies below the best one, relative to it;
    misstated : the relative error of the gain that the step states; position : found; boxes : work of the certifier."""

    deficit: float
    misstated: float
    position: float
    boxes: int


def random_problem(rng: np.random.Generator) -> Problem:
    """Draw a joint: 2 to 40 knots, spacings to 1e4 : 1, prior condition to 1e12, noise 1e-6 to 1e2 of the prior."""
    cyclic = bool(rng.random() < 0.3)
    n = int(rng.integers(3 if cyclic else 2, 41))
    unevenness = rng.choice([0.0, 1.0, 4.0])
    knots = 10.0 ** rng.uniform(-3, 3) * (rng.normal() + np.cumsum(np.r_[0, 10 ** rng.uniform(-unevenness, 0, n - 1)]))
    size = n - 1 if cyclic else n
    factor = _random_factor(rng, size)
    scale = 10.0 ** rng.uniform(-6, 0)
    prior = scale * np.sqrt((factor**2).sum(axis=1).max())
    spline = CyclicSpline(knots) if cyclic else NaturalSpline(knots)
    return Problem(
        knots, cyclic, scale * factor, _random_root(rng, spline), float((prior * 10.0 ** rng.uniform(-6, 2)) ** 2)
    )


def best_position(problem: Problem) -> tuple[float, float]:
    """Return position and gain of the best reading, by the package's search along a line."""
    spline = CyclicSpline(problem.knots) if problem.cyclic else NaturalSpline(problem.knots)
    weighted = problem.root @ problem.factor

    def forms(places: Array) -> tuple[Array, Array]:
        return gain_forms(spline.rows(places), problem.factor, weighted, problem.variance)

    found = largest(forms, spline.knots, 7)
    assert found is not None
    return found


def judged(problem: Problem) -> Verdict:
    """Compare the package's step with the certified best gain."""
    position, stated = best_position(problem)
    polynomials = GainPolynomials(problem)
    reached = polynomials.gain_at(position)
    best = certified_best_gain(polynomials, hint=position)
    return Verdict(
        float(1 + SLACK - reached / best.lower), float(abs(stated - reached) / reached), position, best.boxes
    )


def _random_factor(rng: np.random.Generator, size: int) -> Array:
    """Return F of a prior: independent, of random directions, or what a few good readings have left of one."""
    std: Array = 10.0 ** rng.uniform(-float(rng.uniform(0, 6)), 0, size)
    kind = rng.integers(3)
    if kind == 0:
        return np.diag(std)
    if kind == 1:
        return np.linalg.qr(rng.normal(size=(size, size)))[0] * std
    rows = rng.normal(size=(int(rng.integers(1, size + 1)), size)) * std
    _, s, right = np.linalg.svd(rows)
    shrink = np.ones(size)
    shrink[: len(s)] = 1 / np.hypot(1, 10.0 ** rng.uniform(0, 6) * s / s[0])
    return std[:, None] * (right.T * shrink)


def _random_root(rng: np.random.Generator, spline: NaturalSpline | CyclicSpline) -> Array:
    """Return R of a weight W = Rᵀ R: the Gram matrix, the identity, or a random one."""
    kind = rng.integers(3)
    if kind == 0:
        value, vector = np.linalg.eigh(spline.gram())
        root: Array = np.sqrt(np.maximum(value, 0))[:, None] * vector.T
        return root
    if kind == 1:
        return np.eye(spline.size)
    wide = rng.normal(size=(int(rng.integers(1, spline.size + 1)), spline.size))
    return float(10.0 ** rng.uniform(-6, 6)) * wide
