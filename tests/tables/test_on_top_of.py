"""New tables on top of old ones: what the control then adds is the old correction less what it left.

Every format is written and read by hand here; the machine is known, so that what is left is known too.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from axiscal.cli.app import run
from axiscal.errors.model import ErrorModel
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import InputError, TableError
from axiscal.machine.description import machine_from_text
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import Loaded, OldFile, read_old
from axiscal.tables.offer import Export
from axiscal.tables.registry import controllers, export, exporter
from axiscal.tables.round_trip import drawn_and_known, round_trip
from tests.generators.known import known_to_be
from tests.generators.texts import machine_text

MACHINE = machine_text(
    "w-b-X-Y-Z-t",
    {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)},
    {"EXX": ("10 um", 7, 150), "EXX_reversal": "6 um", "EYX": "10 um", "EZX EZY": "30 um"},
    curve=(5, 150),
    name="M",
)
AT = np.linspace(0.0, 300.0, 13)
OLD_UP = -0.020 * np.sin(AT / 70.0)  # what the old table adds on the way up, mm; nothing at zero
OLD_DOWN = OLD_UP + 0.011
FANUC = "\n".join(
    [
        *("%", "N3620A1P10A2P50A3P100;", "N3621A1P11A2P51A3P101;", "N3622A1P40A2P70A3P110;", "N3623A1P1A2P1A3P1;"),
        *("N3624A1P10.0A2P10.0A3P10.0;", *(f"N{number}P0;" for number in range(10000, 10120)), "%"),
    ]
)
COM = (
    "BEGIN OLD_AXIS .COM MM\nNR        AXISPOS    BACKLASH           X           Y           Z\n"
    "0       -100.0000      0.0000      0.0000      0.0000      0.0000\n[END]\n"
)
PROBES = np.linspace(3.0, 297.0, 40)


def known() -> Estimate:
    return drawn_and_known(machine_from_text(MACHINE), 6)


def exported(controller: str, *files: OldFile, **options: object) -> Export:
    return export(known(), controller, ExportOptions(old_files=files, **options))  # type: ignore[arg-type]


def left(name: str, at: Array, side: int = 0) -> Array:
    """Return what the old compensation left along the error's direction, counted from the axis' zero, mm."""
    estimate = known()
    function = estimate.model.names[name]

    def value(x: Array) -> Array:
        return np.asarray(function.basis.rows(1e-3 * x) @ estimate.mean[function.columns])

    back = estimate.model.names.get(f"{name}_reversal")
    half = 0.0 if back is None else side / 2 * float(estimate.mean[back.columns][0])
    return 1e3 * (value(at) - value(np.zeros(1)) + half)


def wanted(side: int) -> Array:
    old = np.interp(PROBES, AT, OLD_UP if side > 0 else OLD_DOWN)
    return old - left("EXX", PROBES, side)


def comp(kind: int) -> str:
    columns = [AT, OLD_UP, OLD_DOWN] if kind else [AT, AT - OLD_UP, AT - OLD_DOWN]
    return "".join("{:.6f} {:.6f} {:.6f}\n".format(*row) for row in zip(*columns, strict=True))


def comp_added(text: str, side: int) -> Array:
    rows = np.array([[float(word) for word in line.split()] for line in text.splitlines()])
    added: Array = np.interp(PROBES, rows[:, 0], rows[:, 0] - rows[:, 1 if side > 0 else 2])
    return added


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("kind", [0, 1])
def test_a_comp_file_of_either_type_stays_in_the_sum(kind: int, side: int) -> None:
    made = exported("linuxcnc", OldFile("old/x.comp", comp(kind)))
    assert comp_added(made.files["X.comp"], side) == pytest.approx(wanted(side), abs=2e-4)
    assert "on top of it what was found: load them in its place" in made.readme


def test_the_ini_file_names_its_tables_and_their_type_and_a_backlash_becomes_a_table(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(comp(1))
    (tmp_path / "mill.ini").write_text(
        "[EMC]\nMACHINE = mill\n[JOINT_0]\nCOMP_FILE = a.txt\nCOMP_FILE_TYPE = 1\nBACKLASH = 0.5\n"
        "[JOINT_1]\nBACKLASH = 0.030  # mm\n[JOINT_2]\nHOME = 0\n"
    )
    made = exported("linuxcnc", *read_old(["mill.ini"], tmp_path))
    assert comp_added(made.files["X.comp"], 1) == pytest.approx(wanted(1), abs=2e-4)
    for side in (1, -1):  # half to each side, as motion adds it
        assert comp_added(made.files["Y.comp"], side) == pytest.approx(np.full(40, side * 0.015), abs=1e-6)


def test_an_ini_file_that_includes_another_names_its_tables_too(tmp_path: Path) -> None:
    (tmp_path / "joint.inc").write_text("[JOINT_1]\nBACKLASH = 0.030\n")
    (tmp_path / "mill.ini").write_text("[EMC]\nMACHINE = mill\n#INCLUDE joint.inc\n")
    (file,) = read_old(["mill.ini"], tmp_path)
    assert (file.joint, file.backlash) == (1, 0.030)


def test_the_curves_of_an_earlier_hal_file_stay_in_the_sum() -> None:
    first = exported("linuxcnc")
    again = exported("linuxcnc", OldFile("axiscal-cross.hal", first.files["axiscal-cross.hal"]))
    curves = [
        np.array([float(v) for v in re.findall(r"setp \S*y-x\.y-val-\d+ (\S+)", made.files["axiscal-cross.hal"])])
        for made in (first, again)
    ]
    assert np.ptp(curves[0]) > 1e-3
    assert curves[1] == pytest.approx(2 * curves[0], abs=1e-6)  # once for what was loaded, once for what it left


def siemens(table: Array) -> str:
    rows = "".join(f"$AA_ENC_COMP[0,{i},AX1]={v:.6f}\n" for i, v in enumerate(table))
    tail = "$AA_ENC_COMP_STEP[0,AX1]=25.0\n$AA_ENC_COMP_MIN[0,AX1]=0.0\n$AA_ENC_COMP_MAX[0,AX1]=300.0\n"
    unused = "$AA_ENC_COMP_STEP[0,AX9]=0.0\n$AA_ENC_COMP[1,0,AX1]=0.0\n"
    return f"%_N_AX_EEC_INI\nCHANDATA(1)\n{rows}{tail}$AA_ENC_COMP_IS_MODULO[0,AX1]=0\n{unused}M17\n"


def test_encoder_compensation_stays_in_the_sum() -> None:
    """A positive value moves the axis down."""
    made = exported("sinumerik", OldFile("AX_EEC.INI", siemens(-OLD_UP)))
    values = {int(i): float(v) for i, v in re.findall(r"ENC_COMP\[0,(\d+),AX1\]=(\S+)", made.files["AX_EEC.INI"])}
    step = float(re.findall(r"STEP\[0,AX1\]=(\S+)", made.files["AX_EEC.INI"])[0])
    added = -np.interp(PROBES, step * np.arange(len(values)), [values[i] for i in sorted(values)])
    assert added == pytest.approx(np.interp(PROBES, AT, OLD_UP) - left("EXX", PROBES), abs=4e-4)


def test_pitch_data_stay_in_the_sum() -> None:
    parameters = ["N3620A1P20A2P0A3P0;", "N3621A1P21A2P0A3P0;", "N3622A1P32A2P0A3P0;", "N3623A1P2A2P1A3P1;"]
    steps = np.diff(np.round(OLD_UP * 1e3 / 2)).astype(int)
    data = [f"N{10021 + i}P{v};" for i, v in enumerate(steps)]
    text = "\n".join(["%", *parameters, "N3624A1P25.0A2P0A3P0;", *data, "%"])
    made = exported("fanuc", OldFile("pitch.txt", text), template=text)
    new = [int(v) for v in re.findall(r"N100(?:2[1-9]|3[0-2])P(-?\d+);", made.files["pitch.txt"])]
    added = np.interp(PROBES, AT, np.r_[0, 2e-3 * np.cumsum(new)])
    assert added == pytest.approx(np.interp(PROBES, AT, OLD_UP) - left("EXX", PROBES), abs=3e-3)
    assert new != steps.tolist()


def test_a_heidenhain_table_stays_in_the_sum() -> None:
    """Values are deviations, taken away; BACKLASH comes on top when moving downwards."""
    head = "BEGIN X_AXIS .COM MM\nNR      AXISPOS     BACKLASH            X            Y            Z\n"
    rows = "".join(
        f"{i:<4}{p:>11.4f}{u - d:>13.4f}{-u:>13.4f}{0:>13.4f}{0:>13.4f}\n"
        for i, (p, u, d) in enumerate(zip(AT, OLD_UP, OLD_DOWN, strict=True))
    )
    made = exported("heidenhain", OldFile("X_AXIS.COM", f"{head}{rows}[END]\n"), template=f"{head}{rows}[END]\n")
    lines = made.files["X_AXIS.COM"].splitlines()
    names = lines[1].split()
    table = np.array([[float(word) for word in line.split()] for line in lines[2:-1]])
    at, back, own = (table[:, names.index(name)] for name in ("AXISPOS", "BACKLASH", "X"))
    assert -np.interp(PROBES, at, own) == pytest.approx(wanted(1), abs=6e-4)
    assert -np.interp(PROBES, at, own + back) == pytest.approx(wanted(-1), abs=6e-4)


def test_a_column_of_an_axis_that_was_not_measured_stays_beside_the_new_ones() -> None:
    """Its points are others than those of the new columns, and a file has one column of points."""
    only_x = machine_text(
        "w-b-X-Y-Z-t", {"X": (0, 300), "Y": (0, 200), "Z": (0, 100)}, {"EXX": ("10 um", 7, 150)}, name="M"
    )
    model = ErrorModel(machine_from_text(only_x))
    estimate = known_to_be(model, np.arange(model.size) ** 2 * 1e-6)
    at = np.linspace(0, 300, 8)
    y = 0.02 * np.sin(at / 90)
    head = "BEGIN X_AXIS .COM MM\nNR      AXISPOS     BACKLASH            X            Y\n"
    rows = "".join(
        f"{i:<4}{p:>11.4f}{0:>13.4f}{0:>13.4f}{v:>13.4f}\n" for i, (p, v) in enumerate(zip(at, y, strict=True))
    )
    text = f"{head}{rows}[END]\n"
    made = export(estimate, "heidenhain", ExportOptions(template=text, old_files=(OldFile("X_AXIS.COM", text),)))
    table = np.array([[float(word) for word in line.split()] for line in made.files["X_AXIS.COM"].splitlines()[2:-1]])
    assert len(table) != len(at)
    assert np.interp(PROBES, table[:, 1], table[:, 4]) == pytest.approx(np.interp(PROBES, at, y), abs=2e-4)
    departures = {one.axis: one.departure for one in made.tables}
    lost = np.max(np.abs(np.interp(at, table[:, 1], np.interp(table[:, 1], at, y)) - y)) * 1e-3
    assert departures["Y"] == pytest.approx(lost, abs=1e-7)


GRID = np.linspace(0, 300, 7), np.linspace(0, 200, 5)


@pytest.mark.parametrize("controller", ["klipper", "reprapfirmware"])
def test_a_height_map_stays_in_the_sum(controller: str) -> None:
    x, y = GRID
    old = 0.05 * np.sin(x / 90)[None] + 0.03 * (y / 200)[:, None] ** 2
    rows = [", ".join(f"{v:.6f}" for v in row) for row in old]
    if controller == "klipper":
        ends = "x_count = 7\ny_count = 5\nmin_x = 0\nmax_x = 300\nmin_y = 0\nmax_y = 200"
        block = "[bed_mesh default]\nversion = 1\npoints =\n" + "\n".join(f"\t{row}" for row in rows) + f"\n{ends}"
        file = OldFile("printer.cfg", "".join(f"#*# {line}\n" for line in block.split("\n")))
        text = exported(controller, file, mesh=5).files["bed_mesh.cfg"]
        found = re.findall(r"^#\*# \t  (.*)$", text, re.MULTILINE)
    else:
        head = "RepRapFirmware height map file v2\nxmin,xmax,ymin,ymax,radius,xspacing,yspacing,xnum,ynum\n"
        file = OldFile("heightmap.csv", head + "0,300,0,200,-1,50,50,7,5\n" + "\n".join(rows) + "\n")
        found = exported(controller, file, mesh=5).files["heightmap.csv"].splitlines()[3:]
    new = np.array([[float(v) for v in row.split(",")] for row in found])
    mesh_x, mesh_y = np.linspace(0, 300, 5), np.linspace(0, 200, 5)
    was = np.array([np.interp(mesh_x, x, row) for row in old])
    rest = left("EZX", mesh_x)[None] + left("EZY", mesh_y)[:, None]
    apart = new - (was - rest)
    assert np.std(apart) < 0.006 < 0.015 < np.std(was)


def test_old_files_that_cannot_be_are_refused(tmp_path: Path) -> None:
    for file in (
        OldFile("X.comp", "0 0 0\n100 1e308 -1e308\n"),
        OldFile("X.comp", "0 0 0\n100 1e308 0\n", file_type=0),
    ):
        with pytest.raises(TableError, match="too large for a machine"):
            exported("linuxcnc", file)
    (tmp_path / "no.ini").write_text("[JOINT_0]\nHOME = 0\n")
    with pytest.raises(TableError, match="no joint of this INI file"):
        read_old(["no.ini"], tmp_path)
    for line in ("BACKLASH = much", "BACKLASH = nan", "COMP_FILE = no.ini\nCOMP_FILE_TYPE = one"):
        (tmp_path / "no.ini").write_text(f"[JOINT_0]\n{line}\n")
        with pytest.raises(InputError, match="is not a number"):
            read_old(["no.ini"], tmp_path)


CAMPAIGN = (
    'machine = "machine.toml"\nusual = "off"\nsure = "exactly"\n{active}[target]\nreadings = 9\n'
    '[[setups]]\nname = "x"\ninstrument = "interferometer"\n'
    'direction = "x"\nmoves = ["X"]\napproach = "both"\n'
)


def described(folder: Path, active: str = "") -> None:
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "campaign.toml").write_text(CAMPAIGN.format(active=active))
    rows = "".join(f"x,{x:g},X{s},{1 if s == '+' else 3}\n" for x in range(0, 301, 50) for s in "+-")
    (folder / "readings.csv").write_text(f"setup,X_mm,approach,value_um\n{rows}")


def recorded(folder: Path, active: str = "") -> Path:
    described(folder, active)
    out = folder / "out"
    assert run(["estimate", str(folder / "campaign.toml"), str(folder / "readings.csv"), "--out", str(out)]) == 0
    return out / "campaign.axiscal"


def test_without_a_word_the_beginning_asks_and_so_does_the_note(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(tmp_path)
    assert "Is a compensation active" in capsys.readouterr().err
    assert run(["start", str(tmp_path / "campaign.toml"), str(tmp_path / "a.axiscal")]) == 0
    assert "Is a compensation active" in capsys.readouterr().err
    assert run(["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "t")]) == 0
    assert "WAS A COMPENSATION ACTIVE WHILE MEASURING" in (tmp_path / "t" / "README.txt").read_text()


def test_none_was_active(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = recorded(tmp_path, "compensation_active = false\n")
    assert "compensation" not in capsys.readouterr().err
    assert run(["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "t")]) == 0
    assert "WAS A COMPENSATION" not in (tmp_path / "t" / "README.txt").read_text()


def test_one_was_active_and_its_files_are_taken(tmp_path: Path) -> None:
    record = recorded(tmp_path, "compensation_active = true\n")
    assert not (tmp_path / "out" / "tables" / "linuxcnc").exists()
    (tmp_path / "X.comp").write_text(comp(0))
    old = ["--on-top-of", str(tmp_path / "X.comp")]
    assert run(["export", str(record), "--to", "linuxcnc", "--out", str(tmp_path / "t"), *old]) == 0
    added = comp_added((tmp_path / "t" / "X.comp").read_text(), 1)
    assert np.corrcoef(added, np.interp(PROBES, AT, OLD_UP))[0, 1] > 0.99


def test_the_files_that_were_active_can_stand_in_the_campaign(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "X.comp").write_text(comp(0))
    recorded(tmp_path, 'compensation_active = "X.comp"\n')
    added = comp_added((tmp_path / "out" / "tables" / "linuxcnc" / "X.comp").read_text(), 1)
    assert np.corrcoef(added, np.interp(PROBES, AT, OLD_UP))[0, 1] > 0.99
    deviations = tmp_path / "out" / "tables" / "csv"
    assert (deviations / "X.csv").exists()
    assert "left by the compensation that was active" in (deviations / "README.txt").read_text()


@pytest.mark.parametrize("controller", sorted(controllers()))
def test_what_is_written_is_read_back_as_an_old_compensation(controller: str) -> None:
    """A round trip of every format that is read and written."""
    names = {"fanuc": FANUC, "heidenhain": COM}
    made = round_trip(exporter(controller), known(), ExportOptions(template=names.get(controller), mesh=7))
    rng = np.random.default_rng(9)
    poses = rng.uniform([0.0, 0.0, 0.0], [0.3, 0.2, 0.1], (200, 3))
    ways = np.where(rng.uniform(size=(200, 3)) > 0.5, 1.0, -1.0)
    assert np.max(np.abs(made.control(poses, ways))) > 5e-6


def test_the_harness_sees_a_reader_that_reads_something_else(monkeypatch: pytest.MonkeyPatch) -> None:
    control = exporter("marlin")
    first = iter([type(control).load])  # as it is when they are tried
    monkeypatch.setattr(type(control), "load", lambda *given: next(first, lambda *_: Loaded())(*given))
    with pytest.raises(TableError, match="Let load read all that write writes"):
        round_trip(control, known())


def test_marlin_gets_old_and_new_together() -> None:
    """As M503 answers: a backlash of 10 um in X, and a tilted mesh of 3 x 3 points, which stays one of 3 x 3."""
    tilted = {(i, j): 0.02 * i - 0.01 * j for i in range(3) for j in range(3)}
    nodes = "".join(f"echo:  M421 I{i} J{j} Z{height:.3f}\n" for (i, j), height in tilted.items())
    old = f"echo:; Backlash:\necho:  M425 F1 S0 X0.010\necho:  M852 I0 J0 K0\n{nodes}"
    plain = marlin_of(exported("marlin", mesh=3).files["axiscal.gcode"])
    above = marlin_of(exported("marlin", OldFile("m503.txt", old)).files["axiscal.gcode"])
    assert above["X"] == pytest.approx(plain.get("X", 0.0) + 0.010, abs=1e-4)
    middle = {node: height - tilted[1, 1] for node, height in tilted.items()}  # where both are zero
    assert {node: above[node] - plain[node] for node in tilted} == pytest.approx(middle, abs=2e-4)
    assert len(above) == len(tilted) + 1


def marlin_of(text: str) -> dict[object, float]:
    """Return backlash by axis and heights by node, mm."""
    play = {axis: float(value) for axis, value in re.findall(r"([XYZ])([\d.]+)", "".join(re.findall("M425.*", text)))}
    nodes = re.findall(r"M421 I(\d+) J(\d+) Z(-?[\d.]+)", text)
    return {**play, **{(int(i), int(j)): float(height) for i, j, height in nodes}}


def test_a_folder_of_an_export_is_an_old_compensation(tmp_path: Path) -> None:
    """What lies beside the tables, notes and manifest, is none of them."""
    (tmp_path / "X.comp").write_text(comp(0))
    (tmp_path / "README.txt").write_text("X")
    (tmp_path / "manifest-linuxcnc.json").write_text("{}")
    assert [Path(file.name).name for file in read_old([str(tmp_path)])] == ["X.comp"]
