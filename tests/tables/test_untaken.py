"""One rule for all readers of old files: an entry that a reader has no use for is refused, with its file and line."""

from __future__ import annotations

import pytest

from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.registry import loaded
from tests.generators.field import with_field
from tests.generators.texts import machine_text
from tests.refusals.reading import refusals

SPANS = {"X": (-400, 400), "Y": (0, 200), "Z": (0, 100)}
MACHINE = machine_from_text(machine_text("w-b-X-Y-Z-t", SPANS, {"EXX": ("10 um", 7, 150)}, name="M"))
TEXTS = refusals("old_table").texts
ENC, FANUC, CSV, M503 = (
    TEXTS[name] for name in ("sinumerik AX_EEC.INI", "fanuc pitch.txt", "csv X.csv", "marlin m503.txt")
)


def read(controller: str, name: str, text: str, template: str | None = None, axis: str = "") -> Loaded:
    options = ExportOptions(old_files=(OldFile(name, text, axis),), template=template or text)
    return loaded(controller, MACHINE, options)


@pytest.mark.parametrize(
    ("controller", "name", "text"), [("csv", "X.csv", CSV), ("fanuc", "p.txt", FANUC), ("marlin", "m", M503)]
)
def test_an_axis_that_a_file_is_said_to_be_for_has_a_table_in_it(controller: str, name: str, text: str) -> None:
    assert read(controller, name, text, axis="X").tables
    with pytest.raises(TableError, match=f"{name}: no table of Z is in this file"):
        read(controller, name, text, axis="Z")


def test_a_file_of_an_axis_under_its_own_name_is_taken_where_somebody_says_whose_it_is() -> None:
    (usual,), (own,) = (
        read("sinumerik", "s.ini", text, axis=axis).tables
        for text, axis in ((ENC, ""), (ENC.replace("AX1", "MX1"), "X"))
    )
    assert (own.axis, own.forward.tolist()) == (usual.axis, usual.forward.tolist())
    with pytest.raises(TableError, match="this file has tables of AX1, AX2"):
        read("sinumerik", "s.ini", ENC + ENC.replace("AX1", "AX2"), axis="X")


def test_tables_of_the_field_are_taken_or_refused() -> None:
    for text in with_field({}, "09-sinumerik-old-table/s_axlit.ini"):
        with pytest.raises(TableError, match=r"s_axlit.ini, line 3: .*\[0,0,MX1\]=0.0008"):
            read("sinumerik", "s_axlit.ini", text)
        (standard,) = with_field({}, "09-sinumerik-old-table/s_std.ini")
        found, usual = read("sinumerik", "s.ini", text, axis="X"), read("sinumerik", "s_std.ini", standard)
        assert found.tables[0].forward.tolist() == usual.tables[0].forward.tolist()
