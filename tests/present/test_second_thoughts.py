"""What is said after every reading where the readings contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.reading import Reading
from axiscal.present.guide.taking_back import contradictions
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, plus, read

NARROW = campaign_from_texts(f'usual = "off"\nsure = "exactly"\n{CAMPAIGN}', "c.toml", MACHINE, "m")
JUMPED = [0.0] * 7 + [20e-6] * 17
"""m: before reading 8."""


def _said(path: Path, readings: Sequence[Reading]) -> list[str]:
    with Campaign.create(path, NARROW) as campaign:
        campaign.adopt(tuple(readings))
        return contradictions(campaign)


def test_a_zero_that_jumped_is_said_while_measuring(tmp_path: Path) -> None:
    still = read(machine(2), 24)
    assert _said(tmp_path / "still.axiscal", still) == []
    (said,) = _said(tmp_path / "jumped.axiscal", plus(still, JUMPED))
    assert said.startswith("The readings contradict each other (p = ")
    number = said.partition('the zero of "laser" jumped before reading ')[2].partition(" ")[0]
    assert 8 <= int(number) <= 10  # the first after it may be taken for bad readings


def test_nothing_is_said_of_a_campaign_that_has_ended(tmp_path: Path) -> None:
    with Campaign.create(tmp_path / "ended.axiscal", NARROW) as campaign:
        campaign.adopt(tuple(plus(read(machine(2), 24), JUMPED)))
        campaign.finish("no more time")
        assert contradictions(campaign) == []
        campaign.undo()
        assert len(contradictions(campaign)) == 1
