"""The bound for readings anywhere along one coordinate, by branch and bound over where each reading may be.

Readings are alike, so they come in the order of the coordinate. Each has weight one spread over its own interval of
cells, and the matrix Z of all weights together proves

    J ≥ |Φ|² − |Φ − Z|² − Σ_i max over the interval of reading i of |Z b|²

as in `certificate`, which also knows that few readings leave most directions. Within a cell |Z b(t)|² is a polynomial
of the coordinate, and its largest Bernstein coefficient is no less. The interval over which a reading's weight is
spread most is halved, the box with the lowest bound first.
"""

from __future__ import annotations

from collections.abc import Sequence
from heapq import heappop, heappush
from itertools import count as count_from
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.numerics.bernstein import bernstein
from axiscal.planning.bound.certificate import Dual
from axiscal.planning.gains.covariance import Covariance, informed
from axiscal.planning.step.ground import Region

_CELLS = 200
"""Cells of all readings, at least: what a polynomial's coefficients give away is then a ten-thousandth."""
_BOXES = 1500
"""Boxes that are looked at: of time, about ten seconds; any of them prove a bound."""
_FIRST, _EACH = 300, 25
"""Steps of the weights of the first box, and of each half of another."""
_STEP, _GONE = 0.9, 1e-12
"""Power of the step of weights, and what each keeps, so that it can come back."""
_CLOSE = 2e-4
"""Share of J by which better weights could raise a bound at most where they are left."""
_SPREAD = 0.075
"""Share of all cells over which a reading's first weight is spread, about where a good plan has it."""
_NOUGHT = 1e-300
"""No division by nought."""


class _Box(NamedTuple):
    """Plans whose i-th reading lies in the cells low_i to high_i, both (m,).  weights : (m, cells)"""

    low: NDArray[np.intp]
    high: NDArray[np.intp]
    weights: Array


class _Line:
    """Cells of all places that readings may be taken at, one after another.

    rows : B (cells, d + 1, k, r), whitened, at nodes of each cell; middle : of them (cells, k, r)
    """

    def __init__(self, state: Covariance, everywhere: Sequence[Region], numbers: int) -> None:
        self.state, self.numbers = state, numbers
        self.target, parts = state.weighted, list[Array]()
        degree = max(region.degree[0] for region in everywhere)
        values = max(len(region.rows(region.low[:1])[0]) for region in everywhere)
        nodes = (1 - np.cos(np.pi * np.arange(degree + 1) / max(degree, 1))) / 2
        total = sum(len(region.low) for region in everywhere)
        for region in everywhere:
            cut = (
                np.linspace(0, 1, max(1, -(-_CELLS // total)) + 1)
                if np.any(region.high > region.low)
                else np.arange(2.0)
            )
            low, span = region.low, region.high - region.low
            begins, each = low + span * cut[:-1], span * np.diff(cut)
            places = begins[..., None] + each[..., None] * nodes
            noise = region.ground.observation.setups[region.ground.setup].noise
            seen = region.rows(places.reshape(-1, 1)) @ state.factor / noise
            seen = seen.reshape(begins.size, degree + 1, -1, len(state.factor.T))
            parts.append(np.pad(seen, ((0, 0), (0, 0), (0, values - seen.shape[2]), (0, 0))))
        self.rows = np.concatenate(parts)
        self.middle = self.rows[:, degree // 2]
        self._turn = np.linalg.inv(bernstein(degree, nodes))

    def nearest(self, state: Covariance, places: Places) -> NDArray[np.intp]:
        """Return the cells whose middles show most nearly what readings do, ascending, (m,)."""
        found = []
        for index in range(len(places)):
            rows, _ = state.whitened(places.single(index))
            apart = self.middle[:, : len(rows)] - rows
            found.append(int(np.sum(apart**2, axis=(1, 2)).argmin()))
        return np.sort(np.array(found, dtype=np.intp))

    def bound(self, box: _Box, steps: int, enough: float) -> tuple[float, _Box]:
        """Return the best bound for the plans of a box, and the box with the weights that prove it."""
        every, best = np.arange(len(self.rows)), -np.inf
        inside = (every >= box.low[:, None]) & (every <= box.high[:, None])
        weights = np.where(inside, box.weights, 0.0)
        weights[weights.sum(axis=1) < _GONE] = 1.0
        weights = np.where(inside, weights, 0.0)
        weights /= weights.sum(axis=1, keepdims=True)
        flat, proof = self.middle.reshape(-1, self.middle.shape[2]), (-np.inf, self.target, np.inf)
        whole = float(np.sum(self.target**2))
        for _ in range(steps):
            share = np.sqrt(np.repeat(weights.sum(axis=0), self.middle.shape[1]))[:, None]
            factor = informed(np.eye(flat.shape[1]), share * flat)
            z = self.target @ factor @ factor.T
            squares = np.sum((self.rows @ z.T) ** 2, axis=(2, 3)) @ self._turn.T
            largest, at = squares.max(axis=1), np.sum((self.middle @ z.T) ** 2, axis=(1, 2))
            most = np.where(inside, largest, 0.0).max(axis=1)
            spent = float(most.sum())
            found = whole - float(np.sum((self.target - z) ** 2)) - spent
            best, proof = max(best, found), max(proof, (found, z, spent), key=itemgetter(0))
            mean = (weights * at).sum(axis=1)
            if best > enough or float((most - mean).sum()) < _CLOSE * enough:
                break
            weights = weights * (at / np.maximum(mean, _NOUGHT)[:, None]) ** _STEP + _GONE * inside
            weights /= weights.sum(axis=1, keepdims=True)
        if best <= enough:
            _, z, spent = proof
            best = max(best, Dual(self.state, z).floor(spent, self.numbers))
        return best, box._replace(weights=weights)


def by_boxes(state: Covariance, everywhere: Sequence[Region], places: Places, enough: float, numbers: int) -> float:
    """Return a bound for as many readings as a plan has, anywhere along one coordinate, at most what is enough.

    everywhere : where each set-up may be read, of one coordinate each; places : a good plan
    numbers : that all readings of a plan bring at most
    """
    line, count = _Line(state, everywhere, numbers), len(places)
    cells, order = len(line.rows), count_from()
    apart = (np.arange(cells) - line.nearest(state, places)[:, None]) / (_SPREAD * cells)
    begun = _Box(np.zeros(count, dtype=np.intp), np.full(count, cells - 1), np.exp(-(apart**2) / 2))
    value, begun = line.bound(begun, _FIRST, enough)
    heap, looked = [(value, next(order), begun)], 0
    while heap and heap[0][0] <= enough and looked < _BOXES:
        value, _, box = heappop(heap)
        halves = _halves(box)
        if not halves:  # one cell for each reading
            return value
        for half in halves:
            looked += 1
            found, half = line.bound(half, _EACH, enough)
            if (found := max(found, value)) <= enough:
                heappush(heap, (found, next(order), half))
    return min(heap[0][0], enough) if heap else enough


def _halves(box: _Box) -> list[_Box]:
    """Return both parts of a box in which some plan keeps its readings in order."""
    every = np.arange(box.weights.shape[1])
    mean = box.weights @ every
    spread = np.where(box.high > box.low, box.weights @ every**2 - mean**2, -np.inf)
    i = int(spread.argmax())
    if not np.isfinite(spread[i]):
        return []
    cut, found = int(np.clip(mean[i], box.low[i], box.high[i] - 1)), list[_Box]()
    for first, last in ((box.low[i], cut), (cut + 1, box.high[i])):
        low, high = box.low.copy(), box.high.copy()
        low[i], high[i] = first, last
        low[i:] = np.maximum.accumulate(low[i:])
        high[: i + 1] = np.minimum.accumulate(high[: i + 1][::-1])[::-1]
        if np.all(low <= high):
            found.append(_Box(low, high, box.weights))
    return found
