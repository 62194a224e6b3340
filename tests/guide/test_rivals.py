"""A reading that decides is the next one that is asked for, and whoever takes it is told why."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.cli.texts import question_document, question_text
from axiscal.guide.question import Question
from axiscal.measurement.place import Place
from axiscal.record.events import Asked
from axiscal.simulation import Simulator
from tests.generators.laser_axis import CASE


def test_next_asks_for_the_reading_that_decides_and_says_between_what(tmp_path: Path) -> None:
    description, rng = CASE.description, np.random.default_rng(3)
    drawn, ways = Simulator(description.machine, description.setups).drawn(3), np.linspace(0.013, 0.987, 12)
    with Campaign.create(tmp_path / "c.axiscal", description) as campaign:
        for x in ways.tolist():
            value = drawn.read(description.setups[0], (x,), (1,), rng) + 15e-6 * (x > 0.43)
            campaign.record(value, at=Place("laser", (x,), (1,)), live=False)
            found = campaign.contest()
            if found is not None:
                break
        assert found is not None
        asked = campaign.next(beyond=True)
        assert isinstance(asked, Asked)
        assert asked.place == found.place
        told = Question.of(campaign, asked).decides
        assert told.startswith("this reading decides between two causes")
        assert told.count(" um") == 2
        assert f"decides   {told}" in question_text(campaign, asked)
        assert question_document(campaign, asked)["decides"] == told
        campaign.skip("the cover is in the way")
        other = campaign.next(beyond=True)
        assert isinstance(other, Asked)
        assert other.place.pose != asked.place.pose


def test_a_reading_that_decides_nothing_says_nothing_of_it(tmp_path: Path) -> None:
    with Campaign.create(tmp_path / "c.axiscal", CASE.description) as campaign:
        asked = campaign.next()
        assert isinstance(asked, Asked)
        assert Question.of(campaign, asked).decides == ""
        assert question_document(campaign, asked)["decides"] == ""
