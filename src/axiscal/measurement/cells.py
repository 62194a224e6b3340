"""Unknowns that readings open: the rests of cells, and how a zero wanders.

The rest of a cell is the part of an error that splines miss, one number per short cell, shared by its readings.

A zero wanders while machine and instrument warm up or cool down. It moves at a rate that is normal with standard
deviation r and forgets itself over a time T. Within minutes it is a straight line of unknown slope. Within hours it
levels off or turns, as the thermal drift of ISO 230-3. With x = Δ/T, φ = exp(−x), d the distance and v the rate (an
integrated Ornstein-Uhlenbeck process),

    d' = d + T (1 − φ) v + ε,   v' = φ v + η,
    var ε = r²T² (2x − 3 + 4φ − φ²),   cov(ε, η) = r²T (1 − φ)²,   var η = r² (1 − φ²)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from axiscal.numerics import Array

Cell = tuple[int, int]
"""Index of an error with a rest, and the number of the cell along its axis, or of the plane of its axes."""

MEMORY = 3600.0
"""T, s: the time constant of a machine tool's thermal drift is an hour or so."""
STEP = 300.0
"""Between nodes the zero goes straight, s: the drift bends by less than a fiftieth of what it does in an hour."""


@dataclass(frozen=True, eq=False, slots=True)
class Course:
    """The drift of one zero over the readings so far, as a linear map of independent unknowns of variance 1.

    rate : r, m/s or rad/s; columns : of the unknowns among all unknowns
    times : (k,) of the nodes, s; places, paces : (k, n) rows of distance (m or rad) and rate there
    """

    rate: float
    columns: tuple[int, ...]
    times: tuple[float, ...]
    places: Array
    paces: Array

    @classmethod
    def from_zero(cls, rate: float, time: float, column: int) -> Course:
        """Return the course at its first reading, where the zero stands at zero, with one unknown: its rate."""
        return cls(rate, (column,), (time,), np.zeros((1, 1)), np.array([[rate]]))

    @classmethod
    def over(cls, rate: float, times: Sequence[float]) -> Course:
        """Return the course over times, in order, s, with its own unknowns."""
        course = cls.from_zero(rate, times[0], 0)
        for time in times:
            if course.needs_node(time):
                course = course.with_node(time, len(course.columns))
        return course

    def rows(self, times: Array | None = None) -> Array:
        """Return the rows (m, n) of the distance at times (m,), s; at the last node where one is NaN.

        Without times that of the last node alone, (1, n).
        """
        nodes = np.array(self.times)
        when = nodes[-1:] if times is None else np.where(np.isnan(times), nodes[-1], times)
        node = np.maximum(np.searchsorted(nodes, when, side="right") - 1, 0)
        rows: Array = self.places[node] + (when - nodes[node])[:, None] * self.paces[node]
        return rows

    def needs_node(self, time: float) -> bool:
        """Return whether a time, s, lies too far beyond the last node for a straight line."""
        return time > self.times[-1] + STEP

    def with_node(self, time: float, column: int) -> Course:
        """Return the course with a node at a time and two more unknowns, whose first is `column`."""
        fresh = _roots((time - self.times[-1]) / MEMORY, self.rate)
        kept = float(np.exp(-(time - self.times[-1]) / MEMORY))
        place = np.append(self.places[-1] + MEMORY * (1 - kept) * self.paces[-1], fresh[0])
        pace = np.append(kept * self.paces[-1], fresh[1])
        older = [np.pad(rows, ((0, 0), (0, 2))) for rows in (self.places, self.paces)]
        places, paces = (np.vstack([rows, new]) for rows, new in zip(older, (place, pace), strict=True))
        columns = (*self.columns, column, column + 1)
        return replace(self, columns=columns, times=(*self.times, time), places=places, paces=paces)


def _roots(x: float, rate: float) -> Array:
    """Return the lower triangle L (2, 2) with L Lᵀ the covariance of ε and η."""
    kept = np.exp(-x)
    place = (rate * MEMORY) ** 2 * (2 * x - 3 + 4 * kept - kept**2)
    both, pace = rate**2 * MEMORY * (1 - kept) ** 2, rate**2 * (1 - kept**2)
    first = np.sqrt(place)
    return np.array([[first, 0.0], [both / first, np.sqrt(pace - (both / first) ** 2)]])


def wandered(rate: float, seconds: Array | float) -> Array:
    """Return the variances of a zero so long after its first reading, 2 r²T² (x − 1 + exp(−x)), m² or rad²."""
    after = np.abs(seconds) / MEMORY
    return np.asarray(2 * (rate * MEMORY) ** 2 * (after + np.expm1(-after)))
