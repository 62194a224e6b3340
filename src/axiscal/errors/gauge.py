"""What no allowed reading can see: the combinations of errors that stay unknown however long one measures.

They are found as the posterior after a million readings spread over everything that is allowed, in the prior's own
metric, and come in two kinds. Some do not move the tool point at all, or only with the workpiece zero: they are a
matter of how the errors are defined. The others do move it, and need a reading that the campaign does not have.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.errors import gauge_words
from axiscal.errors.gauge_words import Aspect, Hidden
from axiscal.errors.model import ErrorFunction, ErrorModel, Term
from axiscal.errors.plane import PlaneError
from axiscal.errors.volume import VolumeMoments, volume_moments, whole_travel
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.numerics.cubic import NaturalSpline, quadrature
from axiscal.numerics.from_scipy import solution, triangle_over

__all__ = ["Hidden", "hidden", "machine_check", "unseen_factor"]

MANY_READINGS = 1e6
_POSES = 1500
"""Poses drawn to see what none shows: some times the unknowns of the largest machine."""
_NOISE = 1e-6
"""m; a million readings of any instrument leave what none shows."""
_IDLE = 1e-3
"""Of the prior's effect on the tool: a combination that does less does nothing."""
_COUNTS = 0.02
"""Of the largest effect: an error that is less a part of it is not named."""
_CURVE = 0.3
"""Share of an error's curve that has to be hidden before it is named as a whole."""
_SHARE = 0.02
"""Share of an offset or a slope that has to be hidden before it is named."""


def unseen_factor(factor: Array, rows: Array, causes: Array | None = None) -> Array:
    """Return F (n, r) with F Fᵀ the covariance that a million readings would leave.

    factor : (n, q) with the prior covariance = factor factorᵀ
    rows : (m, n) allowed readings, spread evenly, each divided by its noise
    causes : (m, c) what one standard deviation of other unknowns does to them
    F = factor R⁻¹ with RᵀR = 1 + seenᵀ seen, of what a million readings show in the prior's metric. Its first q columns
    are F without causes.
    """
    if not len(rows):
        return factor
    shown = rows @ factor if causes is None else np.hstack([rows @ factor, causes])
    right = np.zeros((shown.shape[1], len(factor)))
    right[: factor.shape[1]] = factor.T
    triangle = triangle_over(np.ones(len(right)), shown * np.sqrt(MANY_READINGS / len(rows)))
    result: Array = solution(triangle.T, right).T
    return result


def machine_check(machine: Machine) -> tuple[str, ...]:
    """Return what no reading of the tool point shows: along x, y and z, at any pose, from both directions."""
    model = ErrorModel(machine)
    if not model.size:
        return ()
    rng = np.random.default_rng(0)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses = rng.uniform(low, high, (_POSES, len(low)))
    rows = model.rows(poses, rng.choice([-1.0, 1.0], poses.shape)).reshape(-1, model.size)
    unseen = unseen_factor(model.prior_root(), rows / _NOISE)
    return tuple(one.text for one in hidden(model, unseen))


def hidden(model: ErrorModel, unseen: Array, moments: VolumeMoments | None = None) -> tuple[Hidden, ...]:
    """Return what cannot be seen, in words: first what moves the tool point, the worst first, then what does not.

    unseen : (size, r) factor of the unseen covariance of the machine's own errors
    moments : over the volume in which the tool point counts; the whole travel without
    """
    moments = moments or volume_moments(model, whole_travel(model))
    beyond = moments.beyond_shift
    before = float(np.sum(beyond * model.prior_covariance()))
    acting, idle = _split(unseen, beyond, _IDLE**2 * before)
    effects = [_effect(term, acting, beyond) for term in model.terms]
    counted = [i for i, effect in enumerate(effects) if effect > _COUNTS * np.sqrt(before)]
    missing = [(_missing(model.terms[i], acting), effects[i]) for i in counted]
    aspects = [aspect for f in model.functions if not f.stated_shape for aspect in _aspects(f, idle)]
    return (*gauge_words.missing(model, missing), *gauge_words.conventions(model, aspects))


def _split(unseen: Array, beyond: Array, floor: float) -> tuple[Array, Array]:
    """Return the factors of what moves the tool point by more than `floor` (m²) and of what does not.

    beyond : (size, size) E[HᵀH] less the part that is one shift of the whole volume
    """
    effects, directions = np.linalg.eigh(unseen.T @ beyond @ unseen)
    turned = unseen @ directions
    return turned[:, effects > floor], turned[:, effects <= floor]


def _effect(function: Term, acting: Array, beyond: Array) -> float:
    """RMS over the volume of what one error's own unseen part does to the tool point, m."""
    own = acting[function.columns]
    return float(np.sqrt(max(np.sum(own * (beyond[function.columns, function.columns] @ own)), 0.0)))


def _missing(function: Term, acting: Array) -> Aspect:
    """Return the aspect of an error that is missed most: all of the curve, or only its slope or constant."""
    if isinstance(function, PlaneError) or function.stated_shape:
        return _of_a_whole(function, acting)
    return max(_candidates(function, acting), key=lambda a: (a.kind == "curve" and a.share > _CURVE, a.size))


def _of_a_whole(term: Term, unseen: Array) -> Aspect:
    """Return the aspect of a term of two axes, waves or steps: all of it; constant and slopes are in the curves."""
    prior = float(np.trace(term.covariance))
    own = unseen[term.columns]
    return Aspect(term, "curve", float(np.sum(own**2)) / prior, float(np.sqrt(prior / len(own))))


def _aspects(function: ErrorFunction, idle: Array) -> Iterator[Aspect]:
    """Yield the aspects of an error that stay open by more than a rounding of the prior."""
    for aspect in sorted(_candidates(function, idle), key=lambda a: a.kind != "curve"):
        if aspect.share > (_CURVE if aspect.kind == "curve" else _SHARE):
            yield aspect
        if aspect.wholly and aspect.kind == "curve":
            return


def _candidates(function: ErrorFunction, unseen: Array) -> Iterator[Aspect]:
    """Yield constant, slope and the rest of the curve, as far as the spline has them."""
    own = unseen[function.columns]
    rows = [("constant", _projection(function, 0))]
    if isinstance(function.basis, NaturalSpline):
        rows.append(("slope", _projection(function, 1)))
    for kind, row in rows:
        prior = float(row @ function.covariance @ row)
        yield Aspect(function, kind, float(np.sum((row @ own) ** 2)) / prior, np.sqrt(prior))
    if function.basis.size > len(rows):
        straight = np.array([row for _, row in rows])
        shape = np.eye(function.basis.size) - np.linalg.pinv(straight) @ straight
        prior = float(np.trace(shape @ function.covariance @ shape.T))
        share = float(np.sum((shape @ own) ** 2)) / prior
        yield Aspect(function, "curve", share, float(np.sqrt(prior / function.basis.size)))


def _projection(function: ErrorFunction, degree: int) -> Array:
    """The row (size,) that reads the mean, or half the mean rise over the travel, off the control values."""
    if function.basis.size == 1:
        return np.ones(1)
    points, weights = quadrature(function.basis)
    ends = (function.basis.knots[0], function.basis.knots[-1])
    legendre = np.polynomial.legendre.Legendre.basis(degree, domain=ends)(points)
    row: Array = (weights * legendre) @ function.basis.rows(points) / (weights @ legendre**2)
    return row
