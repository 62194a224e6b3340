"""Files of controls that an export is put on top of, good ones: what reads them stands with the corpus of bad files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from axiscal.description.ini_file import read_ini
from axiscal.description.ini_machine import machine_of
from axiscal.machine.description import machine_from_text
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import read_old
from axiscal.tables.registry import loaded
from tests.generators.texts import machine_text

_MACHINE = machine_from_text(
    machine_text("w-b-X-Y-Z-t", {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)}, {"EXX": "1 um"})
)

INI = """[EMC]
MACHINE = mill
[KINS]
KINEMATICS = trivkins coordinates=XYZ
JOINTS = 3
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
""" + "".join(
    f"[JOINT_{joint}]\nTYPE = LINEAR\nMIN_LIMIT = 0\nMAX_LIMIT = {high}\nMAX_VELOCITY = 100\nBACKLASH = 0.01\n"
    for joint, high in enumerate((300, 200, 100))
)
_SINUMERIK = "".join(f"$AA_ENC_COMP[0,{i},AX1]=0.00{i}\n" for i in range(4)) + (
    "$AA_ENC_COMP_STEP[0,AX1]=100.0\n$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=300.0\n"
    "$AA_ENC_COMP_IS_MODULO[0,AX1]=0\nM17\n"
)
_FANUC = (
    "%\nN3620A1P20A2P0A3P0;\nN3621A1P21A2P0A3P0;\nN3622A1P23A2P0A3P0;\nN3623A1P2A2P1A3P1;\nN3624A1P100.0A2P0A3P0;\n"
    "N10021P1;\nN10022P-2;\nN10023P3;\n%\n"
)
_HEIDENHAIN = (
    "BEGIN X_AXIS .COM MM\nNR        AXISPOS    BACKLASH           X           Y           Z\n"
    "0          0.0000      0.0010      0.0020      0.0000      0.0000\n"
    "1        300.0000      0.0010      0.0040      0.0000      0.0000\n[END]\n"
)
_LEADSCREW = (
    "kw.ssfk.unit 0\nkw.ssfk.log_achs_name X\nkw.ssfk.interval 1000000\nkw.ssfk.kw_startpos 0\nkw.ssfk.kw_nr_max 2\n"
    "kw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n"
    + "".join(f"kw.ssfk.table[{i}].{s} {i}\n" for i in (0, 1) for s in ("pos", "neg"))
)
_MAP = (
    "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
    "0,300,0,200,-1,150,200,3,2\n0.01,0.02,0.03\n0.00,0.01,-0.01\n"
)
_HAL = "".join(f"setp comp.y-x.x-val-{i} {100 * i}\nsetp comp.y-x.y-val-{i} 0.00{i}\n" for i in range(4))

GOOD: Mapping[tuple[str, str], str] = {
    ("linuxcnc", "X.comp"): "0 0 0\n100 100.01 100.012\n300 300.02 300.01\n",
    ("linuxcnc", "mill.ini"): INI,
    ("linuxcnc", "cross.hal"): _HAL,
    ("sinumerik", "AX_EEC.INI"): _SINUMERIK,
    ("fanuc", "pitch.txt"): _FANUC,
    ("heidenhain", "X_AXIS.COM"): _HEIDENHAIN,
    ("isg", "ssfk_X.lis"): _LEADSCREW,
    ("isg", "volcomp.csv"): "X EXX EYX\n0 0.0 0.0\n150 0.001 0.002\n300 0.002 -0.001\n",
    ("marlin", "mesh.gcode"): "".join(f"M421 I{i} J{j} Z0.0{i}\n" for i in range(3) for j in range(3))
    + "M425 X0.02 F1\n",
    ("reprapfirmware", "heightmap.csv"): _MAP,
    ("csv", "X.csv"): "axis,position_mm,forward_um,reverse_um,std_um\nX,0,0.0,0.0,1.0\nX,300,1.0,2.0,1.0\n",
}
"""Control, name of a file -> what stands in it."""


def read_old_table(controller: str, path: Path) -> object:
    """Read a file as the old compensation of a control."""
    return loaded(controller, _MACHINE, ExportOptions(old_files=read_old([str(path)])))


def read_machine(path: Path) -> object:
    """Read a machine from the INI file of a LinuxCNC."""
    return machine_of(read_ini(path))
