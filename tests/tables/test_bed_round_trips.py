"""A bed map that is read and written again has the same sign, and a printer that loads it holds its height.

The readers here are twins of the printers' own: Klipper's configfile.py and bed_mesh.py, RepRapFirmware's HeightMap.
"""

import configparser
import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.numerics import Array
from tests.commands import Command
from tests.generators.begun import begun

AXES = {"X": 300.0, "Y": 240.0, "Z": 100.0}
PRIORS = (
    'EZX = { std = "80 um", length = "100 mm" }\nEZY = { std = "80 um", length = "100 mm" }\n'
    'EXY = { std = "30 um", length = "100 mm" }\n'
)
SQUARES = 'C0Y = { std = "1 mrad" }\nB0Z = { std = "1 mrad" }\nA0Z = { std = "1 mrad" }\n'
PROBE = '[[setups]]\nname = "bed"\ninstrument = "probe"\ndirection = "z"\nmoves = ["X", "Y"]\nnoise = "2 um"\n'
GAUGE = '[[setups]]\nname = "square"\ninstrument = "probe"\ndirection = "x"\nmoves = ["Y"]\n'
KLIPPER_HEAD = (
    "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n"
    "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n"
)


def bed(x: Array, y: Array) -> Array:
    """Return the height of the bed at (y, x), mm: positive where it is high."""
    arch = 0.12 * np.sin(np.pi * x / 300.0) ** 2
    return arch[None] + (4e-4 * y + 0.05 * np.cos(y / 60.0))[:, None]


X, Y = np.linspace(30.0, 270.0, 7), np.linspace(20.0, 220.0, 6)


def klipper_file(x: Array, y: Array, z: Array) -> str:
    rows = "".join("#*# \t" + ", ".join(f"{v:.6f}" for v in row) + "\n" for row in z)
    keys = {"x_count": len(x), "y_count": len(y), "min_x": x[0], "max_x": x[-1], "min_y": y[0], "max_y": y[-1]}
    tail = "".join(f"#*# {key} = {value}\n" for key, value in keys.items())
    block = f"#*# [bed_mesh default]\n#*# version = 1\n#*# points =\n{rows}{tail}"
    return f"[printer]\nkinematics: cartesian\n{KLIPPER_HEAD}{block}"


def duet_file(x: Array, y: Array, z: Array) -> str:
    head = "RepRapFirmware height map file v2 generated at 2026-01-01 10:00\n"
    head += "xmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
    numbers = [x[0], x[-1], y[0], y[-1], -1.0, x[1] - x[0], y[1] - y[0], len(x), len(y)]
    return head + ",".join(map(str, numbers)) + "\n" + "\n".join(",".join(f"{v:.6f}" for v in row) for row in z) + "\n"


def klipper_profile(printer_cfg: str, name: str) -> tuple[Array, Array, Array]:
    """Return x, y and the points of a profile as Klipper finds them after a restart."""
    regular, header, saved = printer_cfg.partition(KLIPPER_HEAD)
    assert header, "Klipper finds no SAVE_CONFIG block"
    assert "\n#*# " not in regular
    lines = saved.strip().split("\n")
    assert all(line.startswith("#*#") and (len(line) < 4 or line.startswith("#*# ")) for line in lines)
    config = configparser.RawConfigParser(strict=False, inline_comment_prefixes=(";", "#"))
    config.read_string(regular + "\n" + "\n".join(line[4:] for line in lines))
    profile = config[f"bed_mesh {name}"]
    assert profile["version"] == "1"
    assert profile["algo"] in ("lagrange", "bicubic", "direct")
    points = [[float(v) for v in row.split(",") if v.strip()] for row in profile["points"].strip().split("\n")]
    x, y = (
        np.linspace(float(profile[f"min_{a}"]), float(profile[f"max_{a}"]), int(profile[f"{a}_count"])) for a in "xy"
    )
    assert np.shape(points) == (len(y), len(x))
    return x, y, np.array(points)


def duet_map(text: str) -> tuple[Array, Array, Array]:
    first, keys, numbers, *rows = text.splitlines()
    assert first.startswith("RepRapFirmware height map file v2")
    head = dict(zip(keys.split(","), map(float, numbers.split(",")), strict=True))
    x, y = (head[f"{a}min"] + head[f"{a}spacing"] * np.arange(head[f"{a}num"]) for a in "xy")
    return x, y, np.array([[float(v) for v in row.split(",")] for row in rows])


def marlin_words(text: str, command: str) -> list[dict[str, float]]:
    lines = [line.split()[1:] for line in text.splitlines() if line.split()[0] == command]
    return [{word[0]: float(word[1:]) for word in words} for words in lines]


def estimated(
    folder: Path,
    readings: str,
    name: str,
    axes: str = "XYZ",
    more: str = "",
    planes: str = "",
    options: tuple[str, ...] = (),
) -> Path:
    travel = "".join(f'[axes.{a}]\ntravel = ["0 mm", "{AXES[a]:g} mm"]\n' for a in axes)
    chain = "w-Y'-b-X-t" if axes == "XY" else "w-Y'-b-Z-X-t"
    errors = PRIORS + planes + (SQUARES if axes == "XYZ" else "")
    files = {
        "machine.toml": f'chain = "{chain}"\n{travel}[errors]\n{errors}',
        "campaign.toml": f'machine = "machine.toml"\nusual = "off"\nsure = "exactly"\n{PROBE}{more}',
        name: readings,
    }
    begun(folder, files, ("estimate", "campaign.toml", name, "--out", "out", *options))
    return folder / "out" / "campaign.axiscal"


def exported(record: Path, controller: str, *options: str) -> dict[str, str]:
    out = record.parent / controller
    assert run(["export", str(record), "--to", controller, "--out", str(out), *options]) == 0
    return {path.name: path.read_text() for path in out.iterdir()}


WRITERS = {
    "klipper": (klipper_file, "printer.cfg"),
    "reprapfirmware": (duet_file, "heightmap.csv"),
    "marlin": (klipper_file, "printer.cfg"),
}
FRESH = "[printer]\nkinematics: cartesian\n[bed_mesh]\nmesh_min: 0, 0\nmesh_max: 300, 240\n"


def held_by(controller: str, files: dict[str, str]) -> tuple[Array, Array, Array]:
    """Return the map that a printer holds: for Klipper in a fresh printer.cfg, for Marlin at the points it is told."""
    if controller == "reprapfirmware":
        return duet_map(files["heightmap.csv"])
    if controller == "klipper":
        return klipper_profile(FRESH + files["bed_mesh.cfg"], "axiscal")
    z, readme = np.full((len(Y), len(X)), np.nan), files["README.txt"]
    for word in marlin_words(files["axiscal.gcode"], "M421"):
        z[int(word["J"]), int(word["I"])] = word["Z"]
    assert "M852" not in files["axiscal.gcode"]  # no skew that nothing has seen
    assert "7 x 6 points (GRID_MAX_POINTS_X, _Y) from X 30 to 270 and Y 20 to 220" in readme
    return X, Y, z


def warped(x: Array, y: Array) -> Array:
    """Return a bed that no sum of a curve over X and one over Y follows: twisted, with a dent, mm."""
    dent = np.exp(-(((x[None] - 90) / 60) ** 2) - ((y[:, None] - 150) / 60) ** 2)
    twist: Array = 8e-6 * (x[None] - 150) * (y[:, None] - 120) - 0.1 * dent
    return twist + 0.3 * bed(x, y)


PLANE = 'EZXY = { std = "80 um", length = "100 mm", rest = "3 um" }\n'


@pytest.mark.parametrize(
    ("controller", "axes", "planes"),
    [
        ("klipper", "XYZ", ""),
        ("reprapfirmware", "XY", ""),
        ("marlin", "XYZ", PLANE),
        pytest.param("reprapfirmware", "XYZ", PLANE, marks=pytest.mark.long),
    ],
)
def test_a_map_comes_back_as_it_went_in(controller: str, axes: str, planes: str, tmp_path: Path) -> None:
    """The same sign, the same points, and the same heights up to one shift; also without a Z in the machine.

    A warped bed too, where the machine has an error of both axes: a sum of two curves leaves 34 um of it.
    """
    height = warped if planes else bed
    write, name = WRITERS[controller]
    record = estimated(tmp_path, write(X, Y, height(X, Y)), name, axes, planes=planes)
    x, y, z = held_by(controller, exported(record, controller))
    assert x == pytest.approx(X)
    assert y == pytest.approx(Y)
    assert np.std(z - height(X, Y)) < 0.004 < 0.04 < np.std(height(X, Y))


def test_a_high_bed_is_a_tool_too_low(tmp_path: Path, command: Command) -> None:
    record = estimated(tmp_path, klipper_file(X, Y, bed(X, Y)), "printer.cfg")
    poses = tmp_path / "poses.csv"
    poses.write_text("X_mm,Y_mm,Z_mm\n150,120,50\n30,120,50\n")
    top, side = (pose["mean_um"][2] for pose in command("predict", record, poses, "--json").document["poses"])
    assert top - side == pytest.approx(-1e3 * np.ptp(bed(np.array([30.0, 150.0]), np.array([120.0]))), abs=3)


def test_the_plane_that_was_read_has_its_skew_and_the_others_keep_theirs(tmp_path: Path) -> None:
    """Y leans towards +x by 0.8 mrad: every printer takes it away at its XY alone, and has no flat mesh."""
    rows = "".join(f"square,{y},{0.8 * y}\n" for y in range(0, 241, 30))
    record = estimated(tmp_path, f"setup,Y_mm,value_um\n{rows}", "readings.csv", more=GAUGE)
    klipper, marlin = exported(record, "klipper"), exported(record, "marlin")["axiscal.gcode"]
    assert "bed_mesh.cfg" not in klipper
    assert re.findall(r"\b(XY|XZ|YZ)=", klipper["skew.gcode"]) == ["XY"]
    ac, bd, ad = (float(v) for v in re.findall(r"XY=(.*?),(.*?),(\S*)", klipper["skew.gcode"])[0])
    other = np.sqrt(2 * ac**2 + 2 * bd**2 - 4 * ad**2) / 2  # skew_correction.py: the other side of the square
    factor = np.tan(np.pi / 2 - np.arccos((ac**2 - other**2 - ad**2) / (2 * other * ad)))
    assert factor == pytest.approx(0.8e-3, rel=0.02)
    assert marlin_words(marlin, "M852") == [{"I": pytest.approx(0.8e-3, rel=0.02)}]
    assert "M421" not in marlin
    duet = exported(record, "reprapfirmware")
    assert "heightmap.csv" not in duet
    (lean,) = marlin_words(duet["axiscal.g"], "M556")
    assert lean == {"S": 1000, "X": pytest.approx(-0.8, rel=0.02)}


def test_a_plane_without_z_is_told_where_its_height_can_go(tmp_path: Path, command: Command) -> None:
    record = estimated(tmp_path, klipper_file(X, Y, bed(X, Y)), "printer.cfg", "XY")
    said = command("export", record, "--to", "linuxcnc", "--out", tmp_path / "cnc").refusal
    assert "goes as a height map to klipper, marlin or reprapfirmware" in " ".join(said.split())
    assert "readings first" not in said
