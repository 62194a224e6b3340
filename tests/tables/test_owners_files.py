"""The INI file of an owner beside machine.toml: what does not agree, or cannot be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import InputError
from axiscal.machine import machine_from_text
from axiscal.ports.linuxcnc.configuring import configured, options_of, to_mind
from axiscal.tables.exporter import ExportOptions
from axiscal_core.machine import Machine
from tests.generators.texts import machine_text

INI = """\
[EMC]
MACHINE = mill
[KINS]
KINEMATICS = {kinematics}
JOINTS = {joints}
[TRAJ]
COORDINATES = {axes}
LINEAR_UNITS = mm
[HAL]
HALFILE = mill.hal
"""
HAL = """\
loadrt [KINS]KINEMATICS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
"""


def ini(folder: Path, axes: str = "XYZ", kinematics: str = "trivkins", hal: str = "") -> Path:
    """Return the INI file of a machine whose axes go from -100 to 100, beside its HAL file."""
    text = INI.format(kinematics=kinematics, joints=len(axes), axes=axes)
    text += "".join(f"[AXIS_{name}]\nMIN_LIMIT = -100\nMAX_LIMIT = 100\n" for name in axes)
    joins = "".join(f"net j{k} joint.{k}.motor-pos-cmd => joint.{k}.motor-pos-fb\n" for k in range(len(axes)))
    (folder / "mill.hal").write_text(HAL + joins + hal)
    (folder / "mill.ini").write_text(text)
    return folder / "mill.ini"


def mill(travel: float = 100) -> Machine:
    return machine_from_text(machine_text("w-X'-Y'-b-Z-t", dict.fromkeys("XYZ", (-travel, travel)), {"EXX": "5 um"}))


def trunnion(low: float) -> Machine:
    """Return a machine whose swivelling axis lies so many mm below the zero."""
    axes = {**dict.fromkeys("XYZ", (-100, 100)), "A": (-100, 100), "C": (-100, 100)}
    text = machine_text("w-C'-A'-X'-Y'-b-Z-t", axes, {"EXX": "5 um"})
    for name in "AC":
        placed = f'direction = "reversed"\norigin = ["0 mm", "0 mm", "{-low} mm"]'
        text = text.replace(f"[axes.{name}]", f"[axes.{name}]\n{placed}")
    return machine_from_text(text)


def test_a_file_that_is_no_utf_8_is_refused_with_the_byte(tmp_path: Path) -> None:
    path = ini(tmp_path)
    (tmp_path / "mill.hal").write_bytes(b"# 5 \xb5m\n")
    with pytest.raises(InputError, match=r"mill\.hal: byte 4 is no UTF-8"):
        configured(path)


def test_joints_are_said_by_the_ini_file_alone(tmp_path: Path) -> None:
    found = configured(ini(tmp_path))
    assert options_of(found, ExportOptions()).numbers == {"X": (0,), "Y": (1,), "Z": (2,)}
    with pytest.raises(InputError, match="Leave --unit and --number out"):
        options_of(found, ExportOptions(numbers={"X": (0,)}))


def test_what_lies_beyond_the_calibrated_travel_is_said(tmp_path: Path) -> None:
    found = configured(ini(tmp_path))
    assert [*to_mind(found, mill())] == []
    (x, *others) = to_mind(found, mill(80))
    assert x.startswith("X may go -100 mm to 100 mm, and was calibrated over -80 mm to 80 mm")
    assert len(others) == 2


def test_a_pivot_that_lies_elsewhere_is_said(tmp_path: Path) -> None:
    pins = "".join(f"setp xyzac-trt-kins.{pin} {value}\n" for pin, value in (("z-rot-point", -50), ("z-offset", 0)))
    found = configured(ini(tmp_path, "XYZAC", "xyzac-trt-kins", hal=pins))
    assert [*to_mind(found, trunnion(50))] == []
    warnings = [*to_mind(found, trunnion(60))]
    assert sorted(each.partition(" about ")[0] for each in warnings) == [
        f"WARNING: the kinematics turn {n}" for n in "AC"
    ]
    assert all("(0 mm, 0 mm, -50 mm), machine.toml about (0 mm, 0 mm, -60 mm)" in each for each in warnings)
