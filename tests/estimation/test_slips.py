"""What one bad reading does that nothing contradicts: against plain predictions, and on machines with one in them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from axiscal.accuracy.damage import KAPPA
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.defence import OPEN, defence
from axiscal.estimation.effect_map import LARGEST_SHIFT, EffectMap
from axiscal.estimation.estimate import concluded
from axiscal.estimation.ruled import ruled
from axiscal.estimation.slips import Slip
from axiscal.inference.reading_set import ReadingSet
from axiscal.measurement.reading import Reading
from axiscal.planning.vouched import departure_rows, vouched_words
from axiscal.simulation import Simulator
from tests.estimation.test_defence import axis, of, readings
from tests.generators.laser_axis import MACHINE

SHOWN = 15.365
"""Noncentrality that a test of one in 120 shows with 90 %."""


def slip_of(case: Case, taken: list[Reading]) -> Slip:
    """Return what one bad reading does."""
    slip = of(case, taken, 1e-6).slip
    assert slip is not None
    return slip


def far_apart() -> list[Reading]:
    """Return readings out and back of which the last of the way out is far from the others."""
    taken = [each for each in readings(24) if each.pose[0] < 0.85]
    lonely = Reading("laser", (0.98,), (1,), 0.0, time=12 * 60.0 + 30.0)
    return sorted([*taken, lonely], key=lambda each: each.time or 0.0)


def test_damage_and_size_are_those_of_predicting_a_reading_by_all_others() -> None:
    case, taken = axis(), far_apart()
    slip, root = slip_of(case, taken), case.errors.prior_root()
    for index in range(len(taken)):
        others = [*taken[:index], *taken[index + 1 :]]
        numbers = ReadingSet(case.observation, [*others, taken[index]])
        k = (features := numbers.features(root)) @ features.T + np.diag(numbers.noise + numbers.extra_variance)
        v = k[-1, -1] - k[-1, :-1] @ np.linalg.solve(k[:-1, :-1], k[:-1, -1])
        risen = EffectMap.of(case, others).remaining - EffectMap.of(case, taken).remaining
        squared = min(SHOWN * v / (KAPPA**2 - 1), LARGEST_SHIFT**2) * risen / v
        assert slip.damages[index] == pytest.approx(math.sqrt(squared), rel=1e-3)
        if index == slip.index:
            assert slip.size == pytest.approx(min(math.sqrt(SHOWN * v), LARGEST_SHIFT), rel=1e-3)


def test_it_is_the_reading_that_stands_alone() -> None:
    slip = slip_of(axis(), far_apart())
    assert slip.reading.pose == (0.98,)
    assert slip.damages[slip.index] > 2 * np.sort(slip.damages)[-2]


def test_nothing_is_believed_where_each_place_is_read_twice() -> None:
    case, once = axis(), far_apart()
    twice = [replace(each, time=(each.time or 0.0) + shift) for each in once for shift in (0.0, 20.0)]
    promises = [case.yardstick.rms_of(EffectMap.of(case, each).remaining) for each in (once, twice)]
    found = [of(case, each, promise) for each, promise in zip((once, twice), promises, strict=True)]
    assert found[0].believed >= 1
    assert found[1].believed == 0
    assert "believed" in vouched_words(case, found[0])
    assert "believed" not in vouched_words(case, found[1])


def test_how_many_are_believed_goes_with_the_promise() -> None:
    found = of(axis(), far_apart(), 1e-6)
    assert found.slip is not None
    for promise in (0.3e-6, 0.5e-6, 1e-6):
        believed = replace(found, promise=promise).believed
        assert believed == sum(each > OPEN * promise for each in found.slip.damages)
    assert of(axis(), readings(2), 1e-6).believed == 0


def test_a_bad_reading_that_is_believed_was_named_before() -> None:
    """Half of the size that is just shown: nothing contradicts it, and the sentence says which it might be."""
    case, taken = axis(), far_apart()
    slip = slip_of(case, taken)
    machine, rng = Simulator(case.description.machine, case.description.setups).drawn(4), np.random.default_rng(4)
    setup, wrong = case.description.setups[0], 0.5 * slip.size
    read = [replace(each, value=machine.read(setup, each.pose, each.approach, rng)) for each in taken]
    read[slip.index] = replace(read[slip.index], value=read[slip.index].value + wrong)
    known = ruled(concluded(case, read))
    assert not known.outliers
    found = defence(case, read, known.accuracy.rms, case.description.machine)
    assert "at X = 980 mm" in vouched_words(case, found)


def test_a_bad_one_is_a_row_that_does_not_count() -> None:
    case = axis()
    found = of(case, far_apart(), 1e-6)
    (row,) = [each for each in departure_rows(case, found) if each["name"].startswith("bad")]
    assert row["name"] == "bad laser"
    assert not row["counted"]
    assert found.u_def == max([1e-6, *(each.least for each in found.departures if each.family != "bad")])


def test_readings_of_three_numbers_are_bad_as_one() -> None:
    text = 'machine = "m"\n[target]\nreadings = 9\n[[setups]]\nname = "it"\ninstrument = "tracker"\nnoise = "2 um"\n'
    text += 'station = ["500 mm", "-1500 mm", "0 mm"]\n'
    case = Case(campaign_from_texts(text, "c.toml", MACHINE, "m"))
    taken = [
        Reading("it", (x,), (1,), 0.0, others=(0.0, 0.0), time=60.0 * n) for n, x in enumerate(np.linspace(0, 1, 9))
    ]
    assert len(slip_of(case, taken).damages) == 9
