"""FANUC's pitch data, read by a reader of its own: by the manual's sections, one increment after the other."""

import re
from functools import cache

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

MACHINE = machine_text(
    "w-C'-B'-X'-b-Y-t",
    {"X": (-100, 300), "Y": (-200, 0), "B": (-30, 120), "C": (0, 360)},
    {
        "EXX EYY": ("10 um", 9, 150),
        "EXX_reversal": 'std = "5 um", knots = 3',
        "ECC": 'std = "25 urad", knots = 7',
        "EBB": 'std = "25 urad", knots = 4',
    },
    name="M",
)
NUMBERS = {"X": (1,), "Y": (2,), "B": (3,), "C": (4,)}
SIGN = {"X": -1, "Y": 1, "B": -1, "C": -1}  # an error names what the carriage does: X', B', C' carry the workpiece


def template(**parameters: str) -> str:
    """The reference points are 50 of X, 100 at the upper end of Y, 200 of B, and 250 where a turn of C begins."""
    rows = {
        "3605": "A1P00000000A2P00000000", "3620": "A1P50A2P100A3P200A4P250", "3621": "A1P46A2P91A3P199A4P250",
        "3622": "A1P65A2P100A3P208A4P258", "3623": "A1P1A2P1A3P1A4P1", "3624": "A1P20.0A2P20.0A3P15.0A4P45.0",
        "3626": "A1P0A2P0A3P0A4P0", "3627": "A1P0A2P0A3P0A4P0",
    }  # fmt: skip
    rows |= {key.removeprefix("N"): value for key, value in parameters.items()}
    return "\n".join(
        ["%", *(f"N{k}Q1{v};" for k, v in rows.items()), *(f"N{n}Q1P0;" for n in range(10000, 10300)), "%"]
    )


@cache
def known() -> Estimate:
    return drawn_and_known(machine_from_text(MACHINE), 8)


def exported(**parameters: str) -> Export:
    return export(known(), "fanuc", ExportOptions(template=template(**parameters), numbers=NUMBERS))


def deviation(axis: str, at: Array) -> Array:
    """Return the mean over both directions of the deviation along or about an axis, um or thousandths of a degree."""
    own = known().model.by_name[f"E{axis}{axis}"]
    rotary = axis in "BC"
    found = own.spline.rows(np.radians(at) if rotary else 1e-3 * at) @ known().mean[own.columns]
    return SIGN[axis] * np.asarray(1e3 * np.degrees(found) if rotary else 1e6 * found)


def walk(text: str, axis: int, to: float) -> float:
    """Return what the control has added, um, after the way from the reference point to a place, mm (B-63980EN).

    The reference point has number 3620; the entry of number 3620 + k is added on the way from (k - 1) to k intervals.
    """
    value = {
        int(n): {int(a or 0): float(p) for a, p in re.findall(r"(?:A(\d+))?P(-?[\d.]+)", rest)}
        for n, rest in re.findall(r"^N(\d+)Q1(.*);$", text, re.MULTILINE)
    }
    own = {n: value[n][axis] for n in (3620, 3623, 3624)}
    sections = round(to / own[3624])
    gone = range(1, sections + 1) if sections > 0 else range(0, sections, -1)
    total = sum(value[int(10000 + own[3620] + k)][0] for k in gone)
    return own[3623] * (total if sections > 0 else -total)


def test_the_reader_walks_through_the_manual_s_example() -> None:
    """B-63980EN page 100: points 33 to 49, the reference point 40, 50 mm; the drawn curve reaches +4 at -250 mm."""
    values = [2, 1, 1, -2, 0, -1, 0, -1, 2, 1, 0, -1, -1, -2, 0, 1, 2]
    text = template(N3620="A1P40A2P200", N3624="A1P50.0A2P20.0")
    for number, entry in zip(range(10033, 10050), values, strict=True):
        text = text.replace(f"N{number}Q1P0;", f"N{number}Q1P{entry};")
    assert [walk(text, 1, x) for x in (50, 100, 300, -50, -200, -400, -250)] == [2, 3, -1, 1, 2, 0, 4]


@pytest.mark.parametrize(("axis", "interval"), [("X", 20.0), ("Y", 20.0), ("B", 15.0), ("C", 45.0)])
def test_every_section_is_corrected_the_lowest_too(axis: str, interval: float) -> None:
    """The numbers 3621 are FANUC's: 50 - 100 / 20 + 1 = 46, 100 - 200 / 20 + 1 = 91, and of a whole turn 3620."""
    text = exported().files["pitch.txt"]
    ends = np.array(known().machine.axis(axis).travel)
    low, high = np.degrees(ends) if axis in "BC" else 1e3 * ends
    at = np.arange(low, high + 1e-6, interval)
    mean, added = deviation(axis, at), [walk(text, NUMBERS[axis][0], x) for x in at]
    left = mean - np.interp(0.0, at, mean) + added
    assert np.ptp(mean) > 2.5
    assert np.max(np.abs(left)) < 1.5  # half an entry at each end, and the line for the curve


def test_a_turn_sums_to_nothing_and_its_first_point_is_its_last() -> None:
    """FANUC's rule for rotary axes: 3621 = 3620, 3622 a turn further."""
    made = exported()
    first, *others = (int(n) for n in re.findall(r"^N102(?:5[0-8])Q1P(-?\d+);", made.files["pitch.txt"], re.MULTILINE))
    assert sum(others) == 0
    assert first == others[-1]
    assert "3625 = 360.0" in made.readme


def test_only_values_of_the_points_change() -> None:
    pairs = zip(template().splitlines(), exported().files["pitch.txt"].splitlines(), strict=True)
    changed = [new for old, new in pairs if old != new]
    assert all(re.fullmatch(r"N10\d\d\dQ1P-?\d;", new) for new in changed)
    points = {*range(10046, 10066), *range(10091, 10101), *range(10199, 10209), *range(10250, 10259)}
    assert {int(new[1:6]) for new in changed} <= points


def test_points_that_are_no_turn_are_refused_with_those_that_are() -> None:
    why = r"C is a whole turn and has points 249 to 258.* 3621 = 3620 = 250 and 3622 = 258"
    with pytest.raises(TableError, match=why):
        exported(N3621="A1P46A2P91A3P199A4P249")
