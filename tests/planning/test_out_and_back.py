"""A set-up that moves one axis is read out and back: what a drift hides, and what the way back costs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge, block
from axiscal.machine import load_machine
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.order import in_order, seconds_each
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.renewal import renewed
from axiscal.planning.plan.task import Limits, Task
from tests.generators.designs import in_one_round, levered

CAMPAIGN = """machine = "one-axis"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
approach = "{approach}"
"""
DRIFT = 20e-6
NEEDED = 15.365
"""λ of a χ² of one degree that is seen with 90 % at a false alarm of 0.05/6 (scipy agrees below)."""
FALSE = 0.05 / 6


@cache
def one_axis(approach: str = "both") -> tuple[Case, Task]:
    """Return the built-in axis with a laser, and what is to be planned of it."""
    text = CAMPAIGN.format(approach=approach)
    case = Case(campaign_from_texts(text, "campaign.toml", load_machine("one-axis").text, "one-axis"))
    return case, posed(case, case.knowledge)


@cache
def planned(task: Task) -> Places:
    """Return the twenty places that leave least, in the order of the way."""
    return make_plan(task, Limits(readings=20), bounded=False).places


def once_along(places: Places) -> Places:
    """Return the same places from one end to the other."""
    return places.within(np.argsort(places.poses[:, 0]))


def minutes(task: Task, places: Places) -> Array:
    """Return when each reading is taken, s, mounting apart."""
    each = seconds_each(task, places)
    ends: Array = np.cumsum(each) - each[0]
    return ends


def seen_and_left(case: Case, task: Task, places: Places, values: Array) -> tuple[float, Array]:
    """Return the χ² of what readings of such values show against the model, and the curve that they leave, (w,) m."""
    readings = [
        Reading("laser", tuple(pose), tuple(side), value)
        for pose, side, value in zip(places.poses.tolist(), places.approaches.astype(int), values, strict=True)
    ]
    after = block(Knowledge(case.observation, case.prior), readings, np.ones(len(readings), dtype=bool))
    chi = float(sum(each.chi_square for each in after.innovations))
    return chi, case.yardstick.root.of(after.after.belief.mean[: case.errors.size])


def damage(case: Case, task: Task, places: Places) -> float:
    """Return the RMS error of the curve by a drift that is just seen with 90 %, or of 20 um where none is, m."""
    time = minutes(task, places)
    information, left = seen_and_left(case, task, places, (time - time[0]) / np.ptp(time) - 0.5)
    wrong = float(np.sum(left**2))
    return float(np.sqrt(min(NEEDED * wrong / (1.25 * information), DRIFT**2 * wrong)))


def test_the_noncentrality_that_is_seen_with_ninety_percent_is_that_of_scipy() -> None:
    limit = stats.chi2.isf(FALSE, 1)
    assert stats.ncx2.sf(limit, 1, NEEDED) == pytest.approx(0.9, abs=1e-4)


def test_a_drift_of_twenty_micrometres_hides_once_along_and_not_out_and_back() -> None:
    case, task = one_axis()
    back = planned(task)
    along = once_along(back)
    assert damage(case, task, along) > 5.5e-6
    assert damage(case, task, back) < 0.2 * damage(case, task, along)
    more = minutes(task, back)[-1] - minutes(task, along)[-1]
    assert 0 < more < 16.0


def test_sampled_drifts_spoil_the_curve_once_along_unseen_and_are_seen_out_and_back() -> None:
    case, task = one_axis()
    rng, limit = np.random.default_rng(1), stats.chi2.isf(FALSE, 20)
    wrong, seen = dict[str, list[float]](), dict[str, list[bool]]()
    back = planned(task)
    for name, places in (("along", once_along(back)), ("back", back)):
        time = minutes(task, places)
        for _ in range(40):
            drift = 10e-6 * rng.standard_normal()
            values = drift * (time - time[0]) / np.ptp(time) + 0.5e-6 * rng.standard_normal(20)
            chi, left = seen_and_left(case, task, places, values)
            wrong.setdefault(name, []).append(float(np.sqrt(np.sum(left**2))))
            seen.setdefault(name, []).append(chi > limit)
    unseen = {name: np.array(wrong[name])[~np.array(seen[name])] for name in wrong}
    assert np.max(unseen["along"]) > 3 * np.max(unseen["back"])
    assert np.mean(seen["along"]) < 0.1
    assert np.mean(seen["back"]) > 0.5  # a fifth of them is too small to be seen, or to matter


def test_what_comes_and_goes_hides_in_one_round_and_not_in_two() -> None:
    """A zero that goes by 20 um and comes back; 20 readings have a χ² of 20 by chance."""
    case, task = one_axis()
    two = planned(task)
    one = in_one_round(two)
    humps = [(1 - np.cos(2 * np.pi * minutes(task, each) / minutes(task, each)[-1])) / 2 for each in (one, two)]
    found = [seen_and_left(case, task, each, DRIFT * hump) for each, hump in zip((one, two), humps, strict=True)]
    assert found[0][0] < 10
    assert np.sum(found[0][1] ** 2) > 6e-6**2
    assert found[1][0] > 200
    assert 0 < minutes(task, two)[-1] - minutes(task, one)[-1] < 12.0


@pytest.mark.parametrize("approach", ["both", pytest.param("+", marks=pytest.mark.long)])
def test_each_of_two_rounds_goes_out_and_back_and_reads_every_other_place(approach: str) -> None:
    _, task = one_axis(approach)
    order = planned(task)
    at, sides = order.poses[:, 0], order.approaches[:, 0]
    ways = np.split(np.arange(20), [5, 10, 15])
    rises = [bool(at[way[-1]] > at[way[0]]) for way in ways]
    assert rises[0] != rises[1]
    assert rises[2] != rises[3]
    for way, rising in zip(ways, rises, strict=True):
        assert np.all((np.diff(at[way]) > 0) == rising)
        assert approach == "+" or np.all((sides[way] > 0) == rising)
    apart = 4 if approach == "+" else 2
    for way in ways:
        alike = np.flatnonzero(sides == sides[way[0]])
        rank = np.searchsorted(np.sort(at[alike]), at[way])
        assert np.all(np.abs(np.diff(rank)) == apart)


def test_few_readings_are_read_in_one_round() -> None:
    _, task = one_axis()
    order = in_order(task, in_one_round(planned(task)).within(np.arange(0, 20, 3)))
    assert np.sum(np.diff(np.sign(np.diff(order.poses[:, 0]))) != 0) == 1


@pytest.mark.parametrize("approach", ["both", pytest.param("+", marks=pytest.mark.long)])
def test_what_is_left_is_read_as_planned_wherever_the_campaign_was_broken_off(approach: str) -> None:
    _, task = one_axis(approach)
    order = planned(task)
    for count in range(1, 20):
        after = replace(task, here=order.at(count - 1), read=order.within(slice(0, count)))
        left = order.within(slice(count, None))
        mixed = left.within(np.random.default_rng(count).permutation(len(left)))
        assert np.array_equal(in_order(after, mixed).poses, left.poses)


@pytest.mark.parametrize("approach", ["both", pytest.param("+", marks=pytest.mark.long)])
def test_a_place_that_is_skipped_leaves_the_others_in_their_rounds(approach: str) -> None:
    """What is read in its place stands beside its neighbour."""
    _, task = one_axis(approach)
    order = planned(task)
    for count in range(1, 18):
        after = replace(task, here=order.at(count - 1), read=order.within(slice(0, count)))
        left = order.within(slice(count + 1, None))
        found = renewed(after, Limits(readings=20 - count), left)
        kept, stayed = (np.isin(a.poses[:, 0], b.poses[:, 0]) for a, b in ((found, left), (left, found)))
        assert np.array_equal(found.poses[kept], left.poses[stayed])
        assert np.sum(~kept) >= 1


def test_a_reading_whose_side_nobody_told_changes_nothing_for_those_to_come() -> None:
    _, task = one_axis()
    order = planned(task)
    stray = replace(order.at(7), poses=np.array([[0.5]]), approaches=np.zeros((1, 1)))
    after = replace(task, here=stray, read=stray)
    assert in_order(after, order).same_as(order)
    assert [sorted(way) for way in _ways(in_order(after, order))] == [sorted(way) for way in _ways(order)]


def _ways(order: Places) -> list[list[float]]:
    """Return the places of both rounds."""
    at: list[float] = order.poses[:, 0].tolist()
    return [at[:10], at[10:]]


def test_a_set_up_that_moves_several_axes_goes_a_short_way() -> None:
    task = levered(300)
    places = task.lattice.within(np.arange(0, len(task.lattice), 15))
    order = in_order(task, places)
    assert order.same_as(places)


def test_of_several_axes_a_place_that_is_read_again_is_read_last() -> None:
    task = levered(300)
    places = task.lattice.within(np.arange(0, 100, 15))
    order = in_order(task, Places.joined([places, places.at(2)]))
    assert np.array_equal(order.poses[-1], places.poses[2])
    assert order.same_as(Places.joined([places, places.at(2)]))


def test_a_place_that_is_read_twice_is_read_once_in_each_round() -> None:
    _, task = one_axis()
    places = planned(task)
    again = Places.joined([places.at(3), places, places.at(16)])
    order = in_order(task, again)
    assert order.same_as(again)
    for index in (3, 16):
        found = np.flatnonzero(np.all(order.poses == places.poses[index], axis=1))
        assert [each // 11 for each in found.tolist()] == [0, 1]
