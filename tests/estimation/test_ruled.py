"""The verdict on an estimate: drifts and steps widen it, nonsense contradicts it, few readings leave it unchecked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.vouching import defended
from axiscal.estimation.watching import watched_so_far

from axiscal.accuracy.expanded import expanded
from axiscal.campaign.ending import DOES_NOT_FIT, standing
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.inference.outliers import Doubt
from axiscal.simulation import VirtualMachine
from tests.generators.laser_axis import CASE, in_two_rounds, machine, plus, read


def _missed(known: Estimation, machine: VirtualMachine) -> float:
    """Return the RMS that an estimate is wrong by over the travel, a constant taken off, m."""
    poses = np.linspace(0, 1, 200)[:, None]
    sides = np.where(np.arange(200)[:, None] % 2 == 0, 1.0, -1.0)
    left = (machine.deviation(poses, sides) - known.estimate().deviation(poses, sides))[:, 0]
    return float(np.std(left))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_drift_widens_and_what_explains_it_is_taken_off(seed: int) -> None:
    drawn = machine(seed)
    readings = plus(read(drawn, 28), 10e-6 * np.linspace(0, 1, 28))
    model = concluded(CASE, readings)
    known = ruled(model)
    ruling = ruling_of(known)
    assert ruling.verdict == "widened"
    assert ruling.comparison.explanations[0].family in ("drift", "levelling")
    assert ruling.expanded.space >= ruling_of(replace(model, ruling=None)).expanded.space * 0.999
    assert known.accuracy.rms >= model.accuracy.rms
    assert _missed(known, drawn) <= 1.5 * known.accuracy.rms


def test_a_step_between_the_readings_is_within_what_is_promised_then() -> None:
    drawn = machine(4)
    readings = read(drawn, 28)
    stepped = plus(readings, [12e-6 * (each.pose[0] > 0.43) for each in readings])
    known = ruled(concluded(CASE, stepped))
    assert ruling_of(known).verdict == "widened"
    assert ruling_of(known).comparison.explanations[0].family in ("step", "bump")
    assert known.accuracy.rms > concluded(CASE, readings).accuracy.rms


@pytest.mark.parametrize("seed", [1, 3])
def test_a_step_is_not_hidden_by_refusing_the_reading_beside_it(seed: int) -> None:
    """24 readings 40 mm apart, one side on each way: the robust estimate refuses one of them, the verdict does not."""
    drawn = machine(seed)
    stepped = [replace(r, value=r.value + 15e-6 * (r.pose[0] > 0.43)) for r in read(drawn, 24)]
    model = concluded(CASE, stepped)
    known = ruled(model)
    assert ruling_of(known).verdict == "widened"
    assert len(ruling_of(known).readings) == 24


def test_one_slip_is_a_bad_reading_and_no_contradiction() -> None:
    readings = read(machine(2), 40)
    known = ruled(
        concluded(CASE, [replace(readings[10], value=readings[10].value + 60e-6), *readings[:10], *readings[11:]])
    )
    assert ruling_of(known).verdict in ("holds", "unchecked")
    assert len(ruling_of(known).readings) == 39


@pytest.mark.parametrize("shift", [0.0, 60e-6])
def test_the_odds_of_a_verdict_are_those_found_from_its_readings(shift: float) -> None:
    """Of all that can be, whether the verdict compared these or had left a bad one out."""
    readings = read(machine(2), 40)
    known = ruled(concluded(CASE, [replace(readings[10], value=readings[10].value + shift), *readings[:10]]))
    assert watched_so_far(known) == watched_so_far(replace(known, ruling=None))


def test_where_its_neighbour_is_as_likely_the_bad_one_none_is_left_out() -> None:
    """The bad reading was believed, and the good one beside it that contradicts it was doubted."""
    readings = read(machine(2), 40)
    bad = max(range(40), key=lambda index: readings[index].pose)
    beside = max((n for n in range(40) if n != bad), key=lambda index: readings[index].pose)
    taken = [replace(each, value=each.value + 12e-6) if n == bad else each for n, each in enumerate(readings)]
    apart = replace(concluded(CASE, taken), outliers=(Doubt(beside, 6.0, 0.05),), ruling=None)
    ruling = ruling_of(ruled(apart))
    assert ruling.verdict == "widened"
    assert len(ruling.readings) == 40
    assert (ruling.comparison.explanations[0].family, ruling.comparison.explanations[0].place) == ("bad", bad)
    assert sum(ruling.comparison.slips) == pytest.approx(ruling.comparison.explanations[0].odds)


@pytest.mark.long
def test_readings_of_the_model_itself_hold_where_they_could_have_said_otherwise() -> None:
    verdicts = [ruling_of(ruled(concluded(CASE, in_two_rounds(read(machine(seed), 60))))).verdict for seed in range(10)]
    assert verdicts.count("holds") >= 8


def test_few_readings_leave_it_unchecked_and_their_means_as_they_were_and_u_is_of_one_distribution() -> None:
    model = concluded(CASE, read(machine(1), 8))
    known = ruled(model)
    ruling = ruling_of(known)
    assert ruling.verdict == "unchecked"
    assert ruling.defence.u_def > 1.25 * model.accuracy.rms
    assert known.banded is model.banded
    assert known.accuracy.rms <= ruling.standard <= ruling.defence.u_def
    assert 1.96 <= ruling.expanded.factor(ruling.standard) < 2.1  # a little more where places differ


@pytest.mark.parametrize("count", [0, 1, 2])
def test_two_readings_or_less_are_unchecked(count: int) -> None:
    known = ruled(concluded(CASE, read(machine(1), 8)[:count]))
    assert ruling_of(known).verdict == "unchecked"


def test_nonsense_contradicts_every_explanation_and_reaches_no_target() -> None:
    rng, readings = np.random.default_rng(1), read(machine(1), 40)
    nonsense = plus(readings, 60e-6 * rng.standard_cauchy(40))
    known = concluded(CASE, nonsense)
    assert ruling_of(ruled(known)).verdict == "contradicted"
    assert known.accuracy.rms < 3e-6
    assert standing(CASE.description.target, known) == DOES_NOT_FIT


def test_the_verdict_is_the_same_every_time() -> None:
    readings = plus(read(machine(2), 20), 5e-6 * np.linspace(0, 1, 20))
    first, second = (ruled(concluded(CASE, readings)) for _ in range(2))
    assert ruling_of(first).verdict == ruling_of(second).verdict
    assert first.accuracy == second.accuracy


@pytest.mark.parametrize("count", [10, 24])
def test_what_is_said_to_be_open_is_what_the_verdict_is_about_where_the_headline_is_wider(count: int) -> None:
    model = concluded(CASE, read(machine(1), count))
    ruling = ruling_of(ruled(model))
    assert ruling.verdict in ("unchecked", "holds")
    assert ruling.standard > model.accuracy.rms
    assert ruling.defence.promise == model.accuracy.rms
    assert ruling.defence.u_def >= ruling.standard
    assert (ruling.verdict == "unchecked") == ruling.defence.unchecked


@pytest.mark.long
def test_a_promise_that_its_readings_nearly_hold_is_raised_until_they_do_and_no_farther_than_a_fifth() -> None:
    """Else the last digit of a promise would decide. The definition is that of the verdict, by the naive way."""
    raised = []
    for count in range(18, 34, 2):
        model = concluded(CASE, in_two_rounds(read(machine(3), count)))
        own, known = defended(model), ruled(model)
        ruling, promise = ruling_of(known), model.accuracy.rms
        least = max(max(each.damage / 1.25, each.bearable) for each in own.departures if each.counted)
        assert ruling.verdict == ("unchecked" if least > 1.2 * promise else "holds")
        assert known.accuracy.rms == pytest.approx(least if promise < least <= 1.2 * promise else promise)
        assert ruling.raised == pytest.approx(known.accuracy.rms / promise)
        assert (ruling.defence.u_def > 1.25 * known.accuracy.rms) == (least > 1.2 * promise)
        assert (known.banded is model.banded) == (ruling.raised == 1.0)
        if ruling.raised > 1:
            raised.append(model)
    assert raised
    for model in raised:
        known, places = ruled(model), np.linspace(0, 1, 50)[:, None]
        ruling, alone = ruling_of(known), expanded(model.banded.case.yardstick, model.banded.knowledge.belief)
        assert ruling.expanded.space >= ruling.raised * alone.space * (1 - 1e-9)
        assert ruling.standard >= known.accuracy.rms
        assert not ruling.defence.unchecked
        left, right = (each.estimate().deviation(places, np.ones_like(places)) for each in (known, model))
        np.testing.assert_array_equal(left, right)
        wide, narrow = (each.banded.knowledge.belief.covariance for each in (known, model))
        np.testing.assert_allclose(wide, ruling.raised**2 * narrow)
        assert known.accuracy.worst == pytest.approx(ruling.raised * model.accuracy.worst)
