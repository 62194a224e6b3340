"""Files are read back as controls take them: what they do is written here by hand, from their makers' manuals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.ports.linuxcnc.tables.exporting import Linuxcnc
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded
from axiscal.tables.offer import spread_poses
from axiscal.tables.registry import controllers, exporter
from axiscal.tables.round_trip import round_trip
from axiscal.tables.table import CompensationTable
from tests.generators.begun import begun
from tests.tables.test_controllers import FANUC, OPTIONS, TOOTHED, known


def com(*rows: tuple[float, ...]) -> str:
    """Return a table of HEIDENHAIN: positions, BACKLASH, and what X, Y and Z are off by, mm."""
    lines = ["NR  " + "".join(f"{head:>13}" for head in ("AXISPOS", "BACKLASH", "X", "Y", "Z"))]
    lines += [f"{n:<4}" + "".join(f"{value:>13.4f}" for value in row) for n, row in enumerate(rows)]
    return "\n".join(["BEGIN X_AXIS .COM MM", *lines, "[END]", ""])


PITCH = FANUC.replace("N3623Q1A1P1", "N3623Q1A1P2").replace("N10021Q1P0;", "N10021Q1P5;")
ENC = (
    "CHANDATA(1)\n$AA_ENC_COMP[0,0,AX1]=0.0\n$AA_ENC_COMP[0,1,AX1]=0.0042\n$AA_ENC_COMP_STEP[0,AX1]=50.0\n"
    "$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=50.0\n"
    "M17\n"
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
BY_HAND = {  # which axis is moved at X 100, Y 100, Z 50 mm, and by how much coming up and coming down, um
    "linuxcnc, nominal and actual": ("linuxcnc", ("X.comp", "0 0 0\n100 99.99 100.004\n"), "X", 10, -4),
    "sinumerik: positive values move an axis down": ("sinumerik", ("AX_EEC.INI", ENC), "X", -4.2, -4.2),
    "sinumerik, over another axis": ("sinumerik", ("NC_CEC.INI", CEC), "Y", -10, -10),
    "fanuc: increments times the magnification": (
        "fanuc", ("p", PITCH), "X", 10, 10
    ),
    "heidenhain: deviations, and BACKLASH besides on the way down": (
        "heidenhain", ("X_AXIS.COM", com((0, 0, 0, 0, 0), (100, 0.014, -0.01, 0, 0))), "X", 10, -4
    ),
    "isg: actual less setpoint": ("isg", ("ssfk_X.lis", LIST), "X", 10, -4),
    "csv: deviations": ("csv", ("X.csv", f"{CSV}X,0,-10,4,1\n"), "X", 10, -4),
    "klipper: the lengths of its manual": (
        "klipper", ("k", f"SET_SKEW XY=140.4,142.8,99.8 XZ={SQUARE} YZ={SQUARE}\n"), "X", 1695.3, 1695.3
    ),
    "klipper: a bed": ("klipper", ("p.cfg", "".join(f"#*# {line}\n" for line in BED.split("\n"))), "Z", 20, 20),
    "reprapfirmware: a bed": ("reprapfirmware", ("heightmap.csv", MAP), "Z", 20, 20),
    "reprapfirmware: a skew is added": ("reprapfirmware", ("config.g", "M556 S100 X1\n"), "X", 1000, 1000),
    "marlin: a bed": ("marlin", ("bed.gcode", f"M852 I0 J0 K0\n{NODES}"), "Z", 20, 20),
    "marlin: a bed with a row of zeros": ("marlin", ("m503", FLAT_IN_FRONT), "Z", 20, 20),
    "marlin: a skew is taken away": ("marlin", ("m503", "M852 I0.01 J0 K0\n"), "X", -1000, -1000),
    "marlin: half of a lost motion to each side": ("marlin", ("m503", "M425 X0.010 F0.5 S0\n"), "X", 2.5, -2.5),
}  # fmt: skip


MACHINE = known("small")[0].machine


@pytest.mark.parametrize("what", BY_HAND)
def test_files_move_axes_as_their_makers_say(what: str) -> None:
    controller, file, axis, up, down = BY_HAND[what]
    found = exporter(controller).load(dict([file]), MACHINE, ExportOptions(template=file[1])).control(MACHINE)
    poses, ways = np.full((2, 3), [0.1, 0.1, 0.05]), np.array([[1.0], [-1.0]]) * np.ones(3)
    expected = np.zeros((2, 3))
    expected[:, MACHINE.index(axis)] = up, down
    assert 1e6 * found(poses, ways) == pytest.approx(expected, abs=0.6, rel=2e-3)


@pytest.mark.parametrize("controller", sorted(controllers()))
def test_what_is_written_is_read_back(controller: str) -> None:
    """A round trip of every format that is read and written."""
    estimate = known("small")[0]
    made = round_trip(exporter(controller), estimate, OPTIONS.get(controller, ExportOptions()))
    assert np.max(np.abs(made.control(*spread_poses(estimate)))) > 5e-6


def test_the_harness_sees_a_reader_that_reads_something_else(monkeypatch: pytest.MonkeyPatch) -> None:
    control = exporter("marlin")
    first = iter([type(control).load])  # as it is when they are tried
    monkeypatch.setattr(type(control), "load", lambda *given: next(first, lambda *_: Loaded())(*given))
    with pytest.raises(TableError, match="Let load read all that write writes"):
        round_trip(control, known("small")[0])


def test_nothing_replaces_a_compensation_that_was_active(tmp_path: Path) -> None:
    begun(tmp_path, CAMPAIGN, ("estimate", "campaign.toml", "readings.csv", "--out", "out"))
    tables = tmp_path / "out" / "tables"
    assert not (tables / "linuxcnc").exists()
    assert "left by the compensation that was active" in (tables / "csv" / "README.txt").read_text()


CAMPAIGN = {
    "machine.toml": TOOTHED,
    "campaign.toml": (
        'machine = "machine.toml"\nusual = "off"\nsure = "exactly"\ncompensation_active = true\n'
        "[target]\nreadings = 9\n"
        '[[setups]]\nname = "x"\ninstrument = "interferometer"\ndirection = "x"\nmoves = ["X"]\napproach = "both"\n'
    ),
    "readings.csv": "setup,X_mm,approach,value_um\n"
    + "".join(f"x,{x:g},X{s},{1 if s == '+' else 3}\n" for x in range(0, 301, 50) for s in "+-"),
}


def test_a_control_whose_travels_are_written_in_inches_counts_in_inches() -> None:
    """As `init` writes machine.toml of an INI file with LINEAR_UNITS = inch; `--unit` says otherwise."""
    text = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["0 in", "20 in"]\n[errors]\nEXX = { std = "10 um" }\n'
    machine, ends = machine_from_text(text), np.array([0.0, 0.508])
    table = CompensationTable("X", ends, 1e-6 * ends, 1e-6 * ends)
    for options, millimetres in ((ExportOptions(), 25.4), (ExportOptions(unit="mm"), 1.0)):
        files = dict(Linuxcnc().write([table], machine, options).files)
        assert float(files["X.comp"].split()[3]) == pytest.approx(508 / millimetres, 1e-6)
        (again,) = Linuxcnc().load(files, machine, options).tables
        np.testing.assert_allclose(again.positions, ends)
