"""What happens while measuring, on a machine of one axis: the plan stands, or the rest is renewed, from the record."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from axiscal.campaign.basis import plan_basis
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.sources.source import SimulatedSource
from axiscal.description.campaign import read_campaign
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.judged import Doubt
from axiscal.measurement.reading import Place, Reading
from axiscal.measurement.simulation import Simulator
from axiscal.planning.next_readings import next_places, twice_rejected
from axiscal.record.events import Asked, Planned
from tests.generators.texts import campaign_text, setup_text

TEXT = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", noise="0.5 um", approach="both"),
    target={"readings": 16},
    usual="off",
    sure="exactly",
)
OFF = 40e-6
"""How wrong a reading is that the others contradict."""

Start = Callable[[], tuple[Campaign, SimulatedSource]]


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    opened: list[Campaign] = []

    def begin() -> tuple[Campaign, SimulatedSource]:
        (tmp_path / "c.toml").write_text(TEXT)
        description = read_campaign(tmp_path / "c.toml")
        opened.append(Campaign.create(tmp_path / "c.axiscal", description))
        truth = Simulator(description.machine, description.setups).drawn(3)
        return opened[-1], SimulatedSource(truth, 3)

    yield begin
    for campaign in opened:
        campaign.close()


def question(campaign: Campaign) -> Asked:
    """Return what is asked for next."""
    asked = campaign.next()
    assert isinstance(asked, Asked)
    return asked


def read(campaign: Campaign, source: SimulatedSource, count: int) -> None:
    """Take so many readings where they are asked for."""
    for _ in range(count):
        campaign.record(source.read(campaign.request(question(campaign))).value)


def plans(campaign: Campaign) -> list[Planned]:
    """Return all plans of the record, the first one first."""
    return [stored.event for stored in campaign.log.events() if isinstance(stored.event, Planned)]


@pytest.mark.long
def test_the_plan_follows_from_the_record(start: Start) -> None:
    campaign, source = start()
    read(campaign, source, 9)
    campaign.record(source.read(campaign.request(question(campaign))).value + OFF)
    following = question(campaign)
    renewed = campaign.state.plan
    with Campaign.open(campaign.path) as again:
        assert (again.next(), again.state.plan) == (following, renewed)
        again.record(source.read(again.request(following)).value)
        question(again)
        assert len(plans(again)) == 2
    known = estimated(Case(campaign.description), campaign.state.readings)
    left = plans(campaign)[0].places[10:]
    found = next_places(known.case, known.knowledge, known.readings, known.outliers, (), left)
    assert found == plans(campaign)[1].places


def test_a_reading_elsewhere_or_taken_back_renews_the_rest(start: Start) -> None:
    campaign, source = start()
    read(campaign, source, 3)
    question(campaign)
    elsewhere = Place("laser", (0.123,), (1,))
    campaign.record(campaign.state.readings[-1].value, at=elsewhere)
    question(campaign)
    assert len(plans(campaign)) == 2
    campaign.undo()
    read(campaign, source, 2)
    question(campaign)
    assert len(plans(campaign)) == 3


def test_one_rejected_reading_makes_no_gap_and_two_in_different_places_make_none(start: Start) -> None:
    campaign, _ = start()
    case = Case(campaign.description)
    readings = [Reading("laser", (x,), (1,), 0.0, None) for x in (0.1, 0.1001, 0.3, 0.3)]
    rejected = [Doubt(index, 9.0) for index in range(4)]
    assert twice_rejected(case, readings, rejected[:1]) == ()
    assert twice_rejected(case, readings, rejected[1:3]) == ()
    assert [gap.place.pose for gap in twice_rejected(case, readings, rejected)] == [(0.1001,), (0.3,)]


@pytest.mark.parametrize(("drift", "basis"), [('drift = "0"', ["", "", ""]), ("", ["", "1 times 20 min", ""])])
def test_where_a_zero_drifts_a_plan_rests_on_the_clock(drift: str, basis: list[str], tmp_path: Path) -> None:
    (tmp_path / "c.toml").write_text(TEXT + drift)
    case = Case(read_campaign(tmp_path / "c.toml"))
    times: list[list[float]] = [[5.0], [5.0, 1900.0], []]
    taken = [[Reading("laser", (0.1,), (1,), 0.0, None, time=time) for time in each] for each in times]
    assert [plan_basis(case, readings, ()) for readings in taken] == basis
    noisy = [Reading("laser", (0.1,), (1,), 0.0, std, time=5.0) for std in (0.52e-6, 2e-6)]
    assert plan_basis(case, noisy, ()) == "noise of 2"
