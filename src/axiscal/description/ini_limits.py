"""From where to where an axis of LinuxCNC moves, as its INI file says it."""

from __future__ import annotations

import math

from axiscal.description.ini_file import IniFile, IniValue
from axiscal.exceptions import DescriptionError

TURN = {"deg": 360.0, "rad": math.tau}
"""Geometry."""
_ENDLESS = 1e9
"""LinuxCNC's limits where nobody set any are larger; no machine's are."""


def axis_sections(letter: str, joint: int) -> tuple[str, str, str]:
    """Return the sections of an axis: its own, its first joint's, and that of LinuxCNC 2.7 and before."""
    return f"AXIS_{letter}", f"JOINT_{joint}", f"AXIS_{joint}"


def says_limits(ini: IniFile, letter: str, joint: int) -> bool:
    """Whether an INI file has both limits of an axis, and neither is the one that stands for none."""
    return not any(_left_open(found, key) for key, found in _stated(ini, letter, joint).items())


def limits(ini: IniFile, letter: str, joint: int, unit: str) -> tuple[float, float]:
    """Return the limits of an axis in its unit; a rotary axis without any has a turn to either side.

    Raises DescriptionError for a linear axis without, and where the lower one is not below the upper one.
    """
    stated = _stated(ini, letter, joint)
    for key, found in stated.items():
        if letter not in "ABC" and _left_open(found, key):
            what = f"The INI file says no {key} of {letter}"
            remedy = f"Write it under [AXIS_{letter}], as in {key} = {'0' if key == 'MIN_LIMIT' else '500'}"
            if found is not None:
                raise found.fail(what, remedy)
            raise DescriptionError(what, remedy, *ini.place(*axis_sections(letter, joint)))
    low, high = (
        sense * TURN.get(unit, 0.0) if found is None or _left_open(found, key) else found.number(key)
        for sense, (key, found) in zip((-1, 1), stated.items(), strict=True)
    )
    upper = stated["MAX_LIMIT"]
    if upper is not None and low >= high:
        raise upper.fail(f"MAX_LIMIT of {letter} is {high:g}, and MIN_LIMIT is {low:g}", "The larger one is MAX_LIMIT")
    return low, high


def _stated(ini: IniFile, letter: str, joint: int) -> dict[str, IniValue | None]:
    return {key: ini.first(axis_sections(letter, joint), key) for key in ("MIN_LIMIT", "MAX_LIMIT")}


def _left_open(found: IniValue | None, key: str) -> bool:
    return found is None or abs(found.number(key)) > _ENDLESS
