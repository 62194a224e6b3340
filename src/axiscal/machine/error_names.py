"""Names of errors after ISO 230-1, EXX, C0Y, EXX_reversal, EZXY, also in the spellings that people use."""

from __future__ import annotations

import re
from typing import Literal

from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal_core.errors import COMPONENTS, Error

Shape = Literal["curve", "pitch", "step", "plane"]
"""Any curve, one that repeats with a period, one with steps at joints; what two axes do together."""
AXIS_NAME = r"[XYZUVWPQRABC][1-9]?"
"""Pattern of the name of an axis (ISO 841), such as X, U2 or C."""
_MOTION = re.compile(rf"E(?P<component>[XYZABC])(?P<axis>{AXIS_NAME})(?P<suffix>_reversal|_pitch|_step)?")
_LOCATION = re.compile(rf"E?(?P<component>[XYZABC])(?:[0O]|\([0O](?P<reference>{AXIS_NAME})\))(?P<axis>{AXIS_NAME})")
_PLANE = re.compile(rf"E(?P<component>[XYZABC])(?P<first>{AXIS_NAME})(?P<second>{AXIS_NAME})")
_REMEDY = (
    "Component errors are named like EXX or EAC, location errors like C0Y, reversal values like EXX_reversal, what "
    "repeats like EXX_pitch, what steps like EXX_step, errors of two axes together like EZXY"
)


def error_named(text: str) -> Error:
    """Return the error of a name, of no size; "EC0Y", "C(0X)Y", "EC(0X)Y" and "COY" are read as "C0Y".

    Raises DescriptionError for anything else, with the likely name where there is one.
    """
    if found := _PLANE.fullmatch(text):
        if found["first"] == found["second"]:
            remedy = "Name the two axes that act together, such as EZXY"
            raise DescriptionError("{axis} is named twice", remedy, axis=found["first"])
        return Error(text, 0.0, knots=(2, 2))
    if found := _LOCATION.fullmatch(text):
        return Error(f"{found['component']}0{found['axis']}", 0.0)
    if _MOTION.fullmatch(text):
        return Error(text, 0.0, period=1.0 if text.endswith("_pitch") else None)
    raise DescriptionError("{text} is not the name of an error", _REMEDY, text=shown(text))


def reference_in(text: str) -> str | None:
    """Return the axis X of "C(0X)Y", None where the name of an error says none."""
    found = _LOCATION.fullmatch(text)
    return found["reference"] if found else None


def shape_of(error: Error) -> Shape:
    """Return what kind of curve it is."""
    suffix = error.name.partition("_")[2]
    return "plane" if error.sides else "pitch" if suffix == "pitch" else "step" if suffix == "step" else "curve"


def side_name(component: int, axis: str) -> str:
    """Return the name of the curve that an axis alone would have: "EZX" of "EZXY"."""
    return f"E{COMPONENTS[component]}{axis}"
