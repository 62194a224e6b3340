"""A set-up that moves one axis is read out and back, or interleaved: what a drift hides, and what the way costs."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.measurement.reading import Places
from axiscal.planning.next_readings import posed
from axiscal.planning.plan.order import interleaved
from axiscal.planning.plan.plan import make_plan, renewed
from axiscal.planning.plan.task import Limits, Task
from tests.generators.campaigns import built_in
from tests.generators.texts import campaign_text, setup_text

CAMPAIGN = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", noise="0.5 um", approach="{approach}"),
    target={"readings": 20},
)


@cache
def one_axis(approach: str = "both") -> tuple[Case, Task]:
    """Return the built-in axis with a laser, and what is to be planned of it."""
    case = Case(built_in(CAMPAIGN.format(approach=approach)))
    return case, posed(case, case.knowledge)


@cache
def planned(task: Task) -> Places:
    """Return the twenty places that leave least, in the order of the way."""
    return make_plan(task, Limits(readings=20)).places


@cache
def apart(task: Task) -> Places:
    """Return the same places interleaved."""
    return interleaved(task, Limits(readings=20), planned(task))


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


def test_what_is_left_is_read_in_its_order_wherever_the_campaign_was_broken_off() -> None:
    """And a place that comes in for a skipped one is interleaved, as drift then asks for."""
    _, task = one_axis()
    order = apart(task)
    for count in range(1, 18, 3):
        after = replace(task, here=order.single(count - 1))
        left = order.within(slice(count, None))
        none = replace(after, lattice=Places.none(1))
        kept = renewed(none, Limits(readings=20 - count), left, usual=True)
        assert np.array_equal(kept.poses, left.poses)
        new = renewed(after, Limits(readings=20 - count), left.within(slice(1, None)), usual=True)
        assert len(new) == 20 - count
        assert count > 7 or abs(np.corrcoef(new.poses[:, 0], np.arange(len(new)))[0, 1]) < 0.6


@pytest.mark.parametrize(("count", "least"), [(7, 1), (8, 3), (12, 3)])
def test_an_axis_turns_three_times_so_that_a_drift_is_no_backlash_that_varies(count: int, least: int) -> None:
    _, task = one_axis("both")
    sides = make_plan(task, Limits(count), patience=0.0, usual=True).places.approaches[:, 0]
    assert np.count_nonzero(np.diff(sides)) >= least
