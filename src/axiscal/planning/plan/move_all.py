"""All readings of a plan moved at once, off the lattice, to where together they leave least.

The whitened rows B of all numbers give J = |Φ|² − tr(Φ Bᵀ (I + B Bᵀ)⁻¹ B Φᵀ). Its gradient with respect to B is −2 (A
Bᵀ)ᵀ A, A = Φ (I + BᵀB)⁻¹. Differences give the change of B with the coordinates. Rests count as noise of each reading's
own here: where two of them would share a cell, the true J decides whether the move is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.candidates import arrivals_of, turned_to
from axiscal.measurement.charts.chart import Chart, has_room
from axiscal.measurement.place import Places
from axiscal.measurement.travel import sides_of
from axiscal.numerics import Array
from axiscal.numerics.from_scipy import lowest
from axiscal.planning.gains.covariance import Covariance

_STEP = 1e-6
"""Share of the travel: central differences of smooth rows lose below 1e-8 to bending or rounding, ten times off too."""
_ITERATIONS = 80
"""Iterations; where they are left early the plan is still no worse than before."""


class _Free(NamedTuple):
    """The coordinates that may change, each (f,).

    reading : whose; axis : which, of the machine or of its chart; low, high : of a reading of its set-up, m or rad
    charts : of each; None where it is an axis itself
    """

    reading: NDArray[np.intp]
    axis: NDArray[np.intp]
    low: Array
    high: Array
    charts: tuple[Chart | None, ...]

    def of(self, places: Places) -> Array:
        """Return them, (f,) m or rad."""
        coordinates: Array = places.poses[self.reading, np.minimum(self.axis, places.poses.shape[1] - 1)]
        for k, chart in enumerate(self.charts):
            if chart is not None:
                coordinates[k] = chart.places(places.poses[[self.reading[k]]])[0, self.axis[k]]
        return coordinates

    def put(self, places: Places, coordinates: Array) -> Places:
        """Return the places with other values of them, (f,) m or rad; where a chart gives no pose it stays."""
        poses = places.poses.copy()
        for k, chart in enumerate(self.charts):
            if chart is None:
                poses[self.reading[k], self.axis[k]] = coordinates[k]
                continue
            at = chart.places(poses[[self.reading[k]]])
            at[0, self.axis[k]] = coordinates[k]
            found = chart.poses(at)[0]
            poses[self.reading[k]] = found if np.all(np.isfinite(found)) else poses[self.reading[k]]
        return places.moved(poses)


def moved(state: Covariance, places: Places) -> Places:
    """Return the readings, of the same set-ups and from the same sides, where J is lower; the same where it is not.

    state : before the first.  Coordinates on a raster stay; what leaves what its chart can give goes back.
    """
    free = _free(state, places)
    if not len(free.reading) or not np.any(state.weighted):  # or the tool point moves by no error
        return places
    span = free.high - free.low

    def placed(shares: Array) -> Places:
        return free.put(places, free.low + shares * span)

    def value(shares: Array) -> tuple[float, Array]:
        return _value(state, placed(shares), free)

    start = (free.of(places) - free.low) / span
    ended = placed(np.clip(lowest(value, start, 0.0, 1.0, _ITERATIONS), 0.0, 1.0))
    ended = _that_can_be_taken(state, places, ended)
    return ended if state.after_readings(ended).value < state.after_readings(places).value else places


def _that_can_be_taken(state: Covariance, before: Places, after: Places) -> Places:
    """Return places on charts as they can be come to from their sides; those that cannot are as they were before."""
    poses, approaches = after.poses.copy(), after.approaches.copy()
    machine, setups = state.observation.machine, state.observation.setups
    for i, number in enumerate(after.setups.tolist()):
        chart = setups[number].chart
        if chart is None or np.array_equal(poses[i], before.poses[i]):
            continue
        come = turned_to(machine, setups[number], before.approaches[[i]])
        sides = sides_of(chart, chart.places(before.poses[[i]]), come)
        at = chart.places(poses[[i]])
        if has_room(chart, at, sides)[0]:
            approaches[i] = arrivals_of(machine, setups[number], chart, at, sides)[0]
        else:
            poses[i] = before.poses[i]
    return Places(after.setups, poses, approaches)


def _free(state: Covariance, places: Places) -> _Free:
    found = [each for i, number in enumerate(places.setups.tolist()) for each in _coordinates(state, i, number)]
    reading, axis, low, high = np.array([each[:4] for each in found]).reshape(-1, 4).T
    return _Free(reading.astype(np.intp), axis.astype(np.intp), low, high, tuple(each[4] for each in found))


def _coordinates(state: Covariance, reading: int, number: int) -> Iterator[tuple[int, int, float, float, Chart | None]]:
    """Yield the coordinates of a reading that are on no raster, with their ends, and the chart that they are of."""
    setup, axes = state.observation.setups[number], state.observation.machine.axes
    if setup.chart is None:
        for k in setup.moves:
            if setup.raster[k] == 0:
                yield reading, k, *setup.span(axes[k], k), None
        return
    for k in range(setup.chart.size):
        low, high, step, *_ = setup.chart.bounds(k)
        if step == 0:
            yield reading, k, low, high, setup.chart


def _value(state: Covariance, places: Places, free: _Free) -> tuple[float, Array]:
    """Return J over what there was before, and its gradient with respect to shares of the free coordinates."""
    target = state.weighted
    rows, owner = state.whitened(places)
    crossed = target @ rows.T
    information = np.eye(len(rows)) + rows @ rows.T
    left = target - np.linalg.solve(information, crossed.T).T @ rows
    total = float(np.sum(target**2))
    slope = -2 * (left @ rows.T).T @ left / total
    changes = _changes(state, places, free)
    gradient = np.array([np.sum(slope[owner == i] * change) for i, change in zip(free.reading, changes, strict=True)])
    return float(np.sum(left * target)) / total, gradient


def _changes(state: Covariance, places: Places, free: _Free) -> list[Array]:
    """Return the derivative of the rows of its reading with respect to the share of each free coordinate."""
    alone, count, span = places.within(free.reading), len(free.reading), free.high - free.low
    own = free._replace(reading=np.arange(count))
    further, nearer = (
        own.put(alone, np.clip(own.of(alone) + sign * _STEP * span, free.low, free.high)) for sign in (1, -1)
    )
    rows, owner = state.whitened(Places.joined([further, nearer]))
    first = np.searchsorted(owner, np.arange(2 * count + 1))
    ends = [rows[first[k] : first[k + 1]] for k in range(2 * count)]
    apart = (own.of(further) - own.of(nearer)) / span
    apart = np.where(apart > 0, apart, 1.0)  # where a chart gives no pose beside it, nothing changes
    return [(ends[i] - ends[count + i]) / apart[i] for i in range(count)]
