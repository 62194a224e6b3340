"""Checks are planned, asked, kept in the record and told from others in results, however the readings come."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.readers.files import read_any
from axiscal.measurement.reading import Place, Reading
from axiscal.present.result_document import readings_csv, result_json
from axiscal.present.summarising import Extras, summarise
from axiscal.record.events import Asked
from tests.generators.texts import campaign_text, machine_text, setup_text

TEXT = campaign_text("m", setup_text("dial", "indicator", direction="x", noise="1 um"), target={"readings": 7})
MACHINE = machine_text("w-b-X-t", {"X": (0, 500)}, {"EXX": 'std = "10 um", length = "200 mm", knots = 6'})
PLACES = tuple(
    Place("dial", (at,), (1,), check) for at, check in ((0.1, False), (0.317, True), (0.4, False), (0.222, True))
)


@pytest.fixture
def campaign(tmp_path: Path) -> Campaign:
    described = campaign_from_texts(TEXT, "c.toml", MACHINE, "m")
    return Campaign.create(tmp_path / "c.axiscal", described, lambda *_: PLACES)


def test_a_reading_that_was_asked_for_as_a_check_is_one_in_the_record(campaign: Campaign) -> None:
    with campaign:
        for value, place in zip((1e-6, 3e-6, 2e-6, -1e-6), PLACES, strict=True):
            asked = campaign.next(beyond=True)
            assert isinstance(asked, Asked)
            assert asked.place.check is place.check
            campaign.record(value)
    with Campaign.open(campaign.path) as again:
        assert [reading.check for reading in again.state.readings] == [place.check for place in PLACES]
        again.undo()
        assert again.state.pending is not None
        assert again.state.pending.place.check
        again.record(-1e-6)
        assert again.state.readings[-1].check
        again.record(0.0, at=Place("dial", (0.3,), (1,)))
        assert not again.state.readings[-1].check
        found = summarise(again, again.estimate(ended=True), Extras())
    document = result_json(found)["checks"]
    assert (document["count"], document["as_promised"]) == (2, 2)
    assert [each["reading"] for each in document["each"]] == [2, 4]
    assert document["s"] ** 2 == pytest.approx(sum(each["z"] ** 2 for each in document["each"]) / 2, rel=1e-4)
    assert (found.answer.checks, found.answer.as_promised) == (2, 2)


def test_readings_of_a_file_at_places_of_checks_are_checks_and_their_file_says_so(
    campaign: Campaign, tmp_path: Path
) -> None:
    with campaign:
        campaign.prepared()
        campaign.adopt(tuple(Reading("dial", place.pose, place.approach, 1e-6) for place in PLACES))
        assert [reading.check for reading in campaign.state.readings] == [place.check for place in PLACES]
        written = tmp_path / "readings.csv"
        written.write_bytes(readings_csv(summarise(campaign, campaign.estimate(ended=True), Extras())))
    assert [row.check for row in read_any(written)] == [place.check for place in PLACES]
