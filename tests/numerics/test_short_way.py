"""Short ways against OR-tools, which finds the shortest of few places and bounds that of many."""

import numpy as np
import pytest
from ortools.sat.python import cp_model

from axiscal.machine import load_machine
from axiscal.machine.axis import iso_axis
from axiscal.machine.motion import approach_seconds
from axiscal.numerics import Array
from axiscal.numerics.short_way import route, route_seconds
from axiscal_core.machine import Machine

TICK = 1e-4
"""Seconds in which OR-tools counts: it wants whole numbers."""

MILL = Machine(tuple(iso_axis(n, False, (0.0, 0.6)) for n in "XYZ"), tool=0.1, name="m")


def shortest_by_or_tools(table: Array, first: Array) -> tuple[float, float]:
    """Return the time of the shortest way that OR-tools finds in a fixed amount of work, and what none can be below."""
    model, outside = cp_model.CpModel(), len(table)
    seconds = np.zeros((outside + 1, outside + 1))
    seconds[:outside, :outside], seconds[outside, :outside] = table, first
    ticks = np.round(seconds / TICK).astype(int)
    arcs = [(i, j, model.new_bool_var("")) for i in range(outside + 1) for j in range(outside + 1) if i != j]
    model.add_circuit(arcs)
    model.minimize(sum(int(ticks[i, j]) * chosen for i, j, chosen in arcs))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers, solver.parameters.max_deterministic_time = 1, 6.0
    assert solver.solve(model) in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    return solver.objective_value * TICK, solver.best_objective_bound * TICK


@pytest.mark.parametrize("begun", [False, True])
@pytest.mark.parametrize("count", [2, 3, 7, 15, 27])
@pytest.mark.parametrize("machine", [MILL, load_machine("dmu60")], ids=["three axes", "five axes"])
def test_within_three_percent_of_what_or_tools_finds(machine: Machine, count: int, begun: bool) -> None:
    generator = np.random.default_rng(count)
    low, high = np.array([axis.travel for axis in machine.axes]).T
    poses = generator.uniform(low, high, (count, len(low)))
    approaches = generator.choice([-1.0, 0.0, 1.0], poses.shape) * (count % 2)
    table = approach_seconds(machine, poses[:, None], poses[None], approaches[None])
    first = approach_seconds(machine, low, poses, approaches) if begun else np.zeros(count)
    order = [int(i) for i in route(table, first if begun else None)]
    assert sorted(order) == list(range(count))
    way = float(first[order[0]]) + route_seconds(order, table)
    found, bound = shortest_by_or_tools(table, first)
    assert way <= 1.03 * found
    assert way >= bound - len(poses) * TICK
