"""When an accuracy counts as reached, and when it is said that no reading can reach it."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from axiscal.estimation.ruled import ruled, ruling_of
from axiscal.estimation.statements import Resting, Statement
from axiscal.report.verdict import verdict_words

from axiscal.campaign.ending import reaches, standing
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.target import Target
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.planning.feasibility import out_of_reach
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
    return ruled(concluded(CASE, closed(taken)))


def asked(rms: float) -> Target:
    """Return a target of so many m."""
    return replace(CASE.description.target, rms=rms)


def test_it_is_reached_by_the_figure_that_is_printed_whatever_the_verdict_short_of_contradicted(
    gapped: Estimation,
) -> None:
    assert ruling_of(gapped).verdict == "unchecked"
    for share, reached in ((0.99, False), (1.01, True)):
        target = asked(share * gapped.accuracy.rms)
        assert reaches(target, gapped) is reached
        assert standing(target, gapped) == ("rms target reached" if reached else None)


def test_it_is_the_same_before_and_after_the_verdict(gapped: Estimation) -> None:
    before = replace(gapped, ruling=None)
    for share in (0.6, 0.99, 1.01):
        target = asked(share * gapped.accuracy.rms)
        assert standing(target, before) == standing(target, gapped)


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


def test_where_a_promise_rests_on_statements_alone_the_verdict_says_that(gapped: Estimation) -> None:
    """No more than 45 % of the variance: that is not most of it, and one machine in fifty is far worse."""
    ruling = ruling_of(gapped)
    promise = ruling.defence.promise
    rests_on = Resting((Statement("EXX_reversal", "", 3e-6),), 0.45, 0.67 * promise, 0.055, 1.01 * promise)
    alone = replace(ruling, defence=replace(ruling.defence, departures=(), rests_on=rests_on).promising(promise))
    assert verdict_words(alone).endswith("too much of what is promised rests on statements alone.")
    both = replace(ruling, defence=replace(ruling.defence, rests_on=rests_on))
    assert verdict_words(both).endswith("could hardly have done so.")


@pytest.mark.parametrize(("raised", "told"), [(1.0, ""), (1.004, ""), (1.006, "1 %"), (1.18, "18 %")])
def test_a_promise_that_was_made_larger_is_said_with_how_much_where_that_can_be_printed(
    gapped: Estimation, raised: float, told: str
) -> None:
    words = verdict_words(replace(ruling_of(gapped), verdict="holds", raised=raised))
    assert words.startswith("Verdict: holds. The readings could have contradicted the model, and did not.")
    assert words.endswith(f"by uncertainties {told} larger than those of the model." if told else "did not.")
