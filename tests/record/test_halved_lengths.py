"""A record of before with half of each length at each of its ends: it still says what it said, also as a prior."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

from axiscal.answers.answer_of_campaign import answered, standing_answer
from axiscal.campaign.campaign import Campaign
from axiscal.estimation.inheritance import last_estimation
from axiscal.record.copies import carried_text

SAID = pytest.approx((-3908.36, 748.592), rel=1e-5)
"""urad, the angle of a printed square and its U: in result.json of the version that began the record."""


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """The record, of three lengths measured by calipers."""
    packed = Path(__file__).with_name("earlier") / "halved-lengths.axiscal.gz"
    path = tmp_path / "square.axiscal"
    path.write_bytes(gzip.decompress(packed.read_bytes()))
    return path


def test_it_says_what_it_said_and_stays_as_it_is(record: Path) -> None:
    before = record.read_bytes()
    with Campaign.open(record) as campaign:
        assert len(campaign.state.readings) == 6
        (row, *_) = standing_answer(campaign).rows
    assert (row.signed[0].value, row.signed[0].U) == SAID
    assert record.read_bytes() == before


@pytest.mark.long
def test_what_it_leaves_the_next_campaign_is_the_same(record: Path) -> None:
    (row, *_) = answered(last_estimation(carried_text(record)), {})
    assert (1e6 * row.signed[0].value, 1e6 * row.signed[0].known) == SAID
