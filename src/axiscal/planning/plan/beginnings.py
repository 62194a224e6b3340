"""Where exchange begins: designs that need no thought, than which no plan may be worse, and the best of random ones.

Many random plans stand side by side, improved by coordinate exchange; then the best are drawn anew in part. A table
says what each position along an axis adds to a row g, where rows add up over the axes. Both forms of the gain gᵀCWCg /
(σ² + gᵀCg) come from it for all positions and all plans in one product. Rests count as noise of each reading's own
here; the caller compares the true J.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.candidates import snapped, spread
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.planning.plan.task import Patience, Task
from axiscal.planning.step.starts_stacked import Grid, StackedStarts, adds_up, stack_of
from axiscal_core.machine import Machine
from axiscal_core.ties import ALIKE, first_best, first_best_each, ranked

_SEED = 1
"""Any: a plan is the same every time."""
_STARTS, _KEPT, _FEWEST = 64, 4, 4
"""Random plans at most; one in so many of them goes on; fewer are not worth the search."""
_SWEEPS = 16
"""Sweeps that a start takes, roughly: as many starts as there is work for."""
_ROUNDS, _STALLED = 24, 8
"""How often the best are drawn anew in part, at most and without a better plan."""
_REDRAWN = 0.05
"""Share of the readings that are drawn anew, one at least: more lose what was found."""
_SETTLED = 1e-3
"""Share of J that a sweep must gain to be followed by another."""
_CALLS = 1e6
"""Operations that the calls into numpy for one reading are worth, however many plans there are."""
_LEFT = 1e-9
"""Share of a reading's noise: no division by nought where it alone holds an unknown."""

Points = NDArray[np.intp]
"""Indices of positions, (plans, readings, axes): on the grids of the set-up of each reading."""


def best_of_random(task: Task, counts: list[tuple[int, int]], work: float) -> Places | None:
    """Return the best plan found; None for no reading, where rows do not add up, or for so little work.

    counts : (set-up, readings) for each set-up; work : operations that the search may take
    """
    if not any(count for _, count in counts) or not all(_searched(task, setup) for setup, _ in counts):
        return None
    plans = _Plans(task, np.repeat(*np.array(counts).T), Patience(work))
    starts = int(min(_STARTS, work / (_SWEEPS * plans.work)))
    if starts < _FEWEST:
        return None
    points = plans.drawn(starts)
    values = plans.settled(points)
    best = ranked(-values, ALIKE, max(1, starts // _KEPT))
    return plans.places(_improved(plans, points[best], values[best]))


def _searched(task: Task, setup: int) -> bool:
    mounted = task.observation.setups[setup]
    return mounted.chart is None and len(mounted.names) == 1 and adds_up(task.observation.errors, mounted)


def _improved(plans: _Plans, points: Points, values: Array) -> Points:
    """Return the best plan, (readings, axes), after some readings of each were drawn anew while that helps."""
    stalled = 0
    for _ in range(_ROUNDS):
        if stalled >= _STALLED or plans.patience.spent:
            break
        others = plans.redrawn(points)
        after = plans.settled(others)
        better, lowest = after < values * (1 - ALIKE), values.min()
        points[better], values[better] = others[better], after[better]
        stalled = 0 if values.min() < lowest else stalled + 1
    best: Points = points[first_best(-values, ALIKE)]
    return best


class _Plans:
    """Plans side by side, with the same set-up in the same slot.  setups : (readings,) of each slot"""

    def __init__(self, task: Task, setups: NDArray[np.intp], patience: Patience) -> None:
        self._bare, self._setups, self.patience = task.observation.bare, setups, patience
        self._stacks = {setup: stack_of(self._bare, setup) for setup in np.unique(setups).tolist()}
        sizes = {s: [len(grid.positions) for grid in stack.grids] for s, stack in self._stacks.items()}
        axes = max(map(len, sizes.values()), default=0)
        self._sizes = np.array([sizes[s] + [1] * (axes - len(sizes[s])) for s in setups.tolist()]).reshape(-1, axes)
        self._factor = task.state.factor[: self._bare.size]
        root = np.pad(task.root.matrix, ((0, 0), (0, self._bare.size - task.root.unknowns)))
        self._weights, self._rng = root.T @ root, np.random.default_rng(_SEED)

    @cached_property
    def _squares(self) -> dict[int, list[Array]]:
        """Products of the entries of each row by set-up and grid: gigabytes, where splines have hundreds of knots."""
        return {setup: [_squares(grid) for grid in stack.grids] for setup, stack in self._stacks.items()}

    @property
    def work(self) -> float:
        """The operations of one sweep of one plan, roughly."""
        size = self._bare.size
        each = {
            s: sum(4.0 * len(g.columns) ** 2 * len(g.positions) + 4.0 * size**2 for g in stack.grids)
            for s, stack in self._stacks.items()
        }
        return sum(each[s] + 16.0 * size**2 for s in self._setups.tolist()) + 6.0 * size**3

    def drawn(self, count: int) -> Points:
        """Return random plans."""
        points: Points = (self._rng.random((count, *self._sizes.shape)) * self._sizes).astype(np.intp)
        return points

    def redrawn(self, points: Points) -> Points:
        """Return the plans with a few readings of each drawn anew."""
        count, readings, _ = points.shape
        order = self._rng.random((count, readings)).argsort(axis=1)
        anew = order < max(1, round(_REDRAWN * readings))
        return np.where(anew[:, :, None], self.drawn(count), points)

    def places(self, points: Points) -> Places:
        """Return the readings of one plan.  points : (readings, axes)"""
        parts = []
        for setup, stack in self._stacks.items():
            own = points[self._setups == setup]
            poses = np.tile(np.array(self._bare.setups[setup].park), (len(own), 1))
            approaches = np.zeros_like(poses)
            for grid, at in zip(stack.grids, own.T, strict=False):
                poses[:, grid.axis], approaches[:, grid.axis] = grid.positions[at], grid.signs[at]
            parts.append(Places.of_setup(setup, poses, approaches))
        return Places.joined(parts)

    def settled(self, points: Points) -> Array:
        """Exchange coordinates, in place, until a sweep gains little; return J of each plan, (plans,)."""
        going, values = np.arange(len(points)), np.full(len(points), np.inf)
        while True:
            c = self._covariances(points[going])
            now = np.einsum("pij,ij->p", c, self._weights)
            falling = values[going] - now > _SETTLED * now
            values[going] = now
            going, c = going[falling], c[falling]
            if not len(going) or self.patience.spent:
                return values
            points[going] = self._swept(points[going], c)
            self.patience.take(len(going) * self.work + len(self._setups) * _CALLS)

    def _swept(self, points: Points, c: Array) -> Points:
        """Return the plans after every coordinate of every reading was exchanged once.  c : C of each"""
        both = np.stack([c, c @ self._weights @ c])
        grids = {s: list(zip(stack.grids, self._squares[s], strict=True)) for s, stack in self._stacks.items()}
        for slot, setup in enumerate(self._setups.tolist()):
            stack, at = self._stacks[setup], points[:, slot]
            row, noise = _seen(stack, at)
            self._change(both, row, noise, leaves=True)
            for number, (grid, squares) in enumerate(grids[setup]):
                row[:, grid.columns] -= grid.rows[at[:, number]]
                noise -= grid.variances[at[:, number]]
                below, above = _forms(both, row, grid, squares)
                at[:, number] = first_best_each(above / (noise[:, None] + grid.variances + below), ALIKE)
                row[:, grid.columns] += grid.rows[at[:, number]]
                noise += grid.variances[at[:, number]]
            self._change(both, row, noise, leaves=False)
        return points

    def _covariances(self, points: Points) -> Array:
        """Return C of each plan, (plans, n, n)."""
        scaled = np.empty((*points.shape[:2], self._factor.shape[1]))
        for setup, stack in self._stacks.items():
            rows, noise = _seen(stack, points[:, self._setups == setup])
            scaled[:, self._setups == setup] = rows / np.sqrt(noise)[..., None] @ self._factor
        known = np.linalg.inv(np.eye(scaled.shape[2]) + scaled.swapaxes(1, 2) @ scaled)
        return self._factor @ known @ self._factor.T

    def _change(self, both: Array, row: Array, noise: Array, leaves: bool) -> None:
        """Bring C and C W C up to date, in place, for one reading of each plan.  row : (plans, n); noise : (plans,)"""
        c, d = both
        sign, seen = 1.0 if leaves else -1.0, (c @ row[..., None])[..., 0]
        left = np.maximum(noise - sign * np.sum(row * seen, axis=1), _LEFT * noise)
        u = seen / np.sqrt(left)[:, None]
        weighed = u @ self._weights
        far = sign * (c @ weighed[..., None])[..., 0] + 0.5 * np.sum(weighed * u, axis=1)[:, None] * u
        d += np.stack([u, far], axis=2) @ np.stack([far, u], axis=1)
        c += sign * u[:, :, None] * u[:, None, :]


def _squares(grid: Grid) -> Array:
    """Return the products of the entries of each row, (c², positions)."""
    products = grid.rows[:, :, None] * grid.rows[:, None, :]
    return np.ascontiguousarray(products.reshape(len(products), -1).T)


def _seen(stack: StackedStarts, points: Points) -> tuple[Array, Array]:
    """Return the rows (..., n) and noise (...) of readings of one set-up.  points : (..., axes)"""
    rows, noise = np.tile(stack.row, (*points.shape[:-1], 1)), np.full(points.shape[:-1], stack.variance)
    for number, grid in enumerate(stack.grids):
        rows[..., grid.columns] += grid.rows[points[..., number]]
        noise += grid.variances[points[..., number]]
    return rows, noise


def _forms(both: Array, row: Array, grid: Grid, squares: Array) -> Array:
    """Return gᵀCg and gᵀCWCg at every position of a grid, (2, plans, positions).

    both : C and C W C, (2, plans, n, n); row : (plans, n), what does not change of g
    """
    seen = (both @ row[..., None])[..., 0]
    block = both[:, :, grid.columns[:, None], grid.columns].reshape(*seen.shape[:2], -1)
    forms: Array = np.sum(row * seen, axis=2)[..., None] + 2 * seen[..., grid.columns] @ grid.rows.T + block @ squares
    return forms


def plain_designs(task: Task, counts: list[tuple[int, int]]) -> list[Places]:
    """Return the usual and the space-filling readings; once where every set-up is read on a chart, and both are one."""
    evenly, filling = evenly_spaced(task, counts), space_filling(task, counts)
    return [evenly] if evenly.same_as(filling) else [evenly, filling]


def space_filling(task: Task, counts: list[tuple[int, int]]) -> Places:
    """Return so many readings per set-up, spread over everything that may move."""
    machine, setups = task.observation.machine, task.observation.setups
    parts = [(index, count, spread(machine, (setups[index],), max(count, 2))) for index, count in counts]
    return Places.joined([Places.of_setup(i, part.poses[:count], part.approaches[:count]) for i, count, part in parts])


def evenly_spaced(task: Task, counts: list[tuple[int, int]]) -> Places:
    """Return so many readings per set-up, the usual way: one axis at a time from end to end, the others parked."""
    machine, setups = task.observation.machine, task.observation.setups
    parts = [
        Places.of_setup(i, *_axis_by_axis(machine, setups[i], count))
        if setups[i].chart is None
        else space_filling(task, [(i, count)])
        for i, count in counts
    ]
    return Places.joined(parts)


def _axis_by_axis(machine: Machine, setup: Setup, count: int) -> tuple[Array, Array]:
    """Return poses and approaches of so many readings, shared between the axes that move, each (count, q).

    Where both sides are allowed they take turns.
    """
    shares = np.array_split(np.arange(count), len(setup.moves))
    lines = [_line(machine, setup, axis, len(share)) for axis, share in zip(setup.moves, shares, strict=True)]
    even = np.concatenate([np.arange(len(line)) for line in lines]) % 2 == 0
    approaches = np.zeros((count, len(setup.park)))
    approaches[:, list(setup.moves)] = np.where(even, setup.sides[0], setup.sides[-1])[:, None]
    return np.concatenate(lines), approaches


def _line(machine: Machine, setup: Setup, axis: int, count: int) -> Array:
    """Return poses from one end of an axis to the other, (count, q); one alone where it is parked."""
    poses = np.tile(np.array(setup.park), (count, 1))
    poses[:, axis] = np.linspace(*setup.span(machine.axes[axis], axis), count) if count > 1 else setup.park[axis]
    return snapped(machine, setup, poses)
