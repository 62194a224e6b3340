"""Readings that are not linear in what is estimated: what they show exactly, and their rows anywhere.

The whitened unknowns are z in x = m₀ + F₀ z, with m₀, F₀ F₀ᵀ the prior. The mode minimises ½ zᵀz + ½ Σ (yᵢ −
fᵢ(x))²/σᵢ².
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.case import Case
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen, places_of, seen, shown_values
from axiscal.measurement.setup import About
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import transposed_solution

_STEPS, _SETTLED = 80, 1e-7
"""Steps end where the whitened unknowns stay, RMS."""
_FIRST, _SOFTER, _HARDER, _HARDEST = 1e-3, 0.1, 10.0, 1e12
"""Damping, of the diagonal: any start does, for it is a tenth after each step and ten times as much until one helps."""
_KAPPA = 0.5
"""Half of the noise of a share; what it costs is the number of shares, for the polish ends at the mode anyway."""
_HALVINGS, _MOST = 6, 60
"""A share whose index is above one at its second look is halved, at most so often; shares end after so many."""
_WHOLE = 1.0 - 1e-12
"""γ is one up to rounding."""


class BentReadings:
    """case : whose prior counts; readings : believed ones."""

    def __init__(self, case: Case, readings: Sequence[Reading]) -> None:
        self.case, self.readings = case, readings
        self.start = case.prior.mean
        self.root = case.prior.factor
        self.values = np.array([value for reading in readings for value in reading.values])
        self.variances = seen(case.observation, readings).variances

    def at(self, point: Array) -> Seen:
        """Return the readings linearised about a point (k,) of errors and unknowns."""
        return seen(self._about(point), self.readings)

    def rows(self, point: Array) -> Array:
        """Return the rows about a point, (m, k): they change with where a station or tracker is found alone."""
        return self._still if self.case.located(point) is None else self.at(point).rows

    @cached_property
    def _still(self) -> Array:
        return seen(self.case.observation, self.readings).rows

    def _about(self, point: Array) -> Observation:
        located = self.case.located(point) or self.case
        return replace(self.case.observation, setups=located.description.setups, about=About(point))

    def left(self, point: Array) -> Array:
        """Return what the readings leave at a point, over their noise, (m,)."""
        shown = shown_values(self.case.observation, self.readings, point)
        left: Array = (self.values - shown) / np.sqrt(self.variances)
        return left

    def whitened(self, point: Array) -> Array:
        """Return z of a point, (k,)."""
        return np.asarray(np.linalg.lstsq(self.root, point - self.start, rcond=None)[0], dtype=float)

    def second_order(self, point: Array, spread: Array) -> Array:
        """Return q = μ² + τ² of each number over its variance: what is left open there, to second order, (m,).

        spread : S (k, r) with S Sᵀ = C.  μ = ½ tr(B C), τ² = ½ tr((B C)²), B the Hessian of the instrument by its
        unknowns
        """
        result, observation = np.zeros(len(self.values)), self._about(point)
        for setup, mine in self._places.by_setup():
            columns = observation.unknowns_of(setup)
            open_ = spread[columns] @ spread[columns].T
            each = observation.curvatures(setup, self._places.poses[mine])
            for number in range(each.shape[1]):
                product = each[:, number] @ open_
                mean = np.trace(product, axis1=1, axis2=2) / 2
                wide = np.einsum("mij,mji->m", product, product) / 2
                result[self._first[mine] + number] = mean**2 + wide
        return result / self.variances

    @cached_property
    def _first(self) -> NDArray[np.intp]:
        each = np.array([len(reading.values) for reading in self.readings], dtype=np.intp)
        first: NDArray[np.intp] = np.cumsum(each) - each
        return first

    @cached_property
    def _places(self) -> Places:
        return places_of(self.case.observation.setups, self.readings)


class Optimum(NamedTuple):
    """point : (k,) errors and unknowns; cost : ½ zᵀz + ½ Σ(r/σ)² there"""

    point: Array
    cost: float


def polished(problem: BentReadings, start: Array) -> Optimum:
    """Return the optimum that a start leads to, by damped Gauss-Newton (Levenberg, Marquardt).  start : (k,)"""
    z = problem.whitened(start)
    point = problem.start + problem.root @ z
    left = problem.left(point)
    cost, damping = _cost(z, left), _FIRST
    for _ in range(_STEPS):
        slopes = (problem.rows(point) @ problem.root) / np.sqrt(problem.variances)[:, None]
        normal = np.eye(len(z)) + slopes.T @ slopes
        pull = slopes.T @ left - z
        while True:
            step = np.linalg.solve(normal + damping * np.diag(np.diagonal(normal)), pull)
            tried = problem.start + problem.root @ (z + step)
            left_there = problem.left(tried)
            there = _cost(z + step, left_there)
            if there <= cost or damping > _HARDEST:
                break
            damping *= _HARDER
        if not there <= cost:  # nor where it is not a number
            break
        z, point, left, cost, damping = z + step, tried, left_there, there, damping * _SOFTER
        if float(np.sqrt(np.mean(step**2))) < _SETTLED:
            break
    return Optimum(point, cost)


def _cost(z: Array, left: Array) -> float:
    return float(z @ z + left @ left) / 2


class Waypoint(NamedTuple):
    """gamma : the exponent after it; z, point : (k,) the mean, whitened and not; triangle : (k, k) R

    worst : the largest √(q_i)/σ_i that it leaves
    """

    gamma: float
    z: Array
    point: Array
    triangle: Array
    worst: float


def shares(problem: BentReadings) -> list[Waypoint]:
    """Return the way from the prior to all readings, the prior first (Hanebeck and Feiermann 2003).

    The likelihood comes in shares, its exponent γ going from 0 to 1,

        Δ = min(1 − γ, κ²/max_i(q_i/σ_i²)),   the readings with variance σ²/Δ, about the mean, again about the new

    q_i the second order of a reading under the belief. The bound κ compares it with the noise of the share, so every
    share is nearly linear. Shares grow by themselves as the belief sharpens. The belief is held in whitened unknowns as
    R with RᵀR its information: a share is one QR of [R; √Δ A] (Bierman 1977, ch. V).
    """
    size = problem.root.shape[1]
    way = [_after(problem, 0.0, np.zeros(size), np.eye(size))]
    while way[-1].gamma < 1.0 and len(way) < _MOST:
        here = way[-1]
        step = min(1.0 - here.gamma, _KAPPA**2 / max(here.worst**2, 1e-300))
        for _ in range(_HALVINGS):
            once, _ = _taken(problem, here, here.point, step)
            z, triangle = _taken(problem, here, problem.start + problem.root @ once, step)
            after = _after(problem, here.gamma + step, z, triangle)
            if after.worst * np.sqrt(step) <= 1.0:
                break
            step /= 2
        way.append(after)
    return way


def _after(problem: BentReadings, gamma: float, z: Array, triangle: Array) -> Waypoint:
    point = problem.start + problem.root @ z
    spread = transposed_solution(triangle, problem.root.T).T
    index = float(np.sqrt(np.max(problem.second_order(point, spread), initial=0.0)))
    return Waypoint(1.0 if gamma > _WHOLE else gamma, z, point, triangle, index)


def _taken(problem: BentReadings, here: Waypoint, about: Array, step: float) -> tuple[Array, Array]:
    """Return z and R after a share of the readings, linearised about a point.  step : Δ"""
    numbers, size = problem.at(about), len(here.z)
    weights = np.sqrt(step / numbers.variances)
    slopes = weights[:, None] * (numbers.rows @ problem.root)
    left = weights * (numbers.values - numbers.rows @ here.point)
    stacked = np.zeros((size + len(left), size + 1))
    stacked[:size, :size], stacked[size:, :size], stacked[size:, size] = here.triangle, slopes, left
    done = np.asarray(np.linalg.qr(stacked, mode="r"))[:size]
    return here.z + np.linalg.solve(done[:, :size], done[:, size]), done[:, :size]
