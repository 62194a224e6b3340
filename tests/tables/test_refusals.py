"""What no control can hold, and old files that are not whole, are refused with what is wrong and what to do."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.ports.linuxcnc.tables import cross
from axiscal.tables.controllers import sinumerik
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile, read_old
from axiscal.tables.registry import export, loaded
from axiscal.tables.round_trip import drawn_and_known
from axiscal.tables.table import CompensationTable
from tests.generators.texts import machine_text

THREE = machine_from_text(
    machine_text("w-b-X-Y-Z-t", {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)}, {"EXX": ("10 um", 7, 150)}, name="M")
)
LATHE = machine_from_text(
    machine_text("w-b-X-Z-t", {"X": (0, 300), "Z": (0, 100)}, {"EXX": ("10 um", 7, 150)}, name="M")
)


def test_what_a_reader_trips_over_is_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    """No file is known that leads there; whoever finds one is not shown a traceback."""

    def missing(*_: object) -> None:
        raise KeyError("interval")

    monkeypatch.setattr(sinumerik.Sinumerik, "load", missing)
    with pytest.raises(TableError, match=r"a number that sinumerik needs is missing, or is none \('interval'\)"):
        loaded("sinumerik", THREE, ExportOptions(old_files=(OldFile("AX_EEC.INI", ""),)))


def test_a_spacing_is_of_an_axis_of_the_machine() -> None:
    made = export(drawn_and_known(THREE), "csv", ExportOptions(spacing={"X": 0.1}))
    assert made.tables[0].positions == pytest.approx([0, 0.1, 0.2, 0.3])


def test_more_tables_than_a_sinumerik_has() -> None:
    one = table("X", "Y", [0.0, 0.1])
    assert len(sinumerik.cec_tables([one] * 128)) == 128
    with pytest.raises(TableError, match="129 CEC tables are needed, 128 fit"):
        sinumerik.cec_tables([one] * 129)


def test_a_table_is_of_the_axis_that_is_said_on_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "a.comp").write_text("0 0 0\n100 100.01 100.01\n")
    (old,) = read_old(["Y=a.comp"], tmp_path)
    assert old.axis == "Y"
    assert {each.axis for each in loaded("linuxcnc", THREE, ExportOptions(old_files=(old,))).tables} == {"Y"}


def test_a_folder_without_files(tmp_path: Path) -> None:
    with pytest.raises(TableError, match="there is no file in this folder"):
        read_old([str(tmp_path)])


def test_uneven_points_where_the_control_knows_one_distance() -> None:
    with pytest.raises(TableError, match="not evenly spaced"):
        sinumerik.Sinumerik().write([table("X", "X", [0.0, 0.01, 0.03])], THREE, ExportOptions())


def test_what_a_lincurve_cannot_hold() -> None:
    joints, speeds = {"X": (0,), "Y": (1,)}, {"X": 0.1, "Y": 0.1}
    with pytest.raises(TableError, match="the table of X over Y has 17 points, the control holds 16"):
        cross.write([table("X", "Y", np.linspace(0, 0.2, 17).tolist())], joints, speeds)
    with pytest.raises(TableError, match="LinuxCNC has no axis X2"):
        cross.write([table("X", "X2", [0.0, 0.1])], joints, speeds)


def table(axis: str, over: str, at: list[float]) -> CompensationTable:
    zeros = np.zeros(len(at))
    return CompensationTable(axis, np.array(at), zeros, zeros, zeros, over)
