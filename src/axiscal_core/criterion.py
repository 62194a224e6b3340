"""What a plan makes small: J = tr(V C Vᵀ), or any function of the covariance C of all unknowns.

"volume"    the mean square of the deviation of the tool point over the travels, half from each side
"joint"     the sum of the interval variances of all splines (eq. 24-26, 34-36), angles times half the longest way
V           (w, size) of the unknowns in the order of `case.names`
function    of C (size, size); the smaller, the better
"O1"–"O5"   indices of observability (Sun and Hollerbach 2008), negative, so that the largest is the best: of the
            singular values σ of the Jacobian, its numbers in units of their noise, its unknowns in those of their prior
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple

import numpy as np

from axiscal_core.machine import Machine
from axiscal_core.points import even_points
from axiscal_core.refusals import Array, InputError, computed, finite, one_of
from axiscal_core.splines import gauss
from axiscal_core.units import si

Criterion = Literal["volume", "joint", "O1", "O2", "O3", "O4", "O5"] | Array | Callable[[Array], float]
"""What a plan makes small."""
_POSES = 3000  # of several axes: with four times as many the RMS of eight drawn cases changes by 0.1 %
_NODES = 8  # between knots of one axis: exact


class Goal(NamedTuple):
    """root : V (w, size), empty where a function says it; function : of C, None where V says it"""

    root: Array
    function: Callable[[Array], float] | None = None

    def value(self, known: Array) -> float:
        """Return J.  known : F (size, k) with F Fᵀ = C"""
        if self.function is not None:
            return si(computed("criterion", "result", self.function, known @ known.T), "criterion", "result")
        return float(np.sum((self.root @ known) ** 2))


def goal(criterion: Criterion, size: int, words: Mapping[str, Callable[[], Goal]], function: str) -> Goal:
    """Return what a criterion says.  size : of C (size, size); words : what each says, made when it is asked for"""
    if callable(criterion):
        return Goal(np.zeros((0, size)), criterion)
    if isinstance(criterion, str):
        return words[one_of(function, "criterion", criterion, [*words])]()
    root = finite(function, "criterion", criterion, (None, size))
    if not root.any():
        raise InputError(function, "criterion", "weighs nothing", "Give V that is not nought everywhere")
    return Goal(root)


INDICES: Mapping[str, Callable[[Array], float]] = {
    "O1": lambda s: np.exp(np.mean(np.log(s))),  # Borm and Menq 1991, without the root of how many poses there are
    "O2": lambda s: s[0] / s[-1],  # Driels and Pathre 1990
    "O3": lambda s: s[0],  # Nahvi, Hollerbach and Hayward 1994
    "O4": lambda s: s[0] ** 2 / s[-1],  # Nahvi and Hollerbach 1996
    "O5": lambda s: 1 / np.sum(1 / s),  # Sun and Hollerbach 2008
}
"""Indices of singular values, the least first."""
_SEEN = 1e-9  # of the largest σ²: what is seen less is seen by rounding


def observability(index: str, prior: Array, seen: Array) -> Goal:
    """Return the criterion of an index.

    With C₀ = F Fᵀ is F⁻¹ C F⁻ᵀ = (I + JᵀJ)⁻¹: the σ² are those of its inverse, less one, where anything is seen at all.
    prior : C₀ (size, size); seen : C after readings wherever they can be taken
    """
    std = np.sqrt(np.diagonal(prior))
    scale = np.where(std > 0, std, 1.0)
    values, vectors = np.linalg.eigh(prior / np.outer(scale, scale))
    kept = values > _SEEN
    back = (vectors[:, kept] / np.sqrt(values[kept])).T / scale

    def information(covariance: Array) -> Array:
        return np.linalg.inv(back @ covariance @ back.T) - np.eye(len(back))

    squares, ways = np.linalg.eigh(information(seen))
    ways = ways[:, squares > _SEEN * squares[-1]]

    def found(covariance: Array) -> float:
        s = np.sqrt(np.maximum(np.linalg.eigvalsh(ways.T @ information(covariance) @ ways), 1e-30))
        return -float(INDICES[index](s))

    return Goal(np.zeros((0, len(prior))), found)


def volume(machine: Machine, size: int, aligned: bool) -> Goal:
    """Return V with VᵀV the mean square over the travels; of an aligned case, of what no rigid motion explains."""
    n = machine.size
    poses, weights = _over(machine)
    total = np.zeros((n, n))
    reversals = bool(machine.reversing)
    for side in (1.0, -1.0) if reversals else (1.0,):
        rows = machine.rows_at(poses, np.full(poses.shape, side))
        rows = rows * np.sqrt(weights)[:, None, None] / (np.sqrt(2.0) if reversals else 1.0)
        flat = rows.reshape(-1, n)
        if aligned:
            flat = flat - _rigid(machine.frames(poses).tcp, weights, flat)
        total += flat.T @ flat
    return _rooted(total, size)


def _rigid(points: Array, weights: Array, deviations: Array) -> Array:
    """Return the part of deviations (3 m, n) that a rigid motion explains.  points : (m, 3); weights : (m,)"""
    away = points - weights @ points / weights.sum()
    spins = [np.cross(each, away) for each in np.eye(3)]
    shifts = [np.broadcast_to(each, points.shape) for each in np.eye(3)]
    motions = np.stack([*shifts, *spins], axis=2) * np.sqrt(weights)[:, None, None]
    flat = motions.reshape(-1, 6)
    return np.asarray(flat @ np.linalg.lstsq(flat, deviations, rcond=1e-10)[0])


def joint(machine: Machine, size: int) -> Goal:
    """Return V of the paper's own criterion: one Gram matrix for each spline (B&H eq. 24-26, of several axes 34-36).

    A rotation counts as the displacement it makes at the machine's own reach, half the diagonal of its linear travels.
    """
    travels, total = [axis.length for axis in machine.axes if not axis.rotary], np.zeros((machine.size, machine.size))
    reach = float(np.linalg.norm(travels)) / 2 if travels else 1.0
    for term in machine.terms:
        total[term.columns, term.columns] = (reach if term.angular else 1.0) ** 2 * term.gram()
    return _rooted(total, size)


def _rooted(weight: Array, size: int) -> Goal:
    """Return V with VᵀV = W over the machine's coefficients."""
    root = root_of_gram(weight)
    return Goal(np.hstack([root, np.zeros((len(root), size - len(weight)))]))


def root_of_gram(gram: Array) -> Array:
    """Return V (r, n) with VᵀV = W, for W of any rank r.  gram : W (n, n), symmetric"""
    values, vectors = np.linalg.eigh(gram)
    kept = values > 1e-15 * values[-1]
    return np.asarray((vectors[:, kept] * np.sqrt(values[kept])).T)


def _over(machine: Machine) -> tuple[Array, Array]:
    """Return poses all over the travels, (m, q), and their weights, (m,), whose sum is 1."""
    axes = machine.axes
    if len(axes) == 1:
        knots = [term.spline.knots for term in machine.curves if not term.error.repeats]
        nodes, weights = gauss(np.unique(np.concatenate([*knots, axes[0].travel])), _NODES)
        return nodes.reshape(-1, 1), weights.ravel() / weights.sum()
    low, high = np.array([axis.travel for axis in axes]).T
    return low + even_points(_POSES, len(axes)) * (high - low), np.full(_POSES, 1 / _POSES)
