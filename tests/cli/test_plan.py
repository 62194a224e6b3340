"""`axiscal plan`: the document outsiders rely on, its bound, programs, refusals; `next` asks what it printed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

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
