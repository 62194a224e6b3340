"""Estimates where the prior is so wide that the first linearisation misleads: by damped steps to the mode.

The whitened unknowns are z in x = m₀ + F₀ z, with m₀, F₀ F₀ᵀ the prior. The mode minimises ½ zᵀz + ½ Σ (yᵢ −
fᵢ(x))²/σᵢ².

A station has possible places in closed form, and a mirror image. The square of n = |p − s| + z is linear in s, z and
|s|² − z². It reads −2 pᵀs + 2 n z + (|s|² − z²) = n² − |p|². Five points that are not in a plane settle it. Seen from
points in one plane, a station and its mirror image in that plane are alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.case import Case
from axiscal.machine.kinematics import frames
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen, places_of, seen, shown_values
from axiscal.measurement.setup import About
from axiscal.numerics import Array
from axiscal.numerics.gaussian import settled

_STEPS, _SETTLED = 80, 1e-7
"""Steps end where the whitened unknowns stay, RMS."""
_FIRST, _SOFTER, _HARDER, _HARDEST = 1e-3, 0.1, 10.0, 1e12
"""Damping, of the diagonal: any start does, for it is a tenth after each step and ten times as much until one helps."""


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


_SOUND = 1e-6
"""Share of the largest singular value below which points are as good as in a plane."""


def closed_form(case: Case, readings: Sequence[Reading], point: Array) -> Array:
    """Return a point (k,) with stations and dead paths of distances where they alone fit the readings best.

    Those of too few points, or of points in a plane, stay.
    """
    found = point.copy()
    for index, setup in enumerate(case.description.setups):
        seen_by = [reading for reading in readings if reading.setup == setup.name]
        if len(seen_by) < 6:
            continue
        own = dict(zip((u.name for u in setup.unknowns), case.observation.unknowns_of(index).tolist(), strict=True))
        tip = tips(case, seen_by)
        for number, (columns, stated) in enumerate(zip(case.station_columns(index), setup.standing, strict=False)):
            zero = own.get(f"zero_{number + 1}" if setup.stations else "zero")
            shown = np.array([reading.values[number] for reading in seen_by])
            solved = _one_station(tip - np.array(stated), shown, with_zero=zero is not None)
            if solved is not None:
                found[list(columns)] = solved[:3]
                found[[] if zero is None else [zero]] = solved[3]
    return found


def _one_station(places: Array, shown: Array, *, with_zero: bool) -> Array | None:
    """Return s, and z or something else after it, (4,); None of points in a plane.

    places : (m, 3) from where it is stated to stand; shown : (m,) distances less nominal ones, m
    """
    lengths = shown + np.linalg.norm(places, axis=1)
    table = np.column_stack([-2 * places, 2 * lengths, np.ones(len(lengths))])
    table = table if with_zero else np.delete(table, 3, axis=1)
    scale = np.linalg.norm(table, axis=0)
    if not scale.all() or np.linalg.svd(table / scale, compute_uv=False)[-1] < _SOUND:
        return None
    solved = np.linalg.lstsq(table / scale, lengths**2 - np.sum(places**2, axis=1), rcond=None)[0] / scale
    return np.asarray(solved[:4], dtype=float)


def mirrored(case: Case, readings: Sequence[Reading], point: Array, index: int) -> list[Array]:
    """Return points (k,), each with one station of a set-up behind the plane that its points are nearest to.

    In the order of its stations; none where it has too few points, or nothing to move.
    """
    setup, images = case.description.setups[index], []
    seen_by = [reading for reading in readings if reading.setup == setup.name]
    if len(seen_by) < 4:
        return []
    places = tips(case, seen_by)
    middle = places.mean(axis=0)
    _, sizes, turn = np.linalg.svd(places - middle)
    normal = settled(sizes**2, turn.T)[:, -1]
    for columns, stated in zip(case.station_columns(index), setup.standing, strict=False):
        station = np.array(stated) + point[list(columns)]
        image = station - 2 * float((station - middle) @ normal) * normal
        found = point.copy()
        found[list(columns)] = image - np.array(stated)
        images.append(found)
    return images


def tips(case: Case, readings: Sequence[Reading]) -> Array:
    """Return the nominal tool points of readings in the workpiece frame, (m, 3), m."""
    return frames(case.description.machine, np.array([reading.pose for reading in readings])).tcp
