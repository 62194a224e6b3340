"""Entries of the [errors] table: what is known beforehand about one error, or about what two axes do together (EZXY).

Some errors have a stated shape: EXX_pitch repeats with a period (screw, encoder line), EXX_step has steps at joints.

Errors are named after ISO 230-1: EXX, C0Y, EXX_reversal, also in the spellings that people use.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from axiscal.document import shown
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import said
from axiscal_core.axes import Axis

Kind = Literal["motion", "location", "reversal"]
Shape = Literal["curve", "pitch", "step", "plane"]
"""Any curve, one that repeats with a period, one with steps at joints; what two axes do together."""
COMPONENTS = "XYZABC"

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


Sure = Literal["roughly", "well", "exactly"]
"""How well the stated size and length of an error are known."""

DEFAULT_KNOTS = 7
FEWEST_INTERVALS = 4
FEWEST_CYCLIC_KNOTS = 4
MOST_KNOTS = 400
SMOOTH, ROUGH = 2.5, 1.5
"""ν of the Matérn correlation: a curve with two derivatives, or with one (kinks are likelier)."""
_COARSE, _FINE = 2, 4
"""Knot intervals in a correlation length: at two a smooth curve is followed, at four also one that is rougher, or that
turns out to be of half the length.
"""
CHEAP = 200
"""Control values of a machine: a plan of so many takes half a second more than one of half as many."""
GUESSED_REST = 0.05
"""A rest that is to be learnt begins as this share of the std of its error."""


@dataclass(frozen=True, slots=True)
class ErrorEntry:
    """The prior of one error, or of what two axes do together beside the curves of each.

    name : canonical, "EXX", "C0Y", "EXX_reversal", "EZXY"
    std : prior standard deviation, m or rad, of a plane that held its axes' own curves as well; 0 for a rest only
    knots, spacing : as written, spacing in m or rad; at most one of them
    length : correlation length in the axis' unit, m or rad; None for independent control values
    rest : standard deviation of what the spline cannot follow, m or rad
    rest_estimated : the rest is to be learnt from the readings
    period : of an error that repeats along the axis (screw pitch, encoder line), m or rad; None if there is none
    smoothness : ν of the Matérn correlation, 2.5 or 1.5
    harmonics : waves to a period, at most, of an error of the shape "pitch"; 0 for others
    joints : where an error of the shape "step" steps, m or rad
    fine : knots of which nothing is said are as close as a rough curve needs them
    sure : how well std and length are known; None for what the campaign says of all
    smoothness_averaged : an older file leaves the smoothness open; knots are as close as a rough curve needs them
    scale : of a positioning error, the strain by which the linear axis may be longer; None where none is said
    sides : of a plane knots and correlation lengths along each axis, as of an error of std 1
    stretch : factor on the length along each axis that readings have taught; the splines stay those as stated
    usual : nobody stated it, it is what two axes usually do together; then its lengths stay
    parts : the name taken apart; axis : whose error this is, of two the first; kind, component : as of `ErrorName`
    """

    name: str
    std: float
    knots: int | None = None
    spacing: float | None = None
    length: float | None = None
    rest: float | None = None
    rest_estimated: bool = False
    period: float | None = None
    smoothness: float = SMOOTH
    harmonics: int = 0
    joints: tuple[float, ...] = ()
    fine: bool = False
    smoothness_averaged: bool = False
    sure: Sure | None = None
    scale: float | None = None
    sides: tuple[ErrorEntry, ...] = ()
    stretch: tuple[float, ...] = (1.0, 1.0)
    usual: bool = False
    parts: ErrorName = field(init=False, repr=False)
    axis: str = field(init=False, repr=False)
    kind: Kind = field(init=False, repr=False)
    component: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        parts = parse_any_name(self.name)
        found = {"parts": parts, "axis": parts.axis, "kind": parts.kind, "component": parts.component}
        for name, value in found.items():
            object.__setattr__(self, name, value)

    @property
    def constant(self) -> bool:
        """Whether the error is one number: a location error, or a reversal value without knots."""
        return self.kind == "location" or (self.kind == "reversal" and self.knots is None and self.spacing is None)

    @property
    def first_rest(self) -> float:
        """The rest before any reading, m or rad: as stated, a guess where it is to be learnt, else none."""
        return GUESSED_REST * self.std if self.rest is None and self.rest_estimated else self.rest or 0.0

    @property
    def follows_length(self) -> bool:
        """Whether it is a curve of which nobody says how many knots it has: they follow from its length."""
        curve = self.kind == "motion" and self.parts.shape == "curve"
        return curve and self.length is not None and self.knots is None and self.spacing is None

    def knot_count(self, axis: Axis) -> int:
        """Return the number of equidistant knots over the travel, both ends included; 1 for a constant.

        `knots` as written. `spacing`: the fewest intervals not longer than it. Neither: at least four intervals, not
        longer than half the correlation length (a quarter for `fine` or smoothness 1.5). Without a correlation length:
        7 knots, as in the paper (B&H section V).
        Raises DescriptionError when that is not between 2 and 400 (a full turn needs 4 for a periodic curve).
        """
        if self.constant:
            return 1
        count = self._wanted_knots(axis)
        fewest = FEWEST_CYCLIC_KNOTS if axis.cyclic else 2
        if not fewest <= count <= MOST_KNOTS:
            what = "{error}: {count:.0f} knots are too few"
            what = what if count < fewest else "{error}: {count:.0f} knots are too many"
            if axis.cyclic:
                what = "{error}: {count:.0f} knots over a full turn are too many"
                what = "{error}: {count:.0f} knots over a full turn are too few" if count < fewest else what
            remedy = "Between {least} and {most} knots are possible; give knots, spacing or length accordingly"
            raise DescriptionError(what, remedy, error=self.name, count=count, least=fewest, most=MOST_KNOTS)
        return int(count)

    def knot_positions(self, axis: Axis) -> tuple[float, ...]:
        """Return the knots over the travel of the axis, m or rad, both ends included; empty for a constant."""
        intervals = self.knot_count(axis) - 1
        low, high = axis.travel
        return tuple(low + (high - low) * i / intervals for i in range(intervals)) + ((high,) if intervals else ())

    def _wanted_knots(self, axis: Axis) -> float:
        if self.knots is not None:
            return self.knots
        if self.spacing is not None:
            return 1 + max(1, _intervals(axis.length, self.spacing))
        if self.length is not None:
            rough = self.fine or self.smoothness != SMOOTH or self.smoothness_averaged
            parts = _FINE if rough else _COARSE
            return 1 + max(FEWEST_INTERVALS, _intervals(axis.length, self.length / parts))
        return DEFAULT_KNOTS


def as_fine_as_is_cheap(entries: tuple[ErrorEntry, ...], axes: Mapping[str, Axis]) -> tuple[ErrorEntry, ...]:
    """Return the errors, with fine knots where none are stated, if all control values stay few even so."""
    finer = tuple(replace(e, fine=e.length is not None and e.knots is None and e.spacing is None) for e in entries)
    counts = [entry._wanted_knots(axes[entry.axis]) for entry in finer if not entry.constant]
    return finer if sum(counts) <= CHEAP else entries


def _intervals(travel: float, longest: float) -> int:
    """Return how many equal intervals, none longer than `longest`, fill the travel."""
    return math.ceil(travel / longest - 1e-9)


MOST_HARMONICS = 4
"""What is finer than a quarter of a period is noise; a matter of taste."""
MOST_BREAKS = 4000
"""Of a curve along an axis: a step search meets each of them, and takes a second for so many."""
KNOTS_PER_WAVE = 8
"""A cyclic spline of so many follows a sine within 1.2 thousandths (tests/numerics/test_repeated.py)."""
JOINT = 1e-3
"""m, or rad: over so much a reading head goes from one piece of a scale to the next (an assumption)."""
