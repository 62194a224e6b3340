"""Slips at a display: the test with which a mounting begins, and what may be behind a surprise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import standing_screen
from axiscal.description.first_campaign import Purpose
from axiscal.description.first_files import first_described, of_builtin
from axiscal.exceptions import ReadingError
from axiscal.present.answer_of_campaign import standing_answer
from axiscal.present.guide.question import Question, typed
from axiscal.present.guide.slips import (
    CAUSES,
    Cause,
    SurprisingError,
    causes,
    jog,
    keep,
    refuse_surprising,
    surprise_text,
    try_jog,
)
from axiscal.record.accepted import Accepted
from axiscal.record.events import Asked
from tests.generators.texts import FOUR_READINGS
from tests.web.served import started


@pytest.fixture
def campaign(tmp_path: Path) -> Campaign:
    """A campaign with a laser whose first reading is asked for."""
    opened = Campaign.open(started(tmp_path, FOUR_READINGS))
    opened.next()
    return opened


@pytest.mark.parametrize(
    ("typed", "verdict", "words"),
    [
        ("-98", "wrong sign", "counts the other way"),
        ("0.1", "in mm", "is in mm"),
        ("-0.100", "in mm", "is in mm"),
        ("0.0039", "in in", "is in in"),
        ("3.9", "in thou", "thousandths of an inch"),
        ("0", "still", "does not follow"),
        ("1000", "scale", "shows 10 times"),
    ],
)
def test_a_display_that_is_wrong_is_named_before_anything_is_written(
    campaign: Campaign, typed: str, verdict: str, words: str
) -> None:
    test = jog(campaign)
    assert test is not None
    assert test.far == "X +0.100 mm"
    assert test.shows == pytest.approx(100.0)
    with pytest.raises(ReadingError, match=words):
        try_jog(campaign, typed)
    assert campaign.state.notes[-1].text == f'test of sign "laser": X +0.100 mm shows {typed} ({verdict})'
    assert (campaign.state.readings, jog(campaign)) == ((), test)
    try_jog(campaign, typed, anyway=True)
    assert jog(campaign) is None
    campaign.record(0.0)
    assert standing_answer(campaign).model_dump()["overruled"] == ["laser"]
    assert 'Taken all the same: the test at mounting "laser" failed.' in standing_screen(campaign)


def test_a_display_that_follows_is_tested_once_a_mounting(campaign: Campaign) -> None:
    with pytest.raises(ReadingError, match="is no reading"):
        try_jog(campaign, "skip")
    try_jog(campaign, "0.1", anyway=True)
    try_jog(campaign, "0,102 mm")
    assert "overruled" not in standing_answer(campaign).model_dump()
    assert campaign.state.notes[-1].text.endswith("0,102 mm (right)")
    assert jog(campaign) is None
    campaign.record(0.0)
    campaign.next()
    assert jog(campaign) is None
    with pytest.raises(ReadingError, match="nothing to test"):
        try_jog(campaign, "100")


def asked(campaign: Campaign) -> Question:
    """Return what is asked behind a reading of 400 um."""
    campaign.record(400e-6)
    reading = campaign.next()
    assert isinstance(reading, Asked)
    return Question.from_campaign(campaign, reading)


@pytest.mark.parametrize(
    ("typed", "cause", "kept"),
    [
        *((-400e-6, "sign", 400e-6), (0.4e-6, "mm", 400e-6), (400e-6 / 25400, "inch", 400e-6)),
        *((-300e-6, "really", -300e-6), (-300e-6, "bumped", -300e-6)),
    ],
)
def test_a_cause_does_what_it_says_and_is_noted(campaign: Campaign, typed: float, cause: Cause, kept: float) -> None:
    question, value = asked(campaign), np.array([typed])
    assert surprise_text(question, value).startswith(f"It is about {abs(1e6 * typed - 400):.0f} um away")
    assert cause in causes(question, value)
    told = keep(campaign, f"{1e6 * typed} um", cause)
    reading = campaign.state.readings[-1]
    assert reading.value == pytest.approx(kept)
    assert reading.accepted is (cause == "really")
    noted = [note.text for note in campaign.state.notes]
    assert noted == ([] if cause == "really" else [f"reading 2: {CAUSES[cause]}"])
    assert (told == "Kept reading 2; it is on the disk.") is (cause == "really")
    assert [each.mistake for each in campaign.state.told(Accepted)] == ["jump"] * (cause == "bumped")


def test_a_height_in_mm_is_asked_about_where_no_jog_has_shown_the_unit(tmp_path: Path) -> None:
    described = first_described(of_builtin("printer-gantry"), ["probe"], Purpose())
    with Campaign.create(tmp_path / "printer.axiscal", described) as campaign:
        question = Question.from_campaign(campaign, Asked(1, campaign.prepared()[0]))
        campaign.next()
        for text in ("-42", "-0.042 mm", "0"):
            refuse_surprising(campaign, question, typed(campaign, text))
        with pytest.raises(SurprisingError) as asked:
            keep(campaign, "-0.042")
        assert {"mm", "really"} <= set(asked.value.causes)
        keep(campaign, "-0.042", "mm")
        assert campaign.state.readings[-1].value == pytest.approx(-42e-6, rel=1e-9)
