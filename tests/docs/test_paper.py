"""The paper's simulations, as the examples run them: the published sequence, and a dense twin of every step."""

import runpy
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from axiscal.numerics import Array
from tests.docs.examples import ROOT

SEQUENCE = [8.435996, 6.86244, 5.29228, 3.73376, 2.21355, 1.07741, 0.62000, 0.19634, 0.09769, 0.07641, 0.06404]
"""J, computed independently of this project."""
POSITIONS = [5.8730, 2.3144, 8.7285, 4.1742, 1.3682, 0.0, 10.0, 7.0444, 3.1836, 5.0]
KNOTS = np.linspace(0, 10, 7)


SPLINE, STACKED = (
    runpy.run_path(str(ROOT / "examples" / name)) for name in ("ex08_paper_spline.py", "ex05_stacked_axes.py")
)


@dataclass(frozen=True, eq=False)
class Chosen:
    """positions : (m, joints), paper units; variances : J before the first reading and after each"""

    positions: Array
    variances: Sequence[float]


@pytest.fixture(scope="module")
def single() -> Chosen:
    """Return ten readings of the single spline."""
    at, variances = SPLINE["chosen"](10)
    return Chosen(1e3 * np.array(at)[:, None], variances)


@pytest.fixture(scope="module")
def stacked() -> Chosen:
    """Return the readings of the three joints."""
    places = STACKED["chosen"](24)
    return Chosen(1e3 * places.poses, [1e9 * value for value in STACKED["left"](places)[0]])


def dense_rows(positions: Array) -> Array:
    """Return what readings see of the control values, with scipy's splines.  positions : (m, q)."""
    parts = [CubicSpline(KNOTS, np.eye(7), bc_type="natural")(t) for t in positions.T]
    return np.concatenate(parts, axis=1)


def dense_weight() -> Array:
    """Return W of one joint by quadrature."""
    rows, weights = dense_rows(np.linspace(0, 10, 20_001)[:, None]), np.full(20_001, 10 / 20_000)
    weights[[0, -1]] /= 2
    gram: Array = rows.T @ (weights[:, None] * rows)
    return gram


def dense_variances(positions: Array, variance: float) -> list[float]:
    """Return J after each reading: the information matrix inverted."""
    rows, q = dense_rows(positions), positions.shape[1]
    weight = np.kron(np.eye(q), dense_weight())
    covariances = [np.linalg.inv(np.eye(7 * q) + r.T @ r / variance) for r in (rows[:k] for k in range(len(rows) + 1))]
    return [float(np.trace(weight @ covariance)) for covariance in covariances]


def test_the_single_spline_follows_the_published_sequence(single: Chosen) -> None:
    """B&H eq. 26, 27: the overall variance falls as computed independently, to 1e-5."""
    np.testing.assert_allclose(single.variances, SEQUENCE, atol=1e-5)
    found = single.positions[:, 0]
    mirrored = 10 - found if abs(found[0] - POSITIONS[0]) > 1 else found
    np.testing.assert_allclose(mirrored, POSITIONS, atol=1e-4)


@pytest.mark.parametrize(("name", "variance"), [("single", 1e-2), ("stacked", 1e-4)])
def test_dense_algebra_gives_the_same_variances(name: str, variance: float, request: pytest.FixtureRequest) -> None:
    """B&H eq. 36: the sum over all joints, from the positions alone."""
    plan: Chosen = request.getfixturevalue(name)
    np.testing.assert_allclose(plan.variances, dense_variances(plan.positions, variance), rtol=1e-6)


def test_two_combinations_of_constants_are_left(stacked: Chosen) -> None:
    """c ⊗ 1 with Σ c = 0: variance 1/7 of each unit vector's mean, times the length 10, twice."""
    exact = STACKED["case"]("1 nm")
    left = exact.evaluate(exact.lattice(200), criterion="joint").J
    assert left == pytest.approx(20e-9 / 7, rel=1e-5, abs=0.0)
    assert 20 / 7 < stacked.variances[-1] < 20 / 7 + 0.01


@pytest.mark.parametrize(("name", "variance", "along"), [("single", 1e-2, 10_001), ("stacked", 1e-4, 41)])
def test_no_lattice_point_beats_a_reading_chosen(
    name: str, variance: float, along: int, request: pytest.FixtureRequest
) -> None:
    """B&H eq. 27, 37: no position of a line, and no configuration of all joints, takes more of J."""
    plan: Chosen = request.getfixturevalue(name)
    joints = plan.positions.shape[1]
    grid = np.stack(np.meshgrid(*joints * [np.linspace(0, 10, along)], indexing="ij"), axis=-1).reshape(-1, joints)
    lattice, rows, weight = dense_rows(grid), dense_rows(plan.positions), np.kron(np.eye(joints), dense_weight())
    for count in range(len(rows)):
        covariance = np.linalg.inv(np.eye(7 * joints) + rows[:count].T @ rows[:count] / variance)
        best, chosen = (
            np.max(np.sum((seen @ weight) * seen, axis=1) / (variance + np.sum(seen * tried, axis=1)))
            for tried in (lattice, rows[[count]])
            for seen in (tried @ covariance,)
        )
        assert best / chosen - 1 <= 1e-9
