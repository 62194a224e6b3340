"""LinuxCNC tables: read as the controller was seen to read them, written so that it corrects."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.ports.linuxcnc.tables import writer
from axiscal.ports.linuxcnc.tables.writer import LinuxcncTable, dead_band, notes, parse, write
from axiscal.tables.table import CompensationTable

SEEN = "-100 -100.010 -100.014\n0 0 -0.004\n100 100.020 100.016\n200 200.005 200.001\n"
ROW = "0 0.25 -0.5\n"


def correction(table: LinuxcncTable, position: Array, direction: int) -> Array:
    """Return what is added to the command at joint positions (m,), moving in direction +1 or -1, machine units.

    As compute_screw_comp of LinuxCNC's source has it, with slopes of 32 bits.
    """
    trims = (table.forward if direction > 0 else table.reverse).astype(np.float32)
    if trims.size == 0:
        return np.zeros(np.shape(position))
    slopes = np.append((np.diff(trims) / np.diff(table.nominal)).astype(np.float32), np.float32(0))
    at = np.searchsorted(table.nominal, position, side="right") - 1
    within = np.maximum(at, 0)
    inside = trims[within] + slopes[within].astype(np.float64) * (position - table.nominal[within])
    return np.where(at < 0, np.float64(trims[0]), inside)


def at(*positions: float) -> Array:
    return np.array(positions)


def rows(parsed: LinuxcncTable) -> list[tuple[float, ...]]:
    columns = (parsed.nominal, parsed.forward, parsed.reverse)
    return [tuple(row) for row in np.array(columns).T.tolist()]


@pytest.mark.parametrize(
    ("position", "direction", "seen"),
    [(100, 1, -0.020), (100, -1, -0.016), (300, 1, -0.005), (-300, -1, 0.014), (50, 1, -0.010), (-300, 1, 0.010)],
)
def test_corrections_seen_on_the_controller(position: float, direction: int, seen: float) -> None:
    assert correction(parse(SEEN), at(position), direction) == pytest.approx([seen], abs=1e-8)


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        *((start + ROW, []) for start in ("# table\n", "nominal fwd rev\n", "\n", "\ufeff", "0,0.2,-0.5\n", "0 1\n")),
        *((f"{ROW}{stop}2 2 2\n", [0]) for stop in ("\n", "# half way\n", "; half way\n", "1 1\n")),
        *((f"{ROW}1 2 {stop}\n2 2 2\n", [0]) for stop in ("0x5", "3e", "3e5x", "3inf", "nan", "3.4.5")),
        ("-.5e1-3+4;\n1e1 0 0", [-5, 10]),
        (f"{ROW}{'1 1 1'.ljust(253)}\n2 2 2\n", [0, 1, 2]),
        (f"{ROW}{'1 1 1'.ljust(300)}\n2 2 2\n", [0, 1]),
        ("2 2 2\n1 1 1\n0 0 0\n", [2]),
        ("0 0 0\n2 2 2\n1 1 1\n3 3 3\n", [0, 2, 3]),
        ("0 0 0\n0 1 1\n1 1 1\n", [0, 1]),
        ("-1e999 0 0\n1 1 1\n", [1]),
        *(("".join(f"{i} {i} {i}\n" for i in range(count)), [*range(min(count, 256))]) for count in (255, 256, 259)),
    ],
)
def test_reading_stops_at_a_line_that_does_not_match_and_leaves_out_rows_that_do_not_increase(
    text: str, kept: list[float]
) -> None:
    assert parse(text).nominal.tolist() == kept


def test_the_table_that_a_rotary_axis_is_shipped_with() -> None:
    """PocketNC's a.comp.default: zero trims, of Type 1; read as Type 0 it would turn the axis by 45 degrees."""
    text = "0 0 0\n45 0 0\n90 0 0\n135 0 0\n"
    assert correction(parse(text), at(45), 1) == pytest.approx([45])
    parsed = parse(text, file_type=1)
    assert rows(parsed) == [(0, 0, 0), (45, 0, 0), (90, 0, 0), (135, 0, 0)]


def table(**changes: Any) -> CompensationTable:
    good: dict[str, Any] = {"axis": "X", "positions": [-0.1, 0.0, 0.3]} | {
        "forward": [1e-6, 3e-6, -1e-6], "reverse": [0.0, 1e-6, -3e-6], "std": [1e-7] * 3
    }  # fmt: skip
    return CompensationTable(**(good | changes))


@st.composite
def tables(draw: st.DrawFn) -> CompensationTable:
    rotary = draw(st.booleans())
    gaps = draw(st.lists(st.floats(1e-4, 0.5), min_size=0, max_size=30))
    positions = draw(st.floats(-2, 2)) + np.cumsum([0.0, *gaps])
    values = st.lists(st.floats(-2e-5, 2e-5), min_size=len(positions), max_size=len(positions))
    forward, reverse = np.array(draw(values)), np.array(draw(values))
    return CompensationTable("C" if rotary else "X", positions, forward, reverse, forward)


@given(tables(), st.integers(0, 1000))
def test_what_is_written_takes_the_deviation_away(written: CompensationTable, seed: int) -> None:
    unit, scale = ("deg", np.pi / 180) if written.rotary else ("mm", 1e-3)
    text, resolution = write(written, unit), writer.resolution(written, unit)
    parsed = parse(text)
    rng = np.random.default_rng(seed)
    anywhere = rng.uniform(written.positions[0] - 0.1, written.positions[-1] + 0.1, 50)
    for direction in (1, -1):
        left = written.deviation(anywhere, direction) + scale * correction(parsed, anywhere / scale, direction)
        assert np.max(np.abs(left)) <= resolution, unit
    assert resolution < 2.1e-6 * scale
    assert text.isascii()
    assert text[0] in "-0123456789"


def long_table(n: int) -> CompensationTable:
    zeros = np.zeros(n)
    return table(positions=np.linspace(0, 1.0, n), forward=zeros, reverse=zeros, std=zeros)


def test_256_points_fit_and_257_do_not() -> None:
    assert len(write(long_table(256), "mm").splitlines()) == 256
    with pytest.raises(TableError, match=r"257 points.*256 points fit.*one every 3\.922 mm or wider"):
        write(long_table(257), "mm")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"positions": [0.0, 1e-10, 1.0], "forward": [0.0] * 3, "reverse": [0.0] * 3}, "one in the six decimals"),
        ({"forward": [0.0, 0.1, 0.0]}, "after -100 mm changes by more than 50% of the way"),
    ],
)
def test_what_a_file_cannot_hold_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(TableError, match=message):
        write(table(**changes), "mm")


def said(word: str, **known: Any) -> str:
    changes, known = known.pop("changes", {}), {"joints": (0,), "acceleration": 1.0, **known}
    given = table(**changes)
    (note,) = [note for note in notes(given, "deg" if given.rotary else "mm", **known) if word in note]
    return note


def test_dead_bands_seen_on_the_controller() -> None:
    for acceleration, seen in [(1000, (0.25, 0.5)), (5000, (1.25, 2.5)), (50000, (12.5, 25)), (5e5, (125, 250))]:
        assert dead_band(acceleration / 1e3, 1e-3) == pytest.approx(np.array(seen) * 1e-6)


@pytest.mark.parametrize(
    ("acceleration", "warned"),
    [(1.9, False), (2.1, True), (4.0, True), (7.9, True), (8.1, False)],
)
def test_a_reversal_step_in_the_dead_band_is_warned_of(acceleration: float, warned: bool) -> None:
    """The steps are 1 to 2 um: in the band from 2 a dt²/4 = 1 um on, out of it when a dt²/4 is 2 um."""
    assert said("reversal step", acceleration=acceleration).startswith("WARNING") is warned
