"""FANUC's pitch data, read by a reader of its own: by the manual's sections, one increment after the other."""

from __future__ import annotations

import re

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.description import machine_from_text
from axiscal.numerics import Array
from axiscal.tables.exporter import ExportOptions
from axiscal.tables.offer import Export
from axiscal.tables.registry import export
from axiscal.tables.round_trip import drawn_and_known
from tests.generators.texts import machine_text

MACHINE = """name = "M"
chain = "w-X'-b-Y-t"
[axes.X]
travel = ["-100 mm", "300 mm"]
[axes.Y]
travel = ["-200 mm", "0 mm"]
[errors]
EXX = { std = "10 um", knots = 9, length = "150 mm" }
EXX_reversal = { std = "5 um", knots = 3 }
EYY = { std = "10 um", knots = 9, length = "150 mm" }
"""
SIGN = {"X": -1, "Y": 1}  # an error names what the carriage does: X' carries the workpiece


def template(**parameters: str) -> str:
    """X: reference point 50, 20 mm, -100 to 300 mm by FANUC's formula; Y: reference point 200 at its upper end."""
    rows = {
        "3605": "A1P00000000A2P00000000", "3620": "A1P50A2P200", "3621": "A1P46A2P191", "3622": "A1P65A2P200",
        "3623": "A1P1A2P1", "3624": "A1P20.0A2P20.0", "3626": "A1P0A2P0", "3627": "A1P0A2P0",
    }  # fmt: skip
    rows |= {key.removeprefix("N"): value for key, value in parameters.items()}
    return "\n".join(
        ["%", *(f"N{k}Q1{v};" for k, v in rows.items()), *(f"N{n}Q1P0;" for n in range(10000, 10300)), "%"]
    )


def known() -> Estimate:
    return drawn_and_known(machine_from_text(MACHINE), 8)


def deviation(estimate: Estimate, axis: str, at: Array, side: int) -> Array:
    """Return the deviation of the TCP along an axis, from the control values themselves, m."""
    model = estimate.model
    own, back = model.names[f"E{axis}{axis}"], model.names.get(f"E{axis}{axis}_reversal")
    total = own.basis.rows(at) @ estimate.mean[own.columns]
    if back is not None:
        total = total + side / 2 * (back.basis.rows(at) @ estimate.mean[back.columns])
    return SIGN[axis] * np.asarray(total)


def walk(text: str, axis: int, to: float) -> float:
    """Return what the control has added, um, after the way from the reference point to a place, mm (B-63980EN).

    The reference point has number 3620; the entry of number 3620 + k is added on the way from (k - 1) to k intervals.
    """
    value = {
        int(n): {int(a or 0): float(p) for a, p in re.findall(r"(?:A(\d+))?P(-?[\d.]+)", rest)}
        for n, rest in re.findall(r"^N(\d+)Q1(.*);$", text, re.MULTILINE)
    }
    own = {n: value[n][axis] for n in (3620, 3621, 3622, 3623, 3624)}
    total, sections = 0.0, round(to / own[3624])
    for k in range(1, sections + 1):
        total += own[3623] * value[int(10000 + own[3620] + k)][0]
    for k in range(0, sections, -1):
        total -= own[3623] * value[int(10000 + own[3620] + k)][0]
    return total


def test_the_reader_walks_through_the_manual_s_example() -> None:
    """B-63980EN page 100: points 33 to 49, the reference point 40, 50 mm; the drawn curve reaches +4 at -250 mm."""
    values = [2, 1, 1, -2, 0, -1, 0, -1, 2, 1, 0, -1, -1, -2, 0, 1, 2]
    text = template(N3620="A1P40A2P200", N3624="A1P50.0A2P20.0")
    for number, entry in zip(range(10033, 10050), values, strict=True):
        text = text.replace(f"N{number}Q1P0;", f"N{number}Q1P{entry};")
    assert [walk(text, 1, x) for x in (50, 100, 300, -50, -200, -400)] == [2, 3, -1, 1, 2, 0]
    assert walk(text, 1, -250) == 4


@pytest.mark.parametrize("axis", ["X", "Y"])
def test_every_section_is_corrected_the_lowest_too(axis: str) -> None:
    """The numbers 3621 are FANUC's: 50 - 100 / 20 + 1 = 46 and 200 - 200 / 20 + 1 = 191."""
    estimate = known()
    text = export(estimate, "fanuc", ExportOptions(template=template())).files["pitch.txt"]
    low, high = estimate.machine.axis(axis).travel
    at = np.arange(low, high + 1e-9, 20e-3)
    mean = (deviation(estimate, axis, at, 1) + deviation(estimate, axis, at, -1)) / 2
    added = [walk(text, "XY".index(axis) + 1, 1e3 * x) for x in at]
    left = 1e6 * (mean - np.interp(0.0, at, mean)) + added
    assert np.ptp(1e6 * mean) > 5
    assert np.max(np.abs(left)) < 1.5  # half an entry at each end, and the line for the curve
    assert abs(added[0] - added[1]) >= 1  # the section that had no entry


def test_only_values_of_the_points_change() -> None:
    given = template()
    made = export(known(), "fanuc", ExportOptions(template=given)).files["pitch.txt"]
    changed = [(a, b) for a, b in zip(given.splitlines(), made.splitlines(), strict=True) if a != b]
    assert all(re.fullmatch(r"N10\d\d\dQ1P-?\d;", new) for _, new in changed)
    assert {int(new[1:6]) for _, new in changed} <= {*range(10046, 10066), *range(10191, 10201)}


TURNING = machine_text(
    "w-C'-B'-b-X-t",
    {"C": (0, 360), "B": (-30, 120), "X": (0, 200)},
    {
        "EXX": 'std = "10 um", knots = 9, length = "150 mm"',
        "ECC": 'std = "25 urad", knots = 7',
        "EBB": 'std = "25 urad", knots = 4',
    },
    name="T",
)


def turning(**parameters: str) -> Export:
    """X, B and C are axes 1, 2 and 3: C from point 100 in 45 deg steps, B from 200 in 15 deg steps."""
    rows = {
        "3620": "A1P50A2P200A3P100", "3621": "A1P51A2P199A3P100", "3622": "A1P60A2P208A3P108",
        "3623": "A1P1A2P1A3P1", "3624": "A1P20.0A2P15.0A3P45.0", "3626": "A1P0A2P0A3P0", "3627": "A1P0A2P0A3P0",
    } | {key.removeprefix("N"): value for key, value in parameters.items()}  # fmt: skip
    text = template(**{f"N{key}": value for key, value in rows.items()})
    return export(rotary(), "fanuc", ExportOptions(template=text, numbers={"X": (1,), "B": (2,), "C": (3,)}))


def rotary() -> Estimate:
    return drawn_and_known(machine_from_text(TURNING), 8)


def entries(text: str, first: int, last: int) -> list[int]:
    return [int(re.search(rf"^N{10000 + n}Q1P(-?\d+);", text, re.MULTILINE)[1]) for n in range(first, last + 1)]  # type: ignore[index]


def turned(name: str, degrees: Array) -> Array:
    """Return what a rotary axis that carries the workpiece turns the tool too far, thousandths of a degree."""
    estimate = rotary()
    error = estimate.model.names[f"E{name}{name}"]
    return -np.degrees(error.basis.rows(np.radians(degrees)) @ estimate.mean[error.columns]) * 1e3


def test_a_turn_sums_to_nothing_and_its_first_point_is_its_last() -> None:
    """FANUC's rule for rotary axes: 3621 = 3620, 3622 a turn further; what is added from point to point is walked."""
    made = turning()
    first, *others = entries(made.files["pitch.txt"], 100, 108)
    assert sum(others) == 0
    assert first == others[-1]
    curve = turned("C", np.arange(0, 361, 45.0))
    left = curve - curve[0] + np.concatenate([[0], np.cumsum(others)])
    assert np.ptp(curve) > 2.5
    assert np.max(np.abs(left)) < 1.2  # half an entry at both ends, and the line for the curve
    assert "3625 = 360.0" in made.readme
    assert "rotary axes" not in made.readme.split("Left out:")[1].split("\n")[0]


def test_a_rotary_axis_of_less_than_a_turn_is_as_a_linear_one() -> None:
    """B from -30 to 120 deg: points 199 to 208, the lowest section from -30 deg on."""
    steps = entries(turning().files["pitch.txt"], 199, 208)
    at = np.arange(-30, 121, 15.0)
    curve, added = turned("B", at), np.concatenate([[0], np.cumsum(steps)])
    left = curve - curve[2] + added - added[2]
    assert np.ptp(curve) > 2.5
    assert np.max(np.abs(left)) < 1.2


def test_points_that_are_no_turn_are_refused_with_those_that_are() -> None:
    with pytest.raises(
        TableError, match=r"C is a whole turn and has points 99 to 108.* 3621 = 3620 = 100 and 3622 = 108"
    ):
        turning(N3621="A1P51A2P199A3P99")
