"""What one bad reading does that nothing contradicts: against plain predictions, and on machines with one in them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from axiscal.planning.vouched import departure_rows, vouched_words

from axiscal.accuracy.damage import KAPPA
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.defence import OPEN
from axiscal.estimation.effect_map import LARGEST_SHIFT, EffectMap
from axiscal.estimation.estimate import concluded
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.slips import Slip
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.simulation import Simulator
from tests.estimation.test_defence import axis, of, readings
from tests.generators.laser_axis import MACHINE

TRACKER = """machine = "m"
[target]
readings = 9
[[setups]]
name = "it"
instrument = "tracker"
station = ["500 mm", "-1500 mm", "0 mm"]
noise = "2 um"
"""
SHOWN = 15.365
"""Noncentrality that a test of one in 120 shows with 90 %."""


def slips_of(case: Case, taken: list[Reading]) -> tuple[Slip, ...]:
    """Return what each reading does where it is bad, the most harmful first."""
    return of(case, taken, 1e-6).slips


def far_apart() -> list[Reading]:
    """Return readings out and back of which the last of the way out is far from the others."""
    taken = [each for each in readings(24) if each.pose[0] < 0.85]
    lonely = Reading("laser", (0.98,), (1,), 0.0, time=12 * 60.0 + 30.0)
    return sorted([*taken, lonely], key=lambda each: each.time or 0.0)


def left_out(case: Case, taken: list[Reading], index: int) -> tuple[Array, Array]:
    """Return the covariance of the numbers of a reading as the others predict them, and what each of them holds of J.

    By numpy from the covariance of all numbers; the second as a matrix: what J rises by without a direction.
    """
    others = [*taken[:index], *taken[index + 1 :]]
    count, numbers = len(taken[index].values), ReadingSet(case.observation, [*others, taken[index]])
    features = numbers.features(case.errors.prior_root())
    k = features @ features.T + np.diag(numbers.noise + numbers.extra_variance)
    rest, own = k[:-count, :-count], k[-count:, -count:]
    weights = np.linalg.solve(rest, k[:-count, -count:])
    over = case.yardstick.root.of(case.errors.prior_root())
    to_curve = over @ features[:, : over.shape[1]].T
    gain = to_curve[:, -count:] - to_curve[:, :-count] @ weights
    return own - k[-count:, :-count] @ weights, gain.T @ gain


def test_damage_and_size_are_those_of_predicting_a_reading_by_all_others() -> None:
    case, taken = axis(), far_apart()
    for slip in slips_of(case, taken):
        (v,), (n,) = (part.ravel() for part in left_out(case, taken, taken.index(slip.reading)))
        risen = n / v
        others = [each for each in taken if each is not slip.reading]
        assert risen == pytest.approx(
            EffectMap.of(case, others).remaining - EffectMap.of(case, taken).remaining, rel=1e-3
        )
        squared = min(SHOWN * v / (KAPPA**2 - 1), LARGEST_SHIFT**2) * risen / v
        assert slip.harm.damage == pytest.approx(math.sqrt(squared), rel=1e-3)
        assert slip.harm.seen_from == pytest.approx(math.sqrt(SHOWN * v), rel=1e-3)


def test_readings_of_three_numbers_are_bad_in_the_direction_that_harms_most() -> None:
    case = Case(campaign_from_texts(TRACKER, "c.toml", MACHINE, "m"))
    places = enumerate(np.linspace(0, 1, 9).tolist())
    taken = [Reading("it", (x,), (1,), 0.0, others=(0.0, 0.0), time=60.0 * n) for n, x in places]
    rng = np.random.default_rng(0)
    for slip in slips_of(case, taken):
        v, n = left_out(case, taken, taken.index(slip.reading))
        inverse = np.linalg.inv(v)
        ways = rng.standard_normal((4000, 3))
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        seen = np.einsum("ij,jk,ik->i", ways, inverse, ways)
        wrong = np.einsum("ij,jk,ik->i", ways, inverse @ n @ inverse, ways)
        drawn = SHOWN / (KAPPA**2 - 1) * wrong / seen
        assert slip.harm.information[0, 0] > 0
        uncapped = SHOWN / (KAPPA**2 - 1) * slip.harm.wrong / slip.harm.information[0, 0]
        assert 0.99 * uncapped <= drawn.max() <= uncapped * (1 + 1e-6)


def test_it_is_the_reading_that_stands_alone() -> None:
    first, second, *_ = slips_of(axis(), far_apart())
    assert first.reading.pose == (0.98,)
    assert first.harm.damage > 2 * second.harm.damage


def test_nothing_is_believed_where_each_place_is_read_twice() -> None:
    case, once = axis(), far_apart()
    twice = [replace(each, time=(each.time or 0.0) + shift) for each in once for shift in (0.0, 20.0)]
    promises = [case.yardstick.rms_of(EffectMap.of(case, each).remaining) for each in (once, twice)]
    found = [of(case, each, promise) for each, promise in zip((once, twice), promises, strict=True)]
    assert replace(found[0], u_def=promises[0]).believed[0].reading.pose == (0.98,)
    assert not replace(found[1], u_def=promises[1]).believed


def test_how_many_are_believed_goes_with_what_can_be_vouched_for() -> None:
    found = of(axis(), far_apart(), 1e-6)
    for vouched in (0.3e-6, 0.5e-6, 1e-6):
        believed = replace(found, u_def=vouched).believed
        assert list(believed) == [each for each in found.slips if each.harm.damage > OPEN * vouched]
    assert of(axis(), readings(2), 1e-6).slips == ()


def test_of_more_readings_than_are_looked_at_none_is_accused() -> None:
    """A twin that was left out would contradict it."""
    many = [replace(each, time=60.0 * n) for n, each in enumerate(readings(401))]
    assert of(axis(), many, 1e-6).slips == ()
    assert len(of(axis(), many[:400], 1e-6).slips) == 400


@pytest.mark.parametrize(("share", "found"), [(0.4, False), (1.5, True)])
def test_a_bad_reading_is_believed_below_the_size_that_is_said_and_found_above(share: float, found: bool) -> None:
    case, taken = axis(), far_apart()
    first = slips_of(case, taken)[0]
    index, size = taken.index(first.reading), first.harm.seen_from
    machine, rng = Simulator(case.description.machine, case.description.setups).drawn(4), np.random.default_rng(4)
    read = [
        replace(each, value=machine.read(case.description.setups[0], each.pose, each.approach, rng)) for each in taken
    ]
    read[index] = replace(read[index], value=read[index].value + share * size)
    assert ruling_of(ruled(concluded(case, read))).comparison.contradicted == found


def test_it_is_said_where_and_up_to_which_size() -> None:
    case, taken = axis(), far_apart()
    found = of(case, taken, 1e-6)
    first, second, *_ = found.slips
    above = math.sqrt(first.harm.damage * second.harm.damage) / OPEN
    size = f"{1e6 * first.harm.seen_from:.2g} um"
    one = vouched_words(case, replace(found, u_def=above))
    assert one.endswith(
        f"1 of the {len(taken)} readings would be believed if it were bad, the one at X = 980 mm: it is surely shown "
        f"only where it is off by more than {size}. One beside it, or the same once more, would show that one of both "
        "is wrong."
    )
    more = vouched_words(case, replace(found, u_def=0.1e-6))
    assert "readings would be believed if they were bad. The one at X = 980 mm would do most harm: it is surely" in more
    assert "believed" not in vouched_words(case, replace(found, u_def=1e-3))


def test_a_bad_one_of_each_set_up_is_a_row_that_does_not_count() -> None:
    case = axis()
    found = of(case, far_apart(), 1e-6)
    (row,) = [each for each in departure_rows(case, found) if each["name"].startswith("bad")]
    first = found.slips[0].harm
    assert row["name"] == "bad laser"
    assert row["unit"] == "um"
    assert not row["counted"]
    assert row["damage_um"] == pytest.approx(1e6 * first.damage, rel=1e-5)
    assert row["seen_from_um"] == pytest.approx(1e6 * first.seen_from, rel=1e-5)
    assert found.u_def == max([1e-6, *(each.least for each in found.departures if each.family != "bad")])
