"""The same plan everywhere: the last bits of rows and products, and the number of threads, move no reading."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

import axiscal.planning
from axiscal.estimation.accuracy.yardstick import Root
from axiscal.numerics import Array
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.plan.plan import Plan, make_plan
from axiscal.planning.plan.task import Limits, Patience, Task
from tests.generators.designs import levered, read, splines

TASKS = {
    "one axis": (splines(1, 7, 0.1), 12),
    "three axes": (splines(3, 4, 0.1, 800), 12),
    "levers": (levered(300), 9),
    "readings have been taken": (read(levered(300, False), np.random.default_rng(1), 3), 12),
}
"""Most of them have mirror images: one that gains as much as another, but for the last bits."""


@dataclass(frozen=True, eq=False)
class _Turned(Task):
    """The same task with F Q in place of F and Q V in place of V: all digits but the last ones stay."""

    turn: Array = field(default_factory=lambda: np.eye(1))

    @property
    def state(self) -> Covariance:
        return Covariance.from_factor(self.observation, self.belief.factor @ self.turn, self.root)


def _turned(asked: Task, seed: int) -> Task:
    generator = np.random.default_rng(seed)
    counts = len(asked.root.matrix), asked.belief.factor.shape[1]
    left, right = (np.linalg.qr(generator.normal(size=(count, count)))[0] for count in counts)
    parts = {each.name: getattr(asked, each.name) for each in fields(Task)}
    return _Turned(**{**parts, "root": Root(left @ asked.root.matrix)}, turn=right)


FLAT = ("levers", "readings have been taken")
"""Where climbs end J is flat: of other last bits places differ by up to 1e-3 of the travel, and J by 1e-7."""


def _plan(asked: Task, readings: int) -> Plan:
    return make_plan(asked, Limits(readings=readings), bounded=False)


@pytest.mark.long
@pytest.mark.parametrize("name", TASKS)
def test_other_last_bits_make_the_same_plan(name: str) -> None:
    asked, readings = TASKS[name]
    plan = _plan(asked, readings)
    spans = np.array([axis.length for axis in asked.observation.machine.axes])
    other = _plan(_turned(asked, 0), readings)
    np.testing.assert_array_equal(other.places.setups, plan.places.setups)
    np.testing.assert_array_equal(other.places.approaches, plan.places.approaches)
    apart = 2e-3 if name in FLAT else 1e-5
    np.testing.assert_allclose(other.places.poses / spans, plan.places.poses / spans, rtol=0, atol=apart)
    assert other.value == pytest.approx(plan.value, rel=1e-6 if name in FLAT else 1e-7)


@pytest.mark.long
def test_other_last_bits_make_the_same_plan_of_minutes() -> None:
    """Where climbs end J is flat; on the lattice the readings are the same ones."""
    asked = levered(300)
    first, other = (
        make_plan(each, Limits(budget=900.0), bounded=False, patience=0.0) for each in (asked, _turned(asked, 0))
    )
    np.testing.assert_array_equal(other.places.poses, first.places.poses)
    assert other.value == pytest.approx(first.value, rel=1e-7)


@pytest.mark.long
def test_two_axes_that_are_alike_may_still_be_planned_otherwise_and_hardly_worse() -> None:
    """Where both axes can change places as well, a step refused by a hair leads elsewhere; J to 0.2 % so far."""
    asked = splines(2, 5, 0.1)
    plan = _plan(asked, 10)
    assert [_plan(_turned(asked, seed), 10).value for seed in range(4)] == pytest.approx([plan.value] * 4, rel=5e-3)


@pytest.mark.long
def test_the_number_of_threads_does_not_count() -> None:
    found = []
    for threads in (1, 2):
        with threadpool_limits(threads):
            found.append(_plan(levered(300), 9))
    np.testing.assert_array_equal(found[0].places.poses, found[1].places.poses)


def test_nothing_that_plans_looks_at_a_clock() -> None:
    folder = Path(axiscal.planning.__path__[0])
    for file in folder.rglob("*.py"):
        imported = {
            name.partition(".")[0]
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
            for name in _imported(node)
        }
        assert not imported & {"time", "datetime", "signal", "resource"}, file.name


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [each.name for each in node.names]
    return [node.module or ""] if isinstance(node, ast.ImportFrom) else []


def test_patience_ends_by_work() -> None:
    patience = Patience(10.0)
    patience.take(9.0)
    assert not patience.spent
    patience.take(1.0)
    assert patience.spent


def test_no_patience_leaves_every_reading_on_the_lattice() -> None:
    asked = levered(200)
    plan = make_plan(asked, Limits(readings=6), bounded=False, patience=0.0)
    for pose in plan.places.poses:
        assert np.any(np.all(asked.lattice.poses == pose, axis=1))
