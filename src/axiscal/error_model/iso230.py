"""ISO 230-1 and ISO 230-7 names of geometric errors, said in the words of a workshop."""

from __future__ import annotations

import re

_REVERSAL = "_reversal"
_COMPONENT = re.compile(r"E([XYZABC])([XYZUVWPQRABC])([1-9]?)")
_LOCATION = re.compile(r"([XYZABC])0([XYZUVWPQRABC])([1-9]?)")
_PLANE = re.compile(r"E([XYZABC])([XYZUVWPQRABC][1-9]?)([XYZUVWPQRABC][1-9]?)")
_PRIMARY = str.maketrans("UVWPQR", "XYZXYZ")  # U V W and P Q R travel along X Y Z
_ABOUT = {"A": "X", "B": "Y", "C": "Z"}
_PITCH = {"X": "B", "Y": "A", "Z": "A"}


def words(name: str) -> str:
    """Return a canonical error name in plain words; a name of no known form is returned as it is.

    name : `EXX`, `C0Y`, `EXX_reversal`; axis names may carry a digit (`EXX2`)

    Source: ISO 230-1 3.4, ISO 230-7 3.2 (component errors), ISO 230-1 3.5 (location errors).
    """
    if name.endswith(_REVERSAL):
        inner = name.removesuffix(_REVERSAL)
        return _reversal(inner) if _COMPONENT.fullmatch(inner) else name
    if match := _COMPONENT.fullmatch(name):
        return _component(match[1], match[2], match[2] + match[3])
    if match := _LOCATION.fullmatch(name):
        return _location(match[1], match[2], match[2] + match[3])
    if match := _PLANE.fullmatch(name):
        return _together(match[1], match[2], match[3])
    return name


def _together(direction: str, first: str, second: str) -> str:
    turn = f"turn about {_ABOUT[direction].lower()}" if direction in _ABOUT else f"displacement in {direction.lower()}"
    return f"{turn} that {first} and {second} make together"


def _reversal(component: str) -> str:
    inner = words(component)
    return (
        inner.replace("positioning of", "reversal of")
        if inner.startswith("positioning")
        else f"reversal in the {inner}"
    )


def _component(direction: str, letter: str, axis: str) -> str:
    if letter in _ABOUT:
        return _rotary_motion(direction, letter, axis)
    primary = letter.translate(_PRIMARY)
    if direction == primary:
        return f"positioning of {axis}"
    if direction not in _ABOUT:
        return f"straightness of {axis} in {direction.lower()}"
    if _ABOUT[direction] == primary:
        return f"roll of {axis}"
    return f"pitch of {axis}" if direction == _PITCH[primary] else f"yaw of {axis}"


def _rotary_motion(direction: str, letter: str, axis: str) -> str:
    if direction == letter:
        return f"positioning of {axis}"
    if direction in _ABOUT:
        return f"tilt of {axis} about {_ABOUT[direction].lower()}"
    return f"axial error of {axis}" if direction == _ABOUT[letter] else f"radial error of {axis} in {direction.lower()}"


def _location(direction: str, letter: str, axis: str) -> str:
    if letter in _ABOUT:
        return _rotary_location(direction, letter, axis)
    primary = letter.translate(_PRIMARY)
    if direction not in _ABOUT:
        return f"zero of {axis}" if direction == primary else f"offset of {axis} in {direction.lower()}"
    if _ABOUT[direction] == primary:
        return f"constant roll of {axis}"
    (reference,) = {"X", "Y", "Z"} - {primary, _ABOUT[direction]}
    return f"squareness of {axis} to {reference}"


def _rotary_location(direction: str, letter: str, axis: str) -> str:
    if direction == letter:
        return f"zero of {axis}"
    if direction in _ABOUT:
        return f"tilt of the {axis} line about {_ABOUT[direction].lower()}"
    along = direction == _ABOUT[letter]
    return f"offset of {axis} along its line" if along else f"offset of the {axis} line in {direction.lower()}"
