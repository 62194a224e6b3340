"""A printer that is measured, corrected and checked, all by itself, against a small server that stands for it."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.evaluation.check import Check
from tests.campaign.test_printer_source import Server, serving
from tests.commands import Command

pytestmark = pytest.mark.long

CAMPAIGN = """
machine = "printer-gantry"
compensation_active = false
[target]
readings = 14
[[setups]]
name = "bed"
instrument = "probe"
direction = "z"
moves = ["X", "Y"]
reach = { X = ["20 mm", "180 mm"], Y = ["20 mm", "180 mm"] }
settle = "0 s"
noise = "2 um"
"""


class Levelled(Server):
    """A printer whose exported mesh is in force, once it is."""

    check: Check | None = None

    def execute(self, code: str) -> str:
        said = super().execute(code)
        x, y = self.at["X"], self.at["Y"]
        self.klipper["gcode_move"] = {"position": [x, y, 5.0], "gcode_position": [x, y, 5.0]}
        self.klipper["toolhead"] |= {"position": [x, y, 5.0 + self.added(x, y)]}
        return said

    def added(self, x: float, y: float) -> float:
        """What the mesh adds to Z, mm."""
        if self.check is None or not self.klipper["bed_mesh"]["profile_name"]:
            return 0.0
        machine = self.check.description.machine
        pose = np.zeros((1, len(machine.axes)))
        pose[0, [machine.index("X"), machine.index("Y")]] = x / 1e3, y / 1e3
        return 1e3 * float(self.check.tables.control(pose, np.ones_like(pose))[0, machine.index("Z")])


@pytest.fixture
def printer() -> Iterator[Levelled]:
    with serving(Levelled()) as server:
        yield server


def test_a_printer_is_measured_corrected_and_checked(
    printer: Levelled,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    command: Command,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("AXISCAL_PERSON", "Anna")
    source = f"moonraker:127.0.0.1:{printer.server_address[1]}"
    Path("campaign.toml").write_text(CAMPAIGN)
    assert run(["run", "campaign.toml", "--source", source, "--out", "results"]) == 0
    record = "results/campaign.axiscal"
    assert run(["export", record, "--to", "klipper", "--out", "mesh"]) == 0
    capsys.readouterr()
    words = ["verify", record, "--to", "klipper", "--source", source, "--tolerance", "40 um", "--points", "8"]
    words += ["--found", "found.csv", "--left", "left.csv"]
    assert run(words) == 2
    words += ["--loaded", "mesh", "--json"]
    assert "--loaded" in capsys.readouterr().err
    assert command(*words).document["verdict"] is None
    assert "does not have the exported mesh in force" in command(*words).refusal
    in_force(printer, Path("mesh/bed_mesh.cfg"), record)
    said: dict[str, Any] = command(*words).document
    assert (said["verdict"], said["decision"], said["person"], said["source"]) == ("pass", "conform", "Anna", source)
    assert said["in_force"] == {"bed_mesh.cfg": hashlib.sha256(Path("mesh/bed_mesh.cfg").read_bytes()).hexdigest()}
    assert said["left_rms_um"] < 0.2 * said["found_rms_um"]
    text = command(*words[:-1], "--details").printed
    assert "By ISO 14253-1 as left: conform." in text
    assert "Read by Anna from moonraker" in text


def in_force(printer: Levelled, file: Path, record: str) -> None:
    """Put the exported mesh into the printer."""
    rows = [line.partition("\t")[2].split(",") for line in file.read_text().splitlines() if "\t" in line]
    heights = [[float(each) for each in row] for row in rows]
    printer.klipper["bed_mesh"] = {"profile_name": "axiscal", "probed_matrix": heights}
    with Campaign.open(record, write=False) as campaign:
        printer.check = Check.from_campaign(campaign, "klipper")
