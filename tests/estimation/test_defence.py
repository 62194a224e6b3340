"""What readings can vouch for, against simulated campaigns, plain matrices and the estimate's own algebra."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from axiscal.accuracy.damage import FALSE_ALARM, KAPPA, hidden
from axiscal.estimation.defence import Defence, defence, vouched
from axiscal.estimation.departed_volume import field
from axiscal.estimation.effect_map import EffectMap, largest
from axiscal.estimation.vouching import defended
from axiscal.measurement.departures import IN_PLANS, Departure, departures
from scipy import stats

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.knowledge import Knowledge, block
from axiscal.inference.weighted_fit import Fitted
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.simulation import Simulator
from tests.generators.laser_axis import MACHINE, closed

CAMPAIGN = """machine = "m"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "both"
drift = "0 um/h"
"""


OF_A_ZERO = ("drift", "levelling", "excursion")
"""Families whose size is what a zero moves by over a set-up."""


def axis() -> Case:
    """Return an axis of a metre with a laser whose zero is open by a millimetre."""
    return Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m"))


def of(case: Case, taken: Sequence[Reading], promise: float) -> Defence:
    """Return what readings of a machine as it is stated vouch for."""
    return defence(case, taken, promise, case.description.machine)


def readings(count: int = 20, seconds: float = 60.0) -> list[Reading]:
    """Return readings out and back, uneven, so many seconds apart."""
    along = np.linspace(0.01, 0.99, count) + 4e-3 * np.sin(np.arange(count))
    out, back = along[::2], along[1::2][::-1]
    places = [(float(x), 1) for x in out] + [(float(x), -1) for x in back]
    return [Reading("laser", (x,), (side,), 0.0, time=seconds * i) for i, (x, side) in enumerate(places)]


def of_family(family: str, taken: list[Reading], place: int = 0) -> Departure:
    """Return one departure of a family, the one at this place in its list."""
    return [each for each in departures(axis().observation, taken, IN_PLANS) if each.family == family][place]


def with_values(taken: list[Reading], values: Array) -> list[Reading]:
    """Return readings with other values."""
    return [replace(reading, value=float(value)) for reading, value in zip(taken, values, strict=True)]


@pytest.mark.parametrize(
    ("family", "place"),
    [
        ("drift", 0),
        ("levelling", 0),
        ("excursion", 0),
        ("growth", 0),
        ("step", 1),
        ("step", 4),
        ("bump", 10),
        ("reversal", 2),
    ],
)
def test_the_power_is_that_of_twenty_thousand_campaigns(family: str, place: int) -> None:
    case, taken = axis(), readings()
    departure = of_family(family, taken, place)
    column = departure.columns[:, 0] / (np.ptp(departure.columns) if departure.family in OF_A_ZERO else 1.0)
    covariance = Fitted.of(case.observation, taken).covariance()
    effect, promise = EffectMap.of(case, taken).each([departure])[0], 0.8e-6
    size = math.sqrt((KAPPA**2 - 1) / effect.wrong) * promise
    drawn = np.random.default_rng(1).standard_normal((20_000, len(column))) @ np.linalg.cholesky(covariance).T
    contrast = np.linalg.solve(covariance, column)
    statistic = ((drawn + size * column) @ contrast) ** 2 / (column @ contrast)
    seen = float(np.mean(statistic > stats.chi2.isf(FALSE_ALARM, 1)))
    assert effect.power(promise) == pytest.approx(seen, abs=0.01)


@pytest.mark.parametrize(
    ("family", "place"), [("drift", 0), ("excursion", 0), ("growth", 1), ("step", 4), ("bump", 10), ("reversal", 2)]
)
def test_information_and_error_are_what_the_estimate_makes_of_such_readings(family: str, place: int) -> None:
    case, taken = axis(), readings()
    departure = of_family(family, taken, place)
    column = departure.columns[:, 0] / (np.ptp(departure.columns) if departure.family in OF_A_ZERO else 1.0)
    after = block(Knowledge(case.observation, case.prior), with_values(taken, column), np.ones(len(taken)))
    (effect,) = EffectMap.of(case, taken).each([departure])
    information = float(sum(each.chi_square for each in after.innovations))
    assert effect.information[0, 0] == pytest.approx(information, rel=1e-9)
    if departure.function is None:
        left = case.yardstick.root.of(after.after.belief.mean)
        assert effect.wrong == pytest.approx(float(np.sum(left**2)), rel=1e-9)


def test_what_a_step_leaves_over_the_volume_is_its_own_integral() -> None:
    case, taken = axis(), readings()
    departure = of_family("step", taken, 4)
    after = Knowledge(case.observation, case.prior).read(with_values(taken, departure.columns[:, 0]))
    function = case.errors.functions[0]
    at = (np.arange(20_000) + 0.5) / 20_000
    left = (at > departure.place) - function.basis.rows(at) @ after.belief.mean[function.columns]
    if case.yardstick.zeroed[0]:
        left = left - left.mean()
    reversal = after.belief.mean[case.errors.functions[1].columns][0] / 2
    wrong = float(np.mean(left**2)) + reversal**2
    assert EffectMap.of(case, taken).each([departure])[0].wrong == pytest.approx(wrong, rel=0.01)


PLATE = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "300 mm"]
[errors]
EZX = { std = "10 um", knots = 5 }
EZY = { std = "10 um", knots = 5 }
"""
ALIGNED = """machine = "m"
[target]
readings = 20
aligned = true
[[setups]]
name = "probe"
instrument = "probe"
direction = "z"
reach = { X = ["0 mm", "400 mm"], Y = ["0 mm", "300 mm"] }
"""


@pytest.mark.parametrize("family", ["step", "together"])
def test_aligning_a_part_takes_no_more_of_a_departure_than_its_rigid_motion(family: str) -> None:
    """Judged by the departure itself on a fine grid, its own plane taken off by least squares."""
    case = Case(campaign_from_texts(ALIGNED, "c.toml", PLATE, "m"))
    lines = [low + (high - low) * (np.arange(100) + 0.5) / 100 for low, high in case.description.target.volume]
    grid = np.stack([part.ravel() for part in np.meshgrid(*lines)], axis=1)
    taken = [Reading("probe", (float(x), float(y)), (1, 1), 0.0) for x, y in grid]
    first = next(each for each in departures(case.observation, taken[::97], IN_PLANS) if each.family == family)
    same = [each for each in departures(case.observation, taken, IN_PLANS) if each.family == family]
    (shown,) = [each.columns[:, 0] for each in same if (each.owner, each.place) == (first.owner, first.place)]
    plane = np.column_stack([np.ones(len(grid)), grid])
    left = shown - plane @ np.linalg.lstsq(plane, shown, rcond=None)[0]
    followed, beside = field(case.yardstick, first)
    assert float(np.sum(followed**2)) + beside == pytest.approx(float(np.mean(left**2)), rel=0.03)


def test_the_damage_does_not_depend_on_the_promise() -> None:
    case, taken = axis(), closed(readings())
    some, others = (of(case, taken, promise) for promise in (0.5e-6, 5e-6))
    named = [{(each.family, each.owner): each.damage for each in found.departures} for found in (some, others)]
    assert named[0] == named[1]
    assert others.u_def == 5e-6
    assert others.weakest is None
    assert some.weakest is not None
    assert some.u_def == some.weakest.least > 0.5e-6


def test_readings_once_along_vouch_for_less_than_out_and_back() -> None:
    case, back = axis(), readings()
    along = sorted(back, key=lambda reading: reading.pose)
    along = [replace(reading, time=60.0 * i) for i, reading in enumerate(along)]
    damage = [
        next(each.damage for each in of(case, taken, 0.5e-6).departures if each.family == "drift")
        for taken in (along, back)
    ]
    assert damage[0] > 5e-6
    assert damage[1] < 1.2e-6


def test_two_readings_vouch_for_nothing() -> None:
    found = of(axis(), readings()[:2], 0.5e-6)
    assert found.u_def > 5e-6
    assert found.departures[0].power == 0.0


def test_a_reading_that_is_rejected_vouches_for_nothing() -> None:
    case = axis()
    truth = Simulator(case.description.machine, case.description.setups).drawn(2)
    rng, setup = np.random.default_rng(2), case.description.setups[0]
    taken = [replace(r, value=truth.read(setup, r.pose, r.approach, rng)) for r in readings()]
    taken[7] = replace(taken[7], value=taken[7].value + 60e-6)
    found = defended(concluded(case, taken))
    assert found.readings == len(taken) - 1
    assert found.promise <= found.u_def


def _gapped(low: float, high: float) -> list[Reading]:
    """Return the usual readings without those of a gap."""
    return [each for each in readings(28) if not low < each.pose[0] < high]


def test_what_stays_hidden_is_the_share_of_twenty_thousand_campaigns() -> None:
    case, taken = axis(), _gapped(0.4, 0.62)
    steps = [each for each in departures(case.observation, taken, IN_PLANS) if each.family == "step"]
    effects, promise, std = EffectMap.of(case, taken).each(steps), 1.2e-6, 10e-6
    covariance = Fitted.of(case.observation, taken).covariance()
    rng, lower = np.random.default_rng(2), np.linalg.cholesky(covariance)
    which, size = rng.integers(len(steps), size=20_000), std * rng.standard_normal(20_000)
    contrasts = np.stack([np.linalg.solve(covariance, each.columns[:, 0]) for each in steps])
    columns = np.stack([each.columns[:, 0] for each in steps])
    drawn = rng.standard_normal((20_000, len(taken))) @ lower.T + size[:, None] * columns[which]
    statistic = np.sum(drawn * contrasts[which], axis=1) ** 2 / np.sum(columns * contrasts, axis=1)[which]
    worse = size**2 * np.array([each.wrong for each in effects])[which] > (KAPPA**2 - 1) * promise**2
    unseen = float(np.mean(worse & (statistic <= stats.chi2.isf(FALSE_ALARM, 1))))
    assert unseen > 0.02
    assert hidden(effects, std, promise) == pytest.approx(unseen, abs=0.005)


def test_a_gap_leaves_a_promise_unchecked_that_every_place_on_average_would_defend() -> None:
    case, taken = axis(), closed(_gapped(0.4, 0.62))
    average = vouched(case.observation, taken, EffectMap.of(case, taken), 1.3e-6)
    whole, gapped = (of(case, each, 1.3e-6) for each in (closed(readings(28)), taken))
    assert average.u_def <= 1.25 * average.promise
    assert not average.unchecked
    assert gapped.unchecked
    assert gapped.hides
    assert not whole.unchecked


def test_what_readings_with_a_gap_vouch_for_is_what_the_gap_spoils_unseen_in_one_of_twenty() -> None:
    case, taken = axis(), closed(_gapped(0.4, 0.62))
    found = of(case, taken, 1.3e-6)
    assert found.u_def > 1.3e-6
    assert of(case, taken, 1.001 * found.u_def).u_def == pytest.approx(1.001 * found.u_def)
    assert not of(case, taken, 1.001 * found.u_def).hides
    assert of(case, taken, 0.999 * found.u_def).hides
    assert found.weakest is not None
    assert found.weakest.bearable == found.u_def
    assert found.weakest.hidden > 0.05


def test_a_curve_that_was_found_small_does_not_make_steps_in_a_gap_small() -> None:
    case, taken = axis(), _gapped(0.4, 0.62)
    machine = case.description.machine
    larger = replace(machine, errors=tuple(replace(each, std=4 * each.std) for each in machine.errors))
    own, stated = (defence(case, taken, 3e-6, each) for each in (machine, larger))
    shares = [next(each.hidden for each in found.departures if each.family == "step") for found in (own, stated)]
    assert shares[1] > 2 * shares[0]


def test_departures_together_do_what_each_does_alone() -> None:
    case, taken = axis(), readings()
    several = [each for each in departures(case.observation, taken, IN_PLANS) if each.family != "bad"]
    assert {each.columns.shape[1] for each in several} >= {1, 2}
    effects = EffectMap.of(case, taken)
    for departure, together in zip(several, effects.each(several), strict=True):
        (alone,) = effects.each([departure])
        np.testing.assert_allclose(together.information, alone.information, rtol=1e-10, atol=1e-12)
        assert together.most == alone.most
        assert together.wrong == pytest.approx(alone.wrong, rel=1e-9)
        assert together.damage == pytest.approx(alone.damage, rel=1e-9)


@pytest.mark.parametrize("left", [readings(), [each for each in readings(30) if not 0.3 < each.pose[0] < 0.6]])
def test_departures_come_with_the_most_damaging_first(left: list[Reading]) -> None:
    case = axis()
    found = of(case, left, 1e-6).departures
    least = [max(each.damage, each.bearable) for each in found]
    assert len(set(least)) > 3
    assert least == sorted(least, reverse=True)
    plain = vouched(case.observation, left, EffectMap.of(case, left), 1e-6).departures
    assert [each.damage for each in plain] == sorted((each.damage for each in plain), reverse=True)


@pytest.mark.parametrize(
    ("std", "sizes"),
    [
        (10e-6, {"drift": 20e-6, "step": 10e-6, "bump": 10e-6, "pitch": 5e-6, "reversal": 6e-6}),
        (3e-6, {"drift": 20e-6, "step": 3e-6, "bump": 3e-6, "pitch": 3e-6, "reversal": 6e-6}),
    ],
)
def test_no_departure_is_taken_for_larger_than_it_may_be(std: float, sizes: dict[str, float]) -> None:
    """A pitch not than a ground screw has, a reversal not than two of its std (3 um), others not than their curve."""
    text = MACHINE.replace('EXX = { std = "10 um"', f'EXX = {{ std = "{std * 1e6:g} um"')
    case = Case(campaign_from_texts(CAMPAIGN, "c.toml", text, "m"))
    every = departures(case.observation, readings(), IN_PLANS)
    found = {each.family: largest(case.errors, each) for each in every if each.family in sizes}
    assert found == pytest.approx(sizes)
