"""A set-up that moves one axis is read out and back, or interleaved: what a drift hides, and what the way costs."""

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
from axiscal.measurement.reading import Places, Reading
from axiscal.numerics import Array
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.order import in_order, interleaved, seconds_along, seconds_each
from axiscal.planning.plan.plan import make_plan, renewed
from axiscal.planning.plan.task import Limits, Task
from tests.generators.designs import levered
from tests.generators.texts import campaign_text, setup_text

CAMPAIGN = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", noise="0.5 um", approach="{approach}"),
    target={"readings": 20},
)
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


@cache
def apart(task: Task) -> Places:
    """Return the same places interleaved."""
    return interleaved(task, Limits(readings=20), planned(task))


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
    read, after = block(Knowledge(case.observation, case.prior), readings, np.ones(len(readings), dtype=bool))
    chi = float(sum(each.chi_square for each in read.innovations))
    return chi, case.yardstick.root.times(after.belief.mean[: case.errors.size])


def damage(case: Case, task: Task, places: Places) -> float:
    """Return the RMS error of the curve by a drift that is just seen with 90 %, or of 20 um where none is, m."""
    time = minutes(task, places)
    information, left = seen_and_left(case, task, places, (time - time[0]) / np.ptp(time) - 0.5)
    wrong = float(np.sum(left**2))
    return float(np.sqrt(min(NEEDED * wrong / (1.25 * information), DRIFT**2 * wrong)))


def test_the_noncentrality_that_is_seen_with_ninety_percent_is_that_of_scipy() -> None:
    limit = stats.chi2.isf(FALSE, 1)
    assert stats.ncx2.sf(limit, 1, NEEDED) == pytest.approx(0.9, abs=1e-4)


def test_a_drift_of_twenty_micrometres_hides_once_along_and_not_interleaved() -> None:
    case, task = one_axis()
    back = apart(task)
    along = once_along(back)
    assert damage(case, task, along) > 5.5e-6
    assert damage(case, task, back) < 0.2 * damage(case, task, along)
    more = minutes(task, back)[-1] - minutes(task, along)[-1]
    assert 0 < more < 0.02 * seconds_along(task, along)


def test_what_comes_and_goes_hides_out_and_back_and_not_where_readings_interleave() -> None:
    """A zero that goes by 20 um and comes back; 20 readings have a χ² of 20 by chance."""
    case, task = one_axis()
    back = planned(task)
    both = back, apart(task)
    humps = [(1 - np.cos(2 * np.pi * minutes(task, each) / minutes(task, each)[-1])) / 2 for each in both]
    found = [seen_and_left(case, task, each, DRIFT * hump) for each, hump in zip(both, humps, strict=True)]
    assert found[0][0] < 10
    assert np.sum(found[0][1] ** 2) > 6e-6**2
    assert found[1][0] > 200
    assert 0 < minutes(task, both[1])[-1] - minutes(task, back)[-1] < 0.02 * seconds_along(task, back)


@pytest.mark.parametrize("approach", ["both", pytest.param("+", marks=pytest.mark.long)])
def test_the_way_goes_out_and_back_and_reads_every_other_place(approach: str) -> None:
    _, task = one_axis(approach)
    order = planned(task)
    at, sides = order.poses[:, 0], order.approaches[:, 0]
    assert np.sum(np.diff(np.sign(np.diff(at))) != 0) == 1
    if approach == "both":
        assert np.sum(np.diff(sides) != 0) == 1
        assert np.all(np.diff(at[sides > 0]) > 0)
        assert np.all(np.diff(at[sides < 0]) < 0)
    else:
        rank = np.argsort(np.argsort(at))
        assert np.sum(np.abs(np.diff(rank)) == 2) == 18


@pytest.mark.parametrize("approach", ["both", pytest.param("+", marks=pytest.mark.long)])
def test_what_is_left_is_read_in_its_order_wherever_the_campaign_was_broken_off(approach: str) -> None:
    """And a place that comes in for a skipped one is interleaved, as drift then asks for."""
    _, task = one_axis(approach)
    order = apart(task)
    for count in range(1, 18, 3):
        after = replace(task, here=order.single(count - 1), read=order.within(slice(0, count)))
        left = order.within(slice(count, None))
        none = replace(after, lattice=Places.none(1))
        kept = renewed(none, Limits(readings=20 - count), left, usual=True)
        assert np.array_equal(kept.poses, left.poses)
        new = renewed(after, Limits(readings=20 - count), left.within(slice(1, None)), usual=True)
        assert len(new) == 20 - count
        assert count > 7 or abs(np.corrcoef(new.poses[:, 0], np.arange(len(new)))[0, 1]) < 0.6


def test_a_set_up_that_moves_several_axes_goes_a_short_way() -> None:
    task = levered(300)
    places = task.lattice.within(np.arange(0, len(task.lattice), 15))
    order = in_order(task, places)
    assert order.same_as(places)


def test_many_readings_along_an_axis_lie_one_in_each_part_two_at_its_ends_and_few_where_the_plan_has_them() -> None:
    _, task = one_axis("+")
    low, high = task.observation.machine.axes[0].travel
    at = {
        (count, usual): np.sort(make_plan(task, Limits(count), patience=0.0, usual=usual).places.poses[:, 0])
        for count in (7, 20)
        for usual in (True, False)
    }
    assert np.floor(18 * (at[20, True] - low) / (high - low)).tolist() == [0, *range(18), 17]
    assert np.diff(at[20, True]).max() > 2 * np.diff(at[20, True]).min()
    assert np.any(np.floor(18 * (at[20, False] - low) / (high - low)) != [0, *range(18), 17])
    assert np.array_equal(at[7, True], at[7, False])
