"""The first description: what is written can be used as it is."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from axiscal.cli import app
from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.description.first_campaign import OFFERED, setups_of
from axiscal.description.first_files import (
    instruments_of,
    offered_names,
)
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import builtin_names, load_machine
from tests.commands import Command
from tests.generators.machines import random_machine

DOCS = Path(__file__).resolve().parents[2] / "docs"


def written(folder: Path, machine: str, *instruments: str) -> int:
    """Return the status of `axiscal init` for a machine and instruments."""
    named = [word for name in instruments for word in ("--instrument", name)]
    return app.run(["init", str(folder), "--machine", machine, *named, "--target", "20 um"])


@pytest.mark.parametrize("machine", builtin_names())
def test_what_is_written_is_a_campaign(tmp_path: Path, machine: str) -> None:
    across = () if len(load_machine(machine).axes) == 1 or machine.startswith("paper") else ("straightedge",)
    assert written(tmp_path, machine, "interferometer", *across) == 0  # all of its axes along one way have none
    campaign = read_campaign(tmp_path / "campaign.toml")
    assert campaign.machine == load_machine(machine) or campaign.machine.axes == load_machine(machine).axes
    assert [setup.lacks for setup in campaign.setups if setup.lacks] == []


@pytest.mark.parametrize("instrument", ["interferometer", "tracker"])
def test_the_line_on_the_temperature_can_be_used_as_it_stands(tmp_path: Path, instrument: str) -> None:
    assert written(tmp_path, "three-axis-mill", instrument) == 0
    file = tmp_path / "campaign.toml"
    text, machine = file.read_text(), (tmp_path / "machine.toml").read_text()
    assert {setup.warmer for setup in read_campaign(file).setups} == {None}
    said = campaign_from_texts(text.replace("# temperature =", "temperature ="), "c.toml", machine, "machine.toml")
    assert [setup.warmer for setup in said.setups] == pytest.approx([1.5] * len(said.setups))


def test_every_instrument_that_is_offered_can_be_had(tmp_path: Path) -> None:
    assert written(tmp_path, "dmu60", *OFFERED) == 0
    offered = {*OFFERED, "straightedge"} - {"dial", "square", "indexer"}  # a straightedge twice, an autocollimator
    assert {setup.instrument for setup in read_campaign(tmp_path / "campaign.toml").setups} == offered


@pytest.mark.parametrize("language", LANGUAGES)
def test_instruments_are_named_as_people_name_them(language: str) -> None:
    with speaking(language):
        assert instruments_of(", ".join(offered_names().values())) == list(OFFERED)
        named = instruments_of("Laser and ball-bar, touch probe, dial indicator, level")
        assert named == ["interferometer", "ballbar", "sphere", "dial", "level"]
        named = instruments_of("Messuhr und Winkelnormal, Kugelstab, Laser Tracker")
        assert named == ["dial", "square", "ballbar", "tracker"]


@pytest.mark.parametrize("words", [["--machine", "one-axis"], []])
def test_where_nobody_answers_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command, words: list[str]
) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert "Nobody answered" in command("init", tmp_path / "new", *words).refusal
    assert not (tmp_path / "new").exists()


INI = """\
[KINS]
KINEMATICS = trivkins coordinates=XYZ
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
[JOINT_1]
BACKLASH = 0.02
""" + "".join(f"[AXIS_{name}]\nMIN_LIMIT = 0\nMAX_LIMIT = 400\n" for name in "XYZ")


def test_the_first_description_comes_from_the_ini_file_of_a_linuxcnc(tmp_path: Path, command: Command) -> None:
    (tmp_path / "machine.ini").write_text(INI)
    words = ["--from", str(tmp_path / "machine.ini"), "--instrument", "interferometer", "--target", "20 um"]
    assert "the length of the tool" in command("init", tmp_path / "mill", *words, "--chain", "w-Y'-b-X-Z-t").printed
    campaign = read_campaign(tmp_path / "mill" / "campaign.toml")
    assert (campaign.machine.chain, campaign.machine.axis("X").travel) == ("w-Y'-b-X-Z-t", (0.0, 0.4))
    assert campaign.compensation_active == ("../machine.ini",)
    (tmp_path / "machine.ini").write_text(INI.replace("[JOINT_1]\nBACKLASH = 0.02\n", ""))
    assert app.run(["init", str(tmp_path / "bare"), *words, "--chain", "w-Y'-b-X-Z-t"]) == 0
    assert read_campaign(tmp_path / "bare" / "campaign.toml").compensation_active is False
    assert app.run(["init", str(tmp_path / "other"), *words, "--machine", "one-axis"]) == 2
    assert not (tmp_path / "other").exists()


def test_limits_that_an_ini_file_leaves_open_are_asked_for_or_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: Command
) -> None:
    (tmp_path / "machine.ini").write_text(INI.replace("[AXIS_Z]\nMIN_LIMIT = 0\n", "[AXIS_Z]\n"))
    words = ["--from", str(tmp_path / "machine.ini"), "--instrument", "interferometer", "--target", "20 um"]
    asked = io.StringIO("-300 12.5\n\n")
    monkeypatch.setattr(asked, "isatty", lambda: True)
    monkeypatch.setattr("sys.stdin", asked)
    assert "From where to where does Z move, in mm" in command("init", tmp_path / "asked", *words).printed
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert app.run(["init", str(tmp_path / "given"), *words, "--limits", "z -300 12.5"]) == 0
    for name in ("asked", "given"):
        assert read_campaign(tmp_path / name / "campaign.toml").machine.axis("Z").travel == (-0.3, 0.0125)
    assert app.run(["init", str(tmp_path / "none"), "--machine", "one-axis", "--limits", "X 0 1"]) == 2
    assert not (tmp_path / "none").exists()


def test_nothing_is_written_over(tmp_path: Path) -> None:
    (tmp_path / "campaign.toml").write_text("mine")
    assert written(tmp_path, "one-axis", "interferometer") == 1
    assert [each.name for each in tmp_path.iterdir()] == ["campaign.toml"]
    assert (tmp_path / "campaign.toml").read_text() == "mine"


def test_at_a_terminal_a_wrong_answer_is_asked_for_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A slip at the last question does not throw the answers to the others away."""
    typed = io.StringIO("mill\n\n700 300\n700, 350 300\nlasor\ninterferometer, ballbar\n20\n20 um\n")
    monkeypatch.setattr(typed, "isatty", lambda: True)
    monkeypatch.setattr("sys.stdin", typed)
    assert app.run(["init", str(tmp_path)]) == 0
    refused = capsys.readouterr().err
    assert [word in refused for word in ('"mill"', "700 300", "lasor", '"20"')] == [True] * 4
    campaign = read_campaign(tmp_path / "campaign.toml")
    assert [campaign.machine.axis(name).length for name in "XYZ"] == pytest.approx([0.7, 0.35, 0.3])
    assert {setup.instrument for setup in campaign.setups} == {"interferometer", "ballbar"}
    assert campaign.target.expanded == pytest.approx(20e-6)


@pytest.mark.parametrize("kind", OFFERED)
def test_set_ups_are_offered_for_any_chain(kind: str) -> None:
    """Of axes that turn alone, too: no probe gets to a ball there."""
    found = [setups_of(random_machine(seed), kind) for seed in range(60)]
    assert any(found)
