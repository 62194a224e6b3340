"""The planner by itself: it is given what is known, however that was found."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.machine import load_machine
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.planning.next_readings import next_places
from axiscal.planning.promise import promised
from axiscal.record.events import Asked, Gap

TEXT = """
machine = "one-axis"
[target]
readings = 8
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
unknowns = {}
approach = "+"
"""


@pytest.fixture(scope="module")
def case() -> Case:
    """Return one axis of a metre with a laser that needs no zero."""
    return Case(campaign_from_texts(TEXT, "c.toml", load_machine("one-axis").text, "one-axis"))


def reading(x: float) -> Reading:
    """Return a reading; its value says nothing of where the next one should be."""
    return Reading("laser", (x,), (1,), 0.0, time=0.0)


@pytest.mark.long
def test_what_is_known_decides_where_to_read(case: Case) -> None:
    """Where the left half has been read often, the plan goes to the right one; unread, to both."""
    taken = [reading(0.05 * n) for n in range(9) for _ in range(4)]
    known = case.knowledge.read(taken)
    fresh = [place.pose[0] for place in next_places(case, case.knowledge, ())]
    after = [place.pose[0] for place in next_places(case, known, taken[:1])]
    assert len(fresh) == 8
    assert len(after) == 7
    assert min(fresh) < 0.3
    assert min(after) > 0.4


def test_nothing_is_planned_in_a_gap(case: Case) -> None:
    (first, *_) = next_places(case, case.knowledge, ())
    places = next_places(case, case.knowledge, (), gaps=[Gap(Asked(1, first), "blocked")])
    assert len(places) >= 7
    assert all(abs(place.pose[0] - first.pose[0]) >= 0.01 for place in places)


@pytest.mark.long
@pytest.mark.parametrize("usual", ["on", "off"])
def test_what_is_left_of_a_plan_is_kept_where_it_is_best(usual: str) -> None:
    """All places are kept; of a plan that was shaken one may go for a better one."""
    text = f'usual = "{usual}"\n{TEXT}'
    case = Case(campaign_from_texts(text, "c.toml", load_machine("one-axis").text, "one-axis"))
    (here, *left) = next_places(case, case.knowledge, ())
    taken = [reading(here.pose[0])]
    known = case.knowledge.read(taken)
    after = next_places(case, known, taken, left=left)
    assert all(isinstance(place, Place) for place in after)
    stood, stands = (np.sort([place.pose[0] for place in places]) for places in (left, after))
    # Climbing on from a plan finds places micrometres off; far below what a plan of other places differs by.
    kept = np.min(np.abs(stood[:, None] - stands), axis=1) < 1e-4
    assert len(stands) == len(stood)
    assert np.sum(~kept) <= (usual == "on")
    assert promised(case, known, after).rms <= 1.001 * promised(case, known, left).rms
