"""The words of a question: what is said of a place that has been read before."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.machine import load_machine
from axiscal.present.guide.question import Question, expectation
from axiscal.record.events import Asked
from tests.generators.texts import FOUR_READINGS


def test_a_place_that_was_read_before_is_said_with_its_number(tmp_path: Path) -> None:
    described = campaign_from_texts(FOUR_READINGS, "campaign.toml", load_machine("one-axis").text, "one-axis")
    with Campaign.create(tmp_path / "mill.axiscal", described) as campaign:
        first = campaign.next()
        assert isinstance(first, Asked)
        question = Question.of(campaign, first)
        assert question.again == ""
        known = expectation(campaign.estimate(), first.place)
        assert question.surprise(known.mean - 3 * known.std) == pytest.approx(3.0)
        campaign.record(1e-6)
        assert "where reading 1 was taken" in Question.of(campaign, Asked(2, first.place)).again
        other = campaign.next()
        assert isinstance(other, Asked)
        assert Question.of(campaign, other).again == ""
