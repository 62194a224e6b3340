"""`axiscal type`, and a campaign that names its sisters: from a folder of records to a plan."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.estimation.type_prior import is_type_text
from tests.generators.sisters import CAMPAIGN, MACHINE, shop


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "records").mkdir()
    shop(tmp_path / "records", 3)
    (tmp_path / "machine.toml").write_text(MACHINE.format(serial="", travel=500))
    (tmp_path / "campaign.toml").write_text(CAMPAIGN.format(first='sisters = { records = "records/*.axiscal" }\n'))
    return tmp_path


@pytest.mark.long
def test_learn_explain_and_a_campaign_by_the_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = folder / "slide.type.json"
    assert run(["type", "learn", str(folder / "records"), "--out", str(file), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [each["counts"] for each in document["records"]] == [True] * 3
    assert 0 < document["errors"]["EXX"]["in_common"] < 1
    (folder / "campaign.toml").write_text(CAMPAIGN.format(first='prior = "slide.type.json"\n'))
    assert run(["type", "explain", str(file), "--campaign", str(folder / "campaign.toml")]) == 0
    said = capsys.readouterr().out
    assert "Learnt from 3 machines" in said
    assert "become" in said
    assert run(["start", str(folder / "campaign.toml"), str(folder / "new.axiscal"), "--json"]) == 0


@pytest.mark.long
def test_a_record_carries_what_its_sisters_taught(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["start", str(folder / "campaign.toml"), str(folder / "new.axiscal"), "--json"]) == 0
    for record in (folder / "records").iterdir():
        record.unlink()
    with Campaign.open(folder / "new.axiscal", write=False) as campaign:
        assert is_type_text(campaign.description.prior_text)
        assert campaign.estimate().membership is not None
    assert run(["start", str(folder / "campaign.toml"), str(folder / "other.axiscal"), "--json"]) == 1
    assert "names no record that is there" in " ".join(capsys.readouterr().err.split())


def test_two_priors_and_a_damaged_type_are_sentences(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = 'prior = "x.axiscal"\nsisters = { records = "records/*.axiscal" }\n'
    (folder / "x.axiscal").write_bytes(next((folder / "records").iterdir()).read_bytes())
    (folder / "campaign.toml").write_text(CAMPAIGN.format(first=both))
    assert run(["plan", str(folder / "campaign.toml")]) == 1
    assert "Leave one of them out" in " ".join(capsys.readouterr().err.split())
    (folder / "bad.type.json").write_text('{\n "schema": "axiscal-type/1", "machine": "')
    (folder / "campaign.toml").write_text(CAMPAIGN.format(first='prior = "bad.type.json"\n'))
    assert run(["plan", str(folder / "campaign.toml")]) == 1
    assert "axiscal shop type learn" in " ".join(capsys.readouterr().err.split())


@pytest.mark.long
def test_virtual_sisters_fill_a_folder_once(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "campaign.toml").write_text(CAMPAIGN.format(first="").replace('rms = "2 um"', "readings = 6"))
    command = ["type", "rehearse", str(folder / "campaign.toml"), "--machines", "2", "--out", str(folder / "virtual")]
    assert run([*command, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["records"]) == 2
    assert run(command) == 1
    assert "exists already" in capsys.readouterr().err
