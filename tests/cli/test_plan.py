"""`axiscal plan`: the document outsiders rely on, its bound, programs, refusals; `next` asks what it printed."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from axiscal.cli.app import run
from tests.commands import Command
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 10)}, {"EXX": 'std = "1 mm", knots = 7'})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("dial", "indicator", direction="x", noise="0.1 mm", unknowns={}),
    target={"readings": 7, "criterion": "joint"},
    usual="off",
    sure="exactly",
)


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    path = tmp_path / "campaign.toml"
    path.write_text(CAMPAIGN)
    return path


def test_so_many_readings_are_planned_whatever_accuracy_the_campaign_asks_for(campaign: Path, command: Command) -> None:
    campaign.write_text(CAMPAIGN.replace("readings = 7", 'rms = "0.6 mm"'))
    assert len(command("plan", campaign, "--readings", "9", "--json").document["points"]) == 9


@pytest.mark.parametrize(("sure", "needed", "more"), [("exactly", 0, ["--prove"]), ("roughly", 6, [])])
def test_a_target_that_is_met_before_anything_is_read_needs_a_few_that_check_the_sizes(
    campaign: Path, sure: str, needed: int, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    campaign.write_text(campaign.read_text().replace('sure = "exactly"', f'sure = "{sure}"'))
    assert run(["plan", str(campaign), "--target", "90 mm", "--json", *more]) == 0
    printed = capsys.readouterr()
    assert len(json.loads(printed.out)["points"]) == needed
    assert ("meet the target unread" in " ".join(printed.err.split())) == (needed > 0)


def test_a_proof_holds_anywhere_in_the_travel(campaign: Path, command: Command) -> None:
    """Seven readings leave 0.08318 mm² mm at best, as boxes of another program prove too."""
    document = command("plan", campaign, "--prove", "--gap", "0.5", "--json").document
    assert 0.0827e-9 < document["bound_J"] <= document["J"]
    assert document["J"] == pytest.approx(0.08318e-9, rel=1e-4)
    assert document["bound_holds_for"] == "every position in the travel"
    assert 0 <= document["proof_gap_percent"] <= 0.5001
    said = next(
        line
        for line in command("plan", campaign, "--prove", "--details").printed.splitlines()
        if line.startswith("No plan")
    )
    assert said.startswith("No plan of 7 readings anywhere in the travel can make J smaller than 8.2")
    assert "; the proof stopped at a gap of " in said


@pytest.mark.long
def test_a_proof_in_micrometres(campaign: Path, command: Command) -> None:
    campaign.write_text(CAMPAIGN.replace('criterion = "joint"', ""))
    document = command("plan", campaign, "--prove", "--json").document
    assert document["ratio"] == pytest.approx((document["rms_um"] / document["bound_rms_um"]) ** 2)
    assert document["proof_gap_percent"] <= 0.5


@pytest.mark.parametrize(
    ("machine", "setup", "why"),
    [
        ("dmu60", 'moves = ["X", "Y", "Z", "B"]', "4 coordinates without steps, more than 3"),
        ("paper-three-stacked", 'station = ["0 mm", "0 mm", "-300 mm"]', "no polynomial of where it is"),
    ],
)
def test_no_proof_where_boxes_cannot_be_cut(
    campaign: Path, machine: str, setup: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = CAMPAIGN.replace("machine.toml", machine).replace("unknowns = {}", setup)
    if "station" in setup:
        text = text.replace('"indicator"', '"tracer"').replace('direction = "x"', "")
    campaign.write_text(text)
    assert run(["plan", str(campaign), "--prove"]) == 1
    printed = capsys.readouterr()
    said = " ".join(printed.err.split())
    assert why in said
    assert "Leave --prove out" in said
    assert printed.out == ""
    assert "..." not in said


def test_what_half_the_minutes_these_and_twice_as_many_buy_is_shown(campaign: Path, command: Command) -> None:
    document = command("plan", campaign, "--readings", "4", "--json").document
    half, own, twice = [each for each in document["bought"] if each["mark"]]
    assert [half["mark"], own["mark"], twice["mark"]] == ["half", "asked", "double"]
    assert [half["minutes"], twice["minutes"]] == pytest.approx([own["minutes"] / 2, 2 * own["minutes"]])
    assert own["minutes"] == pytest.approx(document["minutes"])
    assert half["expanded_um"] > own["expanded_um"] > twice["expanded_um"]
    printed = command("plan", campaign, "--readings", "4", "--details").printed
    bars = re.search(r"What minutes buy, over the volume: (\S+) ", printed)
    assert bars is not None
    assert list(bars[1]) == sorted(bars[1], reverse=True)
    assert len(bars[1]) == len(document["bought"])
    assert bars[1][0] == "█"


def test_a_set_up_that_no_budget_reaches_is_named(
    campaign: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    slow = CAMPAIGN[CAMPAIGN.index("[[setups]]") :].replace('name = "dial"', 'name = "slow"')
    campaign.write_text(f'{CAMPAIGN}\n{slow}\nsetup_time = "50 min"\n')
    assert run(["plan", str(campaign), "--budget", "30 min"]) == 0
    assert 'than the 30 min there are: "slow" (50' in " ".join(capsys.readouterr().err.split())


def test_a_target_out_of_reach_is_said_at_once(campaign: Path, tmp_path: Path, command: Command) -> None:
    text = CAMPAIGN.replace("readings = 7", 'rms = "500 um"').replace('criterion = "joint"', "")
    campaign.write_text(text)
    said = command("plan", campaign, "--target", "2 um").refusal
    assert "1,000 readings leave at least" in said
    assert 'With half the noise in "dial" (50 um)' in said
    (tmp_path / "machine.toml").write_text(MACHINE.replace("knots = 7", 'knots = 7, rest = "3 um"'))
    said = command("plan", campaign, "--target", "2 um").refusal
    assert "endless readings would leave 3" in said
    assert "finer knots" in said
    campaign.write_text(text.replace('"x"', '"y"'))
    said = command("plan", campaign, "--target", "5 um").refusal
    assert 'With "laser along X" as well, 7 readings reach it' in said  # though X has only a centimetre to go


def test_a_plan_of_fewer_readings_than_asked_for_says_so(campaign: Path, command: Command) -> None:
    found = re.search(
        r"(\d+) of (\d+) readings: more do not fit into 10.4 min",
        command("plan", campaign, "--readings", "12", "--budget", "10.4 min").printed,
    )
    assert found is not None
    planned, asked = map(int, found.groups())
    assert planned < asked == 12
    assert "of 3 readings" not in command("plan", campaign, "--readings", "3").printed


MILL = (Path(__file__).parents[1] / "golden" / "campaigns" / "mill" / "campaign.toml").read_text()
DRIFT = campaign_text(
    "one-axis",
    setup_text("laser", "interferometer", direction="x", approach="both", reading_time="8 min", drift="6 um/h"),
    target={"readings": 4},
)


@pytest.mark.long
@pytest.mark.parametrize("text", [MILL, DRIFT], ids=["mill", "drift"])
def test_places_are_asked_in_the_order_in_which_they_are_printed(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("campaign.toml").write_text(text)

    def said(*words: str) -> Any:
        return command(*words).document

    planned = said("plan", "campaign.toml", "--json")["points"]
    assert len(planned) >= 3
    said("start", "campaign.toml", "--json")
    for point in planned:
        question = said("next", "campaign.axiscal", "--json")["question"]
        assert [question[key] for key in ("setup", "position", "approach")] == [
            point[key] for key in ("setup", "position", "approach")
        ]
        said("record", "campaign.axiscal", "0 um", "--json")
