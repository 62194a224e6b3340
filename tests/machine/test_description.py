"""A machine from its TOML text: axes, priors, knots; the built-in machines are what they say."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from axiscal.exceptions import DescriptionError
from axiscal.machine import builtin_names, load_machine, machine_from_text
from axiscal.machine.axis import iso_axis
from axiscal_core.machine import Machine

TEXT = """\
name = "Mill"
chain = "[w X' b Y C (C) t]"
[tool]
length = "120 mm"
[axes.Y]
travel = ["-100 mm", "300 mm"]
[axes.X]
travel = ["0 mm", "600 mm"]
speed = "10 m/min"
acceleration = "2 m/s^2"
[axes.C]
travel = ["0 deg", "360 deg"]
origin = ["1 mm", "2 mm", "-150 mm"]
[errors]
EXX = { std = "10 um", knots = 13, length = "150 mm" }
EZX = { band = "20 um", spacing = "50 mm" }
"C(0X)Y" = { std = "30 urad" }
EXX_reversal = { std = "3 um" }
EYX = { std = "5 um", knots = 13, rest = "0.5 um" }
EXY = { std = "5 um", length = "90 mm", rest = "estimate" }
ECC = { std = "5 arcsec" }
ECC_reversal = { std = "5 arcsec", knots = 4 }
X0C = { std = "5 um" }
"""


def test_machine_zero_is_within_the_travel() -> None:
    machine = machine_from_text(TEXT.replace('["0 deg", "360 deg"]', '["10 deg", "370 deg"]'))
    assert machine.zero == pytest.approx((0.0, 0.0, math.radians(10)))


def test_knots_stand_twice_as_far_apart_where_there_would_be_many() -> None:
    """Twelve curves of 17 control values are 204, and stay at half their length; eleven are 187."""
    names = [f"E{component}{axis}" for axis in "XY" for component in "XYZABC"]
    head = 'chain = "w-b-X-Y-t"\n' + "".join(f'[axes.{axis}]\ntravel = ["0 mm", "400 mm"]\n' for axis in "XY")
    for count, knots in ((11, 17), (12, 9)):
        sizes = {name: "urad" if name[1] in "ABC" else "um" for name in names[:count]}
        lines = [f'{name} = {{ std = "10 {unit}", length = "100 mm" }}\n' for name, unit in sizes.items()]
        machine = machine_from_text(f'{head}[errors]\n{"".join(lines)}C0Y = {{ std = "30 urad" }}\n')
        assert {e.count for e in machine.stated if e.count > 1} == {knots}


@pytest.mark.parametrize(
    ("error", "said", "count"),
    [
        ("EXX", 'spacing = "100 mm"', 7),
        ("EXX", 'spacing = "99 mm"', 8),
        ("EXX", 'spacing = "99.9999999999 mm"', 7),
        ("EXX", 'spacing = "5 m"', 2),
        ("EXX", 'length = "5 m"', 5),
        ("EXX", 'length = "400 mm"', 7),
        ("EXX", "knots = 7", 7),
        ("EXX_reversal", 'spacing = "300 mm"', 3),
    ],
)
def test_spacing_and_length_give_equidistant_knots(error: str, said: str, count: int) -> None:
    head = 'chain = "w-b-X-t"\n[axes.X]\ntravel = ["100 mm", "700 mm"]\n[errors]\n'
    (term,) = machine_from_text(f'{head}{error} = {{ std = "1 um", {said} }}').terms
    assert term.spline.knots == pytest.approx(np.linspace(0.1, 0.7, count))


def test_a_full_turn_is_cyclic_to_a_nanoradian_and_a_linear_axis_never() -> None:
    assert iso_axis("C", True, (1.0, 1.0 + math.tau + 5e-10)).cyclic
    assert not iso_axis("C", True, (1.0, 1.0 + math.tau - 5e-9)).cyclic
    assert not iso_axis("X", True, (0.0, math.tau)).cyclic


@pytest.mark.parametrize(
    ("name", "direction"),
    [("X", 0), ("U", 0), ("P", 0), ("A", 0), ("Y", 1), ("V2", 1), ("Q", 1), ("B", 1), ("Z", 2), ("W", 2), ("R", 2)],
)
def test_letters_have_the_directions_of_iso_841(name: str, direction: int) -> None:
    axis = iso_axis(name, False, (0.0, 1.0))
    assert axis.direction == tuple(float(place == direction) for place in range(3))
    assert axis.rotary == (name in "ABC")
    assert axis.letter == name[0]


@pytest.mark.parametrize("name", ["", "D", "x"])
def test_a_letter_that_is_no_axis_is_refused(name: str) -> None:
    with pytest.raises(DescriptionError, match="not an axis name"):
        iso_axis(name, False, (0.0, 1.0))


def test_a_machine_is_read_from_a_path_and_named_after_it_if_need_be(tmp_path: Path) -> None:
    path = tmp_path / "old mill.toml"
    path.write_text(TEXT.replace('name = "Mill"', ""), encoding="utf-8")
    assert load_machine(path).name == "old mill"
    assert load_machine(str(path)).axes == machine_from_text(TEXT).axes


def sizes(machine: Machine) -> dict[str, int]:
    """Return the number of free control values of each error."""
    counts = {}
    for entry in machine.stated:
        counts[entry.name] = entry.count - (machine.axis(entry.axis).cyclic and entry.count > 1)
    return counts


@pytest.mark.parametrize("name", builtin_names())
def test_knots_are_fine_enough_for_the_correlation_length(name: str) -> None:
    machine = load_machine(name)
    for term in machine.curves:
        if term.length is not None:
            knots = term.spline.knots
            assert knots[1] - knots[0] <= 0.55 * term.length
