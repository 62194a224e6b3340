"""What skipping a reading and leaving a set-up cost, before it is done."""

from pathlib import Path

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.language.spoken import speaking
from axiscal.present.answer_of_campaign import cost_sentence, cost_words
from tests.generators.laser_axis import CAMPAIGN, MACHINE


def test_leaving_the_only_set_up_leaves_its_rows_unmeasured(tmp_path: Path) -> None:
    text = CAMPAIGN.replace('rms = "3 um"', "readings = 8")
    with Campaign.create(tmp_path / "c.axiscal", campaign_from_texts(text, "c.toml", MACHINE, "m")) as campaign:
        assert cost_words(campaign, rest=True) == ""  # nothing is asked for yet
        campaign.next()
        words = cost_words(campaign, rest=True)
        assert words.startswith("leaves positioning X")
        assert "unmeasured; volume " in words
        with speaking("de"):
            assert "ungemessen" in cost_words(campaign, rest=True)
        one = cost_words(campaign, rest=False)
        assert "unmeasured" not in one
        assert cost_sentence(one) == (f"{one}." if one else "By the plan as it stands this costs nothing.")
        campaign.skip("the laser has to go back", rest=True)
        assert campaign.state.plan == ()
