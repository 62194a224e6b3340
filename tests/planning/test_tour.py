"""Plans by minutes: as good as an exact search of small cases, within their time, and readings that can be taken."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from axiscal.exceptions import PlanError
from axiscal.machine.axis import iso_axis
from axiscal.measurement.instruments.displacement import Indicator
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Unknown
from axiscal.measurement.travel import way_seconds
from axiscal.numerics import Array
from axiscal.planning.plan.order import seconds_along, set_ups_in_order
from axiscal.planning.plan.plan import make_plan, renewed
from axiscal.planning.plan.run import first_seconds
from axiscal.planning.plan.task import Limits, Task
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from tests.generators.designs import levered, problem

TIMES = 2
"""How often the exact search reads one place at most."""


def gantry(candidates: int, speed: float, zero: float = 0.0, reading: float = 1.0, settings: int = 1) -> Task:
    """Return two slow axes of 2 and 1.5 m with two heights and a roll.

    speed : m/s; zero : of each set-up, m; reading : s; settings : set-ups, each takes a minute more to mount
    """
    axes = tuple(iso_axis(name, False, (0.0, far), speed, 1.0) for name, far in (("X", 2.0), ("Y", 1.5)))
    errors = tuple(Error(name, 2e-5, knots=4) for name in ("EZX", "EZY", "EAX"))
    machine, unknowns = Machine(axes, errors, 0.0, name="m"), (Unknown("zero", zero),) if zero else ()
    way, still, noises = (0.0, 0.0, 1.0), ((0, 1), (1.0, 0.75)), 1e-6 / np.arange(1, settings + 1)
    setups = tuple(
        Indicator(f"s{n}", machine, way, *still, noise, unknowns, 60.0 * n, 0.0, reading, (0.0, 0.0), "both")
        for n, noise in enumerate(noises.tolist())
    )
    return problem(machine, setups, candidates)


def shortest(seconds: Array) -> Array:
    """Return the seconds of the shortest open way through each subset, (2^m,), by Held and Karp."""
    count = len(seconds)
    ends = np.full((1 << count, count), np.inf)
    for last in range(count):
        ends[1 << last, last] = 0.0
    for subset in range(1, 1 << count):
        for to in range(count):
            if subset >> to & 1 and (before := subset & ~(1 << to)):
                ends[subset, to] = (ends[before] + seconds[:, to]).min()
    ends[0] = 0.0
    least: Array = ends.min(axis=1)
    return least


def best_of_all(asked: Task, budget: float) -> float:
    """Return the least J of any readings of the candidates within a budget, each read twice at most."""
    lattice, setup, machine = asked.lattice, asked.observation.setups[0], asked.observation.machine
    none = np.zeros_like(lattice.poses)
    ways = shortest(way_seconds(machine, setup, lattice.poses[:, None], lattice.poses[None], none[None]))
    often = np.array(list(product(range(TIMES + 1), repeat=len(lattice))))
    within = ways[(often > 0) @ (1 << np.arange(len(lattice)))] + often.sum(axis=1) * setup.reading_time <= budget
    numbers = asked.observation.numbers(lattice)
    rows, variances = numbers.rows, asked.observation.variances(numbers)
    told = (rows / np.sqrt(variances)[:, None]) @ asked.belief.factor
    grams = (told[:, :, None] * told[:, None, :]).reshape(len(told), -1)
    known = np.eye(told.shape[1]) + (often[within] @ grams).reshape(-1, told.shape[1], told.shape[1])
    reach = asked.root @ asked.belief.factor[: asked.root.shape[1]]
    return float(np.tensordot(np.linalg.inv(known), reach.T @ reach).min())


def test_the_set_up_that_takes_most_per_second_comes_first() -> None:
    """A naive twin takes readings in again for each set-up and turn."""
    task = gantry(9, 0.05, zero=1e-3, settings=3)
    expected, state, left = list[int](), task.state, dict(task.lattice.by_setup())
    while left:
        groups = {setup: task.lattice.within(mine) for setup, mine in left.items()}
        after = {setup: state.after(task.numbers(group)) for setup, group in groups.items()}
        rates = {s: (state.value - after[s].value) / seconds_along(task, group) for s, group in groups.items()}
        expected.append(max(rates, key=lambda setup: rates[setup]))
        state = after[expected[-1]]
        del left[expected[-1]]
    assert list(dict.fromkeys(set_ups_in_order(task, task.lattice).setups.tolist())) == expected


@pytest.mark.parametrize(
    ("candidates", "speed", "budget"),
    [(8, 0.005, 700.0), (8, 0.02, 120.0), (9, 0.05, 60.0)],
)
def test_a_plan_is_within_two_percent_of_the_best_of_all(candidates: int, speed: float, budget: float) -> None:
    asked = gantry(candidates, speed)
    plan = make_plan(asked, Limits(budget=budget), patience=0.0)
    assert plan.value <= 1.02 * best_of_all(asked, budget)


def can_be_taken(asked: Task, places: Places) -> bool:
    """Return whether each reading lies where its set-up reads, from a side that it allows."""
    for index, mine in places.by_setup():
        setup, axes = asked.observation.setups[index], asked.observation.machine.axes
        for k, axis in enumerate(axes):
            low, high = setup.span(axis, k) if k in setup.moves else (setup.park[k], setup.park[k])
            at = places.poses[mine, k]
            if np.any(at < low - 1e-9) or np.any(at > high + 1e-9):
                return False
            if k in setup.moves and not np.all(np.isin(places.approaches[mine, k], (*setup.sides, 0))):
                return False
    return True


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, 3))])
def test_no_plan_takes_longer_than_its_budget_and_every_reading_can_be_taken(seed: int) -> None:
    rng = np.random.default_rng(seed)
    asked = (
        levered(100)
        if seed % 4 == 3
        else gantry(60, 10 ** rng.uniform(-2.5, -0.5), rng.choice([0.0, 1e-4]), rng.uniform(1, 9), 1 + seed % 3)
    )
    first = first_seconds(asked)
    budget = float(min(first.values()) + rng.uniform(0.0, 1.0) * 300)
    plan = make_plan(asked, Limits(budget=budget), patience=1e9, usual=bool(seed % 2))
    assert len(plan.places)
    assert seconds_along(asked, plan.places) <= budget * (1 + 1e-6)
    assert can_be_taken(asked, plan.places)
    left = plan.places.within(slice(len(plan.places) // 2, None))
    here = replace(asked, here=plan.places.single(max(len(plan.places) // 2 - 1, 0)))
    rest = renewed(here, Limits(budget=budget / 2), left, usual=bool(seed % 2))
    assert seconds_along(here, rest) <= budget / 2 * (1 + 1e-6)
    assert can_be_taken(here, rest)


@pytest.mark.parametrize("budget", [0.5, 59.0])
def test_a_budget_shorter_than_one_reading_says_how_long_that_is(budget: float) -> None:
    asked = gantry(20, 0.02, settings=2)
    alone = replace(asked, lattice=asked.lattice.within(asked.lattice.setups == 1))
    with pytest.raises(PlanError, match=r'less than the 1\.02 min .* "s1"'):
        make_plan(alone, Limits(budget=budget))
