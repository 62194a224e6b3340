"""New tables on top of old ones: what the control then adds is the old correction less what it left.

What old files do is written here by hand, for each format from its maker's manual.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from axiscal.machine.description import machine_from_text
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables.exporting import Linuxcnc
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile, read_old
from axiscal.tables.offer import Export, spread_poses
from axiscal.tables.registry import controllers, export, exporter, loaded
from axiscal.tables.round_trip import round_trip
from tests.commands import Command
from tests.generators.begun import begun
from tests.tables.test_controllers import FANUC, OPTIONS, TOOTHED, known


def com(*rows: tuple[float, ...]) -> str:
    """Return a table of HEIDENHAIN: positions, BACKLASH, and what X, Y and Z are off by, mm."""
    lines = ["NR  " + "".join(f"{head:>13}" for head in ("AXISPOS", "BACKLASH", "X", "Y", "Z"))]
    lines += [f"{n:<4}" + "".join(f"{value:>13.4f}" for value in row) for n, row in enumerate(rows)]
    return "\n".join(["BEGIN X_AXIS .COM MM", *lines, "[END]", ""])


PITCH = FANUC.replace("N3623Q1A1P1", "N3623Q1A1P2").replace("N10021Q1P0;", "N10021Q1P5;")
EMPTY = "$AA_ENC_COMP_STEP[0,AX9]=0.0\n"
ENC = (
    "CHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0.0\n$AA_ENC_COMP[0,1,AX1]=0.0042\n$AA_ENC_COMP_STEP[0,AX1]=50.0\n"
    "$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=50.0\n"
    f"{EMPTY}M17\n"
)
CEC = (
    "CHANDATA(1)\n$AN_CEC[0,0]=0.0\n$AN_CEC[0,1]=0.02\n$AN_CEC_INPUT_AXIS[0]=(AX1)\n$AN_CEC_OUTPUT_AXIS[0]=(AX2)\n"
    "$AN_CEC_STEP[0]=200.0\n$AN_CEC_MIN[0]=0.0\n$AN_CEC_MAX[0]=200.0\n$AN_CEC_DIRECTION[0]=0\n"
    "$AN_CEC_MULT_BY_TABLE[0]=0\nM17\n"
)
LIST = (
    "kopf.log_achs_nr 1\nkopf.log_achs_name X\nkw.ssfk.interval 1000000\nkw.ssfk.kw_startpos 0\nkw.ssfk.kw_nr_max 2\n"
    "kw.ssfk.unit 1\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\nkw.ssfk.table[0].pos 0\nkw.ssfk.table[1].pos -100\n"
    "kw.ssfk.table[0].neg 0\nkw.ssfk.table[1].neg 40\n"
)
CSV = "axis,position_mm,forward_um,reverse_um,std_um\n"
ENDS = "x_count = 2\ny_count = 2\nmin_x = 0\nmax_x = 300\nmin_y = 0\nmax_y = 200"
BED = f"[bed_mesh default]\nversion = 1\npoints =\n\t0.0, 0.06\n\t0.0, 0.06\n{ENDS}"
MAP = (
    "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
    "0,300,0,200,-1,300,200,2,2\n0.0,0.06\n0.0,0.06\n"
)
SQUARE = "141.4,141.4,100"
NODES = "".join(f"M421 I{i} J{j} Z{0.06 * i:.2f}\n" for i in (0, 1) for j in (0, 1))
FLAT_IN_FRONT = "".join(f"M421 I{i} J{j} Z{0.08 * j:.2f}\n" for i in (0, 1, 2) for j in (0, 1))
ENABLED = ENC.replace("(1)\n", "(1)\n$MA_ENC_COMP_ENABLE[0,AX1]=0\nNEWCONF\n").replace("0.0042", "4.2EX-3")
ARCHIVE = "".join(f"N10 {line} '3c0a\n" if line.startswith("$") else f"{line}\n" for line in ENABLED.splitlines())
BY_HAND = {  # which axis is moved at X 100, Y 100, Z 50 mm, and by how much coming up and coming down, um
    "linuxcnc, nominal and actual": ("linuxcnc", OldFile("X.comp", "0 0 0\n100 99.99 100.004\n"), "X", 10, -4),
    "linuxcnc, of the joint that its name says": (
        "linuxcnc", OldFile("JOINT_0.comp", "0 0 0\n100 99.99 100.004\n"), "X", 10, -4
    ),
    "linuxcnc, of the axis that somebody says": (
        "linuxcnc", OldFile("joint0.comp", "0 0 0\n100 99.99 100.004\n", "Y"), "Y", 10, -4
    ),
    "linuxcnc, trims": ("linuxcnc", OldFile("X.comp", "0 0 0\n100 0.01 -0.004\n", file_type=1), "X", 10, -4),
    "linuxcnc, BACKLASH": ("linuxcnc", OldFile("mill.ini", "", joint=1, backlash=0.03), "Y", 15, -15),
    "sinumerik: positive values move an axis down": ("sinumerik", OldFile("AX_EEC.INI", ENC), "X", -4.2, -4.2),
    "sinumerik, an archive": ("sinumerik", OldFile("AX_EEC.INI", ARCHIVE), "X", -4.2, -4.2),
    "sinumerik, over another axis": ("sinumerik", OldFile("NC_CEC.INI", CEC), "Y", -10, -10),
    "fanuc: increments times the magnification": (
        "fanuc", OldFile("p", PITCH), "X", 10, 10
    ),
    "heidenhain: deviations, and BACKLASH besides on the way down": (
        "heidenhain", OldFile("X_AXIS.COM", com((0, 0, 0, 0, 0), (100, 0.014, -0.01, 0, 0))), "X", 10, -4
    ),
    "csv: deviations": ("csv", OldFile("X.csv", f"{CSV}X,0,-10,4,1\n"), "X", 10, -4),
    "klipper: the lengths of its manual": (
        "klipper", OldFile("k", f"SET_SKEW XY=140.4,142.8,99.8 XZ={SQUARE} YZ={SQUARE}\n"), "X", 1695.3, 1695.3
    ),
    "klipper: a bed": ("klipper", OldFile("p.cfg", "".join(f"#*# {line}\n" for line in BED.split("\n"))), "Z", 20, 20),
    "reprapfirmware: a bed": ("reprapfirmware", OldFile("heightmap.csv", MAP), "Z", 20, 20),
    "reprapfirmware: a skew is added": ("reprapfirmware", OldFile("config.g", "M556 S100 X1\n"), "X", 1000, 1000),
    "marlin: a bed": ("marlin", OldFile("bed.gcode", f"M852 I0 J0 K0\n{NODES}"), "Z", 20, 20),
    "marlin: a bed with a row of zeros": ("marlin", OldFile("m503", FLAT_IN_FRONT), "Z", 20, 20),
    "marlin: a skew is taken away": ("marlin", OldFile("m503", "M852 I0.01 J0 K0\n"), "X", -1000, -1000),
    "marlin: half of a lost motion to each side": ("marlin", OldFile("m503", "M425 X0.010 F0.5 S0\n"), "X", 2.5, -2.5),
}  # fmt: skip


MACHINE = known("small")[0].machine


@pytest.mark.parametrize("what", BY_HAND)
def test_old_files_move_axes_as_their_makers_say(what: str) -> None:
    controller, file, axis, up, down = BY_HAND[what]
    found = exporter(controller).load([file], MACHINE, ExportOptions(template=file.text)).control(MACHINE)
    poses, ways = np.full((2, 3), [0.1, 0.1, 0.05]), np.array([[1.0], [-1.0]]) * np.ones(3)
    expected = np.zeros((2, 3))
    expected[:, MACHINE.index(axis)] = up, down
    assert 1e6 * found(poses, ways) == pytest.approx(expected, abs=0.6, rel=2e-3)


@pytest.mark.parametrize("controller", [name for name in controllers() if "--on-top-of" in exporter(name).takes])
def test_new_files_hold_the_old_ones_and_what_was_found(controller: str) -> None:
    estimates = [known("small", seed)[0] for seed in (3, 2)]
    poses, ways = spread_poses(estimates[0])
    options = ExportOptions()

    def read(made: Export) -> Array:
        """Return what a control adds that has loaded the files."""
        files = tuple(OldFile(name, text) for name, text in made.files.items())
        return loaded(controller, MACHINE, replace(options, old_files=files)).control(MACHINE)(poses, ways)

    plain, before = (export(each, controller, options) for each in estimates)
    old = tuple(OldFile(name, text) for name, text in before.files.items())
    made = export(estimates[0], controller, replace(options, old_files=old))
    together = read(plain) + read(before)
    assert read(made) == pytest.approx(together, abs=3e-6)
    assert np.ptp(read(before)) > 10e-6
    assert made.control(poses, ways) == pytest.approx(plain.control(poses, ways), abs=3e-6)
    assert "on top of it what was found: load them in its place" in made.readme


@pytest.mark.parametrize("controller", sorted({*controllers()} - {"grblhal", "linuxcnc-volumetric"}))
def test_what_is_written_is_read_back_as_an_old_compensation(controller: str) -> None:
    """A round trip of every format that is read and written; whole corrections are read by their own code in C."""
    estimate = known("small")[0]
    made = round_trip(exporter(controller), estimate, OPTIONS.get(controller, ExportOptions()))
    assert np.max(np.abs(made.control(*spread_poses(estimate)))) > 5e-6


def test_an_ini_file_names_its_tables_and_those_of_files_that_it_includes(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("0 0 0\n100 0.01 -0.004\n")
    (tmp_path / "joint.inc").write_text("[JOINT_1]\nBACKLASH = 0.030  # mm\n")
    (tmp_path / "mill.ini").write_text(
        "[EMC]\nMACHINE = mill\n#INCLUDE joint.inc\n[JOINT_0]\nCOMP_FILE = a.txt\nCOMP_FILE_TYPE = 1\nBACKLASH = 0.5\n"
        "[JOINT_2]\nCOMP_FILE = a.txt\n[JOINT_3]\nHOME = 0\n"
    )
    found = {file.joint: (file.file_type, file.backlash) for file in read_old(["mill.ini"], tmp_path)}
    assert found == {0: (1, None), 1: (None, 0.030), 2: (0, None)}


def test_a_folder_of_an_export_is_an_old_compensation(tmp_path: Path) -> None:
    """What lies beside the tables, notes and manifest, is none of them."""
    for name in ("X.comp", "README.txt", "manifest-linuxcnc.json"):
        (tmp_path / name).write_text("0 0 0\n")
    assert [Path(file.name).name for file in read_old([str(tmp_path)])] == ["X.comp"]


@pytest.mark.parametrize("active", ['"X.comp"', "true"])
def test_files_that_were_active_stand_in_the_campaign_or_are_given(
    active: str, tmp_path: Path, command: Command
) -> None:
    """Three tenths of a millimetre, which nothing that was read comes near."""
    old = {"X.comp": "0 0 0\n150 149.7 149.7\n300 300 300\n"}
    begun(tmp_path, old | described(f"compensation_active = {active}\n"), ESTIMATE)
    tables = tmp_path / "out" / "tables"
    assert (tables / "linuxcnc").exists() is (active != "true")
    if active == "true":
        words = ["--on-top-of", tmp_path / "X.comp", "--out", tables / "linuxcnc"]
        assert command("export", record(tmp_path), "--to", "linuxcnc", *words).status == 0
    rows = np.loadtxt(tables / "linuxcnc" / "X.comp")
    assert np.interp(150, rows[:, 0], rows[:, 0] - rows[:, 1]) == pytest.approx(0.3, abs=0.02)
    assert "left by the compensation that was active" in (tables / "csv" / "README.txt").read_text()


ESTIMATE = ("estimate", "campaign.toml", "readings.csv", "--out", "out")


def record(folder: Path) -> Path:
    return folder / "out" / "campaign.axiscal"


def described(active: str) -> dict[str, str]:
    """Return the files of a campaign of readings along X."""
    campaign = f'machine = "machine.toml"\nusual = "off"\nsure = "exactly"\n{active}[target]\nreadings = 9\n'
    campaign += '[[setups]]\nname = "x"\ninstrument = "interferometer"\ndirection = "x"\nmoves = ["X"]\n'
    rows = "".join(f"x,{x:g},X{s},{1 if s == '+' else 3}\n" for x in range(0, 301, 50) for s in "+-")
    readings = f"setup,X_mm,approach,value_um\n{rows}"
    return {"machine.toml": TOOTHED, "campaign.toml": f'{campaign}approach = "both"\n', "readings.csv": readings}


def test_a_control_whose_travels_are_written_in_inches_counts_in_inches() -> None:
    """As `init` writes machine.toml of an INI file with LINEAR_UNITS = inch; `--unit` says otherwise."""
    text = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["0 in", "20 in"]\n[errors]\nEXX = { std = "10 um" }\n'
    machine = machine_from_text(text)
    for options, millimetres in ((ExportOptions(), 25.4), (ExportOptions(unit="mm"), 1.0)):
        (table,) = Linuxcnc().load([OldFile("mill.ini", "", joint=0, backlash=0.001)], machine, options).tables
        np.testing.assert_allclose(table.forward - table.reverse, -1e-6 * millimetres)
        files = dict(Linuxcnc().write([table], machine, options).files)
        assert float(files["X.comp"].split()[3 * (len(table.positions) - 1)]) == pytest.approx(508 / millimetres, 1e-6)
