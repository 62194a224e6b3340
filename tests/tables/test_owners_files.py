"""The INI file of an owner beside machine.toml: what does not agree, or cannot be read."""

from __future__ import annotations

from pathlib import Path

import pytest

from axiscal.exceptions import InputError
from axiscal.ports.linuxcnc.configuring import configured, options_of
from axiscal.tables.exporter import ExportOptions

INI = """\
[EMC]
MACHINE = mill
[KINS]
KINEMATICS = trivkins
JOINTS = 3
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
[HAL]
HALFILE = LIB:core_sim.hal
HALFILE = mill.hal
"""
HAL = """\
loadrt [KINS]KINEMATICS
addf motion-command-handler servo-thread
addf motion-controller servo-thread
"""


@pytest.fixture(autouse=True)
def _library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lay LinuxCNC's own HAL file where no LinuxCNC is installed."""
    (tmp_path / "hallib").mkdir()
    (tmp_path / "hallib" / "core_sim.hal").touch()
    monkeypatch.setattr("axiscal.ports.linuxcnc.configuring.LIBRARY", tmp_path / "hallib")


def ini(folder: Path) -> Path:
    """Return the INI file of a machine whose axes go from -100 to 100, beside its HAL file."""
    joins = "".join(f"net j{k} joint.{k}.motor-pos-cmd => joint.{k}.motor-pos-fb\n" for k in range(3))
    (folder / "mill.hal").write_text(HAL + joins)
    (folder / "mill.ini").write_text(INI + "".join(f"[AXIS_{n}]\nMIN_LIMIT = -100\nMAX_LIMIT = 100\n" for n in "XYZ"))
    return folder / "mill.ini"


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
