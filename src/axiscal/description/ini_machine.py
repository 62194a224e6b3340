"""What an INI file of LinuxCNC says of a machine: its axes, their limits and speeds, how it is built."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from axiscal.description.ini_file import IniFile, IniValue, number_or_none
from axiscal.description.ini_kinematics import IniBuild, build_of
from axiscal.description.ini_limits import TURN, axis_sections, limits, says_limits
from axiscal.exceptions import DescriptionError

_LINEAR = {"mm": "mm", "metric": "mm", "inch": "in", "in": "in", "imperial": "in"}
_ANGULAR = {"deg": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "radian": "rad"}
_INCH = 1 / 25.4
"""Of LinuxCNC: a number as unit says how many of it a millimetre has."""
_MOST = 6
"""Axes that a chain here may have."""


@dataclass(frozen=True, slots=True)
class IniAxis:
    """One axis, in its unit (`mm`, `in`, `deg`, `rad`) and seconds.

    joints : their numbers; low, high : its limits; speed, acceleration : None where nobody said
    home : where it stands after homing
    """

    letter: str
    unit: str
    joints: tuple[int, ...]
    low: float
    high: float
    speed: float | None
    acceleration: float | None
    home: float | None

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

    compensated : joints with a table or backlash that LinuxCNC applies; servo_period : s, None where nobody said
    """

    name: str
    axes: tuple[IniAxis, ...]
    build: IniBuild
    compensated: tuple[int, ...]
    servo_period: float | None


def lacking_limits(ini: IniFile) -> dict[str, str]:
    """Return the unit of each linear axis of which an INI file leaves open from where to where it moves."""
    unit, letters = _unit(ini, "LINEAR_UNITS", _LINEAR, "mm"), _letters(ini)
    linear = [letter for letter in dict.fromkeys(letters) if letter not in "ABC"]
    return {letter: unit for letter in linear if not says_limits(ini, letter, letters.index(letter))}


def machine_of(ini: IniFile, given: Mapping[str, tuple[float, float]] | None = None) -> IniMachine:
    """Return what an INI file says of a machine.

    given : the limits of the axes that it leaves open, in its unit
    Raises DescriptionError with the line of what cannot be.
    """
    letters, given = _letters(ini), given or {}
    if given:
        _refuse_unasked(ini, given)
    linear, angular = _unit(ini, "LINEAR_UNITS", _LINEAR, "mm"), _unit(ini, "ANGULAR_UNITS", _ANGULAR, "degree")
    joints = {letter: tuple(n for n, each in enumerate(letters) if each == letter) for letter in dict.fromkeys(letters)}
    build = build_of(ini, tuple(joints), tuple(name for name in joints if len(joints[name]) > 1), linear)
    built = [name for name in joints if name in re.findall(r"[A-Z]", build.chain)]
    axes = tuple(_axis(ini, name, joints[name], angular if name in "ABC" else linear, given) for name in built)
    named, period = ini.get("EMC", "MACHINE"), ini.get("EMCMOT", "SERVO_PERIOD")
    return IniMachine(
        name=(named.text if named and named.text else ini.path.stem)[:80],
        axes=axes,
        build=build,
        compensated=tuple(n for n in range(len(letters)) if _compensated(ini, n)),
        servo_period=None if period is None else period.number("SERVO_PERIOD") * 1e-9,
    )


def _refuse_unasked(ini: IniFile, given: Mapping[str, tuple[float, float]]) -> None:
    lacking = lacking_limits(ini)
    for letter, (low, high) in given.items():
        if letter not in lacking:
            open_ = f"those of {', '.join(lacking)} are open" if lacking else "it says those of every axis"
            raise DescriptionError(f"The INI file does not leave the limits of {letter} open", open_, ini.path)
        if not low < high:
            raise DescriptionError(f"{letter} cannot move from {low:g} to {high:g}", "The lower limit comes first")


def _letters(ini: IniFile) -> str:
    """Return the axis of each joint: of KINEMATICS where it says coordinates=, else of COORDINATES."""
    stated = ini.needed("TRAJ", "COORDINATES", "XYZ")
    kinematics = ini.get("KINS", "KINEMATICS")
    given = re.search(r"coordinates=(\w+)", kinematics.text) if kinematics is not None else None
    letters = "".join((given[1] if given else stated.text).split()).upper()
    named = kinematics if given is not None and kinematics is not None else stated
    if not letters or set(letters) - set("XYZABCUVW"):
        raise named.fail(f"{named.text!r} names no axes", "Write their letters, of X Y Z A B C U V W")
    if len(set(letters)) > _MOST:
        raise named.fail(f"{letters} are more than {_MOST} axes", "Describe those that are to be calibrated by hand")
    return letters


def _unit(ini: IniFile, key: str, known: Mapping[str, str], usual: str) -> str:
    found = ini.get("TRAJ", key)
    text = (found.text if found else usual).lower()
    if text in known:
        return known[text]
    value = number_or_none(text)
    if key == "ANGULAR_UNITS" and value == 1.0:
        return "deg"
    if key == "LINEAR_UNITS" and value is not None and math.isclose(value, _INCH, rel_tol=1e-3):
        return "in"
    if key == "LINEAR_UNITS" and value == 1.0:
        return "mm"
    assert found is not None
    raise found.fail(f"{key} = {found.text} is no unit known here", f"Known are {', '.join(known)}")


def _axis(
    ini: IniFile, letter: str, joints: tuple[int, ...], unit: str, given: Mapping[str, tuple[float, float]]
) -> IniAxis:
    places = axis_sections(letter, joints[0])
    least, most = given[letter] if letter in given else limits(ini, letter, joints[0], unit)
    kind = "ANGULAR" if letter in "ABC" else "LINEAR"
    fallback = {key: ini.get("TRAJ", f"MAX_{kind}_{key}") for key in ("VELOCITY", "ACCELERATION")}
    speed, hardest = (ini.first(places, f"MAX_{key}") or fallback[key] for key in ("VELOCITY", "ACCELERATION"))
    home = ini.first(places[1:], "HOME")
    return IniAxis(
        letter=letter,
        unit=unit,
        joints=joints,
        low=least,
        high=most,
        speed=_positive(speed, "MAX_VELOCITY"),
        acceleration=_positive(hardest, "MAX_ACCELERATION"),
        home=None if home is None else home.number("HOME"),
    )


def _positive(found: IniValue | None, key: str) -> float | None:
    if found is None:
        return None
    value = found.number(key)
    if value <= 0:
        raise found.fail(f"{key} = {found.text} is not above zero", "Write the fastest that the axis goes")
    return value


def _compensated(ini: IniFile, joint: int) -> bool:
    for section in (f"JOINT_{joint}", f"AXIS_{joint}"):
        table, backlash = ini.get(section, "COMP_FILE"), ini.get(section, "BACKLASH")
        if (table and table.text) or (backlash and backlash.number("BACKLASH") != 0):
            return True
    return False
