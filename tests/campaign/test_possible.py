"""What a record says must be possible on its machine, or it is damaged and the event is named."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.description.campaign import campaign_from_texts
from axiscal.exceptions import ReadingError
from axiscal.measurement.reading import Reading
from axiscal.record.events import Recorded
from axiscal.record.store import Record
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text("w-X'-b-Y-t", {"X": (0, 300), "Y": (0, 200)}, {"EXX": "20 um"})
CAMPAIGN = campaign_text(
    "machine.toml", setup_text("along x", "interferometer", direction="x", moves=["X"]), target={"readings": 5}
)


def begun(path: Path) -> Campaign:
    description = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")
    return Campaign.create(path, description)


def test_the_ends_of_the_travel_are_possible(tmp_path: Path) -> None:
    path = tmp_path / "r.axiscal"
    begun(path).close()
    with Record.open(path) as record:
        record.append(*(Recorded(Reading("along x", pose, (0, 0), 1e-6)) for pose in ((0.3, 0.0), (0.0, 0.2))))
    with Campaign.open(path) as campaign:
        assert len(campaign.state.readings) == 2


@pytest.fixture(scope="module")
def asked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Campaign]:
    """A campaign whose first reading is asked for."""
    with begun(tmp_path_factory.mktemp("asked") / "r.axiscal") as campaign:
        campaign.next()
        yield campaign


NO_STD = r"no standard deviation.*at least 0\.1 nm"
"""Of one of 1e-9 um each command after it ended with a defect."""


@pytest.mark.parametrize(
    ("value", "std", "says"),
    [
        *((value, None, "no deviation of a machine") for value in (1e3, -1e30, float("nan"), float("inf"))),
        *((1e-6, std, NO_STD) for std in (0.0, -1e-6, 9e-11, 1e-300)),
        (1e-6, float("nan"), "^nan m or rad is no deviation of a machine"),
    ],
)
def test_what_no_reading_has_is_not_recorded(asked: Campaign, value: float, std: float | None, says: str) -> None:
    with pytest.raises(ReadingError, match=says):
        asked.record(value, std)
    assert asked.state.readings == ()
