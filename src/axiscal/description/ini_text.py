"""A first machine.toml from an INI file of LinuxCNC: each line with where it comes from, and what could not be read."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from axiscal.description.ini_machine import IniAxis, IniMachine
from axiscal.machine.axis import letter_direction
from axiscal.units import from_unit, to_unit

_KNOT = 0.05
"""m between knots of a curve; a matter of taste, and the person is asked to change it."""
_MOST_KNOTS = 15
"""Of one curve; a matter of taste: more make a plan slow."""
_TURNS = 100
"""To either side: more are as good as endless."""
_ERRORS = """\

[errors]
# Prior knowledge, one standard deviation each: of a used workshop machine. Change what you know better.
# docs/machine.md of axiscal says what each name means; `axiscal machine check` what no reading could tell apart."""


def machine_text(machine: IniMachine, source: str) -> str:
    """Return the text of machine.toml.  source : the INI file, as it is named"""
    lines = [
        f"# The machine of {_plain(source)}, as LinuxCNC knows it.",
        f"# Kinematics {_plain(machine.build.kinematics)}; joints: {_joints(machine)}.{_period(machine)}",
        f"name = {_quoted(machine.name)}",
        *_chain(machine),
        "",
        "[tool]",
        "# CHECK: from the spindle nose to the tool point of the probe, which the INI cannot say.",
        'length = "100 mm"',
        *(line for axis in machine.axes for line in _axis(machine, axis)),
        *_ERRORS.splitlines(),
        *_errors(machine),
    ]
    return "\n".join(lines) + "\n"


def unread(machine: IniMachine) -> list[str]:
    """Return in sentences what the INI file could not say and was supposed, for the person to look at."""
    found = ["the length of the tool"]
    if not (machine.build.sure or machine.build.said):
        found.append(f"which axes carry the workpiece (chain = {machine.build.chain!r} is supposed)")
    if any(axis.rotary for axis in machine.axes) and not machine.build.sure:
        found.append("where the rotary axes lie (origin)")
    if any(axis.rotary and axis.letter not in machine.build.reversed for axis in machine.axes):
        found.append("which way the rotary axes count (direction)")
    return found


def _chain(machine: IniMachine) -> Iterator[str]:
    build = machine.build
    if not (build.sure or build.said):
        yield "# CHECK: the INI does not say which axes carry the workpiece (primed, before b) and which the tool."
    yield f'chain = "{build.chain}"'


def _joints(machine: IniMachine) -> str:
    return ", ".join(f"{axis.letter} {' and '.join(map(str, axis.joints))}" for axis in machine.axes)


def _period(machine: IniMachine) -> str:
    return "" if machine.servo_period is None else f" Servo period {machine.servo_period * 1e3:g} ms."


def _axis(machine: IniMachine, axis: IniAxis) -> Iterator[str]:
    yield ""
    home = "" if axis.home is None else f"   # homed at {axis.home:g} {axis.unit}"
    yield f"[axes.{axis.letter}]{home}"
    turn = to_unit(from_unit(360.0, "deg"), axis.unit) if axis.rotary else 0.0
    if axis.endless:
        yield f'travel = ["0 {axis.unit}", "{_number(turn)} {axis.unit}"]      # a whole turn'
        low, high = max(min(axis.low, 0.0), -_TURNS * turn), min(max(axis.high, turn), _TURNS * turn)
        yield f'limits = ["{_number(low)} {axis.unit}", "{_number(high)} {axis.unit}"]   # MIN_LIMIT, MAX_LIMIT'
    else:
        low_text, high_text = (f'"{_number(each)} {axis.unit}"' for each in (axis.low, axis.high))
        yield f"travel = [{low_text}, {high_text}]   # MIN_LIMIT, MAX_LIMIT"
    yield from _motion(axis)
    if axis.letter in machine.build.reversed:
        yield f'direction = "reversed"           # as {_plain(machine.build.kinematics)} turns it; else "iso"'
    if axis.rotary:
        at = machine.build.origins.get(axis.letter, (0.0, 0.0, 0.0))
        origin = ", ".join(f'"{_number(each)} {machine.build.unit}"' for each in at)
        said = (
            "from the pins of the kinematics" if machine.build.sure else "CHECK: a point on its line, all axes at zero"
        )
        yield f"origin = [{origin}]   # {said}"


def _motion(axis: IniAxis) -> Iterator[str]:
    if axis.speed is not None:
        per_minute = from_unit(axis.speed, axis.unit) * 60
        text = f"{_number(to_unit(per_minute, 'deg') / 360)} rpm" if axis.rotary else f"{_number(per_minute)} m/min"
        yield f'speed = "{text}"   # MAX_VELOCITY'
    if axis.acceleration is not None:
        value = from_unit(axis.acceleration, axis.unit)
        text = f"{_number(to_unit(value, 'deg'))} deg/s^2" if axis.rotary else f"{_number(value)} m/s^2"
        yield f'acceleration = "{text}"   # MAX_ACCELERATION'


def _errors(machine: IniMachine) -> Iterator[str]:
    for axis in machine.axes:
        yield ""
        yield f"# {axis.letter}"
        yield from _rotary(axis) if axis.rotary else _linear(axis)
    yield ""
    yield "# Location errors: squareness of the linear axes, and where rotary axes lie and lean"
    linear = [axis.letter for axis in machine.axes if axis.letter in "XYZ"]
    squareness = {("X", "Y"): "C0Y", ("X", "Z"): "B0Z", ("Y", "Z"): "A0Z"}
    for pair in itertools.combinations(sorted(linear), 2):
        yield f'{squareness[pair]} = {{ std = "30 urad" }}'
    for axis in machine.axes:
        if axis.rotary:
            across = [way for way in "XYZ" if "XYZ".index(way) != letter_direction(axis.letter)]
            yield from (f'{way}0{axis.letter} = {{ std = "15 um" }}' for way in across)
            yield from (f'{"ABC"["XYZ".index(way)]}0{axis.letter} = {{ std = "40 urad" }}' for way in across)


def _linear(axis: IniAxis) -> Iterator[str]:
    length = float(from_unit(axis.high - axis.low, axis.unit))
    knots = int(min(max(5, round(length / _KNOT) + 1), _MOST_KNOTS))
    reach = f"{_number(to_unit(max(length / 4, 0.01), 'mm'))} mm"
    own = "XYZ"[letter_direction(axis.letter)]
    for way in "XYZ":
        std = "10 um" if way == own else "5 um"
        yield f'E{way}{axis.letter} = {{ std = "{std}", knots = {knots}, length = "{reach}", rest = "0.3 um" }}'
    for way in "ABC":
        yield f'E{way}{axis.letter} = {{ std = "15 urad", knots = {max(5, knots // 2)}, length = "{reach}" }}'
    yield f'E{own}{axis.letter}_reversal = {{ std = "4 um" }}'


def _rotary(axis: IniAxis) -> Iterator[str]:
    for way in "XYZ":
        yield f'E{way}{axis.letter} = {{ std = "4 um", knots = 7, length = "60 deg" }}'
    for way in "ABC":
        rest = ', rest = "1 urad"' if way == axis.letter else ""
        std = "40 urad" if way == axis.letter else "15 urad"
        yield f'E{way}{axis.letter} = {{ std = "{std}", knots = 7, length = "60 deg"{rest} }}'
    yield f'E{axis.letter}{axis.letter}_reversal = {{ std = "20 urad" }}'


def _number(value: float) -> str:
    return f"{float(value) + 0.0:.9g}"


def _plain(text: str) -> str:
    """Return a text that ends no line of remarks."""
    return "".join(character if character.isprintable() else " " for character in text)


def _quoted(text: str) -> str:
    escaped = _plain(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
