"""Every numbered equation of the paper against the function that computes it, each from an independent source.

`docs/equations.md` is made from the docstrings here and in the package: a test that checks an equation names it.
"""

from typing import Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats
from scipy.interpolate import CubicSpline

from axiscal.machine import machine_from_text
from axiscal.machine.kinematics import small_motions, tool_motion
from axiscal.measurement.instruments.displacement import Indicator
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal_core import terms
from axiscal_core.criterion import joint
from axiscal_core.errors import Error
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal
from axiscal_core.splines import CyclicSpline, NaturalSpline, gauss, spacing_limit
from tests.generators.splines import bending, power_maps

KNOTS = np.array([0.0, 0.7, 1.9, 2.4, 4.0, 4.3, 6.0])
H = np.diff(KNOTS)
CONTROL = np.array([0.3, -1.1, 0.8, 2.0, -0.4, 0.9, -1.7])
TURN = np.append(CONTROL[:-1], CONTROL[0])
"""Control values of a cyclic spline; the last point is the first."""

TRANSLATIONS = """
name = "Two stages and a quill"
chain = "w-X'-b-Y-Z-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "300 mm"]
[axes.Z]
travel = ["0 mm", "200 mm"]
[errors]
EXX = { std = "10 um", knots = 7 }
EZX = { std = "5 um", knots = 5 }
EXY = { std = "5 um", knots = 6 }
EYY = { std = "10 um", knots = 6 }
EZZ = { std = "8 um", knots = 4 }
"""


def machine() -> Machine:
    """Return a machine of orthogonal linear joints whose errors are displacements only, as in the paper."""
    return machine_from_text(TRANSLATIONS)


def cyclic() -> tuple[Array, Array, Array, Array]:
    """Return a, b, c, d of the cyclic spline through TURN; a and c with their last entry, which is the first."""
    b, c, d = (matrix @ TURN[:-1] for matrix in power_maps(CyclicSpline(KNOTS)))
    return TURN, b, np.append(c, c[0]), d


def random_covariance(size: int, seed: int = 1) -> Array:
    """Return a covariance without structure."""
    factor = np.random.default_rng(seed).normal(size=(size, size))
    return factor @ factor.T / size


def floats(values: NDArray[np.floating]) -> Array:
    """Return the same numbers; numpy's own types say less than they could."""
    return np.asarray(values, dtype=np.float64)


def poses(count: int, seed: int = 3) -> Array:
    """Return poses inside the travel of the machine."""
    low, high = np.array([axis.travel for axis in machine().axes]).T
    return np.random.default_rng(seed).uniform(low, high, (count, 3))


def height(direction: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> Setup:
    """Return a dial without unknowns."""
    return Indicator(
        "dial", machine(), direction, (0, 1, 2), (0.0, 0.0, 0.0), 1e-6, (), 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), "+"
    )


def test_forward_kinematics_is_a_sum_over_joints() -> None:
    """B&H eq. 1, 28: x_TCP = Σ K^k(t_k) + Σ V^k(t_k), the V^k splines; nothing linearised on the left."""
    model, t = machine(), poses(20)
    a = np.random.default_rng(5).normal(size=model.size) * 1e-5
    motion = tool_motion(machine(), t, small_motions(model, a, t, np.ones_like(t)))
    sums = t + np.array([0.0, 0.0, -machine().tool_length])
    signs = {"X": -1.0, "Y": 1.0, "Z": 1.0}
    for function in model.curves:
        curve = CubicSpline(function.spline.knots, a[function.columns], bc_type="natural")
        name = machine().axes[function.axis].name
        sums[:, function.component] += signs[name] * curve(t[:, function.axis])
    np.testing.assert_allclose(motion.translation, sums, atol=1e-15)
    np.testing.assert_allclose(t + model.rows_at(t, np.ones_like(t)) @ a, sums, atol=1e-15)


def test_a_cyclic_spline_closes() -> None:
    """B&H eq. 7: a_1 = S(t_1) = S(t_n), and slope and curvature close too."""
    spline = CyclicSpline(KNOTS)
    for order in range(3):
        ends = [spline.rows(t, order) @ TURN[:-1] for t in (KNOTS[0], np.nextafter(KNOTS[-1], 0))]
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-12)
    np.testing.assert_allclose(spline.rows(KNOTS) @ TURN[:-1], TURN, atol=1e-15)


def test_slopes_of_a_cyclic_spline() -> None:
    """B&H eq. 8, with h_1 where h_2 is printed."""
    a, b, c, _ = cyclic()
    np.testing.assert_allclose(b, np.diff(a) / H - (c[1:] + 2 * c[:-1]) * H / 3, atol=1e-13)
    printed = (a[1] - a[0]) / H[0] - (c[1] + 2 * c[0]) / 3 * H[1]
    assert abs(printed - b[0]) > 0.1


@pytest.mark.parametrize(("kind", "end"), [(NaturalSpline, "natural"), (CyclicSpline, "periodic")])
def test_coefficients_are_linear_maps_of_the_control_values(
    kind: type[NaturalSpline | CyclicSpline], end: Literal["natural", "periodic"]
) -> None:
    """B&H eq. 3-6, 9-11: b = M1 a, c = M2 a, d = M3 a, column by column as scipy has them; a are the values."""
    spline = kind(KNOTS)
    units = np.eye(spline.size) if end == "natural" else np.vstack([np.eye(6), np.eye(6)[:1]])
    d, c, b, _ = CubicSpline(KNOTS, units, bc_type=end).c
    np.testing.assert_allclose(spline.rows(KNOTS), units, atol=1e-15)
    for found, expected in zip(power_maps(spline), (b, c, d), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-12)


def beam(knots: Array) -> tuple[Array, Array]:
    """Return stiffness blocks of an Euler-Bernoulli beam of unit rigidity, nodes at the knots.

    returns : (n, n) of the rotations among themselves, (n, n) of rotations with deflections, and the rest in one
    """
    n = len(knots)
    stiffness = np.zeros((2 * n, 2 * n))
    for i, h in enumerate(np.diff(knots)):
        element = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]])
        element = np.vstack([element, -element[0], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) / h**3
        at = [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3]
        stiffness[np.ix_(at, at)] += element
    rotations = floats(np.linalg.solve(stiffness[1::2, 1::2], -stiffness[1::2, ::2]))
    energy = stiffness[::2, ::2] + stiffness[::2, 1::2] @ rotations
    return rotations, energy


def test_a_beam_pinned_at_the_control_points_bends_as_the_spline() -> None:
    """B&H eq. 12, 13-14: finite elements of the beam give the spline's slopes, and twice its energy is aᵀ K a."""
    spline = NaturalSpline(KNOTS)
    rotations, energy = beam(KNOTS)
    np.testing.assert_allclose(spline.rows(KNOTS, 1), rotations, atol=1e-12)
    np.testing.assert_allclose(bending(spline), energy, rtol=1e-11, atol=1e-11)


def test_the_widest_spacing_is_that_of_a_spline_between_both_borders() -> None:
    """B&H eq. 15: control points in turn at both borders of a band, and x_d apart, bend with exactly k_max."""
    width, curvature = 3.0, 0.4
    spacing = spacing_limit(width, curvature)
    spline = CyclicSpline(spacing * np.arange(9.0))
    zigzag = width / 2 * np.tile([1.0, -1.0], 4)
    t = np.linspace(0, 8 * spacing, 4001)
    assert np.abs(spline.rows(t, 2) @ zigzag).max() == pytest.approx(curvature)
    assert np.abs(spline.rows(t) @ zigzag).max() == pytest.approx(width / 2)


def test_control_values_are_gaussian() -> None:
    """B&H eq. 16: independent beforehand; draws have the density with mean â and covariance C."""
    axis = machine().axes[0]
    entry = Error("EXX", std=2.0, knots=7)
    np.testing.assert_array_equal(terms.covariance(entry, terms.spline_of(entry, axis)), 4 * np.eye(7))
    mean, covariance = CONTROL, random_covariance(7)
    drawn = Normal(mean, covariance).sample(4000, seed=2) - mean
    distance = np.einsum("ij,jk,ik->i", drawn, np.linalg.inv(covariance), drawn)
    assert stats.kstest(distance, stats.chi2(7).cdf).pvalue > 1e-3


@pytest.mark.parametrize("order", [1, 2, 3])
def test_covariances_of_the_coefficients(order: int) -> None:
    """B&H eq. 17: C_b = M1 C M1ᵀ and so on; every column of a root of C sent through scipy's spline."""
    covariance, matrix = random_covariance(7), power_maps(NaturalSpline(KNOTS))[order - 1]
    sent = CubicSpline(KNOTS, np.linalg.cholesky(covariance), bc_type="natural").c[3 - order]
    np.testing.assert_allclose(matrix @ covariance @ matrix.T, sent @ sent.T, atol=1e-10)
    found = Normal(CONTROL, covariance).through(matrix)
    np.testing.assert_allclose(found.std**2, np.sum(sent**2, axis=1), atol=1e-10)


def test_estimate_and_variance_along_the_spline() -> None:
    """B&H eq. 2, 18, 19, 20: Ŝ(t) = mᵀ â, m from the Kronecker symbol and M1 M2 M3, a power form; variance mᵀ C m."""
    spline, covariance = NaturalSpline(KNOTS), random_covariance(7)
    t = np.linspace(0, 6, 50, endpoint=False)
    i = np.searchsorted(KNOTS, t, side="right") - 1
    u = (t - KNOTS[i])[:, None]
    m = np.eye(7)[i] + sum(matrix[i] * u**k for k, matrix in enumerate(power_maps(spline), start=1))
    found = Normal(CONTROL, covariance).through(spline.rows(t))
    np.testing.assert_allclose(found.mean, m @ CONTROL, atol=1e-12)
    np.testing.assert_allclose(found.std**2, np.diag(m @ covariance @ m.T), atol=1e-12)
    np.testing.assert_allclose(found.mean, CubicSpline(KNOTS, CONTROL, bc_type="natural")(t), atol=1e-12)


@pytest.mark.parametrize("count", [1, 3])
def test_readings_improve_the_estimate(count: int) -> None:
    """B&H eq. 21, 22, 23, 31, 32, 33: the stochastic combination with K as a matrix; and the same by Bayes' rule."""
    rng, covariance = np.random.default_rng(7), random_covariance(7)
    rows, noise, read = rng.normal(size=(count, 7)), np.array([0.1, 0.2, 0.3])[:count], rng.normal(size=count)
    gain = covariance @ rows.T @ np.linalg.inv(np.diag(noise) + rows @ covariance @ rows.T)
    shrink = np.eye(7) - gain @ rows
    found = Normal(CONTROL, covariance).read(rows, read, noise)
    np.testing.assert_allclose(found.mean, shrink @ CONTROL + gain @ read, atol=1e-12)
    expected = shrink @ covariance @ shrink.T + gain @ np.diag(noise) @ gain.T
    np.testing.assert_allclose(found.covariance, expected, atol=1e-12)
    information = np.linalg.inv(covariance) + rows.T @ (rows / noise[:, None])
    np.testing.assert_allclose(found.covariance, np.linalg.inv(information), atol=1e-11)


@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, 1.0, 0.0)])
def test_a_reading_is_linear_in_all_control_values(direction: tuple[float, float, float]) -> None:
    """B&H eq. 29, 30: y = hᵀ x_TCP + v is h̄ᵀ A + v once the nominal position, which is known, is taken away."""
    model, t = machine(), poses(12)
    a = np.random.default_rng(6).normal(size=model.size) * 1e-5
    motion = tool_motion(machine(), t, small_motions(model, a, t, np.ones_like(t)))
    deviation = (motion.translation - t) @ np.array(direction)
    observation = Observation(model, (height(direction),))
    seen = observation.numbers(Places.of_setup(0, t, np.ones_like(t)))
    np.testing.assert_allclose(seen.rows @ a, deviation, atol=1e-15)
    np.testing.assert_array_equal(observation.variances(seen), 1e-12)


def test_overall_variance_of_stacked_vectorial_splines() -> None:
    """B&H eq. 24, 25, 26, 34, 35, 36: the traces of the interval covariance matrices of all joints, by quadrature."""
    model = machine()
    covariance = 1e-10 * random_covariance(model.size)
    total = 0.0
    for axis in range(3):
        own = [function for function in model.curves if function.axis == axis]
        for function in own:
            node, weight = (each.ravel() for each in gauss(function.spline.knots, 5))
            rows = function.spline.rows(node)
            variance = np.einsum("ij,jk,ik->i", rows, covariance[function.columns, function.columns], rows)
            total += float(weight @ variance)
    belief = Normal(np.zeros(model.size), covariance)
    assert joint(model, model.size).value(belief.factor) == pytest.approx(total, rel=1e-12, abs=0.0)


def forward_recurrence(control: Array) -> Array:
    """Return c on even knots of spacing 1 by B&H eq. 5 as a recipe: from c_1 and the right c_2 onwards."""
    c = np.zeros(len(control))
    c[1] = (power_maps(NaturalSpline(np.arange(float(len(control)))))[1] @ control)[1]
    for i in range(2, len(control)):
        c[i] = -c[i - 2] - 4 * c[i - 1] + 3 * (control[i] - 2 * control[i - 1] + control[i - 2])
    return c


def test_the_recurrence_as_a_recipe_multiplies_rounding_errors() -> None:
    """B&H eq. 5 as printed: computed onwards, an error grows by 2 + √3 at every knot, 10²² over 40 of them."""
    control = np.random.default_rng(8).normal(size=41)
    right = np.append(power_maps(NaturalSpline(np.arange(41.0)))[1] @ control, 0.0)
    wrong = np.abs(forward_recurrence(control) - right)
    assert wrong[40] > 1e3
    assert (wrong[30:] / wrong[29:-1]) == pytest.approx(2 + np.sqrt(3), rel=1e-6)


def test_the_knot_where_the_ends_meet_needs_its_neighbours() -> None:
    """B&H eq. 9 as printed: with a_n = a_1 and h_n = h_1 it does not give the spline's c_1."""
    a, _, c, _ = cyclic()
    ratio = H[-1] / H[0]
    load = 3 * ((a[0] - a[6]) / H[0] ** 2 - (a[6] - a[5]) / (H[0] * H[-1]))
    printed = -ratio * c[5] - 2 * (ratio + 1) * c[6] + load
    assert abs(printed - c[0]) > 0.1
    moved = -ratio * c[5] - 2 * (ratio + 1) * c[0] + 3 * ((a[1] - a[0]) / H[0] ** 2 - (a[0] - a[5]) / (H[0] * H[-1]))
    assert moved == pytest.approx(c[1])
