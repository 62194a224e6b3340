"""`axiscal plan` and the bound that it states."""

from __future__ import annotations

from pathlib import Path

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


def test_a_plan_states_what_no_other_can_beat_where_it_is_near(campaign: Path, command: Command) -> None:
    """Four readings of seven coefficients leave three; forty leave none, and nothing is stated."""
    document = command("plan", campaign, "--readings", "4", "--json").document
    assert 0.5 * document["rms_um"] <= document["bound_rms_um"] <= document["rms_um"]
    said = command("plan", campaign, "--readings", "4", "--details").printed
    assert f"No plan of 4 readings can reach a smaller RMS than {document['bound_rms_um']:.0f} um" in said
    assert command("plan", campaign, "--readings", "40", "--json").document["bound_rms_um"] is None
