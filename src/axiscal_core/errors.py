"""What may be wrong with a machine, before any reading: curves by their ISO 230 names, what two axes do together,
offsets, or a basis of one's own.

    >>> error = Error("EXX", std="10 um", knots=7, length="200 mm")
    >>> error.kind, error.axis, error.component
    ('motion', 'X', 0)
    >>> Error("EZXY", "5 um", knots=(5, 5), length=("150 mm", "150 mm")).axes
    ('X', 'Y')

A basis of one's own has `name`, `frame`, `rows(poses)` and `covariance()`: see `Basis`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np

from axiscal_core.axes import Axis
from axiscal_core.refusals import Array, InputError, computed, finite, named, one_of, spread, whole, within
from axiscal_core.theta import SURE, Sure
from axiscal_core.units import EITHER, METRES, RADIANS, Of, Quantity, quantities, si

Kind = Literal["motion", "reversal", "location"]
COMPONENTS = "XYZABC"
_NAME = re.compile(
    r"(?:E(?P<component>[XYZABC])(?P<axis>.+?)(?P<reversal>_reversal)?|(?P<place>[XYZABC])0(?P<of>.+?))"
    r"(?P<shape>_pitch|_step)?"
)
_PLANE = re.compile(r"E[XYZABC]([A-Z][1-9]?)([A-Z][1-9]?)")
SMOOTH, ROUGH = 2.5, 1.5  # ν of the Matérn correlation: a curve with two derivatives, or with one (kinks are likelier)
USUAL_KNOTS = 7  # of a motion of which nothing is said (B&H section V)
_GUESSED = 0.05  # of std: a rest that is to be learnt begins as this share
_ALONG = "length", "period"  # what is measured along the axis


class Basis(Protocol):
    """An error of one's own: u(t) = B(t) a, a ~ N(0, C).

    name : under which it is known; frame : the axis whose frame it moves, or "tool"
    """

    @property
    def name(self) -> str:
        """The name of the error."""

    @property
    def frame(self) -> str:
        """The name of the axis whose frame it displaces and turns; "tool" for the tool, about its point."""

    def rows(self, poses: Array) -> Array:
        """Return B, (m, 6, n): what each coefficient adds to displacement (m) and rotation (rad).  poses : (m, q)"""

    def covariance(self) -> Array:
        """Return C, (n, n)."""


class Own:
    """A basis of one's own, of which every answer is looked at.

    covariance : C (n, n); columns : where its coefficients stand among those of the machine
    """

    def __init__(self, basis: Basis) -> None:
        self.basis, self.frame = basis, basis.frame
        self.name = named("Machine", "errors", basis.name)
        prior = computed(self.name, "covariance()", basis.covariance)
        self.covariance = spread(self.name, "covariance()", prior, None)
        self.columns = slice(0, len(self.covariance))

    def behind(self, start: int) -> Own:
        """Return it with its coefficients from column `start` on."""
        other = copy(self)
        other.columns = slice(start, start + len(self.covariance))
        return other

    def rows(self, poses: Array) -> Array:
        """Return B, (m, 6, n)."""
        found = computed(self.name, "rows(poses)", self.basis.rows, poses)
        return finite(self.name, "rows(poses)", found, (len(poses), 6, len(self.covariance)), posed=True)


@dataclass(frozen=True, init=False)
class Error:
    """One error by its ISO 230 name, EXX, ECY, C0Y, EXX_reversal, EXX_pitch, EXX_step; or of two axes together, EZXY.

    std : before any reading, m or rad; of two axes together that of a plane that held both curves as well
    knots : of its spline; None: seven of a motion (B&H section V), else one number
    length : over which its values are alike, m or rad along the axis; None: a quarter of the travel is usual
    rest : std of detail finer than the spline, m or rad; None: three hundredths of std are usual
    scale : std of the strain of a linear axis, in its positioning error; None: 30 um/m are usual
    period : of what repeats along the axis, m or rad, with `waves` sines in it; of a curve beside such one 0 waves
    sure : how well size and length are known; None: as the case says
    smoothness : ν of the Matérn correlation, 2.5 or 1.5; joints : where a scale made of pieces steps, m or rad
    learnt_rest : the rest is to be learnt; free_knots : they follow from the length, so that readings may ask for more
    sides : of two axes together, what is known along each, as of an error of std 1; knots and lengths of a pair say it
    stretch : factor on the length along each that readings have taught; usual : nobody stated it, its lengths stay
    """

    name: str
    std: float
    knots: int | None
    length: float | None
    rest: float | None
    scale: float | None
    period: float | None
    waves: int
    sure: Sure | None
    smoothness: float
    joints: tuple[float, ...]
    learnt_rest: bool
    free_knots: bool
    sides: tuple[Error, ...]
    stretch: tuple[float, ...]
    usual: bool
    kind: Kind = field(init=False, repr=False, compare=False)
    axis: str = field(init=False, repr=False, compare=False)
    component: int = field(init=False, repr=False, compare=False)
    texts: Mapping[str, str] = field(init=False, repr=False, compare=False)
    """What was said of `length` and `period` as texts: the axis may contradict."""

    def __init__(
        self, name: str, std: Quantity, knots: int | Sequence[int] | None = None,
        length: Quantity | Sequence[Quantity] | None = None, rest: Quantity | None = None,
        scale: Quantity | None = None, period: Quantity | None = None, waves: int = 1, sure: Sure | None = None, *,
        smoothness: float = SMOOTH, joints: Sequence[float] = (), learnt_rest: bool = False, free_knots: bool = False,
        sides: Sequence[Error] = (), stretch: Sequence[float] = (1.0, 1.0), usual: bool = False,
    ) -> None:  # fmt: skip
        if not isinstance(name, str) or not (found := _NAME.fullmatch(name)):
            raise InputError("Error", "name", f"= {name!r} is none", "Names are EXX, C0Y, EXX_reversal, EZXY")
        kind: Kind = "location" if found["place"] else "reversal" if found["reversal"] else "motion"
        component = COMPONENTS.index(found["component"] or found["place"])
        if isinstance(knots, Sequence) or (isinstance(length, Sequence) and not isinstance(length, str)):
            sides, knots, length = _sides(name, knots, length), None, None
        size = RADIANS if component >= 3 else METRES
        every: dict[str, tuple[Any, Of]] = {
            "std": (std, size), "rest": (rest, size), "scale": (scale, RADIANS), "length": (length, EITHER),
            "period": (period, EITHER),
        }  # fmt: skip
        told: dict[str, object] = {
            "name": name,
            "kind": kind,
            "component": component,
            "axis": sides[0].axis if sides else str(found["axis"] or found["of"]),
            "knots": None if knots is None else whole("Error", "knots", knots, 1),
            "waves": whole("Error", "waves", waves, 0),
            "sure": sure if sure is None else one_of("Error", "sure", sure, [*SURE]),
            "smoothness": smoothness,
            "joints": tuple(joints),
            "learnt_rest": learnt_rest,
            "free_knots": free_knots,
            "sides": tuple(sides),
            "stretch": tuple(stretch),
            "usual": usual,
            "texts": {key: each for key in _ALONG if isinstance(each := every[key][0], str)},
        }
        given = [(key, *each, key in _ALONG) for key, each in every.items() if each[0] is not None or key == "std"]
        numbers = {
            key: within("Error", key, value if isinstance(value, float) else si(value, "Error", key, of), 0.0, end)
            for key, value, of, end in given
        }
        for key, each in (told | dict.fromkeys(every) | numbers).items():
            object.__setattr__(self, key, each)
        across = self.axis[0] in "XYZ" and self.axis[0] != COMPONENTS[component]
        idle = {
            "knots": (self.knots or 1) > 1 and (self.repeats or kind == "location"),
            "waves": self.waves > 1 and not self.repeats,
            "length": self.length is not None and (self.repeats or self.count < 2),
            "scale": bool(self.scale) and (kind != "motion" or self.angular or across),
        }
        if self.name.endswith("_pitch") and not self.repeats:
            raise InputError("Error", "period", f"of {self.name} is not stated", "Say after what way it repeats")
        for key in (key for key, stated in idle.items() if stated):
            raise InputError("Error", key, f"changes nothing of {self.name}", "Leave it out")

    @property
    def repeats(self) -> bool:
        """Whether it is a wave along its axis."""
        return self.period is not None and self.waves > 0

    @property
    def count(self) -> int:
        """The number of its knots; 1 for one number."""
        if self.kind == "location":
            return 1
        return self.knots if self.knots is not None else USUAL_KNOTS if self.kind == "motion" else 1

    @property
    def angular(self) -> bool:
        """Whether it is a rotation (rad) rather than a displacement (m)."""
        return self.component >= 3

    @property
    def axes(self) -> tuple[str, ...]:
        """The name of the axis that it belongs to, or of both."""
        return tuple(side.axis for side in self.sides) or (self.axis,)

    @property
    def bare(self) -> str:
        """The name without the words for shape or sides."""
        return self.name.partition("_")[0]

    @property
    def first_rest(self) -> float:
        """The rest before any reading, m or rad: as stated, a guess where it is to be learnt, else none."""
        return _GUESSED * self.std if self.rest is None and self.learnt_rest else self.rest or 0.0

    def refuse_foreign(self, axes: Sequence[Axis]) -> None:
        """Raise InputError unless its axes are among these, and lengths along them are of their kind."""
        names = [axis.name for axis in axes]
        for name in self.axes:
            if name not in names:
                what = f"hold {self.name}, of none of its axes"
                raise InputError("Machine", "errors", what, f"They are {', '.join(names)}")
        own = axes[names.index(self.axis)]
        for side in self.sides:
            side.refuse_foreign(axes)
        for key, text in self.texts.items():
            si(text, "Error", key, own.of)
        if self.scale and (own.rotary or self.name != own.positioning_error):
            raise InputError("Error", "scale", f"changes nothing of {self.name}", "Leave it out")


def _sides(
    name: str, knots: int | Sequence[int] | None, length: Quantity | Sequence[Quantity] | None
) -> tuple[Error, ...]:
    """Return what is known along each of two axes; one value for both counts for each."""
    found = _PLANE.fullmatch(name)
    if found is None or found[1] == found[2]:
        raise InputError("Error", "name", f"= {name!r} does not name two axes", "EZXY is z over X and Y")
    counts = knots if isinstance(knots, Sequence) else (knots, knots)
    lengths = length if isinstance(length, Sequence) and not isinstance(length, str) else (length, length)
    for key, each in (("knots", counts), ("length", lengths)):
        if len(each) != 2:
            raise InputError("Error", key, f"= {each!r} are not two", "Give one along each axis")
    pairs = zip(found.groups(), counts, lengths, strict=True)
    return tuple(Error(name[:2] + axis, 1.0, count, far) for axis, count, far in pairs)


class Offset:
    """One number that displaces and turns the frame of an axis, or of the tool: a `Basis` as a stranger would write it.

    twist : (6,) what a unit of it does, displacement and rotation in that frame where all axes stand at zero
    """

    def __init__(self, name: str, frame: str, twist: Sequence[float], std: Quantity) -> None:
        self.name, self.frame = named("Offset", "name", name), frame
        self.twist = quantities(twist, "Offset", "twist", (6,))
        self.std = within("Offset", "std", si(std, "Offset", "std"), 0.0)

    def rows(self, poses: Array) -> Array:
        """Return the twist at every pose, (m, 6, 1)."""
        return np.broadcast_to(self.twist[:, None], (len(poses), 6, 1))

    def covariance(self) -> Array:
        """Return the variance, (1, 1)."""
        return np.array([[self.std**2]])
