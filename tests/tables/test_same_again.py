"""The table model, and files read and written again: the same to the byte, nothing is lost, nothing drifts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import TableError
from axiscal.machine.axis import Axis
from axiscal.machine.description import Machine
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables import pivots, writer
from axiscal.ports.printers import klipper, marlin, reprapfirmware
from axiscal.tables.controllers import isg, plain_csv, sinumerik
from axiscal.tables.controllers.fanuc import read_records, replace_values
from axiscal.tables.controllers.isg import read_list, write_list
from axiscal.tables.exporter import Exporter, ExportOptions
from axiscal.tables.loaded import Loaded, OldFile
from axiscal.tables.surface import Mesh
from axiscal.tables.table import CompensationTable
from axiscal.tables.volumetric import SampledError
from axiscal.units import from_unit

X, C = Axis.named("X", False, (-0.5, 0.5), 0.1), Axis.named("C", True, (0.0, 2 * np.pi), 1.0)
MACHINE = Machine("a slide and a table", (X, C), 0.1, (), "", "")
SMALL = st.floats(-2e-4, 2e-4)


def values(count: int) -> st.SearchStrategy[Array]:
    """Return so many deviations, m or rad."""
    return st.lists(SMALL, min_size=count, max_size=count).map(np.array)


@st.composite
def tables(draw: st.DrawFn, rotary: bool | None = None) -> CompensationTable:
    """Return a table of a slide or a rotary table on an even grid that begins where a hundredth of a unit begins."""
    turning = draw(st.booleans()) if rotary is None else rotary
    count = draw(st.integers(2, 12))
    first, step = draw(st.integers(-40_000, 0)), draw(st.integers(100, 3000))
    at = from_unit((first + step * np.arange(count, dtype=float)) / 100, "deg" if turning else "mm")
    sides = draw(values(count)), draw(values(count))
    return CompensationTable("C" if turning else "X", at, *sides, np.abs(draw(values(count))))


@st.composite
def meshes(draw: st.DrawFn) -> Mesh:
    """Return heights on an even grid of whole millimetres."""
    columns, rows = draw(st.integers(2, 6)), draw(st.integers(2, 6))
    x, y = (draw(st.integers(-300, 50)) + draw(st.integers(5, 60)) * np.arange(n, dtype=float) for n in (columns, rows))
    return Mesh(from_unit(x, "mm"), from_unit(y, "mm"), draw(values(columns * rows)).reshape(rows, columns))


def loaded(control: Exporter, text: str) -> Loaded:
    """Return what a control makes of one file."""
    return control.load([OldFile("file", text)], MACHINE, ExportOptions())


@given(tables(), st.booleans())
def test_linuxcnc_table(table: CompensationTable, inch: bool) -> None:
    """The control keeps its trims in 32 bits: a trim of a millimetre is 6e-11 mm off, far below a digit of the file."""
    unit = "deg" if table.rotary else "in" if inch else "mm"
    text = writer.write(table, unit)
    kept = writer.parse(text)
    at, forward, reverse = (from_unit(column, unit) for column in (kept.nominal, -kept.forward, -kept.reverse))
    assert writer.write(CompensationTable(table.axis, at, forward, reverse, table.std), unit) == text


@given(st.sampled_from("AB"), st.lists(st.floats(-1, 1), min_size=4, max_size=4), st.booleans())
def test_linuxcnc_pivots(swivel: str, lengths: list[float], conventional: bool) -> None:
    x, y, z, offset = lengths
    text = pivots.write(pivots.Pivots(swivel, (x, y, z), offset, conventional), "mm")
    assert pivots.write(pivots.read(text, "mm"), "mm") == text


@given(tables())
def test_sinumerik(table: CompensationTable) -> None:
    names = {"X": "X1", "C": "C1"}
    files = sinumerik.write([table], sinumerik.blocks_of([table], []), names)
    found = [each for text in files.values() for each in sinumerik.read(text, names, MACHINE)]
    middle = found[0].forward
    half = found[1].forward if len(found) > 1 else np.zeros_like(middle)
    same = CompensationTable(table.axis, found[0].positions, middle + half, middle - half, table.std)
    assert sinumerik.write([same], sinumerik.blocks_of([same], []), names) == files


@given(tables())
def test_isg_leadscrew(table: CompensationTable) -> None:
    text = write_list(table, 3, cyclic=False)
    assert write_list(read_list(text, MACHINE), 3, cyclic=False) == text


@given(st.integers(2, 9), st.data())
def test_isg_volumetric(count: int, data: st.DataObject) -> None:
    curves = {
        name: SampledError(np.linspace(*axis.travel, count), data.draw(values(count)))
        for name, axis in (("EXX", X), ("EYX", X), ("EBX", X), ("EZC", C), ("EAC", C))
    }
    curves["A0C"] = SampledError(np.zeros(1), data.draw(values(1)))
    text = isg.write_csv(curves, MACHINE)
    assert isg.write_csv(isg.read_csv(text, MACHINE), MACHINE) == text


@given(meshes())
def test_klipper_mesh(mesh: Mesh) -> None:
    text = klipper.write_mesh(mesh, "axiscal")
    (found,) = loaded(klipper.Klipper(), text).meshes
    assert klipper.write_mesh(found, "axiscal") == text


@given(meshes(), SMALL, st.floats(0, 1e-3))
def test_marlin(mesh: Mesh, tangent: float, play: float) -> None:
    half = np.full(2, play / 2)
    text = marlin.text_of(Loaded((CompensationTable("X", np.array(X.travel), -half, half),), (mesh,), {"XY": tangent}))
    assert marlin.text_of(marlin.read(text, MACHINE)) == text


@given(meshes())
def test_reprapfirmware(mesh: Mesh) -> None:
    text = reprapfirmware.text_of(mesh)
    (found,) = loaded(reprapfirmware.RepRapFirmware(), text).meshes
    assert reprapfirmware.text_of(found) == text


@given(st.dictionaries(st.tuples(st.integers(1, 9999), st.integers(1, 3)), st.integers(-128, 127), min_size=1))
def test_fanuc(stored: dict[tuple[int, int], int]) -> None:
    rows = [f"N{number:05d}Q1A{axis}P{value}" for (number, axis), value in sorted(stored.items())]
    text = "\n".join(["%", *rows, "%", ""])
    found = read_records(text, "saved")
    again = {(number, axis): int(value) for number, row in found.items() for axis, value in row.items()}
    assert {place: again[place] for place in stored} == stored
    assert replace_values(text, {place: again[place] for place in stored}, "saved") == text


def table(**changes: Any) -> CompensationTable:
    good: dict[str, Any] = {"axis": "X", "positions": [0.0, 0.1, 0.3]} | {
        "forward": [1e-6, 3e-6, -1e-6], "reverse": [0.0, 1e-6, -3e-6], "std": [1e-7] * 3
    }  # fmt: skip
    return CompensationTable(**(good | changes))


def at(*positions: float) -> Array:
    return np.array(positions)


def test_deviation_is_linear_between_the_points_and_constant_outside() -> None:
    assert table().deviation(at(-1, 0, 0.05, 0.2, 9), 1) == pytest.approx([1e-6, 1e-6, 2e-6, 1e-6, -1e-6])
    assert table().deviation(at(-1, 0, 0.05, 0.2, 9), -1) == pytest.approx([0, 0, 5e-7, -1e-6, -3e-6])


def test_sizes_of_the_reversal_step() -> None:
    assert table().reversal == pytest.approx((1e-6, 2e-6))
    assert table(reverse=[2e-6, 1e-6, -1e-6]).reversal == pytest.approx((0, 2e-6))
    assert table(reverse=[1e-6, 3e-6, -1e-6]).reversal == (0, 0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axis": "X\nG0"}, r"'X\\nG0' is not the name of an axis"),
        ({"axis": "../X"}, "is not the name of an axis"),
        ({"axis": ""}, "is not the name of an axis"),
        ({"positions": [0.0, 0.1, 0.1]}, "do not increase"),
        ({"positions": [0.0, 0.3, 0.1]}, "do not increase"),
        ({"positions": [0.0, np.nan, 0.1]}, "positions of X is not finite"),
        ({"forward": [0.0, np.inf, 0.1]}, "forward of X is not finite at 0.1 m"),
        ({"std": [0.0, 1.0]}, r"std of shape \(2,\) for \(3,\) positions"),
        ({"positions": [], "forward": [], "reverse": [], "std": []}, "one number for each position"),
        ({"reverse": [[0.0, 1.0, 2.0]]}, "one number for each position"),
    ],
)
def test_what_no_controller_could_hold_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(TableError, match=message):
        table(**changes)


@given(
    st.lists(st.floats(-10, 10), min_size=1, max_size=20, unique_by=lambda x: round(x, 6)).map(sorted),
    st.booleans(),
    st.data(),
)
def test_csv_comes_back_as_written(positions: list[float], rotary: bool, data: st.DataObject) -> None:
    values = st.lists(st.floats(-1e-3, 1e-3), min_size=len(positions), max_size=len(positions))
    drawn = np.array(data.draw(values))
    written = CompensationTable("C" if rotary else "X", np.array(positions), drawn, drawn, drawn)
    back = plain_csv.parse(plain_csv.text_of(written))
    assert (back.axis, back.rotary) == (written.axis, rotary)
    assert back.positions == pytest.approx(written.positions, abs=1e-9)
    for name in ("forward", "reverse", "std"):
        assert getattr(back, name) == pytest.approx(getattr(written, name), abs=2.5e-10 if rotary else 0.6e-10)
