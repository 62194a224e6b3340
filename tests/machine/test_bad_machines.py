"""Malformed machine files: each ends in one failure of one class, with its line, the offending value and a remedy."""

from __future__ import annotations

import pytest

from axiscal.exceptions import ChainError, DescriptionError, InputError, UnitError
from axiscal.machine import machine_from_text

LINES = """\
name = "Mill"
chain = "w-X'-b-Y-C-t"
[tool]
length = "120 mm"
[axes.X]
travel = ["0 mm", "600 mm"]
speed = "10 m/min"
acceleration = "2 m/s^2"
[axes.Y]
travel = ["0 mm", "400 mm"]
[axes.C]
travel = ["0 deg", "360 deg"]
origin = ["0 mm", "0 mm", "-150 mm"]
speed = "30 rpm"
[errors]
EXX = { std = "10 um", knots = 13, length = "150 mm" }
EZY = { band = "20 um", spacing = "50 mm", rest = "estimate" }
C0Y = { std = "30 urad" }
EXX_reversal = { std = "3 um" }
ECC = { std = "5 arcsec", length = "60 deg" }
""".splitlines()

D, U, C = DescriptionError, UnitError, ChainError

# (line replaced, its new text, class, line reported, offending value, remedy)
CASES: list[tuple[int, str, type[InputError], int | None, str, str]] = [
    # name and chain
    (1, "name = 3", D, 1, "name: 3", "Write a text in quotes"),
    (1, 'name = ""', D, 1, '""', "printable"),
    (1, 'name = "a\\u001bb"', D, 1, '"a\\x1bb"', "printable"),
    (1, f'name = "{"n" * 300}"', D, 1, '"nnn', "up to 200"),
    (1, 'title = "Mill"', D, 1, '"title"', "name, maker, serial, chain, tool, axes, errors"),
    (1, 'nmae = "Mill"', D, 1, '"nmae"', 'Perhaps "name"'),
    (2, "", D, None, '"chain" is missing', "Add a line such as chain ="),
    (2, "chain = 5", D, 2, "chain: 5", "text in quotes"),
    (2, 'chain = ["w", "b"]', D, 2, '["w", "b"]', "text in quotes"),
    (2, 'chain = ""', C, 2, '""', "Write the chain"),
    (2, 'chain = "w-X\'-Y-C-t"', C, 2, "w-X'-Y-C-t", "Write the chain"),
    (2, 'chain = "w-X-b-Y-C-t"', C, 2, "X in the chain", "write X'"),
    (2, "chain = \"w-X'-b-Y'-C-t\"", C, 2, "Y' in the chain", "write Y,"),
    (2, 'chain = "w-X\'-b-Y-X-C-t"', C, 2, "X stands twice", "X2"),
    (2, 'chain = "w-X\'-b-Y-D-t"', C, 2, '"D"', "Axes are"),
    (2, 'chain = "w-X\'-b-Y-Z-t"', D, 11, 'no axis "C"', "Put it into the chain"),
    (2, 'chain = "w-X\'-b-Y-Z-C-t"', D, 2, "axis Z", "Add [axes.Z]"),
    (2, 'chain = "w-X\'-b-Y-C2-t"', D, 11, 'no axis "C"', "Perhaps C2 is meant"),
    # tool
    (3, "[tools]", D, 3, '"tools"', 'Perhaps "tool"'),
    (3, "[[tool]]", D, 3, "tool: [", "Write a table"),
    (4, "length = 120", U, 4, "120", "with its unit"),
    (4, "length = 120 mm", D, 4, "length = 120 mm", "stand in quotes"),
    (4, 'length = "120"', U, 4, '"120"', "with its unit"),
    (4, 'length = ""', U, 4, "empty", "with its unit"),
    (4, 'length = "120 deg"', U, 4, '"120 deg" is an angle', "a length"),
    (4, 'length = "-1 mm"', D, 4, '"-1 mm" is negative', "0 mm"),
    (4, 'length = "20 m"', D, 4, '"20 m" is too large', "10 m"),
    (4, 'length = "nan mm"', U, 4, '"nan mm"', "a length"),
    (4, 'length = "1e400 mm"', U, 4, '"1e400 mm"', "a length"),
    (4, 'length = "120,5 mm"', U, 4, '"120,5 mm"', "point"),
    (4, 'length = "120 mn"', U, 4, '"120 mn"', "Perhaps"),
    (4, 'lenght = "120 mm"', D, 4, '"lenght"', 'Perhaps "length"'),
    (4, "length = true", U, 4, "true", "in quotes"),
    (4, 'length = "1 mm"\nlength = "2 mm"', D, 5, "2 mm", "given once"),
    # axes
    (5, "[axes.Q]", D, 5, 'no axis "Q"', "chain"),
    (5, "[axis.X]", D, 5, '"axis"', 'Perhaps "axes"'),
    (5, "[axes.x]", D, 5, 'no axis "x"', "Perhaps X is meant"),
    (6, "", D, 5, '"travel" is missing in [axes.X]', 'travel = ["0 mm", "600 mm"]'),
    (6, 'travel = "600 mm"', D, 6, '"600 mm"', "list in square brackets"),
    (6, 'travel = ["600 mm"]', D, 6, "axes.X.travel", "travel = "),
    (6, 'travel = ["0 mm", "1 mm", "2 mm"]', D, 6, "axes.X.travel", "travel = "),
    (6, "travel = [0, 600]", U, 6, "axes.X.travel[1]: 0 ", "in quotes"),
    (6, "travel = [0 mm, 600 mm]", D, 6, "0 mm, 600 mm", "stand in quotes"),
    (6, 'travel = ["600 mm", "0 mm"]', D, 6, '["600 mm", "0 mm"] is reversed', '["0 mm", "600 mm"]'),
    (6, 'travel = ["5 mm", "5 mm"]', D, 6, '["5 mm", "5 mm"] is empty', "two ends"),
    (6, 'travel = [\n"0 mm",\n"600 s"]', U, 8, '"600 s" is a time', "a length"),
    (6, 'travel = ["0 deg", "360 deg"]', U, 6, '"0 deg" is an angle', "a length"),
    (6, 'travel = ["0 mm", "600 km"]', D, 6, '"600 km" is too large', "to 1 km"),
    (6, 'travel = ["0 mm", "inf mm"]', U, 6, '"inf mm"', "a length"),
    (7, 'speed = "10 mm"', U, 7, '"10 mm" is a length, not a speed', "10 m/min"),
    (7, 'speed = "30 rpm"', U, 7, '"30 rpm" is a rotational speed', "10 m/min"),
    (7, 'speed = "0 m/min"', D, 7, '"0 m/min" is zero', "m/min"),
    (7, 'speed = "-3 m/min"', D, 7, '"-3 m/min" is negative', "m/min"),
    (7, "speed = 10", U, 7, "10", "in quotes"),
    (7, "velocity = 3", D, 7, '"velocity"', "travel, speed, acceleration, overrun, origin"),
    (8, 'acceleration = "2 m/s"', U, 8, '"2 m/s" is a speed, not an acceleration', "2 m/s^2"),
    (8, 'acceleration = "0 m/s^2"', D, 8, '"0 m/s^2" is zero', "m/s^2"),
    (8, 'origin = ["0 mm", "0 mm", "0 mm"]', D, 8, "a linear axis has no axis line", "rotary axes"),
    (8, 'direction = "x"', D, 8, '"x" is not possible here', "'iso' or 'reversed'"),
    (8, "direction = -1", D, 8, "axes.X.direction: -1", "'reversed'"),
    (12, 'travel = ["0 mm", "360 mm"]', U, 12, '"0 mm" is a length', "an angle"),
    (12, 'travel = ["0 deg", "400 deg"]', D, 12, "more than one turn (400 deg)", '["0 deg", "360 deg"]'),
    (12, 'travel = ["120 deg", "-30 deg"]', D, 12, "reversed", '["-30 deg", "120 deg"]'),
    (13, 'origin = ["0 mm", "0 mm"]', D, 13, "axes.C.origin", "origin ="),
    (13, 'origin = ["0 mm", "0 deg", "0 mm"]', U, 13, '"0 deg"', "a length"),
    (13, "origin = [0, 0, 0]", U, 13, "0", "in quotes"),
    (14, 'speed = "10 m/min"', U, 14, '"10 m/min" is a speed', "30 rpm"),
    # errors
    (15, "[error]", D, 15, '"error"', 'Perhaps "errors"'),
    (16, "EXX = 3", D, 16, "errors.EXX: 3", "Write a table"),
    (16, 'EXX = "10 um"', D, 16, '"10 um"', "Write a table"),
    (16, "EXX = { }", D, 16, "neither std nor band", "std ="),
    (16, 'EXX = { std = "1 um", band = "4 um" }', D, 16, "both std and band", "Keep one"),
    (16, 'EXX = { std = "1 um", knots = 5, spacing = "50 mm" }', D, 16, "both knots and spacing", "Keep one"),
    (16, 'EXX = { std = "0 um" }', D, 16, '"0 um" is zero', "um"),
    (16, 'EXX = { std = "-1 um" }', D, 16, '"-1 um" is negative', "um"),
    (16, 'EXX = { std = "2 m" }', D, 16, '"2 m" is too large', "to 1 m"),
    (16, 'EXX = { std = "1 urad" }', U, 16, '"1 urad" is an angle', "a length"),
    (16, "EXX = { std = 10 }", U, 16, "errors.EXX.std: 10", "in quotes"),
    (16, 'EXX = { std = "10" }', U, 16, '"10"', "with its unit"),
    (16, 'EXX = { sdt = "10 um" }', D, 16, '"sdt"', 'Perhaps "std"'),
    (16, 'EXX = { std = "1 um", knots = 1 }', D, 16, "knots = 1", "2 to 400"),
    (16, 'EXX = { std = "1 um", knots = 401 }', D, 16, "knots = 401", "2 to 400"),
    (16, 'EXX = { std = "1 um", knots = -7 }', D, 16, "knots = -7", "2 to 400"),
    (16, 'EXX = { std = "1 um", knots = 7.5 }', D, 16, "7.5", "whole number"),
    (16, 'EXX = { std = "1 um", knots = "7" }', D, 16, '"7"', "whole number"),
    (16, 'EXX = { std = "1 um", knots = true }', D, 16, "true", "whole number"),
    (16, 'EXX = { std = "1 um", knots = nan }', D, 16, "nan", "whole number"),
    (16, f'EXX = {{ std = "1 um", knots = {"9" * 30} }}', D, 16, "more than 18 digits", "2 to 400"),
    (16, 'EXX = { std = "1 um", spacing = "1 mm" }', D, 16, "601 knots are too many", "400"),
    (16, 'EXX = { std = "1 um", spacing = "50 deg" }', U, 16, '"50 deg" is an angle', "a length"),
    (16, 'EXX = { std = "1 um", spacing = "0 mm" }', D, 16, '"0 mm" is zero', "mm"),
    (16, 'EXX = { std = "1 um", length = "0 mm" }', D, 16, '"0 mm" is zero', "mm"),
    (16, 'EXX = { std = "1 um", length = "-5 mm" }', D, 16, '"-5 mm" is negative', "mm"),
    (16, 'EXX = { std = "1 um", length = "1 mm" }', D, 16, "1201 knots are too many", "400"),
    (16, 'EXX = { std = "1 um", rest = "0 um" }', D, 16, '"0 um" is zero', "um"),
    (16, 'EXX = { std = "1 um", rest = "guess" }', U, 16, '"guess"', "estimate"),
    (16, "EXV = { std = '1 um' }", D, 16, 'no axis "V"', "The axes are X, Y, C"),
    (16, "EVX = { std = '1 um' }", D, 16, '"EVX"', "named like EXX"),
    (16, "exx = { std = '1 um' }", D, 16, '"exx"', "Perhaps EXX is meant"),
    (16, "[errors.EXX]\nstd = 3", U, 17, "errors.EXX.std: 3", "in quotes"),
    (17, 'EZY = { band = "-20 um" }', D, 17, '"-20 um" is negative', "um"),
    (17, 'EXX = { std = "20 um" }', D, 17, "overwrite", "given once"),
    (18, 'C0Y = { std = "30 um" }', U, 18, '"30 um" is a length, not an angle', "arcsec"),
    (18, 'C0Y = { std = "30 urad", knots = 5 }', D, 18, "knots = 5", "only std or band"),
    (18, 'C0Y = { std = "30 urad", rest = "1 urad" }', D, 18, 'rest = "1 urad"', "only std or band"),
    (
        18,
        'C0Y = { std = "1 urad" }\nEC0Y = { std = "1 urad" }',
        D,
        19,
        "EC0Y is C0Y, which is there already in line 18",
        "",
    ),
    (18, 'C(0X)Y = { std = "1 urad" }', D, 18, "C(0X)Y", "stand in quotes"),
    (18, '"C(0V)Y" = { std = "1 urad" }', D, 18, 'no axis "V"', "The axes are"),
    (18, '"C(0Y)Y" = { std = "1 urad" }', D, 18, "own reference", "another axis"),
    (18, 'B0Y = { std = "1 urad" }', D, 18, "B0Y", "A0Y and C0Y; a constant roll is part of EBY"),
    (18, 'X0Y = { std = "1 um" }', D, 18, "X0Y", "A0Y and C0Y"),
    (18, 'C0Z = { std = "1 urad" }', D, 18, 'no axis "Z"', "The axes are"),
    (18, 'C0Y_reversal = { std = "1 urad" }', D, 18, '"C0Y_reversal"', "constant"),
    (19, 'EXX_reversal = { std = "3 urad" }', U, 19, '"3 urad"', "a length"),
    (19, 'EXX_reversal = { std = "3 um", length = "100 mm" }', D, 19, 'length = "100 mm"', "give knots as well"),
    (19, 'EXX_revesal = { std = "3 um" }', D, 19, '"EXX_revesal"', "EXX_reversal"),
    (20, 'ECC = { std = "5 arcsec", knots = 3 }', D, 20, "3 knots over a full turn", "400"),
    (20, 'ECC = { std = "5 arcsec", length = "60 mm" }', U, 20, '"60 mm" is a length', "an angle"),
    (20, 'ECC = { std = "5 arcsek" }', U, 20, '"5 arcsek"', 'Perhaps "arcsec"'),
    (20, "ECC = {", D, 20, "ECC = {", ""),
]


@pytest.mark.parametrize(("line", "text", "kind", "reported", "offender", "remedy"), CASES)
def test_a_malformed_machine_is_refused_where_it_is_wrong(
    line: int, text: str, kind: type[InputError], reported: int | None, offender: str, remedy: str
) -> None:
    lines = [*LINES[: line - 1], text, *LINES[line:]]
    with pytest.raises(InputError) as failure:
        machine_from_text("\n".join(lines), "mill.toml")
    assert type(failure.value) is kind, str(failure.value)
    assert failure.value.line == reported, str(failure.value)
    assert str(failure.value.file) == "mill.toml"
    assert offender in failure.value.what
    assert remedy in failure.value.remedy
    first, *others = str(failure.value).splitlines()
    assert len(first) < 400
    assert all(line.isprintable() for line in (first, *others))


def test_the_file_that_the_cases_spoil_is_right() -> None:
    assert len(machine_from_text("\n".join(LINES)).errors) == 5
    assert len(CASES) >= 100


@pytest.mark.parametrize("text", ["", "# nothing\n", "\n\n", "name = 'x'", "[axes]", "[errors]\n[axes]\nchain = 1"])
def test_an_empty_machine_is_refused(text: str) -> None:
    with pytest.raises(DescriptionError):
        machine_from_text(text)


def test_a_machine_without_any_error_is_refused() -> None:
    with pytest.raises(DescriptionError, match="no error is named") as failure:
        machine_from_text("\n".join(LINES[:15]))
    assert failure.value.line == 15
