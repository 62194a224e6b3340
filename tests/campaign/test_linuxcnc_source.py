"""`--source linuxcnc` where it cannot work: one sentence, and nothing is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.campaign.sources import open_source
from axiscal.cli.app import run
from axiscal.exceptions import SourceError
from axiscal.machine.description import load_machine, machine_from_text
from axiscal.measurement.simulation import Simulator
from axiscal.ports.linuxcnc.lab import session
from axiscal.ports.linuxcnc.linuxcnc_source import LinuxcncMachine

CAMPAIGN = """machine = "one-axis"
[target]
readings = 3
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
"""


@pytest.mark.long
def test_without_linuxcnc_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(session, "available", lambda: False)
    (tmp_path / "c.toml").write_text(CAMPAIGN)
    assert run(["run", str(tmp_path / "c.toml"), "--source", "linuxcnc:1", "--out", str(tmp_path / "out")]) == 1
    said = " ".join(capsys.readouterr().err.split())
    assert "LinuxCNC is not installed here. Install the Debian package linuxcnc-uspace" in said
    assert "0 readings are kept" in said


@pytest.mark.parametrize("text", ["linuxcnc:", "linuxcnc:x", "linuxcnc:-1", "linuxcnc:1.5"])
def test_a_seed_is_a_whole_number(text: str) -> None:
    with pytest.raises(SourceError, match=r"is not a seed.*linuxcnc:7"):
        open_source(text, Simulator(load_machine("one-axis"), ()))


def test_axes_that_linuxcnc_has_not_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    text = 'name = "m"\nchain = "w-b-X-X2-t"\n[tool]\nlength = "1 mm"\n[axes.X]\ntravel = ["0 mm", "1 mm"]\n'
    machine = machine_from_text(text + '[axes.X2]\ntravel = ["0 mm", "1 mm"]\n[errors]\nEXX = { std = "1 um" }\n')
    monkeypatch.setattr(session, "available", lambda: True)
    with pytest.raises(SourceError, match="LinuxCNC has no axis X2"):
        LinuxcncMachine(Simulator(machine, ()).drawn(0))
