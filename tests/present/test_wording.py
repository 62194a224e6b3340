"""Numbers and sentences as a reader sees them."""

from axiscal.campaign.ending import because_text
from axiscal.language.spoken import said, speaking


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
