"""Tables from the belief: the line nearest to the mean deviation, with the right sign; repeats, steps and skew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.errors.volume import whole_travel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.machine.description import load_machine, machine_from_text
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.tables.controllers.isg import curves, tip_control
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded
from axiscal.tables.sampling import axis_tables, cross_tables, own_table
from axiscal.tables.surface import Effect, effect_of_control
from axiscal.tables.table import CompensationTable, Hats
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.splines import NaturalSpline
from tests.generators.known import known_to_be, truth_of
from tests.generators.texts import Std, machine_text

STRAIGHT: dict[str, Std] = {
    "EXX EYX EYY": "10 um",
    "EXY": ("10 um", 5, 200),
    "EZZ": "10 um",
    "EYZ": ("10 um", 5, 200),
    "C0Y B0Z": "50 urad",
    "EXX_reversal EYY_reversal": "5 um",
}
CHAINS = ["w-X'-Y'-b-Z-t", "w-b-X-Y-Z-t", "w-Y'-b-X-Z-t"]


def machine(chain: str) -> Machine:
    return machine_from_text(
        machine_text(
            chain, {"X": (-100, 500), "Y": (0, 400), "Z": (-300, 0)}, STRAIGHT, curve=(7, 200), tool=100, name="M"
        )
    )


def known(model: Machine, seed: int) -> tuple[Estimate, VirtualMachine]:
    """A machine drawn from the prior, and the belief of somebody who knows it."""
    estimate = known_to_be(model, model.root() @ np.random.default_rng(seed).standard_normal(model.size))
    return estimate, truth_of(estimate)


def poses(estimate: Estimate, count: int = 600) -> Array:
    low, high = np.array(estimate.box).T
    spread: Array = low + (high - low) * np.random.default_rng(0).uniform(size=(count, len(low)))
    return spread


def reached(estimate: Estimate, truth: VirtualMachine, tables: tuple[CompensationTable, ...]) -> Effect:
    control = Loaded(tables).control(estimate.machine)
    return effect_of_control(estimate.machine, truth.deviation, control, poses(estimate), estimate.box)


@pytest.mark.parametrize("chain", CHAINS)
def test_tables_take_away_what_moves_along_axes_whichever_side_carries_them(chain: str) -> None:
    estimate, truth = known(machine(chain), 3)
    tables = axis_tables(estimate) + cross_tables(estimate)
    found = reached(estimate, truth, tables)
    assert found.before > 10e-6
    assert found.after < sum(t.departure for t in tables) + 0.02e-6
    assert found.after < 0.01 * found.before


@pytest.mark.parametrize("name", ["three-axis-mill", "dmu60"])
def test_tables_are_the_best_that_tables_can_be(name: str) -> None:
    """On the real kinematics: less of them, more of them, or the other way, leaves more."""
    estimate, truth = known(load_machine(name), 5)
    tables = axis_tables(estimate) + cross_tables(estimate)
    best = reached(estimate, truth, tables)
    assert best.after < 0.95 * best.before
    for share in (0.7, 1.3, -1.0):
        scaled = tuple(replace(t, forward=share * t.forward, reverse=share * t.reverse) for t in tables)
        assert reached(estimate, truth, scaled).after > best.after


@given(st.integers(0, 10**6), st.integers(2, 9), st.booleans())
def test_the_nearest_line_follows_from_all_hats_at_once(seed: int, count: int, closed: bool) -> None:
    """Against least squares over all hats, weighed where the curve is inside the volume; around a turn as well."""
    rng = np.random.default_rng(seed)
    points, bounds = np.cumsum(rng.uniform(0.1, 1, count)), np.sort(rng.uniform(0, count, 2))
    hats = Hats.on(points, rng.uniform(points[0], points[-1], 5), (float(bounds[0]), float(bounds[1])), closed)
    curves = rng.normal(size=(len(hats.nodes), 3))
    shapes = np.array([np.interp(hats.nodes, points, unit) for unit in np.eye(count)]).T
    if closed:
        shapes = np.column_stack([shapes[:, 0] + shapes[:, -1], shapes[:, 1:-1]])
    root = np.sqrt(hats.weights)[:, None]
    naive = np.linalg.lstsq(root * shapes, root * curves, rcond=None)[0]
    naive = np.vstack([naive, naive[:1]]) if closed else naive
    # A sliver of a hat inside the bounds is held by little, so its value keeps half of the digits.
    rounding = 1e-8 * np.abs(naive).max()
    assert hats.best(curves) == pytest.approx(naive, rel=1e-6, abs=rounding)
    assert hats.best(curves[:, 0]) == pytest.approx(hats.best(curves)[:, 0], rel=1e-6, abs=rounding)


@given(st.integers(0, 10**6))
def test_the_stated_distance_is_the_largest_there_is(seed: int) -> None:
    """Against 200,001 places of the cubic and of the line."""
    rng = np.random.default_rng(seed)
    spline = NaturalSpline(np.linspace(0, 1, 6))
    control, points = rng.normal(size=6), np.linspace(0, 1, 4)
    fine = np.union1d(np.linspace(0, 1, 200_001), points)
    hats = Hats.on(points, spline.knots, (0, 1))
    values = hats.best(spline.rows(hats.nodes) @ control)
    stated = hats.departure(spline.rows(hats.nodes) @ control, values)
    largest = np.max(np.abs(spline.rows(fine) @ control - np.interp(fine, points, values)))
    assert largest <= stated * (1 + 1e-12)
    assert stated == pytest.approx(largest, rel=1e-8)


def test_where_nothing_was_read_the_table_says_so() -> None:
    model = machine(CHAINS[0])
    prior = Normal(np.zeros(model.size), model.covariance())
    half = model.by_name["EXX"]
    rows = np.zeros((1, model.size))
    rows[0, model.by_name["EXX_reversal"].columns] = 1.0
    read = prior.read(rows, [1e-6], [1e-14])
    rows[:] = 0.0
    for t in np.linspace(-0.1, 0.1, 6):
        rows[0, half.columns] = half.spline.rows(np.array([t]))[0]
        read = read.read(rows, [5e-6], [1e-14])
    table = own_table(Estimate(model, read, whole_travel(model)), 0, np.linspace(-0.1, 0.5, 13))
    assert not table.prior_only[:4].any()
    assert table.prior_only[-2:].all()
    untouched = own_table(Estimate(model, prior, whole_travel(model)), 0, np.linspace(-0.1, 0.5, 13))
    assert np.max(np.abs(untouched.forward)) == 0
    assert untouched.prior_only.sum() >= 11


_MACHINE = machine_text(
    "w-X'-b-Y-Z-t",
    {"X": (0, 400), "Y": (0, 300), "Z": (0, 200)},
    {
        "EXX": 'std = "8 um", length = "200 mm"',
        "EXX_reversal": "2 um",
        "EXX_pitch": 'std = "4 um", period = "100 mm"',
        "EXX_step": 'std = "3 um", at = ["250 mm"]',
        "EYY_pitch": 'std = "4 um", period = "100 mm"',
    },
)


def test_tables_by_name_take_the_whole_error_motion_away() -> None:
    model = machine_from_text(_MACHINE, "m")
    mean = model.root() @ np.random.default_rng(2).standard_normal(model.size)
    for function in model.curves:
        if function.kind == "reversal":
            mean[function.columns] = 0.0
    estimate = known_to_be(model, mean)
    found = curves(estimate, ExportOptions(spacing={axis.name: axis.length / 800 for axis in model.axes}))
    assert set(found) == {"EXX", "EYY"}
    low, high = np.array(estimate.box).T
    poses = np.random.default_rng(3).uniform(low, high, (50, 3))
    poses = poses[np.abs(poses[:, 0] - 0.25) > 2e-3]
    added = tip_control(model, found)(poses, np.ones_like(poses))
    deviation = model.rows_at(poses, np.ones_like(poses)) @ mean
    assert added == pytest.approx(-deviation, abs=5e-8)
