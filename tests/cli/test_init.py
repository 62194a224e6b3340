"""The first description: what is written can be used as it is."""

from __future__ import annotations

import io
import json
import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.cli import app
from axiscal.description.campaign import campaign_from_texts, read_campaign
from axiscal.description.first_campaign import OFFERED, Purpose
from axiscal.description.first_files import (
    first_described,
    instruments_of,
    of_builtin,
    of_text,
    offered_names,
    with_travels,
)
from axiscal.exceptions import DescriptionError, ReadingError
from axiscal.language.spoken import LANGUAGES, speaking
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.machine.questions import questions
from axiscal.measurement.reading import Reading
from tests.commands import Command
from tests.generators.machines import random_machine
from tests.zoo.animals import Job
from tests.zoo.running import described

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


def test_a_dial_has_no_line_on_the_temperature(tmp_path: Path) -> None:
    assert written(tmp_path, "three-axis-mill", "dial", "square", "level") == 0
    assert "temperature" not in (tmp_path / "campaign.toml").read_text()


def test_the_commands_it_names_can_be_given_as_they_stand(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert written(tmp_path / "my mill", "one-axis", "laser") == 0
    (plan,) = re.findall(r"axiscal (plan .+)", capsys.readouterr().out)
    assert app.run([*shlex.split(plan), "--readings", "2"]) == 0


def test_every_instrument_that_is_offered_can_be_had(tmp_path: Path) -> None:
    assert written(tmp_path, "dmu60", *OFFERED) == 0
    offered = {*OFFERED, "straightedge"} - {"dial", "square", "indexer"}  # a straightedge twice, an autocollimator
    assert {setup.instrument for setup in read_campaign(tmp_path / "campaign.toml").setups} == offered


@pytest.mark.parametrize("kind", OFFERED)
def test_set_ups_are_offered_for_any_chain(kind: str) -> None:
    """Of axes that turn alone, too: no probe gets to a ball there."""
    found = [list(OFFERED[kind].setups(random_machine(seed))) for seed in range(60)]
    assert any(found)


def test_a_board_that_is_turned_is_offered_where_no_axis_does(tmp_path: Path) -> None:
    assert written(tmp_path, "three-axis-mill", "sphere") == 0
    campaign = read_campaign(tmp_path / "campaign.toml")
    assert campaign.target.budget == 1800.0
    boards = [setup.artefact for setup in campaign.setups if setup.artefact]
    assert len({board.standing for board in boards}) == len(campaign.setups) == 5
    heights = np.array([[ball.place[2] for ball in board.balls] for board in boards])
    assert np.ptp(heights) > 0.85 * campaign.machine.axis("Z").length - 32e-3  # of 400 mm, with room over and below
    assert np.ptp(heights[0]) == pytest.approx(campaign.machine.tool_length - 18e-3, abs=1e-3)
    with pytest.raises(DescriptionError, match="Nothing of sphere can be offered"):
        first_described(with_travels(of_builtin("three-axis-mill"), {"X": 80.0}), ["sphere"], Purpose("20 um"))


@pytest.mark.long
def test_the_board_that_is_offered_tells_how_square_z_is(tmp_path: Path) -> None:
    """Axes that are not square, and a board as built and put down by eye, by plain rotations."""
    travels = {"X": (0.0, 600.0), "Y": (0.0, 400.0), "Z": (-200.0, 0.0)}
    axes = (f"[AXIS_{name}]\nMIN_LIMIT = {low}\nMAX_LIMIT = {high}\n" for name, (low, high) in travels.items())
    job = Job(ROUTER.split("[AXIS_X]")[0] + "".join(axes), ("sphere",), "", errors=("EYX", "EXY", "C0Y", "B0Z", "A0Z"))
    campaign, rng = described(job, tmp_path / "router"), np.random.default_rng(7)
    given = tomllib.loads(campaign.read_text())
    (c, b, a), lines = rng.normal(0, 60e-6, 3), ["setup,X_mm,Y_mm,Z_mm,value_x_um,value_y_um,value_z_um"]
    balls = {
        name: np.array([float(each.split()[0]) for each in at]) for name, at in given["artefacts"][0]["balls"].items()
    }
    built = {name: at + rng.normal(0, 0.2, 3) for name, at in balls.items()}
    for setup in given["setups"]:
        put = Rotation.from_euler("z", float(setup["turn"].split()[0]), degrees=True)
        tilt, shift = Rotation.from_rotvec(rng.normal(0, 3e-3, 3)), rng.normal(0, 0.5, 3)
        at = np.array([float(each.split()[0]) for each in setup["at"]])
        for name in rng.permutation([*balls]):
            there = at + put.apply(balls[name])
            stands = at + tilt.apply(put.apply(built[name])) + shift
            x, y, z = there + np.array([0.0, 0.0, 100.0])
            value = [b * z - c * y, -a * z, 0.0] - (stands - there) + rng.normal(0, 1.5e-3, 3)
            lines.append(",".join([setup["name"], *(f"{each:.6f}" for each in (x, y, z, *(1e3 * value)))]))
    (tmp_path / "r.csv").write_text("\n".join(lines))
    told = ["data", "estimate", str(campaign), str(tmp_path / "r.csv"), "--out", str(tmp_path / "out")]
    assert app.run(told) == 0
    found = {row["row"]: row for row in json.loads((tmp_path / "out" / "result.json").read_text())["rows"]}
    for name, true in (("XY", c), ("XZ", -b), ("YZ", a)):
        (row,) = found[f"squareness {name}"]["signed"]
        assert abs(row["value"] - 1e6 * true) < row["U"] < 30


def test_lengths_of_errors_shrink_with_the_travel() -> None:
    small = with_travels(of_builtin("three-axis-mill"), dict.fromkeys("XYZ", 20.0))
    assert questions(machine_from_text(small.text)) == ()


ROUTER = """[KINS]
KINEMATICS = trivkins coordinates=XYZ
JOINTS = 3
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
[AXIS_X]
MIN_LIMIT = -800
MAX_LIMIT = 0
[AXIS_Y]
MIN_LIMIT = -500
MAX_LIMIT = 0
[AXIS_Z]
MIN_LIMIT = -100
MAX_LIMIT = 0
"""


def test_a_probe_on_linuxcnc_is_none_of_a_printer() -> None:
    """Its touches may stand in coordinates of the machine, so that its zero is as wide as Z travels."""
    described = first_described(of_text(ROUTER, "router.ini"), ["probe"], Purpose("60 um"))
    assert described.controls == ("linuxcnc",)
    assert not re.findall("(?i)klipper|marlin|duet|nozzle|printer|layer", described.text)
    touches = [Reading("probe", (-0.1 * k, -0.25, -0.1), (0, 0, 0), -0.0627 + 1e-5 * k) for k in range(1, 8)]
    refuse_implausible(touches, described, "touches.csv")
    narrow = described.text.replace('zero = "100 mm"', 'zero = "1 mm"')
    described = campaign_from_texts(narrow, "campaign.toml", described.machine.text, "machine.toml")
    with pytest.raises(ReadingError, match="state a zero as wide in unknowns"):
        refuse_implausible(touches, described, "touches.csv")


def test_a_length_that_is_longer_than_the_travel_is_asked_about() -> None:
    short = of_builtin("one-axis").text.replace('["0 mm", "1000 mm"]', '["0 mm", "20 mm"]')
    (asked,) = questions(machine_from_text(short))
    assert asked.startswith("The length of EXX is longer than the travel of X: the error is taken as nearly straight.")
    assert asked.endswith('length = "5 mm".')


@pytest.mark.parametrize("language", LANGUAGES)
def test_instruments_are_named_as_people_name_them(language: str) -> None:
    with speaking(language):
        assert instruments_of(", ".join(offered_names().values())) == list(OFFERED)
        named = instruments_of("Laser and ball-bar, touch probe dial indicator level")
        assert named == ["interferometer", "ballbar", "sphere", "dial", "level"]
        named = instruments_of("Messuhr und Winkelnormal, Kugelstab Laser Tracker")
        assert named == ["dial", "square", "ballbar", "tracker"]
        assert instruments_of("laser, tracker") == ["interferometer", "tracker"]


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


def test_a_chain_that_is_said_says_nothing_of_where_rotary_axes_lie(tmp_path: Path, command: Command) -> None:
    ini = INI.replace("XYZ", "XYZC") + "[AXIS_C]\nMIN_LIMIT = 0\nMAX_LIMIT = 180\n"
    (tmp_path / "machine.ini").write_text(ini)
    words = ["--from", str(tmp_path / "machine.ini"), "--instrument", "interferometer", "--target", "20 um"]
    said = command("init", tmp_path / "mill", *words, "--chain", "w-C'-Y'-b-X-Z-t").printed
    assert "where the rotary axes lie" in said
    assert "which axes carry the workpiece" not in said
    text = (tmp_path / "mill" / "machine.toml").read_text()
    assert "CHECK: a point on its line" in text
    assert "from the pins of the kinematics" not in text


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
