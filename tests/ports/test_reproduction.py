"""The paper's simulations: the published sequence, a dense twin of every step, and pictures that a browser draws."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from axiscal.cli.app import run as command
from axiscal.numerics import Array
from axiscal.ports.paper.paper_page import render, table
from axiscal.ports.paper.stack import Experiment, GreedyPlan, document, run
from benchmarks.beyond import beyond
from tests.web.browser import Browser

SEQUENCE = [8.435996, 6.86244, 5.29228, 3.73376, 2.21355, 1.07741, 0.62000, 0.19634, 0.09769, 0.07641, 0.06404]
"""J, computed independently of this project."""
POSITIONS = [5.8730, 2.3144, 8.7285, 4.1742, 1.3682, 0.0, 10.0, 7.0444, 3.1836, 5.0]
KNOTS = np.linspace(0, 10, 7)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    """Return the experiment, run once."""
    return run()


def dense_rows(positions: Array) -> Array:
    """Return what readings see of the control values, with scipy's splines.  positions : (m, q)."""
    parts = [CubicSpline(KNOTS, np.eye(7), bc_type="natural")(t) for t in positions.T]
    return np.concatenate(parts, axis=1)


def dense_variances(positions: Array, variance: float) -> list[float]:
    """Return J after each reading: the information matrix inverted, W by quadrature."""
    t = np.linspace(0, 10, 20_001)
    rows = dense_rows(t[:, None])
    weights = np.full(len(t), 10 / 20_000)
    weights[[0, -1]] /= 2
    gram = rows.T @ (weights[:, None] * rows)
    q = positions.shape[1]
    weight, seen = np.kron(np.eye(q), gram), dense_rows(positions)
    covariances = [np.linalg.inv(np.eye(7 * q) + r.T @ r / variance) for r in (seen[:k] for k in range(len(seen) + 1))]
    return [float(np.trace(weight @ covariance)) for covariance in covariances]


def test_the_single_spline_follows_the_published_sequence(experiment: Experiment) -> None:
    """B&H eq. 26, 27: the overall variance falls as computed independently, to 1e-5."""
    np.testing.assert_allclose(experiment.single.overall_variances, SEQUENCE, atol=1e-5)
    found = experiment.single.positions[:, 0]
    mirrored = 10 - found if abs(found[0] - POSITIONS[0]) > 1 else found
    np.testing.assert_allclose(mirrored, POSITIONS, atol=1e-4)


@pytest.mark.parametrize(("name", "variance"), [("single", 1e-2), ("stacked", 1e-4)])
def test_dense_algebra_gives_the_same_variances(experiment: Experiment, name: str, variance: float) -> None:
    """B&H eq. 36: the sum over all joints, from the positions alone."""
    plan: GreedyPlan = getattr(experiment, name)
    expected = dense_variances(plan.positions, variance)
    np.testing.assert_allclose(plan.overall_variances, expected, rtol=1e-6)


@pytest.mark.long
def test_the_squared_error_of_simulated_splines_is_the_overall_variance(experiment: Experiment) -> None:
    errors = experiment.squared_errors
    deviation = errors.mean(axis=0) - experiment.single.overall_variances
    assert (np.abs(deviation) < 4.5 * errors.std(axis=0, ddof=1) / np.sqrt(len(errors))).all()
    assert len(errors) == 2000


def test_the_knees_stand_where_the_readings_span_what_can_be_seen(experiment: Experiment) -> None:
    for plan, knee in ((experiment.single, 7), (experiment.stacked, 19)):
        falls = -np.diff(plan.overall_variances)
        assert falls[:knee].min() > 3 * falls[knee:].max()


def test_two_combinations_of_constants_are_left(experiment: Experiment) -> None:
    """c ⊗ 1 with Σ c = 0: variance 1/7 of each unit vector's mean, times the length 10, twice."""
    plan = experiment.stacked
    assert plan.stack.variance_left == pytest.approx(20 / 7, rel=1e-5)
    assert 20 / 7 < plan.overall_variances[-1] < 20 / 7 + 0.01
    assert plan.height_variances[-1] < 1e-3
    assert experiment.single.stack.variance_left < 1e-4


def test_seven_chosen_together_beat_seven_in_turn(experiment: Experiment) -> None:
    together = np.array([[0.0, 1.5723, 3.3141, 5.0, 6.6859, 8.4277, 10.0]]).T
    assert dense_variances(together, 1e-2)[-1] == pytest.approx(0.08318, abs=1e-5)
    assert experiment.single.overall_variances[7] > 0.19


@pytest.mark.parametrize(("name", "points"), [("single", 10_001), ("stacked", 41)])
def test_no_lattice_point_beats_a_reading_chosen(experiment: Experiment, name: str, points: int) -> None:
    """points : of a lattice along each joint"""
    plan: GreedyPlan = getattr(experiment, name)
    stack = plan.stack
    along = [np.linspace(*axis.travel, points) for axis in stack.machine.axes]
    poses = np.stack([g.ravel() for g in np.meshgrid(*along, indexing="ij")], axis=1)
    rows = stack.observation.rows(0, poses, np.ones_like(poses)).rows

    def gains(factor: Array, rows: Array) -> Array:
        seen = rows @ factor
        reach = seen @ stack.joint.times(factor).T
        found: Array = np.sum(reach**2, axis=1) / (stack.setup.noise**2 + np.sum(seen**2, axis=1))
        return found

    for before, row in zip(plan.beliefs, plan.rows, strict=False):
        assert np.max(gains(before.factor, rows)) / gains(before.factor, row[None])[0] - 1 <= 1e-9


@pytest.mark.long
def test_the_document_is_the_one_outsiders_rely_on(experiment: Experiment) -> None:
    numbers = json.loads(json.dumps(document(experiment), allow_nan=False))
    assert numbers["schema"] == "axiscal-reproduce/1"
    assert numbers["single_spline"]["J"] == experiment.single.overall_variances
    assert len(numbers["single_spline"]["positions"]) == 10
    assert [len(p) for p in numbers["stacked"]["positions"]] == [3] * 24
    assert all(f" {value:.5f} " in table(experiment) for value in experiment.single.overall_variances)


@pytest.mark.long
def test_the_command_prints_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["reproduce", "--json", "--out", str(tmp_path / "paper")]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads((tmp_path / "paper" / "reproduce.json").read_text())
    page = (tmp_path / "paper" / "reproduce.html").read_text()
    assert len(page) > 1e5
    assert page.count('class="picture"') == 3 + 1 + 12


@pytest.mark.long
def test_where_joints_are_not_what_the_paper_assumes_its_method_misses_more() -> None:
    last = [(np.median(found.linear[:, -1]), np.median(found.whole[:, -1])) for found in beyond()]
    times = [linear / whole for linear, whole in last]
    assert [whole < 6e-6 for _, whole in last] == [True] * 3
    assert times[0] > 4
    assert times[1] > 2
    assert times[2] > 100


@pytest.mark.long
@pytest.mark.chromium
def test_a_browser_draws_every_figure(browser: Browser, experiment: Experiment, tmp_path: Path) -> None:
    page = tmp_path / "reproduce.html"
    page.write_text(render(experiment), encoding="utf-8")
    drawn, errors = browser.drawn(page.as_uri())
    assert errors == []
    assert drawn.count('class="picture"') == 3 + 1 + 12
