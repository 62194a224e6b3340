"""`plan --gcode --log`, `estimate --log`, `record --log`: from a plan over a control's log to what is known."""

import json
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import read_campaign
from axiscal.programs import write_programs
from tests.commands import Command
from tests.generators import touched_table as table
from tests.programs.touching_controls import TouchingMachine, run_linuxcnc


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the log of a plan of eight readings, in a folder with its campaign and its programs."""
    monkeypatch.chdir(tmp_path)
    Path("machine.toml").write_text(table.MACHINE)
    Path("campaign.toml").write_text(table.CAMPAIGN)
    campaign = table.description()
    (file, *_) = write_programs(
        campaign.machine, campaign.setups, table.places(campaign, 8), "linuxcnc", "programs", log=True
    )
    Path("log.txt").write_text("\n".join(run_linuxcnc(file.read_text(), TouchingMachine(noise=1e-3))) + "\n")
    return Path("log.txt")


def test_what_the_log_says_is_known_afterwards(log: Path, command: Command) -> None:
    assert run(["estimate", "campaign.toml", "--log", str(log), "--out", "results"]) == 0
    found = json.loads(Path("results/result.json").read_text())
    assert found["readings"] == 8
    for name, off in table.OFF.items():
        assert found["constants"][name]["mean"] == pytest.approx(off, abs=3 * found["constants"][name]["std"] + 1.0)
    assert (
        "none has no programs of that plan"
        in command("estimate", "campaign.toml", "--log", log, "--programs", "none", "--out", "more").refusal
    )
    assert run(["estimate", "campaign.toml", "--out", "more"]) == 2


@pytest.mark.long
def test_a_record_takes_a_log_once_and_says_what_lacks(
    log: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = log.read_text()
    log.write_text("\n".join(whole.splitlines()[: 1 + 6 * 5 + 2]))
    Campaign.create("one.axiscal", read_campaign("campaign.toml")).close()
    capsys.readouterr()
    assert run(["record", "one.axiscal", "--log", str(log), "--json"]) == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == {"schema": "axiscal-record/1", "logged": 5, "readings": 5}
    for sentence in (
        "a run did not come to its end",
        "reading 6 has 2 of 6 touches",
        "6, 7 and 8 do not stand in the log",
    ):
        assert sentence in said.err
    log.write_text(whole)
    assert "line 2 is in the record already" in command("record", "one.axiscal", "--log", log).refusal
    log.write_text(whole.splitlines()[0])
    assert "no reading of this log is whole" in command("record", "one.axiscal", "--log", log).refusal
    assert run(["record", "one.axiscal", "1 um", "--log", str(log)]) == 2
