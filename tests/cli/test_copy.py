"""`axiscal copy`, and that a record copied by any means holds what was acknowledged."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.texts import campaign_text, machine_text, setup_text

CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text("along x", "interferometer", direction="x", moves=["X"]),
    target={"readings": 5},
    compensation_active=False,
    usual="off",
    sure="exactly",
)


@pytest.fixture
def record(tmp_path: Path) -> Path:
    machine = machine_text("w-X'-b-t", {"X": (0, 300)}, {"EXX": "20 um"})
    begin, ask = ("start", "campaign.toml", "mill.axiscal"), ("next", "mill.axiscal")
    files = {"machine.toml": machine, "campaign.toml": CAMPAIGN}
    begun(tmp_path, files, begin, ask, ("record", "mill.axiscal", "1.5 um"))
    return tmp_path / "mill.axiscal"


def test_report_tables_and_result_name_the_state_of_the_record(record: Path, tmp_path: Path, command: Command) -> None:
    with Campaign.open(record, write=False) as campaign:
        first = 1e3 * campaign.state.readings[0].pose[0]
    for _ in range(4):
        (at,) = command("next", record, "--json").document["question"]["position"].values()
        command("record", record, f"{1.5 + 0.2 * (at - first)} um")
    assert run(["finish", str(record), "--out", str(tmp_path / "out")]) == 0
    copied = command("copy", record, "--json").document
    found = json.loads((tmp_path / "out" / "result.json").read_text())["record"]
    assert found == {"event": copied["event"], "hash": copied["hash"]}
    assert f"<code>{found['hash']}</code>" in (tmp_path / "out" / "report.html").read_text()
    readmes = list((tmp_path / "out" / "tables").rglob("README.txt"))
    assert readmes
    for readme in readmes:
        _, zeros, *others = readme.read_text().splitlines()
        assert zeros.startswith("ZERO WORK OFFSETS")
        assert f"From the record mill.axiscal at event {found['event']}: {found['hash']}" in others
