"""Numbers and sentences as a reader sees them."""

from __future__ import annotations

import pytest

from axiscal.campaign.ending import because_text
from axiscal.language.spoken import said, speaking
from axiscal.present.drawing.plot import PixelScale


def test_a_target_that_no_reading_can_reach_is_said_as_the_campaign_ended() -> None:
    kept = "rms target cannot be reached: endless readings would leave 9.7 um, these leave 9.73 um"
    assert because_text(kept) == kept
    with speaking("de"):
        assert because_text(kept).startswith("Ziel für rms")


def test_a_sentence_has_no_exponent_where_a_person_writes_none() -> None:
    assert said("{size:.2g} um, {share:.0%}", size=228.0, share=0.5) == "230 um, 50 %"
    assert said("{size:.2g} um", size=2.3e7) == "2.3e+07 um"
    with speaking("de"):
        assert said("{size:.2g} um", size=1.26e2) == "130 um"


@pytest.mark.parametrize(("low", "high", "apart"), [(-35, 35, 50), (-300, 300, 50), (0.2, 0.9, 99), (1e4, 3e4, 99)])
def test_a_scale_has_two_ticks_at_least(low: float, high: float, apart: float) -> None:
    ticks = PixelScale(low, high, 0.0, 100.0).ticks(apart)
    assert 2 <= len(ticks) <= 7
    assert all(0.0 <= at <= 100.0 for at, _ in ticks)
