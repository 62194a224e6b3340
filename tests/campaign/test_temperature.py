"""How warm the scale is, as a person says it: as in campaign.toml, taken back by undo, refused where it is idle."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.inheritance import last_campaign
from axiscal.exceptions import DescriptionError, ReadingError, RecordError
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import STEEL
from axiscal.present.answer_of_campaign import standing_answer
from axiscal.present.guide.actions import last_step
from axiscal.present.guide.progress import due, open_temperature
from axiscal.record.carried import carried_text
from tests.generators.laser_axis import CAMPAIGN, MACHINE

WARM = 5.0
"""K above 20 degC."""
PLACES = np.linspace(0.05, 0.55, 12)
"""m, on X."""
NOISE = 0.5e-6
"""m: as the set-up states."""


def _described(said: str = "", text: str = CAMPAIGN) -> CampaignDescription:
    return campaign_from_texts(text.replace("[[setups]]\n", f"[[setups]]\n{said}"), "c.toml", MACHINE, "m")


def _readings(described: CampaignDescription, strain: float = WARM * STEEL) -> tuple[Reading, ...]:
    """Return what a laser shows of a machine whose scale is warm and right at 20 degC, from both sides."""
    low, high = described.machine.axes[0].travel
    places, rng = low + PLACES / 0.6 * (high - low), np.random.default_rng(1)
    return tuple(
        Reading("laser", (at,), (side,), strain * at + rng.normal(0, NOISE))
        for side in (1, -1)
        for at in places.tolist()
    )


def _scale(campaign: Campaign) -> tuple[float, float]:
    """Return scale and its U, um/m."""
    row = next(row for row in standing_answer(campaign).rows if row.kind == "scale")
    return row.signed[0].value, row.known_to


@pytest.fixture
def warm(tmp_path: Path) -> Iterator[Campaign]:
    """A campaign of readings of a warm scale."""
    described = _described()
    with Campaign.create(tmp_path / "warm.axiscal", described) as campaign:
        campaign.adopt(_readings(described))
        yield campaign


def test_what_is_said_counts_as_if_campaign_toml_said_it(warm: Campaign, tmp_path: Path) -> None:
    unsaid = _scale(warm)
    assert unsaid[0] == pytest.approx(WARM * STEEL * 1e6, abs=1.0)
    warm.note("25,0 °C")
    stated = _described('temperature = "25 degC"\n')
    with Campaign.create(tmp_path / "stated.axiscal", stated) as other:
        other.adopt(_readings(stated))
        assert _scale(warm) == pytest.approx(_scale(other), rel=1e-9, abs=0.0)
    assert abs(_scale(warm)[0]) < 1.0
    assert _scale(warm)[1] < 0.6 * unsaid[1]
    warm.note("23 degC")
    assert _scale(warm)[0] == pytest.approx(STEEL * 1e6, abs=1.0)  # their mean is 24


def test_undo_takes_it_back_and_the_record_opens_with_it(warm: Campaign) -> None:
    before, plan = _scale(warm), warm.prepared()
    warm.note("22 °C")
    warm.note("the door is open")
    warm.note("23 °C")
    assert last_step(warm)[0] == 'the temperature of "laser", 23 °C'
    warm.undo()
    assert [note.text for note in warm.state.notes] == ["22 °C", "the door is open"]
    warm.close()
    with Campaign.open(warm.path) as again:
        assert again.description.setup("laser").warmer == pytest.approx(2.0)
        assert len(again.state.readings) == 24
        again.undo()
        assert again.description.setup("laser").warmer is None
        assert _scale(again) == before
        assert again.prepared() == plan


def test_a_temperature_that_no_scale_has_or_that_comes_after_the_end_is_refused(warm: Campaign) -> None:
    last = warm.state.last
    with pytest.raises(DescriptionError, match='"70 degC" is too large'):
        warm.note("70 degC")
    assert warm.state.last == last
    warm.finish()
    warm.note("the machine was cold")
    with pytest.raises(RecordError, match="Take the end back"):
        warm.note("21.4 °C")


@pytest.mark.parametrize(
    "text",
    [
        CAMPAIGN.replace('"interferometer"', '"indicator"'),
        CAMPAIGN.replace("[target]\n", '[target]\nrefers_to = "as read"\n'),
    ],
)
def test_it_is_refused_where_it_changes_nothing(text: str, tmp_path: Path) -> None:
    described = _described(text=text)
    with Campaign.create(tmp_path / "r.axiscal", described) as campaign:
        campaign.adopt(_readings(described))
        assert not open_temperature(campaign)
        with pytest.raises(ReadingError, match=r'"laser" compares no length .*Write a sentence: note the workshop'):
            campaign.note("21.4 °C")


def test_it_is_asked_for_once_and_again_after_half_an_hour(tmp_path: Path) -> None:
    with Campaign.create(tmp_path / "r.axiscal", _described()) as campaign:
        campaign.next()
        assert open_temperature(campaign)
        assert due(campaign).ask
        campaign.note("21.4 °C")
        assert not open_temperature(campaign)
        assert (due(campaign).ask, due(campaign).temperature_degc) == (False, 21.4)
        (note,) = campaign.state.notes
        campaign.state = replace(campaign.state, notes=(replace(note, at="2001-01-01T00:00:00+00:00"),))
        assert due(campaign).ask


def test_a_later_campaign_has_it(warm: Campaign) -> None:
    warm.note("24 °C")
    described, _ = last_campaign(carried_text(warm.path))
    assert described.setup("laser").warmer == pytest.approx(4.0)
