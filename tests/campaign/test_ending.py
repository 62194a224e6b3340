"""When an accuracy counts as reached, and when it is said that no reading can reach it."""

import re
from collections.abc import Sequence
from dataclasses import replace

import pytest

from axiscal.campaign import ending
from axiscal.campaign.ending import (
    ALL_REACHED,
    CONTRADICT,
    FUTILE,
    OUT_OF_REACH,
    out_of_reach,
    reaches,
    standing,
)
from axiscal.description.campaign import campaign_from_texts
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_described, of_builtin
from axiscal.description.target import RowName, Target, Want
from axiscal.estimation.accuracy.expanded import WantedAccuracy
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation, expanded_uncertainty
from axiscal.estimation.inheritance import case_of
from axiscal.estimation.promise.mistake import Explained
from axiscal.planning.plan.task import Limits
from axiscal.planning.proposal import reached_unread
from axiscal.present.answer_of_campaign import answered
from axiscal.present.plan_answer import reach_answer
from axiscal.present.plan_words import reach_text
from tests.generators.laser_axis import CASE, closed, machine, read
from tests.generators.texts import campaign_text, setup_text

POSITIONING, BACKLASH = RowName("positioning", ("X",)), RowName("backlash", ("X",))
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
TEXT = campaign_text(
    "m.toml",
    setup_text("laser", "interferometer", direction="x", moves=["X"], approach="+", noise="0.5 um", drift="0 um/h"),
    target={"rms": "RMS", "readings": 40},
)


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
    assert reaches(replace(target, rms=None), gapped) is None


def test_it_is_not_reached_by_readings_that_contradict_each_other(gapped: Estimation) -> None:
    found = gapped.posterior
    assert found is not None
    for explained, said in (((), CONTRADICT), ((Explained("sign", 1e6, (0,)),), "rms target reached")):
        agreement = replace(found.agreement, p=1e-6, explained=explained)
        known = replace(gapped, posterior=replace(found, agreement=agreement))
        assert standing(asked(1.01 * gapped.accuracy.rms), known) == said
        assert standing(asked(0.99 * gapped.accuracy.rms), known) is None


def test_no_reading_can_is_said_only_below_the_floor(gapped: Estimation) -> None:
    """A floor that is above the target ends the campaign where readings have taken away as much as was asked for."""
    known, floor = gapped.accuracy.rms, 0.95 * gapped.accuracy.rms
    yardstick = gapped.case.yardstick
    gapped.case.__dict__["yardstick_as_sized"] = yardstick
    yardstick.__dict__["rms_floor"] = floor
    try:
        assert standing(asked(1.01 * known), gapped) == "rms target reached"
        assert standing(asked(1.01 * floor), gapped) is None
        assert standing(asked(0.9 * known), gapped) is None  # sizes that are learnt move the floor by as much
        assert standing(asked(0.8 * known), gapped) == (
            f"rms target cannot be reached: endless readings would leave {1e6 * floor:.3g} um, "
            f"these leave {1e6 * known:.3g} um"
        )
        assert reaches(asked(0.8 * known), gapped) is False
        yardstick.__dict__["rms_floor"] = 2 * known  # as stated: the readings have shown less
        assert standing(asked(0.8 * known), gapped) is None
    finally:
        del yardstick.__dict__["rms_floor"], gapped.case.__dict__["yardstick_as_sized"]


def wanting(wants: Sequence[Want], expanded: float | None = None, taken: int = 28) -> tuple[Target, Estimation]:
    """Return a target of rows and U over the volume, m, and what readings make known for it."""
    target = replace(CASE.description.target, rms=None, expanded=expanded, wants=tuple(wants))
    case = Case(replace(CASE.description, target=target))
    return target, concluded(case, closed(read(machine(5), 28))[:taken])


def test_the_volume_and_the_rows_are_wanted_together() -> None:
    few = 10  # endless readings would leave a tenth less
    _, known = wanting([Want(POSITIONING, 1.0)], taken=few)
    ((row, _),), u = answered(known, {}), expanded_uncertainty(known).space
    for volume, limit, said in ((1.01, 1.01, ALL_REACHED), (0.99, 1.01, None), (1.01, 0.99, None)):
        target, known = wanting([Want(POSITIONING, limit * row.known)], volume * u, few)
        assert standing(target, known) == said


def test_an_unreachable_volume_ends_no_job_whose_rows_are_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    wants = Want(POSITIONING), Want(BACKLASH)
    for taken in (2, 28):
        target, known = wanting(wants, 1e-9, taken)
        u = expanded_uncertainty(known).space
        monkeypatch.setattr(ending, "asked", lambda *_, u=u: (WantedAccuracy("U", 1e-9, u),))
        assert (standing(target, known) is None) is (taken == 2)


def test_a_volume_that_stands_still_ends_no_job_while_rows_come_nearer() -> None:
    ((row, _),) = answered(wanting([Want(POSITIONING, 1.0)], taken=16)[1], {})
    wants = [Want(POSITIONING, 0.98 * row.known)]
    (target, few), (_, many) = wanting(wants, taken=8), wanting(wants, taken=16)
    endless, path = replace(target, readings=None, budget=None), [few.accuracy] * (FUTILE + 1)
    assert out_of_reach(endless, path, lambda: few, many) is None
    assert out_of_reach(endless, path, lambda: many, many) == OUT_OF_REACH
    assert out_of_reach(replace(endless, wants=()), path, lambda: few, many) == OUT_OF_REACH


def stated(rms: float) -> Case:
    """Return a laser along X and an error across it, which that does not see.  rms : target, um"""
    text = TEXT.replace('"RMS"', f'"{rms:.6f} um"\nrefers_to = "as read"')
    return Case(campaign_from_texts(text, "c.toml", HIDDEN, "m.toml"))


def test_before_the_first_reading_it_is_said_whether_any_can_and_which_set_up_would_help() -> None:
    floor = 1e6 * stated(1.0).yardstick.floors[0]
    assert reach_answer(stated(1.001 * floor)) is None
    found = reach_answer(stated(0.999 * floor))
    assert found is not None
    said = reach_text(found)
    assert said.startswith("Out of reach: endless readings leave volume ")
    assert 'With "ball bar in xy" as well, ' in said
    assert re.search(r"\d+ readings reach it in [0-9.]+ min", said)


def test_sizes_that_meet_a_target_unread_are_checked_by_a_few_readings() -> None:
    case = Case(replace(CASE.description, target=asked(1.0)))
    ends = [standing(case.description.target, concluded(case, read(machine(5), 28)[:count])) for count in (0, 5, 6)]
    assert ends == [None, None, "rms target reached"]
    assert reached_unread(case, Limits(rms=1.0))
    assert reached_unread(case, Limits(rms=1e-7)) is None
    stacked = first_described(of_builtin("paper-three-stacked"), ["interferometer"], Purpose("10 um"))
    assert "hardly anything" in (reached_unread(case_of(stacked), Limits.of(stacked.target)) or "")  # U of 2.2 mm
