"""ISO 230-1 and ISO 230-7 names of geometric errors, said in the words of a workshop."""

from __future__ import annotations

import re

from axiscal.language.spoken import said

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
    if direction in _ABOUT:
        turn = "turn about {way} that {first} and {second} make together"
        return said(turn, way=_ABOUT[direction].lower(), first=first, second=second)
    shift = "displacement in {way} that {first} and {second} make together"
    return said(shift, way=direction.lower(), first=first, second=second)


def _reversal(component: str) -> str:
    match = _COMPONENT.fullmatch(component)
    assert match is not None  # looked at before
    if match[1] == match[2].translate(_PRIMARY):
        return said("reversal of {axis}", axis=match[2] + match[3])
    return said("reversal in the {motion}", motion=words(component))


def _component(direction: str, letter: str, axis: str) -> str:
    if letter in _ABOUT:
        return _rotary_motion(direction, letter, axis)
    primary = letter.translate(_PRIMARY)
    if direction == primary:
        return said("positioning of {axis}", axis=axis)
    if direction not in _ABOUT:
        return said("straightness of {axis} in {way}", axis=axis, way=direction.lower())
    if _ABOUT[direction] == primary:
        return said("roll of {axis}", axis=axis)
    return said("pitch of {axis}", axis=axis) if direction == _PITCH[primary] else said("yaw of {axis}", axis=axis)


def _rotary_motion(direction: str, letter: str, axis: str) -> str:
    if direction == letter:
        return said("positioning of {axis}", axis=axis)
    if direction in _ABOUT:
        return said("tilt of {axis} about {way}", axis=axis, way=_ABOUT[direction].lower())
    if direction == _ABOUT[letter]:
        return said("axial error of {axis}", axis=axis)
    return said("radial error of {axis} in {way}", axis=axis, way=direction.lower())


def _location(direction: str, letter: str, axis: str) -> str:
    if letter in _ABOUT:
        return _rotary_location(direction, letter, axis)
    primary = letter.translate(_PRIMARY)
    if direction not in _ABOUT:
        return said("zero of {axis}", axis=axis) if direction == primary else _offset(axis, direction)
    if _ABOUT[direction] == primary:
        return said("constant roll of {axis}", axis=axis)
    (reference,) = {"X", "Y", "Z"} - {primary, _ABOUT[direction]}
    return said("squareness of {axis} to {reference}", axis=axis, reference=reference)


def _offset(axis: str, direction: str) -> str:
    return said("offset of {axis} in {way}", axis=axis, way=direction.lower())


def _rotary_location(direction: str, letter: str, axis: str) -> str:
    if direction == letter:
        return said("zero of {axis}", axis=axis)
    if direction in _ABOUT:
        return said("tilt of the {axis} line about {way}", axis=axis, way=_ABOUT[direction].lower())
    if direction == _ABOUT[letter]:
        return said("offset of {axis} along its line", axis=axis)
    return said("offset of the {axis} line in {way}", axis=axis, way=direction.lower())
