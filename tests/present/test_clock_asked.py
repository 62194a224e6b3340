"""A clock that has jumped forward is asked about, on each surface that takes readings."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign import campaign as campaign_file
from axiscal.campaign.campaign import Campaign
from axiscal.present.guide.progress import others_doubted
from tests.generators.begun import begun
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, read

HOUR = 3600.0


@pytest.mark.parametrize(("passed", "asked"), [(15.9 * HOUR, ""), (16.1 * HOUR, "16.1 h")])
def test_a_clock_that_has_jumped_forward_is_asked_about(
    passed: float, asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun(tmp_path, {"campaign.toml": CAMPAIGN, "m": MACHINE}, ("step", "start", "campaign.toml", "m.axiscal"))
    times = iter([60.0, 60.0 + passed])
    monkeypatch.setattr(campaign_file, "seconds_since", lambda *_: next(times))
    with Campaign.open(tmp_path / "m.axiscal") as campaign:
        for reading in read(machine(2), 24)[:2]:
            campaign.record(reading.value, at=reading.place)
        minds = [mind for mind in others_doubted(campaign, frozenset()) if "clock" in mind]
    assert [f"{asked} have passed since reading 1" in mind for mind in minds] == ([True] if asked else [])
