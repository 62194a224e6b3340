"""The case of a machine that is built in, and of one that is made in Python: one surface, beside the dense formulas."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import axiscal as ac
import axiscal_core
from axiscal.measurement.reading_rows import places_of, rows_at
from axiscal.numerics import Array
from axiscal.python import given
from axiscal.python.measured_case import Case

LASER = ac.setup("interferometer", "x", moves=["X"], name="laser", approach="both")
Made = Case | axiscal_core.Case


def built_in(usual: Any = "on") -> Case:
    return ac.Case(ac.load_machine("one-axis"), [LASER], usual=usual)


def made(usual: Any = "on", sure: Any = "well") -> axiscal_core.Case:
    axes = [ac.Axis.linear("X", "x", (0, "600 mm")), ac.Axis.linear("Y", "y", (0, "400 mm"))]
    errors = [ac.Error("EXX", "10 um", length="200 mm", rest="0.5 um"), ac.Error("C0Y", "30 urad")]
    return axiscal_core.Case(ac.Machine(axes, errors), [ac.Laser("laser", "XY")], usual=usual, sure=sure)


BOTH: list[Callable[[], Made]] = [built_in, made]


def line(case: Made, shares: list[float], side: float = 1.0) -> ac.Places:
    """Return places along X, at shares of its travel."""
    machine: Any = case.machine if isinstance(case, axiscal_core.Case) else case.description.machine
    axes = machine.axes
    poses = np.tile([sum(axis.travel) / 2 for axis in axes], (len(shares), 1))
    low, high = axes[0].travel
    poses[:, 0] = (low + np.array(shares) * (high - low)).round(4)
    sides = np.zeros_like(poses)
    sides[:, 0] = side
    return ac.Places("laser", poses, sides)


def rows_of(case: Made, places: ac.Places) -> Array:
    """Return H of readings at places, over errors and unknowns of set-ups."""
    if isinstance(case, axiscal_core.Case):
        return case.numbers(places).rows
    listed = given.places_of(places, case.description, "a test", "places")
    return rows_at(case.inner.observation, places_of(case.description.setups, listed)).rows


def dense(case: Made, places: ac.Places) -> Array:
    """Return C = C₀ − C₀Hᵀ(H C₀ Hᵀ + R)⁻¹H C₀ after readings at places, R of noise and rests."""
    before, rows = case.prior.covariance, rows_of(case, places)
    noise = case.shows(places, np.zeros(len(before))).covariance
    reach = before @ rows.T
    return np.asarray(before - reach @ np.linalg.solve(rows @ reach + noise, reach.T))


def weights(case: Made) -> Array:
    """Return V of three figures of the unknowns."""
    return np.random.default_rng(1).normal(size=(3, len(case.prior.mean)))


@pytest.mark.parametrize("name", ["evaluate", "next", "plan", "estimate", "known", "shows"])
def test_both_take_the_same_arguments(name: str) -> None:
    theirs, own = (inspect.signature(getattr(kind, name)).parameters for kind in (Case, axiscal_core.Case))
    assert [*theirs] == [*own]
    assert [each.kind for each in theirs.values()] == [each.kind for each in own.values()]


@pytest.mark.parametrize("kind", BOTH)
def test_a_plan_makes_a_criterion_of_ones_own_small(kind: Callable[[], Made]) -> None:
    case = kind()
    v = weights(case)
    plan = case.plan(4, criterion=v, candidates=60)
    left = float(np.sum(v @ dense(case, plan.places) * v))
    assert pytest.approx(left, rel=1e-8, abs=0) == plan.J
    assert pytest.approx(left, rel=1e-8, abs=0) == case.evaluate(plan.places, criterion=v).J
    assert pytest.approx(left, rel=1e-8, abs=0) == case.evaluate(plan.places, criterion=lambda c: np.sum(v @ c * v)).J
    assert plan.J < case.evaluate(case.plan(4, candidates=60).places, criterion=v).J
    assert case.evaluate(case.next(criterion=v), criterion=v).J < case.evaluate(case.next(), criterion=v).J


@pytest.mark.parametrize("weighed", ["EXX[3]", "edge.slope"])
def test_a_criterion_of_ones_own_counts_unknowns_of_set_ups_that_a_plan_leaves_out(weighed: str) -> None:
    edge = ac.setup("straightedge", "y", moves=["X"], name="edge", reach={"X": ["50 mm", "550 mm"]})
    case = ac.Case(ac.load_machine("three-axis-mill"), [LASER, edge], usual="off")
    v = np.array([[name in (weighed, "laser.zero") for name in case.names]], dtype=float)
    plan = case.plan(4, criterion=v, candidates=60)
    left = float(np.sum(v @ dense(case, plan.places) * v))
    assert pytest.approx(left, rel=1e-7, abs=0) == plan.J
    assert pytest.approx(left, rel=1e-7, abs=0) == case.evaluate(plan.places, criterion=v).J


@pytest.mark.parametrize("kind", BOTH)
def test_the_criterion_of_the_paper_has_its_own_plan(kind: Callable[[], Made]) -> None:
    case = kind()
    plan = case.plan(4, criterion="joint", candidates=60)
    assert pytest.approx(plan.J, rel=1e-9, abs=0) == case.evaluate(plan.places, criterion="joint").J
    assert plan.J <= case.evaluate(case.plan(4, candidates=60).places, criterion="joint").J


@pytest.mark.parametrize("kind", BOTH)
def test_kept_places_are_among_those_of_a_plan(kind: Callable[[], Made]) -> None:
    case = kind()
    kept = line(case, [0.2, 0.81])
    kept.poses[0, 0] = kept.given[0, 0] = kept.poses[0, 0] + 1.23e-7  # a place stays where it is, to the last digit
    plan = case.plan(5, keep=kept, candidates=60)
    poses = plan.places.poses.tolist()
    where = [poses.index(pose) for pose in kept.poses.tolist()]
    others = plan.places.at(np.setdiff1d(np.arange(5), where))
    assert len(plan) == 5
    assert pytest.approx(plan.J, rel=1e-9, abs=0) == case.evaluate(others, after=kept).J
    assert pytest.approx(plan.J, rel=1e-9, abs=0) == case.evaluate(plan.places).J
    assert plan.J < case.evaluate(kept + line(case, [0.2, 0.81, 0.81])).J
    assert case.plan(2, keep=kept).places.poses[:, 0] == pytest.approx(kept.poses[:, 0], abs=0)


def test_a_case_goes_on_from_what_is_known() -> None:
    """Where sizes are exact and no cell of a rest is visited twice, as from the readings themselves."""
    case = made("off", "exactly")
    there, more = line(case, [0.1, 0.5]), line(case, [0.3, 0.9])
    known = case.estimate(ac.Readings.simulated(case, there, seed=1))
    assert pytest.approx(case.evaluate(there + more).J, rel=1e-7, abs=0) == case.evaluate(more, after=known).J
    assert case.next(after=known).poses == pytest.approx(case.next(after=there).poses, rel=1e-6)
    plan = case.plan(2, after=known, candidates=60)
    assert pytest.approx(case.evaluate(there + plan.places).J, rel=1e-7, abs=0) == plan.J
    assert case.prior.covariance[0, 0] > known.covariance[0, 0]


@pytest.mark.parametrize("kind", BOTH)
def test_a_plan_with_kept_places_keeps_its_minutes(kind: Callable[[], Made]) -> None:
    case = kind()
    kept, most = line(case, [0.2, 0.81]), case.evaluate(line(case, [0.2, 0.81])).minutes + 1.0
    plan = case.plan(minutes=most, keep=kept, candidates=60)
    assert len(kept) < len(plan)
    assert plan.minutes <= most


def test_kept_places_of_another_set_up_are_read_too() -> None:
    other = ac.setup("autocollimator", "z", moves=["X"], name="mirror")
    case = ac.Case(ac.load_machine("three-axis-mill"), [LASER, other])
    kept = ac.Places("mirror", [[0.3, 0.2, 0.2]])
    plan = case.plan(4, keep=kept, candidates=40)
    assert plan.places.instruments.count("mirror") == 1
    assert pytest.approx(plan.J, rel=1e-9, abs=0) == case.evaluate(plan.places).J


@pytest.mark.parametrize("kind", BOTH)
def test_what_was_read_in_two_parts_is_known_as_at_once(kind: Callable[[], Made]) -> None:
    case = kind()
    first, second = (ac.Readings.simulated(case, line(case, at), 1) for at in ([0.1, 0.5, 0.9], [0.3, 0.5, 0.7, 0.8]))
    known, whole = case.estimate(first).read(second), case.estimate(first + second)
    assert np.array_equal(known.mean, whole.mean)
    assert np.array_equal(known.covariance, whole.covariance)
    assert not np.array_equal(known.mean, case.estimate(first).mean)


def test_a_belief_is_read_by_the_dense_formula() -> None:
    case = made("off", "exactly")
    read = ac.Readings.simulated(case, line(case, [0.1, 0.5, 0.9]), 1)
    known = case.known(case.prior.mean, case.prior.covariance).read(read)
    scale = np.sqrt(np.diag(case.prior.covariance))
    apart = (known.covariance - dense(case, read.places)) / np.outer(scale, scale)
    assert np.abs(apart).max() < 1e-9


def test_a_belief_of_a_machine_that_is_built_in_is_read() -> None:
    case = built_in("off")
    size = case.inner.errors.size
    belief = case.known(np.zeros(size), case.prior.covariance[:size, :size])
    read = ac.Readings.simulated(case, line(case, [0.1, 0.5, 0.9]), 1)
    known, stated = belief.read(read), case.estimate(read)
    assert len(known.estimation.readings) == 3
    assert known.rms == pytest.approx(stated.rms, rel=0.3)
    assert known.rms < 0.9 * belief.rms


def test_deviations_of_all_poses_together() -> None:
    """Their blocks are those of each pose; between poses the errors count, and a rest that both share."""
    case = built_in()
    known = case.estimate(ac.Readings.simulated(case, line(case, [0.1, 0.5, 0.9]), 1))
    poses = line(case, [0.2, 0.2, 0.2001, 0.7]).poses
    each, whole = (known.deviation(poses, approach={"X": 1}, joint=joint) for joint in (False, True))
    blocks = whole.covariance.reshape(4, 3, 4, 3)
    every = np.arange(4)
    assert np.array_equal(whole.mean, each.mean.ravel())
    assert blocks[every, :, every] == pytest.approx(each.covariance, abs=0)
    errors, belief = case.inner.errors, known.estimation.printed.belief
    covariance = belief.covariance[: errors.size, : errors.size]
    rows = errors.rows_at(poses, np.tile([1.0, *[0.0] * (poses.shape[1] - 1)], (4, 1)))
    assert np.linalg.eigvalsh(whole.covariance).min() > -1e-9 * np.abs(whole.covariance).max()
    assert blocks[0, :, 1] == pytest.approx(each.covariance[0], rel=1e-9, abs=1e-20), "one place has one deviation"
    assert np.abs(blocks[0, :, 3] - rows[0] @ covariance @ rows[3].T).max() < 1e-9 * np.abs(each.covariance).max()
    shared = blocks[0, 0, 2, 0] - (rows[0] @ covariance @ rows[2].T)[0, 0]
    assert shared == pytest.approx(errors.by_name["EXX"].rest ** 2, rel=1e-6, abs=0)


@pytest.mark.parametrize("machine", ["one-axis", "three-axis-mill"])
def test_readings_that_are_there_count_as_those_to_come(machine: str) -> None:
    case = ac.Case(ac.load_machine(machine), [LASER])
    there, more = line(case, [0.1, 0.4, 0.9]), line(case, [0.2, 0.6], -1.0)
    whole, after = case.evaluate(there + more), case.evaluate(more, after=there)
    assert (after.J, after.rms, after.U) == pytest.approx((whole.J, whole.rms, whole.U), rel=1e-9, abs=0)
