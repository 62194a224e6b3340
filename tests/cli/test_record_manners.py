"""What `record` and `report` say at once: a set-up that is left, a side that nobody told, a reading that is doubted."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from axiscal.campaign import campaign as running
from axiscal.cli.app import run
from tests.commands import Command
from tests.generators.begun import begun
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text("w-X'-b-Y-t", {"X": (0, 300), "Y": (0, 200)}, {"EXX EYY": "20 um", "EXX_reversal": "6 um"})
CAMPAIGN = campaign_text(
    "machine.toml",
    setup_text(
        "along x",
        "interferometer",
        direction="x",
        moves=["X"],
        approach="both",
        setup_time="30 min",
        reading_time="2 min",
    ),
    setup_text("along y", "interferometer", direction="y", moves=["Y"], setup_time="30 min", reading_time="2 min"),
    target={"budget": "100 min"},
    usual="off",
    sure="exactly",
    compensation_active=False,
)


@pytest.fixture
def record(tmp_path: Path) -> Path:
    files = {"machine.toml": MACHINE, "campaign.toml": CAMPAIGN}
    begun(tmp_path, files, ("start", "campaign.toml", "mill.axiscal"))
    return tmp_path / "mill.axiscal"


def asked(record: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Ask for a reading and return its set-up."""
    capsys.readouterr()
    assert run(["next", str(record), "--json"]) == 0
    return str(json.loads(capsys.readouterr().out)["question"]["setup"])


@pytest.mark.parametrize("words", [("1 um", "--at", "X=100"), ("1 apple", "--at", "X=100 mm")])
def test_what_is_misspelt_is_said_before_anything_is_estimated(
    record: Path, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    for name in ("estimated", "in_detail"):
        monkeypatch.setattr(running, name, None)
    assert "unit" in command("record", record, *words, "--setup", "along x").refusal


def test_leaving_a_set_up_says_what_that_costs(
    record: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    first = asked(record, capsys)
    run(["record", str(record), "1.0 um"])
    asked(record, capsys)
    other, at = ("along y", "Y=50 mm") if first == "along x" else ("along x", "X=50 mm")
    told = command("record", record, "2 um", "--at", at, "--setup", other, "--approach", f"{at[0]}+").said
    found = re.search(rf'this leaves "{first}", which costs.*volume ([\d.]+) → ([\d.]+) um', told)
    assert found is not None, told
    before, after = map(float, found.groups())
    assert after > before


def test_a_place_without_a_side_says_what_is_supposed(record: Path, command: Command) -> None:
    told = command("record", record, "1 um", "--at", "X=120 mm", "--setup", "along x").said
    assert "nothing is supposed of the side from which X came; the reading counts as less sure, by half the" in told
    assert '--approach "X+"' in told
    told = command("record", record, "1 um", "--at", "X=180 mm", "--setup", "along x", "--approach", "X+").said
    assert "supposed" not in told


def test_a_curve_of_an_axis_that_carries_the_workpiece_says_why_its_sign_is_the_other(
    record: Path, tmp_path: Path
) -> None:
    page = tmp_path / "x.HTML"
    assert run(["report", str(record), "--out", str(page)]) == 0
    said = page.read_text()
    assert "X carries the workpiece: these curves say what the table does, readings show it with the other sign" in said
    assert "Y carries the workpiece" not in said


def test_one_command_keeps_a_reading_and_says_the_next_one(
    record: Path, command: Command, capsys: pytest.CaptureFixture[str]
) -> None:
    asked(record, capsys)
    told = command("record", record, "1.0 um", "--next").said
    assert "Kept reading 1" in told
    assert "Reading 2: set-up" in told
    document = json.loads(command("record", record, "0.4 um", "--next", "--json").said)
    assert (document["reading"], document["next"]["question"]["reading"]) == (2, 3)
    document = json.loads(command("next", record, "--json").said)
    assert document["question"]["reading"] == 3


def test_what_next_says_to_type_for_three_values_is_taken(tmp_path: Path, command: Command) -> None:
    """The line is given as it stands, with numbers for its letters."""
    sphere = '[[setups]]\nname = "ball"\ninstrument = "sphere"\nartefact = "ball"\nraster = { C = "90 deg" }\n'
    ball = '[[artefacts]]\nname = "ball"\nballs = { one = ["50 mm", "0 mm", "0 mm"] }\n'
    head = 'machine = "machine.toml"\ncompensation_active = false\n[target]\nreadings = 2\n'
    axes: dict[str, tuple[float, float]] = {"C": (0, 360), "X": (-200, 200), "Y": (-200, 200), "Z": (-200, 200)}
    (tmp_path / "machine.toml").write_text(machine_text("w-C'-b-X-Y-Z-t", axes, {"EXX EYY": "20 um"}))
    (tmp_path / "campaign.toml").write_text(head + ball + sphere)
    record = str(tmp_path / "ball.axiscal")
    assert run(["start", str(tmp_path / "campaign.toml"), record]) == 0
    line = re.search(r'record \S+ "(x um, y um, z um)"', command("next", record).said)
    assert line is not None
    typed = line[1].replace("x", "1").replace("y", "-2").replace("z", "0.5")
    assert "1 reading" in command("record", record, typed).said + command("status", record).said
