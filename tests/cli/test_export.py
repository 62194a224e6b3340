"""`axiscal export`: files with what they leave, or one sentence and nothing written."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axiscal.campaign.campaign import Campaign
from axiscal.cli.app import run
from axiscal.description.campaign import campaign_from_texts
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.tables import registry
from axiscal.tables.offer import Export
from axiscal.tables.surface import Effect
from tests.commands import Command
from tests.generators.reaches import reach_of
from tests.generators.texts import machine_text
from tests.golden.given import CAMPAIGNS

MACHINE = machine_text(
    "w-X'-b-Y-Z-t",
    {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)},
    {"EXX EYY EZY": "20 um", "C0Y": "90 urad"},
    tool=50,
    name="Bench",
)
CAMPAIGN = 'machine = "machine.toml"\n[target]\nreadings = 30\n' + "".join(
    f'[[setups]]\nname = "{d}"\ninstrument = "probe"\ndirection = "{d}"\nunknowns = {{}}\n' + reach_of(MACHINE)
    for d in "xyz"
)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A record of thirty readings of a virtual machine, in a folder of results."""
    described = campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "machine.toml")
    machine, rng = Simulator(described.machine, described.setups).drawn(3), np.random.default_rng(3)
    lattice = spread(described.machine, described.setups, 30)
    readings = []
    for number, *place in zip(lattice.setups, lattice.poses, lattice.approaches.astype(int), strict=True):
        setup, (pose, side) = described.setups[number], (tuple(each.tolist()) for each in place)
        readings.append(Reading(setup.name, pose, side, machine.read_all(setup, pose, side, rng)[0]))
    path = tmp_path_factory.mktemp("export") / "campaign.axiscal"
    with Campaign.create(path, described) as campaign:
        campaign.adopt(tuple(readings))
    return path


def test_files_that_leave_no_less_are_not_to_be_loaded(
    record: Path, tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = registry.export

    def worse(*given: Any) -> Export:
        return replace(made(*given), effect=Effect(3e-6, 3.1e-6))

    given = ["export", str(record), "--to", "csv", "--out", str(tmp_path / "out")]
    assert "load " in command(*given).printed
    monkeypatch.setattr(registry, "export", worse)
    said = command(*given).said
    assert said.endswith("do not load these files: they leave no less error than there is")
    assert "README.txt there" not in said


@pytest.mark.parametrize(
    ("first", "exported", "verified"),
    [
        ('["linuxcnc-volumetric", "sinumerik"]\ncompensation_active = true', "sinumerik --on-top-of OLD", "sinumerik"),
        ('["fanuc"]', "fanuc --template FILE", "fanuc --template FILE"),
    ],
)
def test_a_campaign_whose_tables_need_a_file_of_the_control_ends_with_their_export(
    first: str, exported: str, verified: str, tmp_path: Path, command: Command
) -> None:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "campaign.toml").write_text(f"controls = {first}\n{CAMPAIGN}")
    (tmp_path / "readings.csv").write_text("setup,X_mm,Y_mm,Z_mm,value_um\nx,10,20,30,1\ny,200,90,60,2\n")
    out = tmp_path / "out"
    said, record = (
        command("estimate", tmp_path / "campaign.toml", tmp_path / "readings.csv", "--out", out).said,
        f"{out}/campaign.axiscal",
    )
    assert f"axiscal export {record} --to {exported} axiscal verify {record} --to {verified}" in said


def test_tables_made_from_a_file_of_the_control_are_verified_by_it(
    record: Path, tmp_path: Path, command: Command
) -> None:
    saved, out = tmp_path / "saved.txt", tmp_path / "tables"
    text = (CAMPAIGNS / "controllers" / "saved-fanuc.txt").read_text()
    saved.write_text(text.replace("A3P241", "A3P250").replace("A3P200", "A3P241"))  # Z lies higher here
    made_from = ["--to", "fanuc", "--template", str(saved)]
    (again,) = (
        line for line in command("export", record, *made_from, "--out", out).printed.splitlines() if "verify" in line
    )
    assert again.split() == ["axiscal", "verify", str(record), *made_from]
    printed = command("verify", record, *made_from, "--source", "sim:3", "--tolerance", "10 um").printed
    assert printed.startswith("AS PROMISED")


def test_a_bump_is_exported_and_the_sign_that_it_shows_is_kept(record: Path, tmp_path: Path, command: Command) -> None:
    def exported(*options: str) -> dict[str, str]:
        """Return the files by name, and as "" what was printed."""
        printed = command("export", record, "--to", "isg", "--out", tmp_path / "isg", *options).printed
        return {file.name: file.read_text() for file in (tmp_path / "isg").iterdir()} | {"": printed}

    assumed, bump = exported(), exported("--probe-sign")
    assert "WHICH WAY DOES THE CONTROL TAKE THESE VALUES?" in assumed["README.txt"].splitlines()[1]
    assert bump["README.txt"].startswith("TWO READINGS TELL THE SIGN. Let X come from below")
    assert "TWO READINGS TELL THE SIGN" in bump[""]
    told = command("verify", record, "--to", "isg", "--bump", "10.3 um").printed
    assert "The control takes its tables the other way round. The record keeps it" in told
    other = exported()
    assert other["volcomp.lis"].replace("negate XYZ\n", "") == assumed["volcomp.lis"] != other["volcomp.lis"]
    assert re.match(r"SIGN MEASURED ON \d{4}-\d\d-\d\d: .* the other way", other["README.txt"].splitlines()[1])
    assert exported("--probe-sign")["volcomp.lis"] == bump["volcomp.lis"]
    assert command("verify", record, "--to", "isg", "--bump", "-9.6 um", "--json").document["sign"] == "as assumed"
    assert exported()["volcomp.lis"] == assumed["volcomp.lis"]
    assert "--to fanuc --template FILE" in command("verify", record, "--to", "fanuc", "--bump", "10 um").printed
    assert "by 1 um" in command("verify", record, "--to", "isg", "--bump", "1 um").refusal
    assert "linuxcnc states which way" in command("verify", record, "--to", "linuxcnc", "--bump", "10 um").refusal


def test_an_axis_may_have_two_joints_and_a_spacing_of_its_own(record: Path, tmp_path: Path) -> None:
    export = ["export", str(record), "--to", "linuxcnc", "--spacing", "X=25 mm", "--spacing", "Y=50 mm", "--out"]
    assert run([*export, str(tmp_path / "a"), "--number", "Y=1", "--number", "Y=2"]) == 0
    made = {file.name: file.read_text() for file in (tmp_path / "a").iterdir()}
    assert "[JOINT_2]" in made["README.txt"]
    rows = {axis: [float(row.split()[0]) for row in made[f"{axis}.comp"].splitlines()] for axis in "XY"}
    assert rows == {"X": [25.0 * i for i in range(13)], "Y": [50.0 * i for i in range(5)]}
