"""What an INI file of LinuxCNC says of a machine: its axes, their limits and speeds, how it is built."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from axiscal.description.ini_file import IniFile, IniValue
from axiscal.description.ini_kinematics import IniBuild, build_of
from axiscal.exceptions import DescriptionError

_LINEAR = {"mm": "mm", "metric": "mm", "inch": "in", "in": "in", "imperial": "in"}
_ANGULAR = {"deg": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "radian": "rad"}
_INCH = 1 / 25.4
"""Of LinuxCNC: a number as unit says how many of it a millimetre has."""
_TURN = {"deg": 360.0, "rad": math.tau}
"""Geometry."""
_ENDLESS = 1e9
"""LinuxCNC's limits where nobody set any are larger; no machine's are."""
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
        return self.rotary and self.high - self.low >= _TURN[self.unit]


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


def machine_of(ini: IniFile) -> IniMachine:
    """Return what an INI file says of a machine; raises DescriptionError with the line of what cannot be."""
    letters = _letters(ini)
    linear, angular = _unit(ini, "LINEAR_UNITS", _LINEAR, "mm"), _unit(ini, "ANGULAR_UNITS", _ANGULAR, "degree")
    joints = {letter: tuple(n for n, each in enumerate(letters) if each == letter) for letter in dict.fromkeys(letters)}
    build = build_of(ini, tuple(joints), tuple(name for name in joints if len(joints[name]) > 1), linear)
    built = [name for name in joints if name in re.findall(r"[A-Z]", build.chain)]
    axes = tuple(_axis(ini, name, joints[name], angular if name in "ABC" else linear) for name in built)
    named, period = ini.get("EMC", "MACHINE"), ini.get("EMCMOT", "SERVO_PERIOD")
    return IniMachine(
        name=(named.text if named and named.text else ini.path.stem)[:80],
        axes=axes,
        build=build,
        compensated=tuple(n for n in range(len(letters)) if _compensated(ini, n)),
        servo_period=None if period is None else _number(period, "SERVO_PERIOD") * 1e-9,
    )


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
    value = None if found is None else _number_or_none(text)
    if key == "ANGULAR_UNITS" and value == 1.0:
        return "deg"
    if key == "LINEAR_UNITS" and value is not None and math.isclose(value, _INCH, rel_tol=1e-3):
        return "in"
    if key == "LINEAR_UNITS" and value == 1.0:
        return "mm"
    assert found is not None
    raise found.fail(f"{key} = {found.text} is no unit known here", f"Known are {', '.join(known)}")


def _axis(ini: IniFile, letter: str, joints: tuple[int, ...], unit: str) -> IniAxis:
    places = (f"AXIS_{letter}", f"JOINT_{joints[0]}", f"AXIS_{joints[0]}")  # the last as LinuxCNC 2.7 and before
    low, high = (_first(ini, places, key) for key in ("MIN_LIMIT", "MAX_LIMIT"))
    for key, found in (("MIN_LIMIT", low), ("MAX_LIMIT", high)):
        if found is None or abs(_number(found, key)) > _ENDLESS:
            if letter in "ABC":
                continue
            what = f"The INI file says no {key} of {letter}"
            remedy = f"Write it under [AXIS_{letter}], as in {key} = {'0' if key == 'MIN_LIMIT' else '500'}"
            raise found.fail(what, remedy) if found else DescriptionError(what, remedy, *ini.place(*places))
    least, most = _bound(low, "MIN_LIMIT", -_TURN.get(unit, 0.0)), _bound(high, "MAX_LIMIT", _TURN.get(unit, 0.0))
    if high is not None and least >= most:
        raise high.fail(f"MAX_LIMIT of {letter} is {most:g}, and MIN_LIMIT is {least:g}", "The larger one is MAX_LIMIT")
    kind = "ANGULAR" if letter in "ABC" else "LINEAR"
    fallback = {key: ini.get("TRAJ", f"MAX_{kind}_{key}") for key in ("VELOCITY", "ACCELERATION")}
    speed, hardest = (_first(ini, places, f"MAX_{key}") or fallback[key] for key in ("VELOCITY", "ACCELERATION"))
    home = _first(ini, (f"JOINT_{joints[0]}", f"AXIS_{joints[0]}"), "HOME")
    return IniAxis(
        letter=letter,
        unit=unit,
        joints=joints,
        low=least,
        high=most,
        speed=_positive(speed, "MAX_VELOCITY"),
        acceleration=_positive(hardest, "MAX_ACCELERATION"),
        home=None if home is None else _number(home, "HOME"),
    )


def _first(ini: IniFile, sections: tuple[str, ...], key: str) -> IniValue | None:
    return next((found for section in sections if (found := ini.get(section, key)) is not None), None)


def _bound(found: IniValue | None, key: str, endless: float) -> float:
    value = endless if found is None else _number(found, key)
    return value if abs(value) <= _ENDLESS else endless


def _positive(found: IniValue | None, key: str) -> float | None:
    if found is None:
        return None
    value = _number(found, key)
    if value <= 0:
        raise found.fail(f"{key} = {found.text} is not above zero", "Write the fastest that the axis goes")
    return value


def _compensated(ini: IniFile, joint: int) -> bool:
    for section in (f"JOINT_{joint}", f"AXIS_{joint}"):
        table, backlash = ini.get(section, "COMP_FILE"), ini.get(section, "BACKLASH")
        if (table and table.text) or (backlash and _number(backlash, "BACKLASH") != 0):
            return True
    return False


def _number(found: IniValue, key: str) -> float:
    value = _number_or_none(found.text)
    if value is None:
        raise found.fail(f"{key} = {found.text} is not a number", "Write digits with a decimal point")
    return value


def _number_or_none(text: str) -> float | None:
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None
