"""Machines from a printer.cfg of Klipper, and files that are none."""

import io
from pathlib import Path

import pytest

from axiscal.description.first_files import of_file
from axiscal.exceptions import DescriptionError
from axiscal.machine import machine_from_text
from axiscal_core.machine import Machine
from tests.commands import Command

COREXY = """\
[include mainsail.cfg]
[printer]
kinematics: corexy
max_velocity: 300    # mm/s
max_accel = 3000
max_z_velocity: 15
[stepper_x]
position_min: -4
position_max: 250
[stepper_y]
position_max: 210 ; where the belt ends
[stepper_z]
position_min: -5
position_max: 220
[gcode_macro START]
gcode:
  position_max: 7
#*# [stepper_x]
#*# position_max: 9
"""


def read(folder: Path, text: str) -> Machine:
    """Return the machine of a printer.cfg."""
    file = folder / "printer.cfg"
    file.write_text(text)
    return machine_from_text(of_file(file, folder).text)


def test_kinematics_travels_and_speeds_are_read(tmp_path: Path) -> None:
    machine = read(tmp_path, COREXY)
    assert machine.name == "3D printer (corexy)"
    travels = {axis.name: tuple(round(1e3 * end, 9) for end in axis.travel) for axis in machine.axes}
    assert travels == {"X": (-4, 250), "Y": (0, 210), "Z": (0, 220)}  # below the bed a probe only looks for it
    assert {axis.name: round(1e3 * axis.speed, 9) for axis in machine.axes} == {"X": 300, "Y": 300, "Z": 15}
    assert [axis.name for axis in machine.axes if axis.workpiece_side] == ["Z"]
    assert {axis.name: axis.acceleration for axis in machine.axes}["X"] == pytest.approx(3.0)


def test_what_a_printer_includes_counts_in_its_place(tmp_path: Path) -> None:
    (tmp_path / "axes").mkdir()
    (tmp_path / "axes" / "all.cfg").write_text(f"{COREXY}[include ../printer.cfg]\n[stepper_y]\nposition_max: none\n")
    whole = "[include mainsail.cfg]\n[include axes/*.cfg]\n[stepper_y]\nposition_max: 190\n"
    travels = {axis.name: axis.travel for axis in read(tmp_path, whole).axes}
    assert travels["Y"] == pytest.approx((0.0, 0.19))
    with pytest.raises(DescriptionError, match=r"all\.cfg, line 22: position_max = none is not a number"):
        read(tmp_path, whole.replace("[stepper_y]", "[stepper_e]"))
    with pytest.raises(DescriptionError, match=r"line 1: The file 'more\.cfg' that is included here is not there"):
        read(tmp_path, "[include more.cfg]\n")


def test_the_bed_of_a_cartesian_printer_slides(tmp_path: Path) -> None:
    machine = read(tmp_path, COREXY.replace("corexy", "cartesian"))
    assert [axis.name for axis in machine.axes if axis.workpiece_side] == ["Y"]


MESHED = f"{COREXY}[bltouch]\nx_offset: 0\ny_offset: 25\n[bed_mesh]\nmesh_min: 25,35.0\nmesh_max: 240.0, 230\n"


def test_the_probe_reaches_what_the_mesh_and_the_travels_share(
    tmp_path: Path, command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is what a printer is measured by where nobody says another."""
    file = tmp_path / "printer.cfg"
    file.write_text(MESHED)
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    assert "Nobody answered" in command("init", tmp_path / "bed", "--from", file).refusal
    monkeypatch.setattr("sys.stdin", io.StringIO("\n"))
    command("init", tmp_path / "bed", "--from", file, "--target", "")
    text = (tmp_path / "bed" / "campaign.toml").read_text()
    assert 'reach = { X = ["25 mm", "240 mm"], Y = ["35 mm", "210 mm"] }   # CHECK' in text


def test_init_begins_with_a_printer(tmp_path: Path, command: Command) -> None:
    file = tmp_path / "printer.cfg"
    file.write_text(f"{COREXY}[bltouch]\nx_offset: 7.5\ny_offset: -28\n")
    given = ("--from", file, "--instrument", "probe", "--target", "")
    assert 'chain = "w-Z\'-b-Y-X-t" is supposed' in command("init", tmp_path / "bed", *given).out
    assert 'offset = ["7.5 mm", "-28 mm", "0 mm"]   # CHECK' in (tmp_path / "bed" / "campaign.toml").read_text()
    said = command("init", tmp_path / "other", *given, "--chain", "w-Y'-b-Z-X-t").out
    assert "is supposed" not in said
    assert "w-Y'-b-Z-X-t" in (tmp_path / "other" / "machine.toml").read_text()
    assert "says the limits of every axis" in command("init", tmp_path / "c", *given, "--limits", "X 0 9").err
    assert not (tmp_path / "c").exists()
