"""One rule for all readers of old files: an entry that a reader has no use for is refused, with its file and line."""

from __future__ import annotations

import pytest

from axiscal.exceptions import ReadingError, TableError
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.registry import CONTROLLERS, exporter, loaded
from tests.generators.field import with_field
from tests.generators.texts import machine_text

SPANS = {"X": (-400, 400), "Y": (0, 200), "Z": (0, 100)}
MACHINE = machine_from_text(machine_text("w-b-X-Y-Z-t", SPANS, {"EXX": ("10 um", 7, 150)}, name="M"))
ENC = (
    "CHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0.001\n$AA_ENC_COMP[0,1,AX1]=0.002\n$AA_ENC_COMP_STEP[0,AX1]=10.0\n"
    "$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=10.0\nM17\n"
)
FANUC = (
    "%\nN3620A1P10A2P0A3P0;\nN3621A1P11A2P0A3P0;\nN3622A1P12A2P0A3P0;\nN3623A1P1A2P0A3P0;\nN3624A1P10.0A2P0A3P0;\n"
    "N10011P1;\nN10012P2;\nN10013P0;\n%\n"
)
HAL = "setp lincurve.y-x.x-val-00 0\nsetp lincurve.y-x.y-val-00 0\nsetp y-x.x-val-01 9\nsetp y-x.y-val-01 0.1\n"
COM = (
    "BEGIN X_AXIS .COM MM\nNR AXISPOS BACKLASH X C\n"
    "0 0.0000 0.0000 0.0010 0.0000\n1 9.0000 0.0000 0.0010 0.0000\n[END]\n"
)
MAP = (
    "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
    "0,10,0,10,-1,10,10,2,2\n0.1,0.2\n0.3,0.4\n"
)

CSV = "axis,position_mm,forward_um,reverse_um,std_um\nX,0,1,1,1\nX,9,1,1,1\n"
M503 = "echo: M425 F1 S0 X0.1\nM852 I0.01 J0 K0\n"
CASES = [
    ("sinumerik", "AX_EEC.INI", ENC, ENC.replace("M17", "$AA_ENC_COMP[0,0,MX2]=0.1\nM17"), 7, "MX2"),
    (
        "sinumerik",
        "AX_EEC.INI",
        ENC,
        ENC.replace("M17", "$AA_ENC_COMP[1,0,AX1]=0.1\nM17"),
        7,
        "another measuring system",
    ),
    ("sinumerik", "AX_EEC.INI", ENC, ENC.replace("AX1", "X_ENC"), 2, "X_ENC"),
    ("sinumerik", "AX_EEC.INI", ENC, ENC.replace("$AA_ENC_COMP_STEP[0,AX1]=10.0\n", ""), 2, "no STEP"),
    ("fanuc", "pitch.txt", FANUC, FANUC.replace("N10013P0", "N10013P3"), 9, "N10013P3"),
    ("heidenhain", "X.COM", COM, COM.replace("0.0010 0.0000\n[", "0.0010 0.0050\n["), 2, "column C"),
    ("linuxcnc", "X.comp", "0 0 0\n9 9.1 9\n", "0 0 0\n0 0.1 0\n9 9.1 9\n", 2, "skips this row: '0 0.1 0'"),
    ("linuxcnc", "X.comp", "0 0 0\n9 9.1 9\n\n", "0 0 0\n9 9.1 9\n5 5.1 5\n", 3, "skips this row: '5 5.1 5'"),
    ("linuxcnc", "X.comp", "0 0 0\n9 9.1 9\n# end\n", "0 0 0\n9 9.1 9\n# more\n20 20 20\n", 4, "'20 20 20'"),
    ("linuxcnc", "cross.hal", HAL, HAL + "setp lincurve.0.x-val-02 20\n", 5, "names no axis over another"),
    ("klipper", "k.cfg", "SET_SKEW XY=100,100,70\n", "SET_SKEW XY=100,100,70\nSET_SKEW XZ=100,99\n", 2, "XZ=100,99"),
    (
        "klipper",
        "k.cfg",
        "[skew_correction a]\nxy_skew = 0.01\n",
        "[skew_correction a]\nxy_skew = 0.01\n[skew_correction b]\nxy_skew = 0.02\n",
        3,
        "skew_correction b",
    ),
    ("marlin", "m503.txt", M503, M503.replace("X0.1", "X0.1 E0.2"), 1, "E0.2"),
    ("marlin", "m503.txt", M503, M503.replace("I0.01", "I=0.01"), 2, "I=0.01"),
    ("reprapfirmware", "config.g", "M556 S100 X1\n", "M556 S100 X1\nM425 X0.1 U0.2\n", 2, "U0.2"),
    ("reprapfirmware", "heightmap.csv", MAP, MAP + "0.5,0.6\n", 3, "2 rows are announced, and there are 3"),
    ("csv", "X.csv", CSV, CSV.replace("std_um", "std_um,note").replace("1,1,1\n", "1,1,1,a\n"), 1, "note"),
]


def read(controller: str, name: str, text: str, template: str | None = None, axis: str = "") -> Loaded:
    options = ExportOptions(old_files=(OldFile(name, text, axis),), template=template or text)
    return loaded(controller, MACHINE, options)


@pytest.mark.parametrize(("controller", "name", "good", "bad", "line", "said"), CASES)
def test_an_entry_without_use_is_refused(controller: str, name: str, good: str, bad: str, line: int, said: str) -> None:
    read(controller, name, good)
    with pytest.raises((TableError, ReadingError)) as refused:
        read(controller, name, bad, good)
    assert said in str(refused.value)
    assert f"{name}, line {line}:" in str(refused.value)


def test_every_reader_of_old_files_has_such_a_case() -> None:
    takers = {name for name in CONTROLLERS if "--on-top-of" in exporter(name).takes}
    assert takers - {"isg"} == {case[0] for case in CASES}  # isg refuses a column by its name, test_isg_reversal


@pytest.mark.parametrize(
    ("controller", "name", "text"), [("csv", "X.csv", CSV), ("fanuc", "p.txt", FANUC), ("marlin", "m", M503)]
)
def test_an_axis_that_a_file_is_said_to_be_for_has_a_table_in_it(controller: str, name: str, text: str) -> None:
    assert read(controller, name, text, axis="X").tables
    with pytest.raises(TableError, match=f"{name}: no table of Z is in this file"):
        read(controller, name, text, axis="Z")


def test_all_entries_are_said_at_once() -> None:
    with pytest.raises(TableError) as refused:
        read("linuxcnc", "X.comp", "0 0 0\n9 9 9\n9 9.1 9\n20 20 20\n7 7 7\n")
    assert all(f"line {line}" in str(refused.value) for line in (3, 5))


def test_a_file_of_an_axis_under_its_own_name_is_taken_where_somebody_says_whose_it_is() -> None:
    (usual,), (own,) = (
        read("sinumerik", "s.ini", text, axis=axis).tables
        for text, axis in ((ENC, ""), (ENC.replace("AX1", "MX1"), "X"))
    )
    assert (own.axis, own.forward.tolist()) == (usual.axis, usual.forward.tolist())
    with pytest.raises(TableError, match="this file has tables of AX1, AX2"):
        read("sinumerik", "s.ini", ENC + ENC.replace("AX1", "AX2"), axis="X")


def test_what_the_template_keeps_of_other_axes_is_no_loss() -> None:
    other = FANUC.replace("N10013P0", "N10013P3")
    assert read("fanuc", "pitch.txt", other, other).tables[0].forward == pytest.approx(
        read("fanuc", "pitch.txt", FANUC).tables[0].forward
    )


def test_tables_of_the_field_are_taken_or_refused() -> None:
    for text in with_field({}, "09-sinumerik-old-table/s_axlit.ini"):
        with pytest.raises(TableError, match=r"s_axlit.ini, line 3: .*\[0,0,MX1\]=0.0008"):
            read("sinumerik", "s_axlit.ini", text)
        (standard,) = with_field({}, "09-sinumerik-old-table/s_std.ini")
        found, usual = read("sinumerik", "s.ini", text, axis="X"), read("sinumerik", "s_std.ini", standard)
        assert found.tables[0].forward.tolist() == usual.tables[0].forward.tolist()
