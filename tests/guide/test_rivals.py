"""A reading that decides is the next one that is asked for, and whoever takes it is told why."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from axiscal.estimation.deciding import Contest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.texts import question_document, question_text
from axiscal.guide.question import Question
from axiscal.measurement.place import Place
from axiscal.record.events import Asked
from axiscal.simulation import Simulator
from tests.generators.laser_axis import CASE


def test_next_asks_for_the_reading_that_decides_and_says_between_what(tmp_path: Path) -> None:
    description, rng = CASE.description, np.random.default_rng(0)
    drawn, ways = Simulator(description.machine, description.setups).drawn(0), np.linspace(0.013, 0.987, 12)
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


def test_a_reading_that_is_taken_back_and_vouched_for_competes_anew(tmp_path: Path) -> None:
    """An implausible reading competes with nothing until somebody vouches for it: then it is the cause, not a step.

    The judge is the same record opened by somebody who did not look before.
    """
    description, rng, path = CASE.description, np.random.default_rng(0), tmp_path / "c.axiscal"
    drawn, setup = Simulator(description.machine, description.setups).drawn(0), description.setups[0]

    def fresh() -> Contest | None:
        with Campaign.open(path, write=False) as other:
            return other.contest()

    with Campaign.create(path, description) as campaign:
        for x in np.linspace(0.013, 0.987, 12).tolist():
            value = drawn.read(setup, (x,), (1,), rng) + 15e-6 * (x > 0.43)
            campaign.record(value, at=Place("laser", (x,), (1,)), live=False)
            if campaign.contest() is not None:
                break
        far = Place("laser", (0.995,), (1,))
        wrong = drawn.read(setup, far.pose, (1,), rng) + 150e-6
        campaign.record(wrong, at=far, live=False)
        doubted = campaign.contest()
        campaign.undo()
        campaign.record(wrong, at=far, accepted=True, live=False)
        believed = campaign.contest()
    assert doubted is not None
    assert doubted != believed
    assert believed == fresh()
