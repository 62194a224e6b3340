"""`axiscal type`, and a campaign that names its sisters: from a folder of records to a plan."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.type_text import is_type_text
from tests.commands import Command
from tests.generators.sisters import CAMPAIGN, MACHINE, shop


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "records").mkdir()
    shop(tmp_path / "records", 3)
    (tmp_path / "machine.toml").write_text(MACHINE.format(serial="", travel=500))
    (tmp_path / "campaign.toml").write_text(CAMPAIGN.format(first='sisters = { records = "records/*.axiscal" }\n'))
    return tmp_path


@pytest.mark.long
def test_a_record_carries_what_its_sisters_taught(folder: Path, command: Command) -> None:
    assert run(["start", str(folder / "campaign.toml"), str(folder / "new.axiscal"), "--json"]) == 0
    for record in (folder / "records").iterdir():
        record.unlink()
    with Campaign.open(folder / "new.axiscal", write=False) as campaign:
        assert is_type_text(campaign.description.prior_text)
        assert campaign.estimate().membership is not None
    assert (
        "names no record that is there"
        in command("start", folder / "campaign.toml", folder / "other.axiscal", "--json").refusal
    )
