"""Bed maps of which cells were not probed, or of which a printer has several: readings are what was probed and named.

The round map is filled by a twin of Klipper's own code (bed_mesh.py, generate_points and probe_finalize).
"""

from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import ReadingError
from axiscal.machine import load_machine as build
from axiscal.measurement.readers.files import read_any
from axiscal.numerics import Array
from axiscal.ports.printers.klipper import Klipper
from axiscal.ports.printers.reprapfirmware import RepRapFirmware
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.loaded import OldFile
from tests.tables.test_bed_round_trips import X, Y, bed, duet_file, klipper_file

ROUND = "[bed_mesh]\nmesh_radius: {}\nmesh_origin: 5, -5\nround_probe_count: {}\n"
RECTANGLE = "[bed_mesh]\nmesh_min: -75, -85\nmesh_max: 85, 75\nprobe_count: 5, 5\n"


def height(x: float, y: float) -> float:
    return 0.1 + 1e-3 * x - 2e-3 * y + 1e-5 * x * y


def round_map(radius: float, count: int) -> tuple[Array, Array, list[list[float]], set[tuple[float, float]]]:
    """Return x, y, rows and the probed places of a round bed about (5, -5), mm, as Klipper saves them."""
    step = np.floor(100 * 2 * radius / (count - 1)) / 100
    at = step * (np.arange(count) - count // 2)
    rows, probed = [], set()
    for b in at:
        inside = [a for a in at if np.sqrt(a * a + b * b) <= radius]
        probed |= {(round(a + 5, 6), round(b - 5, 6)) for a in inside}
        row = [height(a + 5, b - 5) for a in inside]
        aside = (count - len(row)) // 2
        rows.append([row[0]] * aside + row + [row[-1]] * aside)
    return at + 5, at - 5, rows, probed


def places(path: Path) -> dict[tuple[float, float], float]:
    """Return the heights by place, mm."""
    return {
        (round(1e3 * each.position["X"], 6), round(1e3 * each.position["Y"], 6)): -1e3 * each.value
        for each in read_any(path)
    }


@pytest.mark.parametrize(("radius", "count"), [(80.0, 5), (75.0, 7), (119.9, 9), (100.0, 11)])
@pytest.mark.parametrize("head", ["", ROUND])
def test_cells_that_klipper_filled_are_no_readings(tmp_path: Path, radius: float, count: int, head: str) -> None:
    x, y, rows, probed = round_map(radius, count)
    (tmp_path / "printer.cfg").write_text(head.format(radius, count) + klipper_file(x, y, np.array(rows)))
    found = places(tmp_path / "printer.cfg")
    assert found.keys() == probed
    assert len(probed) < count**2
    assert found == pytest.approx({place: height(*place) for place in probed}, abs=1e-6)


def test_all_cells_of_a_rectangle_are_readings(tmp_path: Path) -> None:
    x, y, rows, _ = round_map(80.0, 5)
    (tmp_path / "stated.cfg").write_text(RECTANGLE + klipper_file(x, y, np.array(rows)))
    rows[0][0] += 1e-6
    (tmp_path / "seen.cfg").write_text(klipper_file(x, y, np.array(rows)))
    assert [len(places(tmp_path / name)) for name in ("stated.cfg", "seen.cfg")] == [25, 25]


def test_klipper_corrects_by_the_cells_that_it_filled() -> None:
    x, y, rows, _ = round_map(80.0, 5)
    file = OldFile("printer.cfg", ROUND.format(80, 5) + klipper_file(x, y, np.array(rows)))
    (mesh,) = Klipper().load([file], build("printer-gantry"), ExportOptions()).meshes
    assert 1e3 * mesh.added == pytest.approx(np.array(rows), abs=1e-6)


def test_what_lies_outside_the_radius_of_a_duet_is_no_reading(tmp_path: Path) -> None:
    at = np.linspace(-100.0, 100.0, 5)
    z = np.array([[height(x, y) if np.hypot(x, y) < 105 else 0.0 for x in at] for y in at])
    (tmp_path / "heightmap.csv").write_text(duet_file(at, at, z).replace(",-1.0,", ",105.0,"))
    found = places(tmp_path / "heightmap.csv")
    assert found == pytest.approx({(x, y): height(x, y) for x in at for y in at if np.hypot(x, y) < 105}, abs=1e-6)


def test_a_duet_fills_cells_by_the_plane_of_the_others() -> None:
    at = np.linspace(-100.0, 100.0, 5)
    plane = np.array([[0.1 + 1e-3 * x - 2e-3 * y for x in at] for y in at])
    text = duet_file(at, at, plane).replace(f"{plane[0, 0]:.6f}", "0", 1)
    (mesh,) = RepRapFirmware().load([OldFile("map.csv", text)], build("printer-gantry"), ExportOptions()).meshes
    assert 1e3 * mesh.added == pytest.approx(plane, abs=1e-6)


def test_one_of_several_meshes_is_named(tmp_path: Path) -> None:
    path = tmp_path / "printer.cfg"
    second = klipper_file(X, Y, bed(X, Y) + 0.25).partition("#*#\n")[2].replace("default", "hot bed")
    path.write_text(klipper_file(X, Y, bed(X, Y)) + second)
    cold, hot = (places(tmp_path / f"printer.cfg#{name}") for name in ("default", "hot bed"))
    assert {place: hot[place] - cold[place] for place in hot} == pytest.approx(dict.fromkeys(cold, 0.25), abs=1e-6)
    with pytest.raises(
        ReadingError, match=r"2 meshes are saved here: default, hot bed.*Name one of them: printer.cfg#hot bed"
    ):
        read_any(path)
    with pytest.raises(ReadingError, match=r"no mesh warm is saved here\. Saved are: default, hot bed"):
        read_any(tmp_path / "printer.cfg#warm")


def test_a_profile_of_a_file_without_meshes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("setup,X_mm,value_um\na,1,2\n")
    with pytest.raises(ReadingError, match="no mesh hot is saved here"):
        read_any(tmp_path / "r.csv#hot")
    (tmp_path / "r#1.csv").write_text("setup,X_mm,value_um\na,1,2\n")
    assert len(read_any(tmp_path / "r#1.csv")) == 1
