"""What a promise rests on that no reading shows, against dense algebra, drawn machines and another prior."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.accuracy.damage import KAPPA
from axiscal.estimation.defence import Defence, defence
from axiscal.estimation.effect_map import EffectMap
from axiscal.estimation.statements import LeftOpen, Resting, Single, singles

from axiscal.estimation import statements
from axiscal.estimation.case import Case
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.promise.problem import Inherited
from benchmarks.trust.benches import Changes, case_of, visits

UNMEASURED: Changes = (("TOOL", "100 um"),)
SHARE = 0.02


def five_axes(changes: Changes = ()) -> tuple[Case, list[Reading]]:
    """Return five axes under an R-test whose tool is known to 5 um, with a dozen readings anywhere."""
    case, taken = case_of("five axes", "stated", changes), visits("five axes", "stated", "random", 24, 20_269_000)
    return case, [Reading("it", *visit, 0.0, others=(0.0, 0.0), time=60.0 * i) for i, visit in enumerate(taken)]


def vouched(case: Case, taken: list[Reading], stated: Case | None = None) -> Defence:
    """Return what readings can vouch for, of the promise that the case makes of them."""
    promise = case.yardstick.measure(case.knowledge.read(taken).belief).rms
    return defence(case, taken, promise, (stated or case).description.machine)


def rested(found: Defence) -> Resting:
    """Return what a promise rests on."""
    assert found.rests_on is not None
    return found.rests_on


def drawn_errors(case: Case, taken: list[Reading], count: int) -> tuple[Array, Array, float]:
    """Return squares of what is left over the volume of machines, (count,), with and without their single unknowns.

    With them the mean square that is left, model and single unknowns. By the dense matrices: truth − estimate of
    y = G a + v for drawn a, the constant shift that is not counted off.
    """
    numbers, yardstick = ReadingSet(case.observation, taken), case.yardstick
    prior, rows, size = case.prior.covariance, numbers.rows, case.errors.size
    features = numbers.features(case.errors.prior_root())
    covariance = features @ features.T + np.diag(numbers.noise + numbers.extra_variance)
    gain = prior @ rows.T @ np.linalg.inv(covariance)
    columns = np.array([each.column for each in stated_singles(case)]).T
    left = (columns - gain @ (rows @ columns))[:size]
    beside = (prior - gain @ rows @ prior)[:size, :size] - left @ left.T
    values, vectors = np.linalg.eigh((beside + beside.T) / 2)
    rng = np.random.default_rng(0)
    others = (vectors * np.sqrt(np.maximum(values, 0.0))) @ rng.standard_normal((size, count))
    single = left @ rng.standard_normal((left.shape[1], count))

    def square(x: Array) -> Array:
        squares: Array = np.sum((yardstick.root.matrix @ x) ** 2, axis=0) - np.sum((yardstick.shifts @ x) ** 2, axis=0)
        return squares

    return square(others + single), square(others), float(np.sum(square(left)))


def test_a_promise_that_an_unmeasured_tool_hides_behind_is_not_vouched_for() -> None:
    found = vouched(*five_axes(UNMEASURED))
    assert found.rests
    assert found.unchecked
    assert not found.leaves
    assert found.u_def == rested(found).bearable > found.promise
    assert (round(found.promise * 1e6, 1), round(found.u_def * 1e6, 1)) == (17.4, 23.2)
    assert (round(rested(found).share, 2), round(rested(found).hidden, 3)) == (0.66, 0.095)
    assert [each.name for each in rested(found).named] == ["Z0B"]
    (shown_by,) = rested(found).shown_by
    assert (shown_by.name, shown_by.owner) == ("tool_z", "tool")
    assert shown_by.std == pytest.approx(100e-6)


def test_a_tool_that_was_measured_closely_leaves_the_promise_as_it_is() -> None:
    found = vouched(*five_axes((("TOOL", "2 um"),)))
    assert not found.unchecked
    assert found.u_def == found.promise
    assert rested(found).bearable < found.promise
    assert (round(found.promise * 1e6, 1), round(rested(found).share, 2)) == (9.6, 0.13)
    assert round(rested(found).hidden, 3) == 0.019


def test_one_that_was_measured_roughly_is_what_most_of_a_promise_rests_on() -> None:
    found = vouched(*five_axes())
    assert found.rests
    assert (round(found.promise * 1e6, 1), round(found.u_def * 1e6, 1)) == (11.7, 13.0)
    assert (round(rested(found).share, 2), round(rested(found).hidden, 3)) == (0.42, 0.047)
    assert [each.name for each in rested(found).named] == ["tool_y", "tool_x"]
    assert rested(found).shown_by == rested(found).named


def test_what_exact_values_would_take_away_is_what_another_prior_leaves() -> None:
    case, taken = five_axes()
    exact, open_ones = five_axes((("TOOL", "0.001 um"),))[0], rested(vouched(case, taken))
    known = {"tool_x", "tool_y", "tool_z"}
    found = left_by(case, case, taken)[0]
    which = [i for i, each in enumerate(stated_singles(case)) if each.statement.name in known]
    before, after = (case.yardstick.steady.value(each.knowledge.read(taken).belief.factor) for each in (case, exact))
    assert statements._gain(found, which) == pytest.approx(before - after, rel=1e-4)
    assert {each.name for each in open_ones.shown_by} <= known


@pytest.mark.long
@pytest.mark.parametrize("changes", [(), UNMEASURED])
def test_one_machine_in_fifty_is_worse_than_what_is_borne(changes: Changes) -> None:
    case, taken = five_axes(changes)
    found = vouched(case, taken)
    squares, without, effect = drawn_errors(case, taken, 100_000)
    assert rested(found).effect ** 2 == pytest.approx(effect, rel=1e-6)
    truth, known = (np.sqrt(each + found.promise**2 - np.mean(squares)) for each in (squares, without))

    def spoilt(promise: float) -> float:
        return float(np.mean(truth > KAPPA * promise) - np.mean(known > KAPPA * promise))

    assert spoilt(found.promise) == pytest.approx(rested(found).hidden, abs=0.003)
    assert spoilt(rested(found).bearable) == pytest.approx(SHARE, abs=0.002)
    assert found.rests == (spoilt(found.promise) > SHARE)


def test_what_is_borne_does_not_depend_on_what_a_wider_model_promises() -> None:
    case, taken = five_axes(UNMEASURED)
    for promise, rests in ((15.0e-6, True), (40.0e-6, False)):
        found = defence(case, taken, promise, case.description.machine)
        assert found.rests is rests
        assert found.u_def == max(promise, rested(found).bearable)


def test_a_constant_shift_that_nobody_sees_is_not_what_a_promise_rests_on() -> None:
    case, taken = case_of("axis", "stated"), visits("axis", "stated", "even", 24, 1)
    readings = [Reading("it", *visit, 0.0, time=60.0 * i) for i, visit in enumerate(taken)]
    assert rested(vouched(case, readings)).share < 1e-3


def test_larger_statements_are_as_another_prior_makes_them() -> None:
    case, taken = five_axes(UNMEASURED)
    large = five_axes((*UNMEASURED, ('{ std = "15 um" }', '{ std = "30 um" }')))[0]
    left, times = left_by(case, case, taken)
    turned = left.with_stds(times)
    wanted = left_by(large, case, taken)[0]
    np.testing.assert_allclose(turned.fields, wanted.fields, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(turned.seen, wanted.seen, rtol=1e-6, atol=1e-9)


def stated_singles(case: Case) -> list[Single]:
    """Return the single unknowns of a case."""
    root = case.errors.prior_root()
    return list(singles(case.observation, root @ root.T, case.description.machine))


def left_by(case: Case, measuring: Case, taken: list[Reading]) -> tuple[LeftOpen, Array]:
    """Return what readings leave of single unknowns, and twice for every axis line, once for all else.

    measuring : the case over whose volume
    """
    root, numbers = case.errors.prior_root(), ReadingSet(case.observation, taken)
    found = stated_singles(case)
    columns = np.array([each.column for each in found]).T
    features = numbers.features(root)
    effects = EffectMap(
        measuring.yardstick, features, np.sqrt(numbers.noise + numbers.extra_variance), np.zeros((1, features.shape[1]))
    )
    times = np.array([2.0 if each.statement.name in ("X0B", "Z0B", "X0C", "Y0C") else 1.0 for each in found])
    return effects.left_open(numbers.rows @ columns, root, columns[: len(root)]), times


def test_what_was_learnt_of_other_errors_says_nothing_of_what_nobody_read() -> None:
    case, taken = five_axes(UNMEASURED)
    machine = case.description.machine
    smaller = replace(machine, errors=tuple(replace(each, std=each.std / 3) for each in machine.errors))
    learnt = Case(replace(case.description, machine=smaller))
    found, own = vouched(learnt, taken, case), vouched(learnt, taken)
    assert rested(found).effect == pytest.approx(rested(vouched(case, taken)).effect, rel=0.01)
    assert rested(own).effect < 0.5 * rested(found).effect
    assert rested(own).bearable < 0.5 * rested(found).bearable


def test_what_an_earlier_campaign_has_read_is_no_statement() -> None:
    case = five_axes(UNMEASURED)[0]
    size, root, at = case.errors.size, case.errors.prior_root(), case.errors.names["Z0B"].columns.start
    for left in (1.0, 0.1):
        inherited = Case(case.description, Inherited(np.zeros(size), left * root @ root.T))
        every = singles(inherited.observation, left * root @ root.T, case.description.machine)
        found = next(each for each in every if each.statement.name == "Z0B")
        assert found.column[at] == pytest.approx(15e-6 * left)
        assert found.times == 1.0
