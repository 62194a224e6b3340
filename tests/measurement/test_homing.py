"""A mesh is zero where the printer homes Z: by its own file, as stated, or in the middle."""

from pathlib import Path

import numpy as np
import pytest

from axiscal.description.campaign import read_campaign
from axiscal.measurement.readers.probe_offset import sections_in, zero_of
from axiscal.numerics import Array
from axiscal.present.delivery import read_in
from tests.controls.fetched import MissingError
from tests.controls.klipper_mesh import asked, held
from tests.generators.field import with_field
from tests.tables.test_bed_round_trips import (
    X,
    Y,
    bed,
    duet_file,
    estimated,
    exported,
    held_by,
    klipper_file,
)

PROBE = "[bltouch]\nx_offset: -20\ny_offset: 5\nz_offset: 1\n"
BY_PROBE = "[stepper_z]\nendstop_pin: probe:z_virtual_endstop\n"
HOME = "[safe_z_home]\nhome_xy_position: 110, 90  # mm\n"


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (f"{HOME}[bed_mesh]\nzero_reference_position = 150, 140\n", (150, 140)),
        (HOME, None),
        (HOME + PROBE + BY_PROBE.replace("probe:z_virtual_endstop", "^PC2"), None),
        (HOME + BY_PROBE.replace(":z_v", ": z_v"), (110, 90)),
        (HOME + PROBE + BY_PROBE, (90, 95)),
        (klipper_file(X, Y, bed(X, Y)), None),
        *((text, (150, 150)) for text in with_field({}, "04-bed-map-zero/bowl.cfg")),
        *((text, None) for text in with_field({}, "15-two-profiles/two.cfg")),
    ],
)
def test_files_of_a_printer_say_where_it_homes(text: str, place: tuple[float, float] | None) -> None:
    found = zero_of(sections_in(text) or {})
    assert found == (None if place is None else pytest.approx((place[0] * 1e-3, place[1] * 1e-3)))


WAYS = {
    "zero_reference_position": "[bed_mesh]\nzero_reference_position: {x}, {y}\n",
    "safe_z_home": f"{BY_PROBE}[probe]\nx_offset: 4\ny_offset: -7\n[safe_z_home]\nhome_xy_position: {{hx}}, {{hy}}\n",
    "index": "[bed_mesh]\nmesh_min: 30, 20\nmesh_max: 270, 220\nprobe_count: 7, 6\nrelative_reference_index: {index}\n",
}


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_a_mesh_is_zero_where_its_own_file_says_by_the_mesh_of_klipper(seed: int, tmp_path: Path) -> None:
    """To 1 um; the stated place is drawn, and the way to state it."""
    rng, (name, way) = np.random.default_rng(seed), [*WAYS.items()][seed % 3]
    x, y = (round(float(rng.uniform(*ends)), 2) for ends in ((35, 265), (25, 215)))
    index = int(rng.integers(42))
    try:
        if name == "index":
            x, y = asked(nodes=[((30, 20), (270, 220), (7, 6), None, (0, 0))])[0][index]
        stated = way.format(x=x, y=y, hx=x - 4, hy=y + 7, index=index)
        text = stated + klipper_file(X, Y, bed(X, Y) + rng.uniform(-0.3, 0.3))
        files = exported(estimated(tmp_path, text, "printer.cfg"), "klipper")
        (height,) = asked([held(files["bed_mesh.cfg"], (x, y))])
    except MissingError as why:
        pytest.skip(str(why))
    assert height == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("radius", [None, 97.3])
def test_the_nodes_of_a_mesh_are_counted_as_klipper_counts_them(radius: float | None) -> None:
    counts, low, high, origin = (
        ((7, 7), (-97.3, -97.3), (97.3, 97.3), (12, 5)) if radius else ((5, 4), (15, 12), (285, 230), (0, 0))
    )
    try:
        (nodes,) = asked(nodes=[(low, high, counts, radius, origin)])
    except MissingError as why:
        pytest.skip(str(why))
    said = f"mesh_radius: {radius}\nmesh_origin: 12, 5\nround_probe_count: 7\n"
    said = said if radius else "mesh_min: 15, 12\nmesh_max: 285, 230\nprobe_count: 5, 4\n"
    for index, node in enumerate([*nodes, None]):
        found = zero_of(sections_in(f"[bed_mesh]\n{said}relative_reference_index: {index}\n") or {})
        assert found == (None if node is None else pytest.approx((node[0] * 1e-3, node[1] * 1e-3)))


@pytest.mark.parametrize(
    ("readings", "name", "controller"),
    [
        (f"[bed_mesh]\nzero_reference_position: 60, 140\n{klipper_file(X, Y, bed(X, Y))}", "printer.cfg", "klipper"),
        (duet_file(X, Y, bed(X, Y)), "heightmap.csv", "reprapfirmware"),
        (klipper_file(X, Y, bed(X, Y)), "printer.cfg", "marlin"),
    ],
)
def test_the_place_stands_on_the_screen_and_in_the_record(
    readings: str, name: str, controller: str, tmp_path: Path
) -> None:
    """By the file itself, or as it is stated."""
    zero = None if controller == "klipper" else "60 mm, 140 mm"
    record = estimated(tmp_path, readings, name, options=("--zero", zero) if zero else ())
    described = read_campaign(record.parents[1] / "campaign.toml", target_needed=False, asking=False)
    assert "zero at X60 Y140" in read_in(described, record.parents[1] / name, zero=zero).told
    assert r"zero_at = [\"60 mm\", \"140 mm\"]" in record.read_text(errors="replace")
    x, y, mesh = held_by(controller, exported(record, controller))
    assert height(x, y, mesh, (60.0, 140.0)) == pytest.approx(0.0, abs=2e-4 if controller == "marlin" else 1e-6)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return estimated(tmp_path_factory.mktemp("bed"), klipper_file(X, Y, bed(X, Y)), "printer.cfg")


def height(x: Array, y: Array, mesh: Array, at: tuple[float, float]) -> float:
    """Return a mesh at a place: linear along x, then along y.  x, y : mm"""
    return float(np.interp(at[1], y, [np.interp(at[0], x, row) for row in mesh]))


@pytest.mark.parametrize(
    ("controller", "option", "place"),
    [
        ("reprapfirmware", (), (150.0, 120.0)),
        ("marlin", ("--zero", "70 mm, 20 mm"), (70.0, 20.0)),
        ("klipper", ("--zero", "90 mm, 95 mm"), (90.0, 95.0)),
    ],
)
def test_the_files_of_every_printer_are_zero_where_it_homes(
    record: Path, controller: str, option: tuple[str, ...], place: tuple[float, float]
) -> None:
    files = exported(record, controller, *option)
    x, y, mesh = held_by(controller, files)
    assert np.ptp(mesh) > 0.1
    assert height(x, y, mesh, place) == pytest.approx(0.0, abs=2e-4 if controller == "marlin" else 1e-6)
    assert f"zero at X{place[0]:g} Y{place[1]:g}" in files["README.txt"]
