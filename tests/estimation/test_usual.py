"""Which sizes vary, and how: θ = f q(x) is Student-t of four degrees where x is standard normal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm
from scipy.stats import t as student

from axiscal.description import usual as model
from axiscal.description.usual import (
    DRIFT,
    LENGTH,
    NOISE,
    REST,
    REVERSAL,
    ROUGH,
    SURE,
    Size,
    Sizes,
    sizes_of,
    usual_machine,
)
from axiscal.machine.entry import Sure
from tests.generators.problems import case_of, plain_case, sizes_for


def test_a_curve_has_a_rough_part_besides_its_rest() -> None:
    """Usual where nobody states a rest, else beside the stated one."""
    described = plain_case("plate").description
    machine = described.machine
    for before, after in zip(machine.errors, usual_machine(machine, described.setups).errors, strict=True):
        white = REST.size * before.std if before.rest is None else before.rest
        assert after.rest == pytest.approx(np.hypot(white, ROUGH.size * before.std))


def test_what_is_constant_stays_smooth() -> None:
    described = plain_case("five axes").description
    machine = described.machine
    pairs = list(zip(machine.errors, usual_machine(machine, described.setups).errors, strict=True))
    assert any(before.constant for before, _ in pairs)
    assert all(before == after for before, after in pairs if before.constant)


@pytest.mark.parametrize("kind", ["axis", "plate", "five axes", "two set-ups"])
def test_every_size_has_an_owner_and_no_two_the_same(kind: str) -> None:
    sizes = sizes_for(case_of(kind))
    owned = [(size.kind, owner) for size in sizes.of for owner in size.owners]
    assert len(owned) == len(set(owned)) > 0
    assert all(size.owners for size in sizes.of)
    assert all(size.spread > 0 for size in sizes.of)


def test_errors_that_are_alike_share_a_factor() -> None:
    """Positions of linear axes one, their angles another."""
    sizes = sizes_for(case_of("five axes"))
    assert sizes.index("std", "EXX") == sizes.index("std", "EYY") >= 0
    assert sizes.index("std", "EXX") != sizes.index("std", "EAX")
    assert sizes.index("std", "EXX") != sizes.index("std", "ECC")
    assert sizes.index("length", "EXX") == sizes.index("length", "EAX") >= 0


def test_each_setup_has_its_noise() -> None:
    sizes = sizes_for(case_of("two set-ups"))
    assert sizes.index("noise", "probe") != sizes.index("noise", "nest")
    assert sizes.index("drift", "probe") == sizes.index("drift", "nest") >= 0
    assert sizes.spreads[sizes.index("noise", "nest")] == pytest.approx(NOISE.spread)
    assert sizes.spreads[sizes.index("drift", "nest")] == pytest.approx(DRIFT.spread)


@pytest.mark.parametrize(("sure", "spread"), [("roughly", np.log(3.0)), ("well", np.log(1.5))])
def test_how_sure_somebody_is_is_the_spread(sure: Sure, spread: float) -> None:
    sizes = sizes_for(case_of("axis"), sure)
    assert sizes.spreads[sizes.index("std", "EXX")] == pytest.approx(spread)
    assert sizes.spreads[sizes.index("length", "EXX")] == pytest.approx(min(spread, LENGTH.spread))
    assert sizes.spreads[sizes.index("reversal", "EXX_reversal")] == pytest.approx(min(spread, REVERSAL.spread))
    assert np.log(SURE[sure]) == pytest.approx(spread)


def test_what_is_exact_and_not_usual_leaves_no_size() -> None:
    assert len(sizes_for(case_of("five axes"), "exactly", usual=False)) == 0


def test_one_error_may_be_known_and_another_not() -> None:
    described = case_of("plate").description
    errors = [replace(each, sure="exactly") if each.name == "EZX" else each for each in described.machine.errors]
    plain = replace(described.machine, errors=tuple(errors))
    sizes = sizes_of(plain, described.setups, "roughly", usual=False, inherited=False)
    assert sizes.index("std", "EZX") == sizes.index("length", "EZX") == -1
    assert sizes.index("std", "EZY") >= 0


def test_an_inherited_prior_keeps_its_sizes() -> None:
    """Only rests, what passes, and noises vary then."""
    sizes = sizes_for(case_of("five axes"), inherited=True)
    assert {size.kind for size in sizes.of} == {"rest", "drift", "cycle", "growth", "way", "noise"}


def test_the_table_says_where_its_figures_come_from() -> None:
    causes = [each for each in vars(model).values() if isinstance(each, model.Cause)]
    assert len(causes) == len({cause.name for cause in causes}) == 14
    assert all(cause.source and cause.kernel and cause.size > 0 and cause.factor >= 1 for cause in causes)


mpmath = pytest.importorskip("mpmath")  # untyped: Any

ONE = Sizes((Size("length", ("EXX",), 1.0),))
NEAR = 3.0
"""|x| up to which θ of spread one is not cut: q(3) is 6.6."""


@given(st.floats(-NEAR, NEAR))
def test_theta_is_the_quantile_of_four_degrees(x: float) -> None:
    theta, _ = ONE.theta(np.array([x]))
    # scipy takes the share of nearly one half to 1e-16 only, and its own quantile there to 1e-8
    assert theta[0] == pytest.approx(np.sign(x) * student.isf(norm.sf(abs(x)), 4), rel=1e-9, abs=1e-7)


def test_near_the_median_theta_is_a_line() -> None:
    """θ = x φ(0)/f(0): a digit lost in a difference would show."""
    x = np.array([1e-7, 1e-6, 1e-5, 1e-4])
    np.testing.assert_allclose(ONE.theta(x)[0], x * norm.pdf(0) / student.pdf(0, 4), rtol=1e-7)


@given(st.floats(-NEAR + 0.01, NEAR - 0.01))
def test_slope_is_that_of_differences(x: float) -> None:
    step = 1e-3
    above, below = (ONE.theta(np.array([x + sign * step]))[0][0] for sign in (1, -1))
    assert ONE.theta(np.array([x]))[1][0] == pytest.approx((above - below) / (2 * step), rel=1e-5)


@pytest.mark.parametrize("x", [2.0, 5.0, 8.0, 12.0, 20.0])
def test_tails_are_right_to_many_digits(x: float) -> None:
    """The share beyond θ, an integral with forty digits, is that beyond x."""
    small = Sizes((Size("std", ("EXX",), 1e-30),))
    with mpmath.workdps(40):
        q = mpmath.mpf(float(small.theta(np.array([x]))[0][0])) / mpmath.mpf(1e-30)
        # with t = q/r the integral from q to infinity becomes one from nought to one
        beyond = mpmath.quad(lambda r: mpmath.mpf(3) / 8 * (1 + (q / r) ** 2 / 4) ** -2.5 * q / r**2, [0, 0.5, 1])
        wanted = mpmath.erfc(mpmath.mpf(x) / mpmath.sqrt(2)) / 2
        assert abs(beyond / wanted - 1) < 1e-10


def test_sides_mirror_each_other_and_nought_is_nought() -> None:
    x = np.linspace(0, NEAR, 50)
    np.testing.assert_allclose(ONE.theta(-x)[0], -ONE.theta(x)[0], rtol=1e-14)
    assert ONE.theta(np.zeros(1))[0][0] == 0.0


def test_spread_scales_and_far_out_nothing_overflows() -> None:
    several = Sizes((Size("length", ("EXX", "EYY"), 0.5), Size("noise", ("laser",), 2.0)))
    theta, slope = several.theta(np.array([[1.0, 1.0], [40.0, -40.0]]))
    np.testing.assert_allclose(theta[0], np.array([0.5, 2.0]) * student.ppf(norm.cdf(1.0), 4), rtol=1e-9)
    assert theta[1].tolist() == [7.0, -7.0]
    assert slope[1].tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("kind", "most"),
    [(kind, 10) for kind in ("std", "reversal", "rest", "together", "way")] + [("drift", 30), ("growth", 30)],
)
def test_no_size_is_learnt_far_beyond_what_is_stated(kind: model.Kind, most: float) -> None:
    """Behind that it does not move; a length may be anything, and a noise as wide as a bad reading."""
    theta, slope = Sizes((Size(kind, ("EXX",), np.log(3.0)),)).theta(np.array([[1.0], [9.0], [-9.0]]))
    assert np.exp(theta[:2, 0]).tolist() == [pytest.approx(3.5, rel=0.05), pytest.approx(most)]
    assert theta[2, 0] == -7.0
    assert [bool(each) for each in slope[:, 0]] == [True, False, False]


def test_a_size_is_found_by_kind_and_owner() -> None:
    several = Sizes((Size("std", ("EXX", "EYY"), 0.5), Size("noise", ("laser",), 2.0)))
    assert several.indices("std", ["EYY", "EZZ", "EXX"]).tolist() == [0, -1, 0]
    assert several.index("noise", "EXX") == -1
