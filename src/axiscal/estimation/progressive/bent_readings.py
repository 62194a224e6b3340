"""Readings that are not linear in what is estimated: what they show exactly, and their rows anywhere.

In the whitened unknowns z, x = m₀ + F₀ z with m₀, F₀ F₀ᵀ the prior, the mode is where ½ zᵀz + ½ Σ (yᵢ − fᵢ(x))²/σᵢ² is
smallest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.case import Case
from axiscal.measurement.about import About
from axiscal.measurement.observation import Observation
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.measurement.reading_rows import Seen, places_of, seen, shown_values
from axiscal.numerics import Array


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
