"""The rows of a set-up on a chart as sums of levers times splines: what they are over a box of its coordinates.

A row along a matrix is w(u) = Σ_f L_f(u) S_f(t_f(u)), f over errors and unknowns: L_f, t_f are waves of the chart's
coordinates, S_f a cubic spline of one axis (see `numerics.waves`). So w and its first and second derivatives are known
at a place. Over a box u + h about it, with D the derivative along h,

    |D³(L S)| ≤ |D³L||S| + 3|D²L||S'||Dt| + 3|DL|(|S''||Dt|² + |S'||D²t|)
                + |L|(|S'''||Dt|³ + 3|S''||Dt||D²t| + |S'||D³t|)

where each factor is at most its value in the middle and what the next derivative makes of it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.observation import Observation, directions_of
from axiscal.numerics import Array
from axiscal.numerics.cubic import Constant, CyclicSpline, Spline
from axiscal.numerics.waves import Span, Waves

Poses = Callable[[Array], Array]
"""(m, coordinates) places -> (m, q) poses."""


class Boxes(NamedTuple):
    """middles, halves : (m, coordinates)."""

    middles: Array
    halves: Array

    def some(self, which: NDArray[np.intp] | NDArray[np.bool_]) -> Boxes:
        """Return some of them."""
        return Boxes(self.middles[which], self.halves[which])


class RowSizes(NamedTuple):
    """How large |f|, |Df|, |D²f|, |D³f| are at most over boxes, (functions, m) or (m,) each."""

    value: Array
    first: Array
    second: Array
    third: Array

    def of(self, which: int | slice) -> RowSizes:
        """Return those of some functions."""
        return RowSizes(*(each[which] for each in self))


class TravellingWaves:
    """Several functions of the coordinates: what goes on with every turn, and waves."""

    def __init__(self, onward: Array, waves: Waves) -> None:
        self._onward, self._waves = onward, waves
        self._every = range(len(waves.spans))

    @classmethod
    def of(cls, function: Poses, spans: Sequence[Span]) -> TravellingWaves:
        """Return them from their samples.  function : (m, coordinates) -> (m, functions)"""
        low = np.array([[span.low for span in spans]])
        turned = low + 2 * np.pi * np.diag([float(span.around) for span in spans])
        onward = ((function(turned) - function(low)) / (2 * np.pi)).T
        return cls(onward, Waves.of(lambda places: function(places).T - onward @ places.T, spans))

    def at(self, places: Array, *along: int) -> Array:
        """Return the values, or the derivatives along some coordinates, at places (m, coordinates), (functions, m)."""
        values = self._waves.at(places, *along)
        if not along:
            return values + self._onward @ places.T
        return values + self._onward[:, along[0], None] if len(along) == 1 else values

    def sizes(self, boxes: Boxes) -> RowSizes:
        """Return how large they and their derivatives along the way from the middle can be over boxes."""
        halves = boxes.halves.T
        third, second = np.zeros((2, len(self._onward), len(boxes.middles)))
        for along in product(self._every, repeat=3):
            third += np.outer(self._most[along], np.prod(halves[list(along)], axis=0))
        for along in product(self._every, repeat=2):
            second += np.outer(self._most[along], np.prod(halves[list(along)], axis=0))
        first = second + sum(np.abs(self.at(boxes.middles, i)) * halves[i] for i in self._every)
        return RowSizes(np.abs(self.at(boxes.middles)) + first, first, second, third)

    @cached_property
    def _most(self) -> dict[tuple[int, ...], Array]:
        return {along: self._waves.most(*along) for n in (2, 3) for along in product(self._every, repeat=n)}


@dataclass(frozen=True, eq=False)
class _Lever:
    """One error or unknown.  reach : (size, w) of its columns; reversal : whether it counts by the side of its axis"""

    axis: int
    basis: Spline
    columns: slice
    reach: Array
    reversal: bool

    def sizes(self, rows: Sequence[Array], t: Array, off: Array) -> RowSizes:
        """Return how large |S|, |S'|, |S''|, |S'''| are within t ± off.  rows : of orders 0 to 2 at t, (m, size)"""
        third = self._bend(t - off, t + off)
        each = [np.sqrt(np.maximum(np.einsum("mi,ij,mj->m", row, self._gram, row), 0.0)) for row in rows]
        second = each[2] + third * off
        first = each[1] + second * off
        return RowSizes(each[0] + first * off, first, second, third)

    def _bend(self, low: Array, high: Array) -> Array:
        """Return the largest |S'''| from low to high: it is constant between knots, and nothing beyond the last."""
        knots = self.basis.knots
        cyclic = isinstance(self.basis, CyclicSpline)
        if cyclic:
            moved = np.floor((low - knots[0]) / (knots[-1] - knots[0])) * (knots[-1] - knots[0])
            low, high = low - moved, high - moved
        first = np.clip(np.searchsorted(knots, low, side="left") - 1, 0, len(knots) - 2)
        last = np.clip(np.searchsorted(knots, high, side="right") - 1, 0, len(knots) - 2)
        bend: Array = np.where(cyclic & (high >= knots[-1]), self._within[0, -1], self._within[first, last])
        return bend

    @cached_property
    def _gram(self) -> Array:
        gram: Array = self.reach @ self.reach.T
        return gram

    @cached_property
    def _within(self) -> Array:
        """The largest |S'''| from interval to interval, (n - 1, n - 1)."""
        knots = self.basis.knots
        rows = self.basis.rows((knots[:-1] + knots[1:]) / 2, 3)
        sizes, every = np.linalg.norm(rows @ self.reach, axis=1), range(len(knots) - 1)
        return np.array([[sizes[i : max(i, j) + 1].max() for j in every] for i in every])


class ChartRows:
    """The rows of a set-up along a matrix (n, w) on a chart, or on the part of one with some coordinates held.

    poses : the chart's, over the coordinates that are free; spans : of these
    """

    def __init__(self, observation: Observation, setup: int, poses: Poses, spans: Sequence[Span], reach: Array) -> None:
        self._parts = _parts(observation, setup, reach)
        self._reach, self._every = reach, range(len(spans))
        self._numbers = len(directions_of(observation.setups[setup]))
        self._levers = TravellingWaves.of(lambda places: _levers(observation, setup, poses(places)), spans)
        self._axes = TravellingWaves.of(poses, spans)

    def at(self, places: Array, signs: Array) -> Array:
        """Return w at places (m, coordinates), (m, k).  signs : (m, q) from where each axis comes, +1, −1, 0"""
        return self._seen(Boxes(places, np.zeros_like(places)), signs)[0][0]

    def longest(self, boxes: Boxes, signs: Array) -> Array:
        """Return how long |w| is at most over boxes, (m,)."""
        seen, third = self._seen(boxes, signs)
        halves, inner = boxes.halves, 1 + len(self._every)
        slopes = np.stack([seen[0], *(seen[1 + i] * halves[:, i, None] for i in self._every)], axis=1)
        products = slopes @ slopes.transpose(0, 2, 1)
        corners = np.array([(1.0, *each) for each in product((1.0, -1.0), repeat=len(self._every))])
        longest = np.sqrt(np.maximum(np.einsum("ci,mij,cj->mc", corners, products, corners).max(axis=1), 0.0))
        for (i, j), bend in zip(combinations_with_replacement(self._every, 2), seen[inner:], strict=True):
            times = 0.5 if i == j else 1.0
            longest += times * np.linalg.norm(bend, axis=1) * halves[:, i] * halves[:, j]
        whole: Array = longest + third / 6
        return whole

    def _seen(self, boxes: Boxes, signs: Array) -> tuple[list[Array], Array]:
        """Return w, its derivatives ∂ᵢw and ∂ᵢⱼw (i ≤ j) in the middle of boxes (m, k), and |D³w| at most (m,)."""
        middles, every = boxes.middles, self._every
        pairs = list(combinations_with_replacement(every, 2))
        orders: list[tuple[int, ...]] = [(), *((i,) for i in every), *pairs]
        shape = (len(self._parts), self._numbers, len(middles))
        levers = {order: self._levers.at(middles, *order).reshape(shape) for order in orders}
        axes = {order: self._axes.at(middles, *order) for order in orders}
        rows = np.zeros((len(orders), len(middles), self._numbers, len(self._reach)))
        third = np.zeros(len(middles))
        sizes, ways = self._levers.sizes(boxes), self._axes.sizes(boxes)
        for f, part in enumerate(self._parts):
            sign = 0.5 * signs[:, part.axis] if part.reversal else np.ones(len(middles))
            own = {order: (lever[f] * sign).T[:, :, None] for order, lever in levers.items()}
            way = {order: each[part.axis][:, None, None] for order, each in axes.items()}
            s0, s1, s2 = (part.basis.rows(axes[()][part.axis], order)[:, None] for order in range(3))
            rows[0, :, :, part.columns] += own[()] * s0
            for i in every:
                rows[1 + i, :, :, part.columns] += own[(i,)] * s0 + own[()] * way[(i,)] * s1
            for at, (i, j) in enumerate(pairs, 1 + len(every)):
                turned = own[(i,)] * way[(j,)] + own[(j,)] * way[(i,)] + own[()] * way[(i, j)]
                bent = own[()] * way[(i,)] * way[(j,)] * s2
                rows[at, :, :, part.columns] += own[(i, j)] * s0 + turned * s1 + bent
            mine = sizes.of(slice(f * self._numbers, (f + 1) * self._numbers))
            lever = RowSizes(*(np.linalg.norm(each, axis=0) * np.abs(sign) for each in mine))
            spline = part.sizes((s0[:, 0], s1[:, 0], s2[:, 0]), axes[()][part.axis], ways.first[part.axis])
            third += _third(lever, spline, ways.of(part.axis))
        seen = rows.reshape(-1, len(self._reach)) @ self._reach
        return list(seen.reshape(len(orders), len(middles), -1)), third


def _third(lever: RowSizes, s: RowSizes, t: RowSizes) -> Array:
    """Return |D³(L S(t))| at most, (m,)."""
    turning = lever.value * (s.third * t.first**3 + 3 * s.second * t.first * t.second + s.first * t.third)
    mixed = 3 * lever.second * s.first * t.first + 3 * lever.first * (s.second * t.first**2 + s.first * t.second)
    third: Array = lever.third * s.value + mixed + turning
    return third


def _parts(observation: Observation, setup: int, reach: Array) -> list[_Lever]:
    """Return what a row is made of, errors first.  reach : (n, w)"""
    parts = list[_Lever]()
    for function in observation.errors.functions:
        of = function.columns
        parts.append(_Lever(function.axis, function.basis, of, reach[of], function.kind == "reversal"))
    for column in observation.unknowns_of(setup).tolist():
        of = slice(column, column + 1)
        parts.append(_Lever(0, Constant(), of, reach[of], False))
    return parts


def _levers(observation: Observation, setup: int, poses: Array) -> Array:
    """Return what a unit of each part adds to each number, (m, parts · numbers)."""
    mounted = observation.setups[setup]
    model, nominal = model_of(mounted), Nominal(observation.machine, poses, mounted.moves)
    errors = observation.levers(setup, poses)[:, : len(observation.errors.functions)].transpose(1, 0, 2)
    ways = [np.array(mounted.direction) if way is None else way for way in directions_of(mounted)]
    own = [[model.unknown_effect(mounted, unknown.name, way, nominal) for way in ways] for unknown in mounted.unknowns]
    both = np.concatenate([errors, np.array(own).reshape(-1, len(ways), len(poses))])
    levers: Array = both.reshape(-1, len(poses)).T
    return levers
