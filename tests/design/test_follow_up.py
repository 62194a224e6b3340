"""Readings more, chosen for what all of them can vouch for."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.design.plan.follow_up import follow_up
from axiscal.design.plan.guarded import vouched_along
from axiscal.design.plan.order import in_order, seconds_each
from axiscal.design.plan.plan import make_plan
from axiscal.design.plan.task import Limits, Task
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from tests.design.test_out_and_back import one_axis

TASK = one_axis()[1]


def after(task: Task, taken: Places, ends: Array, coming: Places) -> float:
    """Return what all readings can vouch for, those to come after those that were taken."""
    later = ends[-1] + np.cumsum(seconds_each(task, coming))
    return vouched_along(task, Places.joined([taken, coming]), np.concatenate([ends, later])).u_def


@pytest.mark.long
def test_what_comes_after_a_plan_that_nobody_guarded_vouches_for_more_than_the_sharpest_readings() -> None:
    places = make_plan(TASK, Limits(readings=14), guard=False).places
    ends = np.cumsum(seconds_each(TASK, places))
    coming = follow_up(TASK, places, ends, 4)
    assert len(coming) == 4
    more = make_plan(TASK, Limits(readings=18), guard=False).places
    sharper = in_order(TASK, more.within(np.arange(len(more) - 4, len(more))))
    found = after(TASK, places, ends, coming)
    assert found < 0.7 * after(TASK, places, ends, sharper)
    assert found < 0.7 * vouched_along(TASK, places, ends).u_def


def test_it_ends_with_the_time_that_is_left() -> None:
    places = make_plan(TASK, Limits(readings=8), guard=False).places
    ends = np.cumsum(seconds_each(TASK, places))
    whole = follow_up(TASK, places, ends, 4)
    spent = np.cumsum(seconds_each(TASK, whole))
    fewer = follow_up(TASK, places, ends, 4, budget=float(spent[1]) + 1e-6)
    assert fewer.poses == pytest.approx(whole.poses[:2])
    assert len(follow_up(TASK, places, ends, 4, budget=0.0)) == 0


def test_readings_more_go_into_a_gap_and_close_it() -> None:
    places = make_plan(TASK, Limits(readings=24), guard=False).places
    share = places.poses[:, 0] / TASK.observation.machine.axes[0].length
    gapped = in_order(TASK, places.within(np.flatnonzero((share < 0.4) | (share > 0.62))))
    ends = np.cumsum(seconds_each(TASK, gapped))
    coming = follow_up(TASK, gapped, ends, 4)
    later = np.concatenate([ends, ends[-1] + np.cumsum(seconds_each(TASK, coming))])
    before = vouched_along(TASK, gapped, ends, gaps=True)
    after_them = vouched_along(TASK, Places.joined([gapped, coming]), later, gaps=True)
    assert before.hides
    assert not after_them.hides
