"""What is said after every reading where the readings contradict the model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from axiscal.guide.contradicted import contradicted_words

from axiscal.campaign.campaign import Campaign
from axiscal.measurement.reading import Reading
from tests.generators.laser_axis import CASE, machine, plus, read


def _said(path: Path, readings: Sequence[Reading]) -> list[str]:
    with Campaign.create(path, CASE.description) as campaign:
        campaign.adopt(tuple(readings))
        return contradicted_words(campaign)


def test_a_drift_is_said_while_measuring_as_soon_as_the_odds_are_twenty_to_one(tmp_path: Path) -> None:
    still = read(machine(2), 24)
    drifting = plus(still, 10e-6 * np.linspace(0, 1, 24))
    assert _said(tmp_path / "early.axiscal", drifting[:3]) == []
    said = _said(tmp_path / "late.axiscal", drifting)
    assert said[0].startswith("The readings contradict the model, by odds of 10^")
    assert 'the zero of "laser" drifts' in said[0]
    assert not any("contradict" in each for each in _said(tmp_path / "still.axiscal", still))


def test_nothing_is_said_of_a_campaign_that_has_ended(tmp_path: Path) -> None:
    with Campaign.create(tmp_path / "ended.axiscal", CASE.description) as campaign:
        campaign.adopt(tuple(plus(read(machine(2), 24), 10e-6 * np.linspace(0, 1, 24))))
        campaign.finish("no more time")
        assert contradicted_words(campaign) == []
        campaign.undo()
        assert len(contradicted_words(campaign)) == 1
