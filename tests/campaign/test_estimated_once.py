"""What is known follows from the record alone: the same in any folder, and no file is left for the next command."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from axiscal.campaign import campaign as running
from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import CampaignDescription, campaign_from_texts
from axiscal.estimation.estimation import Estimation
from axiscal.exceptions import AmbiguityError
from axiscal.measurement.reading import Reading
from tests.generators.laser_axis import CAMPAIGN, MACHINE, machine, plus, read
from tests.generators.recorded import write_record

COUNT = 24
SAID = ['usual = "off"\nsure = "exactly"', 'sure = "roughly"']


def _described(said: str = SAID[0]) -> CampaignDescription:
    text = CAMPAIGN.replace('rms = "3 um"', 'rms = "0.01 um"')
    return campaign_from_texts(f"{said}\n{text}", "c.toml", MACHINE, "m")


def _readings(count: int) -> tuple[Reading, ...]:
    """Return readings of a virtual machine, of which one is bad."""
    return tuple(plus(read(machine(3), count), 2e-5 * (np.arange(count) == 20)))


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A record of readings, in a folder of its own."""
    (tmp_path / "records").mkdir()
    return write_record(tmp_path / "records" / "c.axiscal", _described(), _readings(COUNT))


def _ambiguous(_case: object, _readings: Sequence[Reading], _known: Estimation) -> Estimation:
    raise AmbiguityError("the station fits in two places", "read where they differ")


def test_no_command_leaves_a_file_for_the_next(record: Path) -> None:
    with Campaign.open(record) as campaign:
        campaign.so_far()
        campaign.finish("all were read")
    with Campaign.open(record) as campaign:
        campaign.so_far()
        campaign.log.copy_to(record.with_name("copy.axiscal"))
    assert {path.name for path in record.parent.iterdir()} == {"c.axiscal", "copy.axiscal"}


def test_a_station_in_two_places_does_not_refuse_the_reading_that_decides_and_has_a_status_after_its_end(
    record: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running, "in_detail", _ambiguous)
    with Campaign.open(record) as campaign:
        assert campaign.estimate().readings
        with pytest.raises(AmbiguityError):
            campaign.estimate(ended=True)
        campaign.finish("no more time")
        assert campaign.so_far().accuracy == campaign.estimate().accuracy


def test_each_answer_is_found_once_for_the_same_readings(record: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with Campaign.open(record) as campaign:
        first = campaign.so_far(), campaign.reached(), campaign.estimate(ended=True)
        for name in ("in_detail", "standing"):
            monkeypatch.setattr(running, name, None)
        assert (campaign.so_far(), campaign.reached(), campaign.estimate(ended=True)) == first
        campaign.undo()
        with pytest.raises(TypeError):  # of other readings they say nothing
            campaign.reached()
