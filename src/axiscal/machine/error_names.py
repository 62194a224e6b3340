"""Names of errors after ISO 230-1, EXX, C0Y, EXX_reversal, EZXY, also in the spellings that people use."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal_core.errors import COMPONENTS, Kind

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


@dataclass(frozen=True, slots=True)
class ErrorName:
    """The parts of an error's name.

    canonical : "EXX", "C0Y", "EXX_reversal"; axis : name of the axis it belongs to
    component : 0…5 for x y z a b c; reference : the axis X of "C(0X)Y", where it was written
    second : the other axis, Y of "EZXY"
    """

    canonical: str
    axis: str
    kind: Kind
    component: int
    reference: str | None = None
    second: str | None = None

    @property
    def axes(self) -> tuple[str, ...]:
        """The names of the axis that it belongs to, or of both."""
        return (self.axis,) if self.second is None else (self.axis, self.second)

    @property
    def angular(self) -> bool:
        """Whether the error is an angle (rad) rather than a displacement (m)."""
        return self.component >= 3

    @property
    def bare(self) -> str:
        """The name without the words for shape or sides."""
        return self.canonical.partition("_")[0]

    @property
    def shape(self) -> Shape:
        """What kind of curve it is."""
        suffix = self.canonical.partition("_")[2]
        if self.second is not None:
            return "plane"
        return "pitch" if suffix == "pitch" else "step" if suffix == "step" else "curve"


def parse_any_name(text: str) -> ErrorName:
    """Return the parts of the name of an error, also of what two axes do together, "EZXY"; raises DescriptionError."""
    if found := _PLANE.fullmatch(text):
        component = COMPONENTS.index(found["component"])
        return ErrorName(text, found["first"], "motion", component, second=found["second"])
    return parse_error_name(text)


def parse_error_name(text: str) -> ErrorName:
    """Return the parts of an ISO 230-1 error name; "EC0Y", "C(0X)Y", "EC(0X)Y" and "COY" are read as "C0Y".

    Raises DescriptionError for anything else, with the likely name where there is one.
    """
    if found := _LOCATION.fullmatch(text):
        component, axis = found["component"], found["axis"]
        return ErrorName(f"{component}0{axis}", axis, "location", COMPONENTS.index(component), found["reference"])
    if found := _MOTION.fullmatch(text):
        component, axis, suffix = found["component"], found["axis"], found["suffix"] or ""
        kind: Kind = "reversal" if suffix == "_reversal" else "motion"
        return ErrorName(f"E{component}{axis}{suffix}", axis, kind, COMPONENTS.index(component))
    raise DescriptionError("{text} is not the name of an error", _likely(text) or said(_REMEDY), text=shown(text))


def _likely(text: str) -> str | None:
    """Return a hint when only the case, or blanks, stand between the text and a name."""
    bare = "".join(text.split()).upper()
    for suffix in ("reversal", "pitch", "step"):
        bare = bare.replace(f"_{suffix.upper()}", f"_{suffix}").replace(f"-{suffix.upper()}", f"_{suffix}")
    if bare != text and (_LOCATION.fullmatch(bare) or _MOTION.fullmatch(bare)):
        return said("Perhaps {word} is meant; names are written in capitals", word=bare)
    if bare.endswith("_reversal") and _LOCATION.fullmatch(bare.removesuffix("_reversal")):
        what = (
            "A location error is a constant and has no reversal value; only component errors such as EXX_reversal have"
        )
        return said(what)
    return None


def side_name(component: int, axis: str) -> str:
    """Return the name of the curve that an axis alone would have: "EZX" of "EZXY"."""
    return f"E{COMPONENTS[component]}{axis}"
