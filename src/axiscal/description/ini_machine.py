"""What an INI file of LinuxCNC says of a machine: its axes, their limits and speeds, how it is built."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axiscal.description.ini_file import IniFile, IniValue
from axiscal.document.file import number_or_none
from axiscal.exceptions import AxiscalError, DescriptionError
from axiscal.language.spoken import put
from axiscal.measurement.readers.text_file import read_text

Point = tuple[float, float, float]
BELTS = "corexykins"
"""The module whose joints 0 and 1 are X + Y and X - Y."""
_TRT = re.compile(r"xyz([ab])c-trt-kins")
_SETP = re.compile(r"(?:setp\s+)?([\w.:-]+?)\.([\w-]+)\s+=?\s*(\S+)")
_NET = re.compile(r"(?:net|newsig|linksp)\s+(\S+)\s+(.*)")
_SETS = re.compile(r"sets\s+(\S+)\s+(\S+)")
_ELSEWHERE = re.compile(r"\[(\w+)\](\w+)")
_UNITS = {
    "LINEAR_UNITS": {"mm": "mm", "metric": "mm", "inch": "in", "in": "in", "imperial": "in"},
    "ANGULAR_UNITS": {"deg": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "radian": "rad"},
}
"""By key, units by their words; the first is the usual one."""
_INCH = 1 / 25.4
"""Of LinuxCNC: a number as unit says how many of it a millimetre has."""
_MOST = 6
"""Axes that a chain here may have."""
_EVERY = "XYZABCUVW"
_NUMBERED = {"xyzac-trt-kins": "XYZAC", "xyzbc-trt-kins": "XYZBC"}
"""The axes of joint 0, 1, 2 ... where nobody says them, of these kinematics and of all others (LinuxCNC, kins(9))."""


@dataclass(frozen=True, slots=True)
class IniAxis:
    """One axis, in its unit (`mm`, `in`, `deg`, `rad`) and seconds.

    joints : their numbers; low, high : its limits; speed, acceleration : None where nobody said
    home : where it stands after homing; diameters : a lathe's display shows diameters of it
    """

    letter: str
    unit: str
    joints: tuple[int, ...]
    low: float
    high: float
    speed: float | None
    acceleration: float | None
    home: float | None
    diameters: bool = False

    @property
    def rotary(self) -> bool:
        """Whether it turns."""
        return self.letter in "ABC"

    @property
    def endless(self) -> bool:
        """Whether its limits leave it a whole turn or more."""
        return self.rotary and self.high - self.low >= TURN[self.unit]


@dataclass(frozen=True, slots=True)
class IniMachine:
    """A machine as its INI file has it.

    chain : ISO 10791-6; sure : whether the kinematics say so, and not only what such machines usually are
    kinematics : name of the module; unit : mm or in; servo_period : s, None where nobody said
    compensated : joints with a table or backlash that LinuxCNC applies
    reversed : axes that count against ISO 841; origins : of rotary axes, in the machine's unit
    said : a person has said the chain, who says nothing of where axes turn by that
    """

    name: str
    axes: tuple[IniAxis, ...]
    chain: str
    sure: bool
    kinematics: str
    unit: str
    compensated: tuple[int, ...]
    servo_period: float | None
    reversed: tuple[str, ...] = ()
    origins: Mapping[str, Point] = field(default_factory=dict)
    said: bool = False


def lacking_limits(ini: IniFile) -> dict[str, str]:
    """Return the unit of each linear axis of which an INI file leaves open from where to where it moves."""
    linear = {name: joints[0] for name, joints in _joints(ini).items() if name not in "ABC"}
    unit = unit_in(ini, "LINEAR_UNITS")
    return {name: unit for name, joint in linear.items() if None in _limits(ini, name, joint).values()}


def machine_of(ini: IniFile, given: Mapping[str, tuple[float, float]] | None = None) -> IniMachine:
    """Return what an INI file says of a machine.

    given : the limits of the axes that it leaves open, in its unit
    Raises DescriptionError with the line of what cannot be.
    """
    joints, given, lacking = _joints(ini), given or {}, lacking_limits(ini)
    for letter in (each for each in given if each not in lacking):
        what, remedy = "The INI file does not leave the limits of {letter} open", "Those that it leaves: {lacking}"
        raise DescriptionError(what, remedy, ini.path, letter=letter, lacking=", ".join(lacking) or "-")
    linear, angular = (unit_in(ini, key) for key in _UNITS)
    named, period, stated = ini.get("EMC", "MACHINE"), ini.get("EMCMOT", "SERVO_PERIOD"), ini.get("KINS", "KINEMATICS")
    kinematics = stated.text.split()[0] if stated is not None and stated.text else "trivkins"
    chain, sure, against, origins = _built(ini, kinematics, joints)
    built = [name for name in joints if name in re.findall(r"[A-Z]", chain)]
    return IniMachine(
        name=(named.text if named and named.text else ini.path.stem)[:80],
        axes=tuple(_axis(ini, name, joints[name], angular if name in "ABC" else linear, given) for name in built),
        chain=chain,
        sure=sure,
        kinematics=kinematics,
        unit=linear,
        compensated=tuple(n for n in sorted(sum(joints.values(), ())) if _compensated(ini, n)),
        servo_period=None if period is None else period.number("SERVO_PERIOD") * 1e-9,
        reversed=against,
        origins=origins,
    )


def _joints(ini: IniFile) -> dict[str, tuple[int, ...]]:
    """Return the joints of each axis of COORDINATES; KINEMATICS may number more, as the Y of a lathe, which stands."""
    stated = ini.needed("TRAJ", "COORDINATES", "XYZ")
    kinematics = ini.get("KINS", "KINEMATICS") or stated
    given, moving = re.search(r"coordinates=(\w+)", kinematics.text), "".join(stated.text.split()).upper()
    named, letters = (kinematics, given[1].upper()) if given else (stated, moving)
    if not given and not set(moving) - set(_EVERY) and len(set(moving)) == len(moving):  # no joints of one axis
        letters = _NUMBERED.get(kinematics.text.partition(" ")[0], _EVERY)
    axes = [letter for letter in dict.fromkeys(letters) if letter in moving]
    if not axes or set(letters) - set(_EVERY):
        raise named.fail("{text!r} names no axes", "Write their letters, of X Y Z A B C U V W", text=named.text)
    if len(axes) > _MOST:
        remedy = "Describe those that are to be calibrated by hand"
        raise named.fail("{letters} are more than {most} axes", remedy, letters="".join(axes), most=_MOST)
    found = {axis: tuple(n for n, each in enumerate(letters) if each == axis) for axis in axes}
    count = ini.get("KINS", "JOINTS")
    for axis, numbers in found.items():
        if count is not None and max(numbers) >= count.number("JOINTS"):
            what = "JOINTS is {count}, and joint {joint} moves {axis}"
            remedy = "Write as many as the kinematics have, as LinuxCNC needs them to start"
            raise count.fail(what, remedy, count=count.text, joint=max(numbers), axis=axis)
    return found


def unit_in(ini: IniFile, key: str) -> str:
    """Return the unit in which an INI file counts, LINEAR_UNITS or ANGULAR_UNITS; raises DescriptionError."""
    known, found = _UNITS[key], ini.get("TRAJ", key)
    text = found.text.lower() if found else next(iter(known))
    if text in known:
        return known[text]
    value = number_or_none(text)
    if value == 1.0:
        return next(iter(known.values()))
    if key == "LINEAR_UNITS" and value is not None and math.isclose(value, _INCH, rel_tol=1e-3):
        return "in"
    assert found is not None
    remedy = "Known are {known}"
    raise found.fail("{key} = {text} is no unit known here", remedy, key=key, text=found.text, known=", ".join(known))


def _axis(
    ini: IniFile, letter: str, joints: tuple[int, ...], unit: str, given: Mapping[str, tuple[float, float]]
) -> IniAxis:
    """Return an axis; a rotary one without limits has a turn to either side.  given : as of `machine_of`"""
    places, ends = _sections(ini, letter, joints[0]), _limits(ini, letter, joints[0])
    for key, found in ends.items():
        if found is None and letter not in "ABC" and letter not in given:
            what = "The INI file says no {key} of {letter}"
            remedy = 'Write it under [AXIS_{letter}], as in {key} = {example}, or add --limits "{letter} 0 500"'
            place, example = ini.place(*places), "0" if key == "MIN_LIMIT" else "500"
            raise DescriptionError(what, remedy, *place, key=key, letter=letter, example=example)
    turns = zip(ends.items(), (-TURN.get(unit, 0.0), TURN.get(unit, 0.0)), strict=True)
    stated = [turn if found is None else found.number(key) for (key, found), turn in turns]
    least, most = given.get(letter, stated)
    if not least < most:
        what, place = "{letter} cannot move from {low:g} to {high:g}", ini.place(*places)
        raise DescriptionError(what, "The lower limit comes first", *place, letter=letter, low=least, high=most)
    kind = "ANGULAR" if letter in "ABC" else "LINEAR"
    fallback = {key: ini.get("TRAJ", f"MAX_{kind}_{key}") for key in ("VELOCITY", "ACCELERATION")}
    speed, hardest = (ini.first(places, f"MAX_{key}") or fallback[key] for key in ("VELOCITY", "ACCELERATION"))
    home, lathe = ini.first(places[1:], "HOME"), ini.get("DISPLAY", "LATHE")
    return IniAxis(
        letter=letter,
        unit=unit,
        joints=joints,
        low=least,
        high=most,
        speed=_positive(speed, "MAX_VELOCITY"),
        acceleration=_positive(hardest, "MAX_ACCELERATION"),
        home=None if home is None else home.number("HOME"),
        diameters=letter == "X" and lathe is not None and lathe.text not in ("", "0"),
    )


def _positive(found: IniValue | None, key: str) -> float | None:
    if found is not None and found.number(key) <= 0:
        remedy = "Write the fastest that the axis goes"
        raise found.fail("{key} = {text} is not above zero", remedy, key=key, text=found.text)
    return None if found is None else found.number(key)


def _compensated(ini: IniFile, joint: int) -> bool:
    pairs = ((ini.get(each, "COMP_FILE"), ini.get(each, "BACKLASH")) for each in (f"JOINT_{joint}", f"AXIS_{joint}"))
    return any((table and table.text) or (step and step.number("BACKLASH") != 0) for table, step in pairs)


TURN = {"deg": 360.0, "rad": math.tau}
"""Geometry."""
_ENDLESS = 1e9
"""LinuxCNC's limits where nobody set any are larger; no machine's are."""


def _sections(ini: IniFile, letter: str, joint: int) -> tuple[str, ...]:
    """Return the sections of an axis: its own, and its first joint's, as now and in LinuxCNC 2.7; none of a belt."""
    stated = ini.get("KINS", "KINEMATICS")
    if stated is not None and stated.text.startswith(BELTS) and letter in "XY":
        return (f"AXIS_{letter}",)
    return f"AXIS_{letter}", f"JOINT_{joint}", f"AXIS_{joint}"


def _limits(ini: IniFile, letter: str, joint: int) -> dict[str, IniValue | None]:
    """Return the limits of an axis by their keys, None where one is left open."""
    stated = {key: ini.first(_sections(ini, letter, joint), key) for key in ("MIN_LIMIT", "MAX_LIMIT")}
    return {key: each if each and abs(each.number(key)) <= _ENDLESS else None for key, each in stated.items()}


Built = tuple[str, bool, tuple[str, ...], Mapping[str, Point]]
"""Chain, whether it is sure, axes that are reversed, and origins, as of `IniMachine`."""


def _built(ini: IniFile, name: str, joints: Mapping[str, tuple[int, ...]]) -> Built:
    """Return how a machine is built; raises DescriptionError for kinematics that are no chain of axes.

    name : of its kinematics; joints : by the letters of its axes
    """
    stated = ini.get("KINS", "KINEMATICS")
    linear, rotary = [each for each in joints if each not in "ABC"], [each for each in joints if each in "ABC"]
    place = (ini.path, None) if stated is None else (stated.file, stated.line)
    if set(linear) - {"Z"} == {"X", "Y", "U", "V"}:
        what = "{axes} are two towers that hold a wire or a bar between them, and no chain from workpiece to tool"
        remedy = "Describe one of them by hand, and calibrate each for itself"
        raise DescriptionError(what, remedy, *place, axes=" ".join(linear))
    if name in ("trivkins", "gantrykins"):
        doubled = [each for each in joints if len(joints[each]) > 1]
        return _plain(linear, rotary, doubled), False, (), dict.fromkeys(rotary, (0.0, 0.0, 0.0))
    if name == BELTS:
        return "w-Z'-b-Y-X-t" if "Z" in joints else "w-b-Y-X-t", False, (), {}
    if found := _TRT.fullmatch(name):
        return _swivelling(ini, name, found[1].upper(), joints)
    what = "{name} is no chain of axes that can be read here"
    remedy = "Read are trivkins, corexykins, xyzac-trt-kins, xyzbc-trt-kins; docs/robots.md and docs/scope.md say more"
    raise DescriptionError(what, remedy, *place, name=name)


def _plain(linear: Sequence[str], rotary: Sequence[str], doubled: Sequence[str]) -> str:
    """Return what machines of these axes usually are: a bridge where two joints move one axis, a lathe, a mill."""
    tables = "".join(f"-{letter}'" for letter in reversed(rotary))
    late = [letter for letter in linear if letter not in "XYZ"]
    if doubled or set(linear) == {"X", "Z"}:  # the bridge, or the saddle of a lathe, carries the others
        first = [letter for letter in doubled if letter in linear] or ["Z"]
        carried = first + [letter for letter in linear if letter not in (*first, *late)]
        return f"w{tables}-b-{'-'.join(carried + late)}-t"
    moved = "".join(f"-{letter}'" for letter in linear if letter in "XY")
    head = "".join(f"-{letter}" for letter in linear if letter == "Z" or letter in late)
    return f"w{tables}{moved}-b{head}-t"


def _swivelling(ini: IniFile, name: str, swivel: str, letters: Collection[str]) -> Built:
    stated = ini.needed("KINS", "KINEMATICS", name)
    if not {"X", "Y", "Z", "C", swivel} <= set(letters):
        remedy = "Name them in [TRAJ] COORDINATES"
        raise stated.fail("{name} has axes X, Y, Z, {swivel} and C", remedy, name=name, swivel=swivel)
    pins, clear = _pins(ini, name)
    x, y, z = (pins.get(f"{way}-rot-point", 0.0) for way in "xyz")
    z += pins.get("z-offset", 0.0)
    line = (x, y + pins.get("y-offset", 0.0), z) if swivel == "A" else (x + pins.get("x-offset", 0.0), y, z)
    against = () if pins.get("conventional-directions", 0.0) else (swivel, "C")
    return f"w-C'-{swivel}'-X'-Y'-b-Z-t", clear, against, {swivel: line, "C": (x, y, z)}


def _pins(ini: IniFile, module: str) -> tuple[Mapping[str, float], bool]:
    """Return the numbers that HAL sets at pins of a module, straight or by a signal: HALCMD lines and files at hand.

    With them whether every pin that says where axes turn, or which way, was understood.
    """
    signals, joined, found = dict[str, float | None](), dict[str, str](), dict[str, float | None]()
    for line in _hal(ini):
        if (given := _SETS.fullmatch(line)) is not None:
            signals[given[1]] = _value(ini, given[2])
        elif (net := _NET.match(line)) is not None:
            ends = [word.removeprefix(f"{module}.") for word in net[2].split() if word.startswith(f"{module}.")]
            joined |= dict.fromkeys(ends, net[1])
        elif (pin := _SETP.fullmatch(line)) is not None and pin[1] == module:
            found[pin[2]] = _value(ini, pin[3])
    said = {pin: signals.get(signal) for pin, signal in joined.items()} | found
    values = {pin: value for pin, value in said.items() if value is not None}
    return values, not any(_PLACES.fullmatch(pin) for pin in said.keys() - values.keys())


_PLACES = re.compile(r"[xyz]-rot-point|[xyz]-offset|conventional-directions")
"""Pins that say where axes turn, or which way."""


def _hal(ini: IniFile) -> list[str]:
    lines = [each.text for each in ini.all("HAL", "HALCMD")]
    for named in (*ini.all("HAL", "HALFILE"), *ini.all("HAL", "POSTGUI_HALFILE")):
        path = ini.path.parent / Path(named.text.split()[0]) if named.text else ini.path
        if path.suffix == ".hal" and path.is_file():  # those of the library, and programs, set no pivots
            try:
                lines += [line.partition("#")[0].strip() for line in read_text(path).lines]
            except AxiscalError as failure:
                raise named.fail(put("{fault}", fault=failure), "Check the name, or take the line out") from failure
    return lines


def _value(ini: IniFile, text: str) -> float | None:
    """Return what HAL makes of a word: a number, TRUE or FALSE, or what stands in the INI file; None for another."""
    if (named := _ELSEWHERE.fullmatch(text)) is not None:
        stands = ini.get(named[1], named[2])
        text = stands.text if stands is not None else ""
    if text.upper() in ("TRUE", "FALSE"):
        return float(text.upper() == "TRUE")
    return number_or_none(text)
