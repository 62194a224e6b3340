"""A zero that was set anew, as a person tells it: the readings before have a zero of their own."""

from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.outputs import standing_screen
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import ReadingError, RecordError
from axiscal.measurement.reading import Place
from axiscal.present.answer_of_campaign import standing_answer
from axiscal.present.guide.actions import Named, named_now
from axiscal.record.accepted import Accepted
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, read
from tests.generators.turned_back import OUT, begun_out_and_back

DESCRIBED = campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m")


def _begun(path: Path, count: int, step: float = 0.0, before: int = 0) -> Campaign:
    """Return a campaign of some readings, with a step before one of them."""
    campaign = Campaign.create(path, DESCRIBED)
    for index, each in enumerate(read(machine(3), 15)[:count]):
        campaign.record(each.value + step * (index >= before), at=each.place)
    return campaign


def _setups(campaign: Campaign) -> list[str]:
    return [each.setup for each in campaign.state.readings]


def test_the_next_reading_has_a_zero_of_its_own_and_undo_takes_that_back(tmp_path: Path) -> None:
    with _begun(tmp_path / "r.axiscal", 4) as campaign:
        campaign.next()
        told = campaign.accept("jump", before=campaign.state.free)
        assert told == Accepted("jump", ("laser",), 5, name="laser, before reading 5")
        assert _setups(campaign) == ["laser, before reading 5"] * 4
        assert campaign.next().place.setup == "laser"  # type: ignore[union-attr]
        assert campaign.record(3e-4).number == 5
        assert _setups(campaign)[-1] == "laser"
        assert not campaign.estimate().left_out
        with pytest.raises(ReadingError, match="its zero jumped"):
            campaign.record(0.0, at=Place("laser, before reading 5", (0.1,), (1,)))
        assert {place.setup for place in campaign.prepared()} == {"laser"}
    with Campaign.open(tmp_path / "r.axiscal") as again:
        assert _setups(again) == ["laser, before reading 5"] * 4 + ["laser"]
        again.undo()
        again.undo()
        assert _setups(again) == ["laser"] * 4
        assert again.next().reading == 5  # type: ignore[union-attr]


@pytest.mark.parametrize(("setup", "before"), [("laser", 1), ("laser", 0), ("laser", 9), ("other", 3)])
def test_a_zero_before_the_first_reading_or_behind_the_next_is_refused(setup: str, before: int, tmp_path: Path) -> None:
    with _begun(tmp_path / "r.axiscal", 3) as campaign:
        last = campaign.state.last
        with pytest.raises(RecordError, match=f'No zero of "{setup}" can change before reading {before}'):
            campaign.accept("jump", setup, before)
        assert campaign.state.last == last


def test_a_step_is_asked_about_by_the_second_reading_behind_it_and_accepted_it_agrees(tmp_path: Path) -> None:
    """Once more it is not asked: the same jump was named before."""
    with _begun(tmp_path / "r.axiscal", 6, 140e-6, 5) as campaign:
        assert named_now(campaign) is None
        places = read(machine(3), 15)[6:]
        asked = list[Named | None]()
        for each in places[:3]:
            campaign.record(each.value + 140e-6, at=each.place)
            asked.append(named_now(campaign))
        assert asked[0] == Named("jump", "laser", 6, 'Was the zero of "laser" set anew before reading 6?', ("jump",))
        assert asked[1:] == [asked[0]] * 2
        assert campaign.accept("jump").reading == 6
        assert named_now(campaign) is None
        assert not campaign.estimate().agreement.contradicts


@pytest.mark.parametrize("answer", ["jump", "backlash"])
def test_a_step_where_the_axis_turned_stands_on_the_screen_until_it_is_answered(tmp_path: Path, answer: str) -> None:
    record = begun_out_and_back(tmp_path / "r.axiscal", 2 * OUT, 30e-6)
    asked = "shows a step before reading 11, where X turned: zero set anew, or backlash? (1 : "
    with Campaign.open(record) as campaign:
        assert asked in " ".join(standing_screen(campaign).split())
        assert standing_answer(campaign).asks
        before = {row.row for row in standing_answer(campaign).rows if row.measured}
        campaign.accept(answer)
        assert "backlash?" not in standing_screen(campaign)
        after = {row.row for row in standing_answer(campaign).rows if row.measured}
        assert before - after == ({"backlash X"} if answer == "jump" else set())
