"""What branch and bound makes of the gap between a plan and its bound, of 200 candidates: percent of the root of J.

`python benchmarks/bench_branching.py 600` gives each case ten minutes of processor time; one unless said.

A node holds readings that all of its plans have, and candidates that the others come from. What the readings leave of
the target is bounded for each next reading: by the rank of those that then follow (Weyl 1912), with the zeros of
set-ups that none of them is of yet, or by weights. Of candidates that a child may still use the one with the largest
bound comes first, and later ones never use it again: a plan is met once, at its largest bound.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from heapq import heapify, heappop, heappush
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import numpy as np
from numpy.typing import NDArray

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.bound.certificate import groups, zeros_each, zeros_of
from axiscal.planning.bound.relaxation import optimal_weights
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import informed
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.plan import Plan, make_plan
from axiscal.planning.plan.task import Limits, Task
from axiscal_core.threads import one_thread
from benchmarks.bench_bound import best_of_all
from benchmarks.cases import five_axis, stacked
from benchmarks.peers.problems import Stacked

Indices = NDArray[np.intp]
SECONDS, MARKS = 60.0, (10.0, 60.0, 180.0, 600.0)
HALVINGS = 30
"""Of the brackets of eigenvalues, to a billionth: their upper ends count."""
SEEN = 1e-9
"""Share of the largest singular value: its square is rounding."""
CLOSE = 1e-3
"""Share of J by which weights may be off: any prove a bound."""


@dataclass(frozen=True, eq=False, slots=True)
class Group:
    """Candidates of set-ups that are all used.

    rows : of unit noise (N, r); target : (w, r); beyond : J of what no candidate sees; setups : of each (N,)
    kept : by how many zeros are open, the share that stays of a direction that one of them is spent on
    """

    rows: Array
    target: Array
    beyond: float
    setups: Indices
    kept: dict[int, float]


Children = Callable[[Group, list[int], Indices, int], Array]


@dataclass(frozen=True, eq=False, slots=True)
class Branch:
    """The children of a node that are not looked at yet.

    taken : the readings of all of them; left, bounds : the next of each, the largest bound first, (c,)
    place : of the child that is next, which has the least; none of its plans uses those before it
    """

    group: Group
    taken: list[int]
    left: Indices
    bounds: Array
    place: int

    @property
    def bound(self) -> float:
        """The bound on J of all that is left of it."""
        return float(self.bounds[self.place])

    def __lt__(self, other: Branch) -> bool:
        return self.bound < other.bound


def grouped(task: Task, lattice: Places, readings: int) -> Iterator[Group]:
    """Yield the candidates of each set of set-ups that a plan may use."""
    state = task.state.opened(lattice)
    rows, target = state.whitened(lattice)[0], state.weighted
    each = zeros_each(state, lattice)
    for group in groups(lattice.setups, readings):
        mine, zeros = np.isin(lattice.setups, group), zeros_of(each, group)
        columns = np.zeros(0, dtype=np.intp) if zeros is None else zeros.columns
        others = np.delete(rows[mine], columns, axis=1)
        _, sizes, along = np.linalg.svd(others, full_matrices=False)
        along = along[sizes > SEEN * sizes[0]]
        seen = np.delete(target, columns, axis=1) @ along.T
        turned = np.linalg.svd(seen, full_matrices=False)
        small = np.hstack([turned[1][:, None] * turned[2], np.zeros((len(turned[1]), len(columns)))])
        stiff = 0.0 if zeros is None else zeros.stiffness * len(columns)
        kept = {number: stiff / (number + stiff) for number in range(1, len(columns) + 1)}
        beyond = float(np.sum(target**2) - np.sum(seen**2))
        yield Group(np.hstack([others @ along.T, rows[mine][:, columns]]), small, beyond, lattice.setups[mine], kept)


def by_rank(group: Group, taken: list[int], able: Indices, readings: int) -> Array:
    """Return the bound of plans with each candidate as their next reading, by the rank of those after it."""
    left, rows = _after(group, taken, able)
    after = readings - len(taken) - 1
    values, turn = np.linalg.eigh(left @ left.T)
    values = np.maximum(values[::-1], 0.0)
    told = (rows @ left.T @ turn[:, ::-1]) / np.sqrt(1 + np.sum(rows**2, axis=1))[:, None]
    bounds: Array = group.beyond + values.sum() - np.sum(told**2, axis=1)
    used, every = set(group.setups[taken].tolist()), set(group.setups.tolist())
    for setup in set(group.setups[able].tolist()):
        own, unread = group.setups[able] == setup, len(every - used - {setup})
        largest = _largest(values, told[own], after)
        bounds[own] -= largest
        if unread > after:
            bounds[own] = np.inf
        elif unread and group.kept:
            bounds[own] += group.kept[unread] * np.maximum(largest - _largest(values, told[own], after - unread), 0.0)
    return bounds


def by_weights(group: Group, taken: list[int], able: Indices, readings: int) -> Array:
    """Return the bound of plans with each candidate as their next reading, by the optimal weights of all."""
    left, rows = _after(group, taken, able)
    after, number = readings - len(taken) - 1, len(able)
    if not after:
        return by_rank(group, taken, able, readings)
    even, ones = np.full(number, (after + 1) / number), np.ones(number)
    weights = optimal_weights(rows, np.arange(number), left, even, ones, after + 1.0, CLOSE)
    half = informed(np.eye(rows.shape[1]), rows * np.sqrt(weights)[:, None])
    z = left @ half @ half.T
    spent = np.sum((rows @ z.T) ** 2, axis=1)
    off = np.linalg.eigvalsh((left - z).T @ (left - z))[::-1]
    bounds: Array = group.beyond + np.sum(left**2) - off[: after + 1].sum() - after * spent.max() - spent
    return bounds


def _after(group: Group, taken: list[int], able: Indices) -> tuple[Array, Array]:
    """Return the target and the rows of candidates after readings."""
    if not taken:
        return group.target, group.rows[able]
    both = informed(np.vstack([group.target, group.rows[able]]), group.rows[taken])
    return both[: len(group.target)], both[len(group.target) :]


def _largest(values: Array, told: Array, number: int) -> Array:
    """Return at least the sum of the largest eigenvalues of diag(values) − v vᵀ for each v of told (c, r), (c,)."""
    number = min(number, len(values))
    low, high = (np.tile(x[:number], (len(told), 1)) for x in (np.append(values[1:], 0.0), values))
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        apart = values - middle[:, :, None]
        apart[apart == 0.0] = 1e-300
        above = 1 - np.sum(told[:, None] ** 2 / apart, axis=2) > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    total: Array = high.sum(axis=1)
    return total


def _branched(group: Group, taken: list[int], able: Indices, children: Children, readings: int, bound: float) -> Branch:
    """Return the children of a node.  able : candidates that they may use; bound : of the node"""
    bounds = np.maximum(children(group, taken, able, readings), bound)
    order = np.argsort(-bounds, kind="stable")
    return Branch(group, taken, able[order], bounds[order], len(able) - 1)


def closed(
    task: Task, lattice: Places, readings: int, best: float, children: Children, marks: tuple[float, ...]
) -> Iterator[tuple[float, float, int]]:
    """Yield J of the best plan, its bound, and nodes, at some seconds of processor time, and where it ends before.

    best : J of a plan
    """
    begun, nodes, after = time.process_time(), 0, list(marks)
    queue = [
        _branched(group, [], np.arange(len(group.rows)), children, readings, 0.0)
        for group in grouped(task, lattice, readings)
    ]
    heapify(queue)
    while queue:
        branch = heappop(queue)
        while after and time.process_time() - begun > after[0]:
            after.pop(0)
            yield best, min(branch.bound, best), nodes
        if not after:
            return
        if branch.bound >= best:
            break
        nodes += 1
        taken, able, place = [*branch.taken, int(branch.left[branch.place])], branch.left[branch.place :], branch.place
        if place > 0:
            heappush(queue, replace(branch, place=place - 1))
        if len(taken) == readings:
            best = min(best, branch.bound)
        else:
            heappush(queue, _branched(branch.group, taken, able, children, readings, branch.bound))
    yield best, best, nodes


def show(name: str, task: Task, readings: int, children: Children, marks: tuple[float, ...]) -> None:
    """Print the gap before, and after some seconds."""
    plan: Plan = make_plan(task, Limits(readings=readings), patience=0.0)
    print(f"{name}, {readings} readings: {100 * (plan.ratio**0.5 - 1):.2f} %", end="", flush=True)
    lattice = Places.joined([task.lattice, plan.places])
    known = 0.0 if plan.bound is None else plan.bound.value
    for best, bound, nodes in closed(task, lattice, readings, plan.value, children, marks):
        gap = 100 * ((best / max(bound, known)) ** 0.5 - 1)
        print(f"; {gap:.2f} % after {nodes} nodes", end="", flush=True)
    print()


def checked() -> None:
    """Print the best of all plans of few candidates beside what branch and bound finds and proves."""
    print("J over that of the best of all plans: found, proven")
    for task, readings in ((five_axis(24), 3), (stacked(Stacked("", "", 2, 7, 0.1, 3), 24), 3)):
        exact = best_of_all(Scores(Pool(task.observation, task.lattice), task.state), readings)
        for children in (by_rank, by_weights):
            *_, (best, bound, _) = closed(task, task.lattice, readings, 1.3 * exact, children, (np.inf,))
            print(f"{children.__name__:10} {best / exact:.9f} {bound / exact:.9f}")


def main(seconds: float) -> None:
    """Print all of it."""
    marks = (*(mark for mark in MARKS if mark < seconds), seconds)
    checked()
    for readings in (5, 10, 20):
        show("five axes", five_axis(200), readings, by_rank, marks)
    generator = np.random.default_rng(1)
    for number in range(12):
        joints, knots, readings = (int(generator.integers(*ends)) for ends in ((2, 6), (7, 21), (13, 61)))
        case = Stacked("", "", joints, knots, float(10 ** generator.uniform(-2, 0)), min(readings, 20))
        name = f"{joints} joints, {knots} knots, noise {case.noise:.3f}"
        way = by_weights if case.noise > 0.5 else by_rank  # noise hides what the rank would leave
        show(name, stacked(case, 200, number % 2 == 1), case.readings, way, marks)


if __name__ == "__main__":
    with one_thread():
        main(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
