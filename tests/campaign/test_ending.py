"""When an accuracy counts as reached, and when it is said that no reading can reach it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from axiscal.campaign.ending import CONTRADICT, reaches, standing
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.target import Target
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.planning.feasibility import out_of_reach
from axiscal.promise.agreement import Explained
from tests.generators.laser_axis import CASE, closed, machine, read

HIDDEN = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "1 m"]
[axes.Y]
travel = ["0 mm", "1 m"]
[errors]
EXX = { std = "3 um", knots = 9 }
EYX = { std = "3 um", knots = 5 }
"""
TEXT = """
machine = "m.toml"
[target]
rms = "RMS"
readings = 40
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
approach = "+"
noise = "0.5 um"
drift = "0 um/h"
"""


@pytest.fixture(scope="module")
def gapped() -> Estimation:
    """Return what is known from readings of which none was taken in a fifth of the travel."""
    taken = [each for each in read(machine(5), 28) if not 0.4 < each.pose[0] < 0.62]
    return concluded(CASE, closed(taken))


def asked(rms: float) -> Target:
    """Return a target of so many m."""
    return replace(CASE.description.target, rms=rms)


@pytest.mark.parametrize(("share", "reached"), [(0.99, False), (1.01, True)])
def test_it_is_reached_by_the_figure_that_is_printed(gapped: Estimation, share: float, reached: bool) -> None:
    target = asked(share * gapped.accuracy.rms)
    assert reaches(target, gapped) is reached
    assert standing(target, gapped) == ("rms target reached" if reached else None)


def test_it_is_not_reached_by_readings_that_contradict_each_other(gapped: Estimation) -> None:
    found, scales = gapped.posterior, gapped.stages.learnt
    assert found is not None
    for explained, said in (((), CONTRADICT), ((Explained("sign", 1e6, (0,)),), "rms target reached")):
        agreement = replace(found.agreement, p=1e-6, explained=explained)
        stages = gapped.stages._replace(learnt=replace(scales, found=replace(found, agreement=agreement)))
        known = replace(gapped, stages=stages)
        assert standing(asked(1.01 * gapped.accuracy.rms), known) == said
        assert standing(asked(0.99 * gapped.accuracy.rms), known) is None


def test_of_two_accuracies_the_one_that_is_reached_is_said(gapped: Estimation) -> None:
    known = gapped.accuracy
    both = replace(asked(0.5 * known.rms), worst=1.01 * known.worst)
    assert standing(both, gapped) == "worst target reached"


def test_no_reading_can_is_said_only_below_the_floor(gapped: Estimation) -> None:
    """A floor that is above the target ends the campaign where readings have taken away as much as was asked for."""
    known, floor = gapped.accuracy.rms, 2 * gapped.accuracy.rms
    yardstick = gapped.case.yardstick
    yardstick.__dict__["floors"] = (floor, floor)
    try:
        assert standing(asked(1.01 * floor), gapped) == "rms target reached"
        assert standing(asked(0.9 * known), gapped) == (
            f"rms target cannot be reached: endless readings would leave {1e6 * floor:.3g} um, "
            f"these leave {1e6 * known:.3g} um"
        )
        assert reaches(asked(0.9 * known), gapped) is False
    finally:
        del yardstick.__dict__["floors"]


def stated(rms: float) -> Case:
    """Return a laser along X and an error across it, which that does not see.  rms : target, um"""
    return Case(campaign_from_texts(TEXT.replace("RMS", f"{rms:.6f} um"), "c.toml", HIDDEN, "m.toml"))


def test_before_the_first_reading_it_is_said_whether_any_can_and_which_set_up_would_help() -> None:
    floor = 1e6 * stated(1.0).yardstick.floors[0]
    assert out_of_reach(stated(1.001 * floor)) is None
    said = out_of_reach(stated(0.999 * floor)) or ""
    assert said.startswith("the rms target cannot be reached with these set-ups: endless readings would leave ")
    assert 'With "ball bar in xy" as well it can be reached: ' in said
    assert re.search(r"\d+ readings in [0-9.]+ min for all set-ups", said)
