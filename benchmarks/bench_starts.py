"""How far plans are from the best of 200 random starts, each improved by plain coordinate exchange.

Twelve cases of stacked splines are drawn: joints, knots, readings, noise and criterion. The exchange here is written
out plainly, with dense matrices, and knows nothing of axiscal's search: only rows and criterion are the same.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal_core.threads import one_thread
from benchmarks.cases import stacked
from benchmarks.peers.problems import TRAVEL, Stacked

STARTS, CASES = 200, 12
FINE, COARSE = 1000, 10
"""Positions along a joint: first every tenth of a thousand, then each."""
FINISHED = 20
"""So many of the best starts go on between all positions."""
SETTLED = 1e-5
"""Share of J that a sweep must gain to be followed by another."""

Indices = NDArray[np.intp]


def drawn() -> Iterator[tuple[Stacked, bool]]:
    """Yield the cases, and whether the criterion is `volume`."""
    rng = np.random.default_rng(1)
    for number in range(CASES):
        joints, knots, readings = int(rng.integers(2, 6)), int(rng.integers(7, 21)), int(rng.integers(13, 61))
        yield Stacked("", "", joints, knots, float(10 ** rng.uniform(-2, 0)), readings), number % 2 == 1


def random_starts(task: Task, readings: int, starts: int) -> Array:
    """Return J after coordinate exchange from each of so many random plans, the best first, (starts,).

    All move between every tenth position of a joint until they settle; the best go on between all positions.
    """
    exchange = _Exchange(task, _rows_along(task))
    rng = np.random.default_rng(0)
    places = COARSE * rng.integers(0, FINE // COARSE + 1, (starts, readings, len(exchange.rows)))
    values = exchange.settled(places, np.arange(0, FINE + 1, COARSE), around=False)
    order = np.argsort(values)
    best = places[order[:FINISHED]]
    values[order[:FINISHED]] = exchange.settled(best, np.arange(-COARSE, COARSE + 1), around=True)
    best_first: Array = np.sort(values)
    return best_first


def _rows_along(task: Task) -> Array:
    """Return what each joint makes of a row at each position, in its own columns, (q, positions, n / q)."""
    axes = len(task.observation.machine.axes)
    own, parts = task.observation.size // axes, []
    for axis in range(axes):
        poses = np.full((FINE + 1, axes), TRAVEL / 2)
        poses[:, axis] = np.linspace(0.0, TRAVEL, FINE + 1)
        rows = task.observation.numbers(Places.of_setup(0, poses, np.ones_like(poses))).rows
        parts.append(rows[:, axis * own : (axis + 1) * own])
    return np.stack(parts)


class _Exchange:
    """Coordinate exchange of many plans side by side.  rows : (q, positions, n / q)"""

    def __init__(self, task: Task, rows: Array) -> None:
        self.rows = rows
        self.prior, self.noise = np.linalg.inv(task.belief.covariance), task.observation.setups[0].noise ** 2
        self.weights = task.root.T @ task.root

    def settled(self, places: Indices, steps: Indices, around: bool) -> Array:
        """Exchange coordinates, in place, until a sweep gains less than 1e-5 of J; return J of each plan, (starts,).

        places : (starts, readings, q); steps : where to look, around : counted from where a reading is
        """
        going, values = np.arange(len(places)), np.full(len(places), np.inf)
        while len(going):
            part = places[going]
            c = self._covariances(part)
            d = c @ self.weights @ c
            for slot in range(places.shape[1]):
                self._improve(part[:, slot], c, d, steps, around)
            places[going] = part
            after = np.einsum("sij,ij->s", self._covariances(part), self.weights)
            gained, values[going] = values[going] - after, after
            going = going[gained > SETTLED * after]
        return values

    def _covariances(self, places: Indices) -> Array:
        """Return C of each plan, (starts, n, n)."""
        seen = self._seen(places)
        return np.asarray(np.linalg.inv(self.prior + np.swapaxes(seen, 1, 2) @ seen / self.noise), dtype=np.float64)

    def _seen(self, places: Indices) -> Array:
        """Return the rows of readings, (..., n).  places : (..., q)"""
        return np.concatenate([rows[places[..., axis]] for axis, rows in enumerate(self.rows)], axis=-1)

    def _improve(self, places: Indices, c: Array, d: Array, steps: Indices, around: bool) -> None:
        """Take one reading of each plan out, move it along each joint to where it gains most, and put it back."""
        self._change(c, d, self._seen(places), leaves=True)
        for axis, rows in enumerate(self.rows):
            size = rows.shape[1]
            own = slice(axis * size, (axis + 1) * size)
            others = self._seen(places)
            others[:, own] = 0.0
            at = np.clip(places[:, axis, None] * around + steps, 0, FINE)
            there = rows[at] if around else rows[steps]
            above, below = (_forms(matrix, others, there, own) for matrix in (d, c))
            best = (above / (self.noise + below)).argmax(axis=1)
            places[:, axis] = at[np.arange(len(at)), best]
        self._change(c, d, self._seen(places), leaves=False)

    def _change(self, c: Array, d: Array, row: Array, leaves: bool) -> None:
        """Bring C and C W C up to date, in place, for one reading of each plan.  row : (starts, n)"""
        sign = 1.0 if leaves else -1.0
        seen = (c @ row[..., None])[..., 0]
        u = seen / np.sqrt(self.noise - sign * np.sum(row * seen, axis=1))[:, None]
        weighed = u @ self.weights
        far = sign * (c @ weighed[..., None])[..., 0] + 0.5 * np.sum(weighed * u, axis=1)[:, None] * u
        d += np.stack([u, far], axis=2) @ np.stack([far, u], axis=1)
        c += sign * u[:, :, None] * u[:, None, :]


def _forms(matrix: Array, others: Array, there: Array, own: slice) -> Array:
    """Return gᵀ M g of rows g = others + there, (starts, positions).

    there : (positions, own) the same for all, or (starts, positions, own)
    """
    seen, block = (matrix @ others[..., None])[..., 0], matrix[:, own, own]
    if there.ndim == 2:
        products = (there[:, :, None] * there[:, None, :]).reshape(len(there), -1)
        square, linear = block.reshape(len(block), -1) @ products.T, seen[:, own] @ there.T
    else:
        square, linear = np.sum(there @ block * there, axis=2), (there @ seen[:, own, None])[..., 0]
    return np.asarray(np.sum(others * seen, axis=1)[:, None] + 2 * linear + square)


def main() -> None:
    """Print ours over the best of the random starts, and the plan's seconds of the processor."""
    print("| joints | knots | readings | noise | criterion | ours / best of 200 | s |")
    print("|---|---|---|---|---|---|---|")
    for case, volume in drawn():
        task = stacked(case, 4000, volume)
        start = time.process_time()
        value = make_plan(task, Limits(readings=case.readings)).value
        seconds = time.process_time() - start
        found = random_starts(task, case.readings, STARTS)
        name = f"{case.axes} | {case.knots} | {case.readings} | {case.noise:.3f} | {'volume' if volume else 'joint'}"
        print(f"| {name} | {value / found.min():.4f} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    with one_thread():
        main()
