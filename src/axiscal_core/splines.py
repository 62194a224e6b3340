"""Cubic splines as linear maps of their control values (B&H eq. 2-12).

>>> natural(0.0, 1.0, 5)(0.5) @ [0, 0, 1, 0, 0]
array([1.])
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from axiscal_core.refusals import Array


@dataclass(frozen=True, eq=False)
class Spline:
    """S(t) = m(t)ᵀ a.

    Between two knots, A = (t₁ - t)/h and B = (t - t₀)/h:   S = A a₀ + B a₁ - h²/6 A B ((1 + A) s₀ + (1 + B) s₁)

    knots : (k,); level : (k, n) maps control values to those at the knots; bend : (k, n) to S'' there
    cyclic : it goes on around the turn
    """

    knots: Array
    level: Array
    bend: Array
    cyclic: bool = False

    @property
    def size(self) -> int:
        """n, the number of control values."""
        return int(self.level.shape[1])

    @property
    def positions(self) -> Array:
        """The positions of the control values, (n,)."""
        return self.knots[: self.size]

    def __call__(self, t: ArrayLike) -> Array:
        """Return m(t)ᵀ of every t, (m, n).  Beyond its ends a spline that is not cyclic stays as it is there."""
        at = np.atleast_1d(np.asarray(t, dtype=np.float64))
        start, end = self.knots[[0, -1]]
        if self.cyclic:
            at = np.where((at >= start) & (at <= end), at, start + np.mod(at - start, end - start))
        at = np.clip(at, start, end)
        i = np.clip(np.searchsorted(self.knots, at, side="right") - 1, 0, len(self.knots) - 2)
        h = (self.knots[i + 1] - self.knots[i])[:, None]
        a, b = (self.knots[i + 1] - at)[:, None] / h, (at - self.knots[i])[:, None] / h
        bent = (1 + a) * self.bend[i] + (1 + b) * self.bend[i + 1]
        rows: Array = a * self.level[i] + b * self.level[i + 1] - h**2 / 6 * a * b * bent
        return rows

    def gram(self) -> Array:
        """Return ∫ m mᵀ dt, (n, n) (the integral of eq. 25): five nodes between knots are exact to degree nine."""
        t, weights = gauss(self.knots, 5)
        rows = self(t)
        result: Array = (rows.T * weights) @ rows
        return result


def natural(start: float, stop: float, knots: int) -> Spline:
    """Return a spline without curvature at its ends (eq. 3-6): a beam that is bent at its supports."""
    t = np.linspace(start, stop, knots)
    h, bend, i = np.diff(t), np.zeros((knots, knots)), np.arange(knots - 2)
    if knots > 2:
        system, load = np.zeros((2, knots - 2, knots))
        system[i, i], system[i, i + 1], system[i, i + 2] = h[:-1] / 6, (h[:-1] + h[1:]) / 3, h[1:] / 6
        load[i, i], load[i, i + 2] = 1 / h[:-1], 1 / h[1:]
        load[i, i + 1] = -load[i, i] - load[i, i + 2]
        bend[1:-1] = np.linalg.solve(system[:, 1:-1], load)
    return Spline(t, np.eye(knots), bend)


def cyclic(start: float, stop: float, knots: int) -> Spline:
    """Return a spline whose ends meet in value, slope and curvature (eq. 7-10); it has one control value less."""
    t, n = np.linspace(start, stop, knots), knots - 1
    after, i = np.diff(t), np.arange(n)
    before = np.roll(after, 1)
    system, load = np.zeros((2, n, n))
    for column, width in (((i - 1) % n, before), ((i + 1) % n, after)):
        np.add.at(system, (i, column), width / 6)  # of four knots both neighbours may be one
        np.add.at(load, (i, column), 1 / width)
    system[i, i] += (before + after) / 3
    load[i, i] -= 1 / before + 1 / after
    bend = np.asarray(np.linalg.solve(system, load), dtype=np.float64)
    return Spline(t, np.eye(n)[np.arange(knots) % n], bend[np.arange(knots) % n], cyclic=True)


def constant(start: float, stop: float) -> Spline:
    """Return a spline of one value everywhere: an offset, a location error, a reversal."""
    return Spline(np.array([start, stop]), np.ones((2, 1)), np.zeros((2, 1)))


def gauss(breaks: Array, count: int) -> tuple[Array, Array]:
    """Return nodes and weights of Gauss-Legendre between breaks.  breaks : (b,), ascending"""
    x, w = np.polynomial.legendre.leggauss(count)
    half = np.diff(breaks)[:, None] / 2
    return (breaks[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()


def distances(spline: Spline) -> Array:
    """Return how far control values are apart, (n, n): of a cyclic spline the chord, which keeps kernels definite."""
    t = spline.positions
    apart: Array = np.abs(t[:, None] - t)
    if spline.cyclic:
        turn = spline.knots[-1] - spline.knots[0]
        apart = turn / np.pi * np.sin(np.pi * apart / turn)
    return apart


def matern(distance: Array) -> Array:
    """Return the Matérn-5/2 correlation at distances in correlation lengths."""
    s = np.sqrt(5) * distance
    result: Array = (1 + s + s**2 / 3) * np.exp(-s)
    return result


def matern_by_length(distance: Array) -> Array:
    """Return its derivative by the logarithm of the length."""
    s = np.sqrt(5) * distance
    result: Array = s**2 * (1 + s) / 3 * np.exp(-s)
    return result


def even_points(count: int, dimensions: int) -> Array:
    """Return points that fill the unit cube evenly, (count, dimensions): an additive recurrence (Roberts 2018)."""
    root = 2.0
    for _ in range(64):  # the positive root of x^(d + 1) = x + 1
        root = (1 + root) ** (1 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    result: Array = (0.5 + np.outer(np.arange(1, count + 1), steps)) % 1
    return result
