"""A set-up that moves one axis is read out and back: what a drift hides, and what the way back costs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy import stats

from axiscal.description.campaign import campaign_from_texts
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.plan import make_plan
from axiscal.design.plan.task import Limits, Task
from axiscal.estimation.case import Case
from axiscal.estimation.knowledge import Knowledge, block
from axiscal.machine import load_machine
from axiscal.measurement.place import Places
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.planning.next_readings import posed
from tests.generators.designs import levered

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
    after = block(Knowledge(case.observation, case.prior), readings, np.ones(len(readings)))
    chi = float(sum(each.chi_square for each in after.innovations))
    mean = after.after.belief.mean[: case.errors.size].copy()
    mean[case.errors.functions[1].columns] = 0.0  # the reversal: what it takes of a drift, only a closing reading shows
    return chi, case.yardstick.root.of(mean)


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
    assert damage(case, task, back) < 0.2e-6
    more = minutes(task, back)[-1] - minutes(task, along)[-1]
    assert 0 < more < 6.0


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
    assert np.median(wrong["along"]) > 3 * np.median(wrong["back"])
    assert np.mean(seen["along"]) < 0.1
    assert np.mean(seen["back"]) > 0.5  # a fifth of them is too small to be seen, or to matter


def test_one_side_is_read_on_the_way_out_and_the_other_on_the_way_back() -> None:
    _, task = one_axis()
    order = planned(task)
    turn = int(np.flatnonzero(np.diff(order.approaches[:, 0]))[0]) + 1
    assert set(order.approaches[:turn, 0]) != set(order.approaches[turn:, 0])
    for part in (slice(0, turn), slice(turn, None)):
        assert np.all(np.diff(order.poses[part, 0]) * order.approaches[part, 0][1:] > 0)


def test_where_one_side_is_asked_for_every_other_place_is_read_on_the_way_back() -> None:
    _, task = one_axis("+")
    order = planned(task)
    turn = int(order.poses[:, 0].argmax())
    assert 9 <= turn <= 10
    assert np.all(np.diff(order.poses[: turn + 1, 0]) > 0)
    assert np.all(np.diff(order.poses[turn:, 0]) < 0)


def test_what_is_left_of_the_way_back_is_read_from_where_the_machine_stands() -> None:
    _, task = one_axis()
    order = planned(task)
    after = replace(task, here=order.at(12))
    left = order.within(slice(13, None))
    mixed = left.within(np.random.default_rng(0).permutation(len(left)))
    assert np.array_equal(in_order(after, mixed).poses, left.poses)


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


def test_a_place_that_is_read_once_more_or_was_read_before_comes_after_the_way_back() -> None:
    _, task = one_axis()
    along = planned(task).poses[:, 0]
    places = planned(task)
    turn, half = int(np.argmax(along)), int(np.argmin(np.abs(along - 0.5)))
    again = Places.joined([places.at(turn), places, places.at(half)])
    order = in_order(task, again)
    assert order.same_as(again)
    once, last = order.within(slice(0, 20)), order.within(slice(20, 22))
    assert once.same_as(places)
    assert last.same_as(Places.joined([places.at(half), places.at(turn)]))
    turned = Places.joined([once, last.at(1), last.at(0)])
    assert seconds_each(task, order).sum() <= seconds_each(task, turned).sum()
    left = Places.joined([places.at(turn), places.within(slice(12, 20))])
    begun = replace(task, here=places.at(11), read=places.within(slice(0, 12)))
    assert in_order(begun, left).at(8).same_as(places.at(turn))
