"""Cubic splines as linear maps of their control values: natural, cyclic, repeated, and the constant (B&H eq. 2-12).

>>> NaturalSpline(even_knots(0.0, 1.0, 5)).rows(0.5) @ [0, 0, 1, 0, 0]
array([1.])

Schoenberg's form gives the value inside an interval of length h. With A = (t_{i+1} - t)/h, B = (t - t_i)/h and s = S''
at the knots:  S = A a_i + B a_{i+1} - h²/6 A B ((1 + A) s_i + (1 + B) s_{i+1}).  Nothing in it cancels near a knot,
which the power form of B&H eq. 2 does not promise near t_{i+1}; s solves a diagonally dominant system.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from axiscal_core.refusals import Array, InputError, finite, within

_WHERE, _REMEDY = "Spline", "Give finite numbers that increase"
_MOST_KNOTS = 5000  # of memory: S'' has their square


class Spline(Protocol):
    """A function on a stretch of an axis that is linear in its control values: S(t) = m(t)ᵀ a (B&H eq. 18)."""

    @property
    def knots(self) -> Array:
        """Positions of the control points, both ends included, shape (n,), m or rad; read-only."""

    @property
    def size(self) -> int:
        """Number of control values."""

    @property
    def control_positions(self) -> Array:
        """Positions of the control values, (size,), m or rad."""

    def rows(self, t: ArrayLike, derivative: int = 0) -> Array:
        """Return m(t)ᵀ, or its derivative of order 0 to 3, for each position in `t`: (m, size)."""

    def gram(self) -> Array:
        """Return ∫ m mᵀ dt over the knots, (size, size)."""


class Integrated:
    """What has a Gram matrix by a quadrature that is exact."""

    __slots__ = ()

    def gram(self: Spline) -> Array:
        """Return ∫ m mᵀ dt over the knots (the integral in B&H eq. 25): (size, size), m or rad."""
        nodes, weights = gauss(self.knots, 5)  # exact for degree 9 per interval
        root = np.sqrt(weights).reshape(-1, 1) * self.rows(nodes.ravel())
        return root.T @ root


@dataclass(frozen=True, slots=True, eq=False)
class _Cubic(Integrated):
    _fewest: ClassVar[int]
    """Knots that there must be at least."""
    knots: Array
    second: Array = field(init=False, repr=False)
    """S'' at the knots from the control values, shape (n, size), 1/m² or 1/rad²."""

    def __post_init__(self) -> None:
        knots = _checked_knots(self.knots, self._fewest)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            second = self._second_derivatives(np.diff(knots))
        if not np.isfinite(second).all():
            raise InputError(_WHERE, "knots", "lie so close together, or so far apart, that it overflows", _REMEDY)
        second.setflags(write=False)
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "second", second)

    @property
    def size(self) -> int:
        """Number of control values."""
        return int(self.second.shape[1])

    @property
    def control_positions(self) -> Array:
        """Positions of the control values, (size,)."""
        return self.knots[: self.size]

    def rows(self, t: ArrayLike, derivative: int = 0) -> Array:
        """Return m(t)ᵀ of B&H eq. 18-19, the value of B&H eq. 2, or its derivative of order 0 to 3.

        At the left ends of the intervals the derivatives are b, 2 c, 6 d: M1, 2 M2, 6 M3 (B&H eq. 4-6, 8-11).
        With control values of covariance C theirs is M C Mᵀ (B&H eq. 17).
        t : (m,) or scalar, m or rad; at a knot the interval on its right counts
        returns : (m, size)
        raises InputError : a position is not finite, or the order is not 0 to 3
        """
        position = _checked_positions(t, derivative)
        inside = self._inside(position)
        i = np.searchsorted(self.knots[1:-1], inside, side="right")
        left, right = self.knots[i], self.knots[i + 1]
        h = right - left
        weights = _WEIGHTS[derivative](h, (right - inside) / h, (inside - left) / h)
        return self._continued(self._combined(i, weights), position - inside, derivative)

    def _combined(self, i: NDArray[np.intp], weights: tuple[Array, Array, Array, Array]) -> Array:
        """Return the rows that give a_i, a_{i+1}, s_i, s_{i+1} these weights: (m, size)."""
        rows = self.second.take(i, axis=0, mode="clip")  # unchecked copies: indices are within bounds
        rows *= weights[2][:, None]
        right = self.second.take(i + 1, axis=0, mode="clip")
        right *= weights[3][:, None]
        rows += right
        flat, first = rows.reshape(-1), np.arange(len(i)) * self.size
        flat[first + i] += weights[0]
        flat[first + (i + 1) % self.size] += weights[1]
        return rows

    def _second_derivatives(self, h: Array) -> Array:
        raise NotImplementedError

    def _inside(self, position: Array) -> Array:
        raise NotImplementedError

    def _continued(self, rows: Array, beyond: Array, derivative: int) -> Array:
        return rows


@dataclass(frozen=True, slots=True, eq=False)
class NaturalSpline(_Cubic):
    """Natural cubic spline, S'' = 0 at both ends (B&H eq. 3-6); a beam bent at its supports (B&H eq. 13-14).

    No curve through its points has less ∫ S''² dt (B&H eq. 12).
    knots : (n,) increasing, n >= 2; m or rad. Two knots make a straight line.
    Beyond its knots it goes on as the straight line that the unloaded beam would be.
    raises InputError : knots are too few, not finite, not increasing
    """

    _fewest: ClassVar[int] = 2

    def _second_derivatives(self, h: Array) -> Array:
        n = len(h) + 1
        second = np.zeros((n, n))
        if n > 2:
            i = np.arange(n - 2)
            system, load = np.zeros((n - 2, n)), np.zeros((n - 2, n))
            _fill(system, load, i, (i, i + 1, i + 2), h[:-1], h[1:])
            second[1:-1] = np.linalg.solve(system[:, 1:-1], load)
        return second

    def _inside(self, position: Array) -> Array:
        return np.clip(position, self.knots[0], self.knots[-1])

    def _continued(self, rows: Array, beyond: Array, derivative: int) -> Array:
        if not beyond.any():
            return rows
        outside = beyond != 0
        if derivative > 1:
            rows[outside] = 0.0
        elif derivative == 0:
            end = np.where(beyond[outside] > 0, self.knots[-1], self.knots[0])
            rows[outside] += beyond[outside, None] * self.rows(end, 1)
        return rows


@dataclass(frozen=True, slots=True, eq=False)
class CyclicSpline(_Cubic):
    """Cyclic cubic spline: value, slope and curvature agree where the ends meet (B&H eq. 7-10).

    knots : (n,) increasing, n >= 3, both ends of the turn included, so n - 1 control values; m or rad.
    Positions are taken modulo the turn; the last knot is the first one.
    raises InputError : knots are too few, not finite, not increasing
    """

    _fewest: ClassVar[int] = 3

    def _second_derivatives(self, h: Array) -> Array:
        size = len(h)
        i = np.arange(size)
        system, load = np.zeros((size, size)), np.zeros((size, size))
        _fill(system, load, i, ((i - 1) % size, i, (i + 1) % size), np.roll(h, 1), h)
        second = np.linalg.solve(system, load)
        return np.vstack([second, second[:1]])

    def _inside(self, position: Array) -> Array:
        start, stop = self.knots[0], self.knots[-1]
        turned = np.minimum(start + np.mod(position - start, stop - start), np.nextafter(stop, start))
        return np.where((position >= start) & (position < stop), position, turned)


@dataclass(frozen=True, slots=True, eq=False)
class Repeated(Integrated):
    """A cyclic cubic spline over one period, again and again: S(t) = S(t + period).

    start, stop : the stretch, m or rad; period : m or rad; size : control values in a period, 3 or more
    Eight of them follow a sine within 1.2 thousandths of it.
    """

    start: float
    stop: float
    period: float
    size: int
    _one: CyclicSpline = field(init=False, repr=False)

    def __post_init__(self) -> None:
        one = CyclicSpline(even_knots(self.start, self.start + self.period, self.size + 1))
        object.__setattr__(self, "_one", one)

    @property
    def knots(self) -> Array:
        """All breaks within the stretch, both ends included, (n,)."""
        step = self.period / self.size
        inside = self.start + step * np.arange(1, np.ceil((self.stop - self.start) / step - 1e-9))
        return np.concatenate([[self.start], inside, [self.stop]])

    @property
    def control_positions(self) -> Array:
        """Positions of the control values in the first period, (size,)."""
        return self._one.control_positions

    def rows(self, t: ArrayLike, derivative: int = 0) -> Array:
        """Return m(t)ᵀ, or its derivative of order 0 to 3: (m, size).  Raises InputError."""
        return self._one.rows(t, derivative)


@dataclass(frozen=True, slots=True, eq=False)
class Segments(Integrated):
    """Levels between joints, with a straight way of some width from one to the next: a scale made of pieces.

    Straight between breaks, with rows that sum to one: all that is exact for a spline is exact for them.

    start, stop : the stretch; joints : increasing, within it; width : of each way; all m or rad
    raises InputError : the stretch is not finite or not increasing
    """

    start: float
    stop: float
    joints: tuple[float, ...]
    width: float

    def __post_init__(self) -> None:
        _checked_knots([self.start, self.stop], 2)

    @property
    def size(self) -> int:
        """Number of levels."""
        return len(self.joints) + 1

    @property
    def knots(self) -> Array:
        """Both ends and where each way begins and ends, (2 + 2 joints,)."""
        ways = np.array(self.joints)[:, None] + self.width * np.array([-0.5, 0.5])
        return np.concatenate([[self.start], ways.ravel(), [self.stop]])

    @property
    def control_positions(self) -> Array:
        """The middle of each level, (size,)."""
        return (self.knots[::2] + self.knots[1::2]) / 2

    def rows(self, t: ArrayLike, derivative: int = 0) -> Array:
        """Return the share of each level at positions, or its derivative: (m, size)."""
        along = (_checked_positions(t, derivative)[:, None] - np.array(self.joints)) / self.width + 0.5
        passed = np.clip(along, 0.0, 1.0)
        if derivative:
            passed = np.where((along >= 0) & (along < 1) & (derivative == 1), 1.0 / self.width, 0.0)
        return np.asarray(-np.diff(passed, prepend=0.0 if derivative else 1.0, append=0.0))


@dataclass(frozen=True, slots=True, eq=False)
class Constant(Segments):
    """The spline of one control point: an offset or a location error, 1 everywhere.

    start, stop : the stretch over which `gram` integrates; m or rad
    raises InputError : the stretch is not finite or not increasing
    """

    start: float = 0.0
    stop: float = 1.0
    joints: tuple[float, ...] = ()
    width: float = 1.0

    @property
    def control_positions(self) -> Array:
        """The start of the stretch, (1,)."""
        return self.knots[:1]


def even_knots(start: float, stop: float, n: int) -> Array:
    """Return `n` evenly spaced knots from `start` to `stop`, (n,). Raises InputError."""
    return _checked_knots(np.linspace(start, stop, min(max(n, 0), _MOST_KNOTS + 1)), 2)


def spacing_limit(width: float, curvature: float) -> float:
    """Return the widest knot spacing of a spline that stays in a band: sqrt(6 width / curvature) (B&H eq. 15).

    width : of the band, m; curvature : the largest |S''|, 1/m
    An upper limit: a sine gets just under two points a wave.
    raises InputError : not finite and positive
    """
    for argument, value in (("width", width), ("curvature", curvature)):
        within("spacing_limit", argument, value, 0.0, open_end=True)
    return math.sqrt(6 * width / curvature)


def _values(h: Array, a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
    bend = -(h**2) / 6 * a * b
    return a, b, bend * (1 + a), bend * (1 + b)


def _slopes(h: Array, a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
    return -1 / h, 1 / h, h / 6 * (1 - 3 * a**2), h / 6 * (3 * b**2 - 1)


def _curvatures(h: Array, a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
    return np.zeros_like(h), np.zeros_like(h), a, b


def _cubics(h: Array, a: Array, b: Array) -> tuple[Array, Array, Array, Array]:
    return np.zeros_like(h), np.zeros_like(h), -1 / h, 1 / h


_WEIGHTS = (_values, _slopes, _curvatures, _cubics)  # weights of a_i, a_{i+1}, s_i, s_{i+1} in S, S', S'', S'''


def _fill(
    system: Array, load: Array, i: NDArray[np.intp], at: tuple[NDArray[np.intp], ...], before: Array, after: Array
) -> None:
    """Add the equations of continuous slope, each divided by the length of its two intervals (B&H eq. 5, 9)."""
    both = before + after
    for column, value in zip(at, (before / both, np.full_like(both, 2.0), after / both), strict=True):
        system[i, column] += value
    left, right = 6 / (before * both), 6 / (after * both)
    for column, value in zip(at, (left, -(left + right), right), strict=True):
        load[i, column] += value


def _checked_knots(knots: ArrayLike, fewest: int) -> Array:
    """Return the knots as a read-only copy. Raises InputError."""
    checked = finite(_WHERE, "knots", knots, (None,))
    if not fewest <= len(checked) <= _MOST_KNOTS:
        raise InputError(_WHERE, "knots", f"are {len(checked)}", f"Give {fewest} to {_MOST_KNOTS}")
    if not (checked[1:] > checked[:-1]).all():
        first = int(np.argmin(checked[1:] > checked[:-1]))
        what = f"go from {checked[first]:g} to {checked[first + 1]:g}"
        raise InputError(_WHERE, "knots", what, _REMEDY, first)
    checked.setflags(write=False)
    return checked


def _checked_positions(t: ArrayLike, derivative: int) -> Array:
    """Return the positions as a vector. Raises InputError."""
    position = finite(_WHERE, "t", [t] if np.isscalar(t) else t, (None,))
    if derivative not in (0, 1, 2, 3):
        raise InputError(_WHERE, "derivative", f"= {derivative!r} is none of a cubic", "Give 0 to 3")
    return position


def gauss(breaks: Array, count: int) -> tuple[Array, Array]:
    """Return nodes and weights, each (intervals, count), exact for degree 2 count − 1 between any two breaks.

    breaks : (intervals + 1,) ascending
    """
    node, weight = np.polynomial.legendre.leggauss(count)
    half = np.diff(breaks)[:, None] / 2
    return breaks[:-1, None] + half * (1 + node), half * weight


def ramp(spline: Spline) -> Array:
    """Return the control values of a strain of one about the middle of the travel, (size,) m."""
    low, high = spline.knots[[0, -1]]
    return np.asarray(spline.control_positions - (low + high) / 2)


def distances(spline: Spline) -> Array:
    """Return how far control values are apart, (n, n): of a cyclic spline the chord, which keeps kernels definite."""
    t = spline.control_positions
    apart: Array = np.abs(t[:, None] - t)
    if isinstance(spline, CyclicSpline):
        turn = spline.knots[-1] - spline.knots[0]
        apart = turn / np.pi * np.sin(np.pi * apart / turn)
    return apart


SMOOTH = 2.5
"""ν of a Matérn correlation where nothing is stated; 1.5 is the other one."""


def matern(distance: Array, smoothness: float = SMOOTH) -> Array:
    """Return the Matérn correlation of ν = 2.5 or 1.5 at distances r in correlation lengths.

    (1 + s + s²/3) exp(−s) or (1 + s) exp(−s), s = √(2 ν) r
    """
    s = np.sqrt(2 * smoothness) * distance
    return np.asarray((1 + s + (s**2 / 3 if smoothness == SMOOTH else 0.0)) * np.exp(-s))


def matern_by_length(distance: Array, smoothness: float = SMOOTH) -> Array:
    """Return its derivative by the logarithm of the correlation length, at the same distances."""
    s = np.sqrt(2 * smoothness) * distance
    return np.asarray((s**2 * (1 + s) / 3 if smoothness == SMOOTH else s**2) * np.exp(-s))
