"""The campaign on a machine with one unknown and a plain plan: what it asks, keeps, takes back, and when it stops."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import OUT_OF_REACH, Milestone
from axiscal.campaign.sources import Answer, Request, Skip
from axiscal.description.campaign import read_campaign
from axiscal.exceptions import RecordError, SourceError
from axiscal.measurement.reading import Place, Reading
from axiscal.record.events import Asked, Gap
from tests.generators.texts import machine_text

MACHINE = machine_text("w-X'-Y'-b-t", {"X": (0, 600), "Y": (0, 400)}, {"EXX_reversal": "20 um"})
TEXT = """
machine = "m.toml"
usual = "off"
sure = "exactly"
[target]
TARGET
[[setups]]
name = "laser along X"
instrument = "interferometer"
direction = "x"
moves = ["X"]
park = { Y = "200 mm" }
approach = "both"
noise = "10 um"
unknowns = {}
setup_time = "0 s"
settle = "0 s"
reading_time = "59 s"
[[setups]]
name = "laser along Y"
instrument = "interferometer"
direction = "y"
moves = ["Y"]
park = { X = "200 mm" }
"""
"""The machine has one unknown, half a reversal of 10 um, and each reading has a noise of 10 um and takes a minute."""


def std_after(readings: int) -> float:
    """Return how well the machine is known: 1/σ² adds up."""
    return float(10e-6 / np.sqrt(1 + readings))


def every_ten_millimetres(
    _case: object,
    _knowledge: object,
    readings: Sequence[Reading],
    _outliers: object,
    gaps: Sequence[Gap],
    _left: object,
) -> tuple[Place, ...]:
    """Plan X = 0, 10, 20 … mm, each place once."""
    closed = {reading.pose[0] for reading in readings} | {gap.place.pose[0] for gap in gaps}
    return tuple(Place("laser along X", (0.01 * n, 0.2), (1, 0)) for n in range(61) if 0.01 * n not in closed)


class Listed:
    """A source that gives the answers of a list, and raises those that are failures."""

    def __init__(self, *answers: Answer | Skip | BaseException) -> None:
        self.answers = list(answers)
        self.requests: list[Request] = []

    def read(self, request: Request) -> Answer | Skip:
        self.requests.append(request)
        answer = self.answers.pop(0)
        if isinstance(answer, BaseException):
            raise answer
        return answer

    def close(self) -> None:
        pass


class Start(Protocol):
    def __call__(self, target: str, noise: str = ...) -> Campaign: ...


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    opened: list[Campaign] = []

    def begin(target: str, noise: str = "10 um") -> Campaign:
        (tmp_path / "m.toml").write_text(MACHINE)
        (tmp_path / "c.toml").write_text(TEXT.replace("TARGET", target).replace("10 um", noise))
        description = read_campaign(tmp_path / "c.toml")
        opened.append(Campaign.create(tmp_path / "c.axiscal", description, every_ten_millimetres))
        return opened[-1]

    yield begin
    for campaign in opened:
        campaign.close()


def reopened(campaign: Campaign) -> Campaign:
    campaign.close()
    return Campaign.open(campaign.path, every_ten_millimetres)


def ignore(milestone: Milestone) -> None:
    pass


def test_undo_takes_back_and_asks_again(start: Start) -> None:
    campaign = start("readings = 3")
    first = campaign.next()
    campaign.record(1e-6)
    assert campaign.estimate().accuracy.rms == pytest.approx(std_after(1), rel=1e-6)
    campaign.next()
    campaign.undo()
    assert campaign.estimate().accuracy.rms == pytest.approx(std_after(0), rel=1e-6)
    assert campaign.next() == first
    with pytest.raises(RecordError, match="nothing to take back"):
        campaign.undo()


@pytest.mark.parametrize(
    ("target", "because", "readings"),
    [
        ('rms = "5.1 um"', "rms target reached", 3),
        ('worst = "4.5 um"', "worst target reached", 4),
        ("readings = 7", "7 readings taken", 7),
        ('budget = "40 min"', "time budget used", 40),
        ('rms = "2 um"\nreadings = 2', "2 readings taken", 2),
        ('rms = "2 um"\nworst = "7.2 um"\nbudget = "60 min"', "worst target reached", 1),
        ("readings = 70", "nothing is left to measure", 61),
    ],
)
def test_the_first_target_reached_stops(start: Start, target: str, because: str, readings: int) -> None:
    campaign = start(target)
    seen: list[Milestone] = []
    values = np.random.default_rng(1).normal(0, 10e-6, 100).tolist()
    assert campaign.run(Listed(*map(Answer, values)), seen.append) == because
    assert campaign.state.finished == because
    assert [milestone.number for milestone in seen] == list(range(readings + 1))
    assert [m.accuracy.rms for m in seen] == pytest.approx([std_after(n) for n in range(readings + 1)], rel=1e-6)


def test_beyond_the_plan_no_reading_is_worth_a_long_mounting(start: Start, tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(MACHINE.replace("[errors]", '[errors]\nEYY_reversal = { std = "20 um" }'))
    (tmp_path / "d.toml").write_text(TEXT.replace("TARGET", "readings = 4") + 'approach = "both"\nsetup_time = "1 h"\n')
    with Campaign.create(tmp_path / "d.axiscal", read_campaign(tmp_path / "d.toml")) as campaign:
        places = ("laser along Y", (0.2, 0.1), (0, 1)), ("laser along X", (0.1, 0.2), (1, 0))
        campaign.adopt(tuple(Reading(*place, 1e-6) for place in (*places, *places)))
        for _ in range(3):
            question = campaign.next(beyond=True)
            assert isinstance(question, Asked)
            assert question.place.setup == "laser along X"
            campaign.record(1e-6, live=False)


def test_a_finished_campaign_is_closed_until_the_end_is_taken_back(start: Start) -> None:
    campaign = start("readings = 3")
    campaign.next()
    assert campaign.finish() == "ended by the operator"
    assert campaign.finish() == "ended by the operator"
    for step in (campaign.next, lambda: campaign.record(1e-6), lambda: campaign.skip("late")):
        with pytest.raises(RecordError, match="finished: ended by the operator"):
            step()
    campaign.undo()
    assert isinstance(campaign.next(), Asked)


@pytest.mark.parametrize("failure", [SourceError("the command died", "mend it"), KeyboardInterrupt()])
def test_a_failing_source_costs_no_reading_and_the_run_goes_on(start: Start, failure: BaseException) -> None:
    campaign = start("readings = 5")
    with pytest.raises(type(failure)):
        campaign.run(Listed(Answer(1e-6), Skip("warming up"), Answer(2e-6), failure), ignore)
    with reopened(campaign) as again:
        assert [reading.value for reading in again.state.readings] == [1e-6, 2e-6]
        source = Listed(*[Answer(3e-6)] * 5)
        assert again.run(source, ignore) == "5 readings taken"
        assert [request.reading for request in source.requests] == [4, 5, 6]


def test_a_source_that_only_skips_is_given_up(start: Start) -> None:
    campaign = start("readings = 5")
    with pytest.raises(SourceError, match="skipped 25 readings in a row; the last one because: warming up"):
        campaign.run(Listed(*[Skip("warming up")] * 99), ignore)
    assert len(campaign.state.skipped) == 25


def test_a_target_that_no_reading_brings_nearer_ends_the_run(start: Start) -> None:
    campaign = start('rms = "2 um"', noise="10 mm")
    assert campaign.run(Listed(*[Answer(1e-6)] * 60), ignore) == OUT_OF_REACH
    assert len(campaign.state.readings) == 50


def test_a_reading_that_cannot_be_ends_the_run_and_is_kept(start: Start) -> None:
    campaign = start("readings = 9")
    with pytest.raises(SourceError, match=r"reading 3 in .*standard deviations.*mm instead of um"):
        campaign.run(Listed(Answer(1e-6), Answer(2e-6), Answer(5e-3)), ignore)
    assert len(campaign.state.readings) == 3
    assert campaign.state.finished is None
