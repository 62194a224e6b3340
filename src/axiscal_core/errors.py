"""What may be wrong with a machine: curves by their ISO 230 names, planes, offsets, or a basis of one's own.

    >>> error = Error("EXX", std="10 um", knots=7, length="200 mm")
    >>> error.kind, error.axis, error.component
    ('motion', 'X', 0)

A basis of one's own has `name`, `frame`, `rows(poses)` and `covariance()`: see `Basis`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, cast

import numpy as np

from axiscal_core.axes import Axis
from axiscal_core.refusals import Array, InputError, computed, finite, listed, named, one_of, spread, whole, within
from axiscal_core.splines import (
    Constant,
    CyclicSpline,
    NaturalSpline,
    Repeated,
    Spline,
    distances,
    even_knots,
    matern,
    ramp,
)
from axiscal_core.theta import SURE, Sure
from axiscal_core.units import EITHER, METRES, RADIANS, Quantity, quantities, si

Kind = Literal["motion", "reversal", "location"]
COMPONENTS = "XYZABC"
_NAME = re.compile(
    r"(?:E(?P<component>[XYZABC])(?P<axis>.+?)(?P<reversal>_reversal)?|(?P<place>[XYZABC])0(?P<of>.+?))(?:_pitch)?"
)
CELLS, ASIDE = 8, 2e-4
"""Cells of a knot interval, within which a rest is one value; they begin so far before a knot, m or rad.

Places are round numbers, and stand at knots: a correction must not leave a cell."""
_ALONG = "length", "period"  # what is measured along the axis
_WAVE_KNOTS = 8  # a cyclic spline of so many follows a sine to 1.2 thousandths


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
    """A basis of one's own, of which every answer is looked at."""

    def __init__(self, basis: Basis) -> None:
        self.basis, self.frame = basis, basis.frame
        self.name = named("Machine", "errors", basis.name)
        prior = computed(self.name, "covariance()", basis.covariance)
        self._prior = spread(self.name, "covariance()", prior, None)

    def rows(self, poses: Array) -> Array:
        """Return B, (m, 6, n)."""
        found = computed(self.name, "rows(poses)", self.basis.rows, poses)
        return finite(self.name, "rows(poses)", found, (len(poses), 6, len(self._prior)), posed=True)

    def covariance(self) -> Array:
        """Return C, (n, n)."""
        return self._prior


@dataclass(frozen=True)
class Error:
    """One error by its ISO 230 name: EXX, ECY, C0Y, EXX_reversal, EXX_pitch.

    std : before any reading, m or rad; knots : of its spline; None: seven of a motion (B&H section V), else one number
    length : over which its values are alike, m or rad along the axis; None: a quarter of the travel is usual
    rest : std of detail finer than the spline, m or rad; None: three hundredths of std are usual
    scale : std of the strain of a linear axis, in its positioning error; None: 30 um/m are usual
    period : of what repeats along the axis, m or rad, with `waves` sines in it
    sure : how well size and length are known; None: as the case says
    """

    name: str
    std: Quantity
    knots: int | None = None
    length: Quantity | None = None
    rest: Quantity | None = None
    scale: Quantity | None = None
    period: Quantity | None = None
    waves: int = 1
    sure: Sure | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not _NAME.fullmatch(self.name):
            raise InputError("Error", "name", f"= {self.name!r} is none", "Names are EXX, C0Y, EXX_reversal")
        whole("Error", "knots", self.count, 1)
        whole("Error", "waves", self.waves, 1)
        if self.sure is not None:
            one_of("Error", "sure", self.sure, [*SURE])
        size = RADIANS if self.component >= 3 else METRES
        every = {"std": size, "length": EITHER, "rest": size, "scale": RADIANS, "period": EITHER}
        for field, of in every.items():
            value, along = getattr(self, field), field in _ALONG
            if value is not None or field == "std":
                number = within("Error", field, si(value, "Error", field, of), 0.0, open_end=along)
                # quantities become numbers once, here; those along an axis where that is known
                object.__setattr__(self, field, value if along else number)
        wave, more = self.period is not None, (self.knots or 1) > 1
        idle = {"knots": more and (wave or self.kind == "location"), "waves": self.waves > 1 and not wave}
        idle["length"] = self.length is not None and (wave or self.count < 2)
        idle["scale"] = bool(self.scale) and not self.positioning
        if self.name.endswith("_pitch") and not wave:
            raise InputError("Error", "period", f"of {self.name} is not stated", "Say after what way it repeats")
        for field in (field for field, stated in idle.items() if stated):
            raise InputError("Error", field, f"changes nothing of {self.name}", "Leave it out")

    @property
    def kind(self) -> Kind:
        """What it is: a motion over the travel, a reversal, or where an axis stands."""
        found = self._parts
        return "location" if found["place"] else "reversal" if found["reversal"] else "motion"

    @property
    def axis(self) -> str:
        """The name of its axis."""
        return str(self._parts["axis"] or self._parts["of"])

    @property
    def component(self) -> int:
        """0 to 2 along x, y, z and 3 to 5 about them."""
        return COMPONENTS.index(self._parts["component"] or self._parts["place"])

    @property
    def count(self) -> int:
        """The number of its knots; 1 for one number."""
        if self.kind == "location":
            return 1
        return self.knots if self.knots is not None else 7 if self.kind == "motion" else 1

    @property
    def positioning(self) -> bool:
        """Whether it is how far a linear axis goes."""
        return self.name == f"E{self.axis}{self.axis}" and self.component < 3

    @property
    def _parts(self) -> re.Match[str]:
        return cast("re.Match[str]", _NAME.fullmatch(self.name))


@dataclass(frozen=True, eq=False)
class Curved:
    """An error on its axis.  at : index of the axis"""

    error: Error
    at: int
    spline: Spline
    linear: bool

    @property
    def name(self) -> str:
        """The name of the error."""
        return self.error.name

    @property
    def std(self) -> float:
        """Before any reading, m or rad."""
        return cast(float, self.error.std)

    @property
    def rest(self) -> float:
        """Standard deviation of the rest, detail finer than the spline, m or rad."""
        return cast(float, self.error.rest or 0.0)

    @property
    def length(self) -> float | None:
        """Over which its control values are alike; None where that is not so, and where they are nothing."""
        alike = self.spline.size > 1 and self.error.period is None and self.std > 0
        return cast("float | None", self.error.length) if alike else None

    @property
    def ramp(self) -> Array | None:
        """The effect of one standard deviation of the scale on the control values, (n,); None without scale."""
        if not self.error.scale:
            return None
        return np.asarray(cast(float, self.error.scale) * ramp(self.spline))

    def correlation(self, longer: float = 1.0) -> Array:
        """Return R of the control values, (n, n), without the scale.  longer : factor on the length

        Independent ones (eq. 16) without a length, else Matérn-5/2; of a wave, cosine and sine of k turns have 1/k².
        """
        if self.length is not None:
            return matern(distances(self.spline) / (self.length * longer))
        if self.error.period is not None:
            turns = 2 * np.pi * np.arange(self.spline.size) / self.spline.size
            each = [np.cos(k * (turns[:, None] - turns)) / k**2 for k in range(1, self.error.waves + 1)]
            return np.asarray(np.sum(each, axis=0))
        return np.eye(self.spline.size)

    def covariance(self) -> Array:
        """Return C before any reading, (n, n)."""
        result: Array = self.std**2 * self.correlation()
        return result if self.ramp is None else result + np.outer(self.ramp, self.ramp)


def curved(error: Error, axes: Sequence[Axis]) -> Curved:
    """Return an error on its axis: a constant, cyclic on a full turn or along a wave, else a natural spline."""
    names = [axis.name for axis in axes]
    if error.axis not in names:
        raise InputError("Machine", "errors", f"hold {error.name}, of none of its axes", f"They are {', '.join(names)}")
    at = names.index(error.axis)
    axis, (low, high) = axes[at], axes[at].travel
    length, period = (
        None if (stated := getattr(error, field)) is None else si(stated, "Error", field, axis.of) for field in _ALONG
    )
    error = replace(error, length=length, period=period)
    spline: Spline
    if error.period is not None:
        spline = Repeated(low, high, cast(float, error.period), _WAVE_KNOTS * error.waves)
    elif error.count < 2:
        spline = Constant(low, high)
    else:
        spline = (CyclicSpline if axis.cyclic else NaturalSpline)(even_knots(low, high, error.count))
    return Curved(error, at, spline, not axis.rotary)


WHITE, ROUGH, SCALE, LENGTH = 0.03, 0.045, 30e-6, 0.25
"""Usual shares of std, strain, and share of the travel, where nothing is stated."""


def as_usual(error: Error, axis: Axis) -> Error:
    """Return a curve with what curves usually have and nobody stated: a length, a rest, a scale.  See `causes`."""
    if error.kind != "motion" or error.period is not None or error.count < 2:
        return error
    std, rest = cast(float, error.std), error.rest
    white = WHITE * std if rest is None else cast(float, rest)
    scale = SCALE if error.scale is None and error.positioning and not axis.rotary else error.scale
    length = LENGTH * axis.length if error.length is None else error.length
    return replace(error, rest=float(np.hypot(white, ROUGH * std)), scale=scale, length=length)


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


class Plane:
    """An error of two axes together, EZXY, beside the curves of each: products of their splines.

    std : m or rad, of a plane that held both curves as well; lengths : over which it is alike along each axis
    """

    def __init__(
        self, name: str, std: Quantity, axes: Sequence[Axis], lengths: Sequence[Quantity], knots: Sequence[int] = (5, 5)
    ) -> None:
        counts = listed("Plane", "knots", knots)
        if [len(listed("Plane", "axes", axes)), len(counts)] != [2, 2] or not all(isinstance(a, Axis) for a in axes):
            raise InputError("Plane", "axes", "or knots are not two", "Give two axes, and two counts")
        if not re.fullmatch(r"E[XYZABC].+", name) or name[2:] != "".join(axis.name for axis in axes):
            raise InputError("Plane", "name", f"= {name!r} does not name both axes", "EZXY is z over X and Y")
        self.name, self.frame = name, axes[1].name
        self.component = COMPONENTS.index(name[1])
        size = si(std, "Plane", "std", RADIANS if self.component >= 3 else METRES)
        self.std = within("Plane", "std", size, 0.0)
        every = [even_knots(*axis.travel, whole("Plane", "knots", n, 2)) for axis, n in zip(axes, counts, strict=True)]
        self.splines = [NaturalSpline(each) for each in every]
        self.lengths = quantities(lengths, "Plane", "lengths", (2,), [axis.of for axis in axes])
        within("Plane", "lengths", float(self.lengths.min()), 0.0, open_end=True)
        self.axes = tuple(axes)
        self._columns: tuple[int, int] = (0, 1)

    def on(self, axes: Sequence[Axis]) -> None:
        """Find its axes among the columns of poses; it moves the frame of the one nearer to the tool."""
        names = [axis.name for axis in axes]
        for axis in self.axes:
            one_of("Plane", "axes", axis.name, names)
        self._columns = names.index(self.axes[0].name), names.index(self.axes[1].name)
        self.frame = names[max(self._columns)]

    def rows(self, poses: Array) -> Array:
        """Return the products, (m, 6, n)."""
        first, second = (spline.rows(poses[:, k]) for spline, k in zip(self.splines, self._columns, strict=True))
        result = np.zeros((len(poses), 6, first.shape[1] * second.shape[1]))
        result[:, self.component] = (first[:, :, None] * second[:, None, :]).reshape(len(poses), -1)
        return result

    def covariance(self) -> Array:
        """Return the product of two centred kernels: means along each side are the curves' (Gu and Wahba 1993)."""
        each = []
        for spline, length in zip(self.splines, self.lengths, strict=True):
            centre = np.eye(spline.size) - 1 / spline.size
            each.append(centre @ matern(distances(spline) / length) @ centre)
        return np.asarray(self.std**2 * np.kron(each[0], each[1]))
