"""The same first line and the same rows on a terminal, on the page, in HTML, in the PDF and in JSON."""

import re
from pathlib import Path
from typing import get_args

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import standing_screen
from axiscal.description.campaign import campaign_from_texts
from axiscal.present import rendering
from axiscal.present.answer import Outcome, Verdict
from axiscal.web.desk import Desk
from tests.generators.laser_axis import CAMPAIGN, MACHINE
from tests.golden.surfaces import numbers, of_screen, of_state


def test_every_verdict_has_its_words_and_its_colour_in_the_pdf() -> None:
    template = (Path(rendering.__file__).parent / "paper" / "report.typ").read_text(encoding="utf-8")
    (colours,) = re.findall(r"#let colours = \(([^)]*)\)", template)
    assert set(re.findall(r"(\w+): ", colours)) == set(get_args(Verdict))


def test_before_the_first_reading_all_show_the_plan_and_whether_it_reaches(tmp_path: Path) -> None:
    text = CAMPAIGN.replace('rms = "3 um"', 'U = "0.2 um"\nreadings = 12')
    with Campaign.create(tmp_path / "c.axiscal", campaign_from_texts(text, "c.toml", MACHINE, "m")) as campaign:
        campaign.next()
        desk = Desk(campaign)
        desk.think()
        page, progress, screen = desk.state.answer, desk.state.progress, of_screen(standing_screen(campaign))
        assert page is not None
        assert page.first[0] == "CANNOT BE REACHED WITH THESE SET-UPS"
        assert any("Out of reach" in each for each in page.sentences)
        assert page.document.minutes == pytest.approx(progress.left_minutes)
        shown = of_state(page.model_dump(mode="json"))
        assert shown.first == screen.first
        assert [[row[0], *map(numbers, row[1:])] for row in shown.cells[1:]] == [
            [row[0], *map(numbers, row[1:])] for row in screen.cells[1:]
        ]


def test_the_page_counts_the_open_question_and_the_clock_as_every_screen_does(tmp_path: Path) -> None:
    text = CAMPAIGN.replace('rms = "3 um"', "readings = 9")
    with Campaign.create(tmp_path / "c.axiscal", campaign_from_texts(text, "c.toml", MACHINE, "m")) as campaign:
        campaign.next()
        campaign.record(1e-6)
        desk = Desk(campaign)
        desk.think()
        assert desk.state.answer is not None
        found, progress = desk.state.answer.document, desk.state.progress
        assert isinstance(found, Outcome)
        assert (found.more, found.clocked) == (progress.coming, True) == (8, True)
        assert [found.minutes, found.more_minutes] == pytest.approx([progress.minutes, progress.left_minutes], rel=1e-5)
