"""A set-up: one instrument, mounted in one way, that reads along (or about) one direction.

Where readings are linearised: about the machine that is believed, instead of about the nominal one.

    e_i(x) = f_i(x) − h_i x,    y_i ← y_i − e_i(x)                                                (chord iteration)

f_i what the instrument would show by the exact chain where errors and unknowns are x, h_i the row of the reading. With
rows at the nominal machine each round converges by the largest rotation, about 1e-3. If that is not enough, the rows
are taken at x as well (Gauss-Newton; Bell and Cathey 1993).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar

from axiscal.machine.motion import USUAL, Driving
from axiscal_core.axes import Axis

if TYPE_CHECKING:
    from axiscal.measurement.artefact import Artefact
    from axiscal.measurement.charts.room import Chart

from axiscal.numerics import Array
from axiscal.numerics.displays import COARSE

Approach = Literal["both", "+", "-"]
Contact = Literal["free", "held", "retracted"]
"""Between two places nothing is in the way, or the tool keeps in touch, or it goes off and comes back."""
Sited = Literal["anywhere", "line", "sight", "reach", "ball", "bar", "length"]
"""What says where an instrument reads: one axis or a line alone, what it sees, its reach, a ball, a bar, two ends."""
SaidOfDrift = Literal["nothing", "usual", "stated", "denied"]
"""Of how fast a zero wanders: nothing, what is usual of its instrument, a rate, or that it does not."""
Vector = tuple[float, float, float]
Nodes = tuple[float, float, int]
"""Of a map along an axis: the first node, the last, m, and how many there are."""

_SOFT = 0.1
"""Share of a bound: nobody knows where it ends more sharply, and the estimate settles."""
FINEST = 1e-10
"""No reading is known better than this, m or rad: an atom's width. Smaller noise is a slip, and ends in rounding."""

STEEL = 11.7e-6
"""1/K, of what scales, screws and workpieces are made of as a rule."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A quantity of the set-up itself that is estimated along with the machine.

    name : such as "zero" (constant offset of every reading, m or rad) or "slope" (rad; times the distance of the
        moving linear axis from the middle of its travel); each kind of instrument has its own
    std : prior standard deviation in the same unit
    owner : the artefact, bar or tool that it belongs to, with which all set-ups share it; "" is the set-up alone
    """

    name: str
    std: float
    owner: str = ""


Model = TypeVar("Model")
"""Class of what an instrument sees."""


@dataclass(frozen=True)
class Figures(Generic[Model]):
    """Usual figures of a kind of instrument; every one of them can be replaced in the description of a set-up.

    model : what it sees; noise : standard deviation of one reading, m or rad
    unknowns : what each new mounting leaves open, with prior standard deviations
    setup_time, settle, reading_time : s
    wanders : std of the rate of its zero, m/s or rad/s: as a rule, and where machine and instrument are warm
    site : what says where it reads; contact : as of `Setup`, at the balls of an artefact
    light : whether it compares positions with the wavelength
    display : whether a person reads a display that follows the tool, so that a jog shows on it
    park, approach : where other axes stand, m or rad by name, and from which sides it is read, unless a set-up says it
    type_b : what no reading shows: name, standard deviation in SI units, and the unit that it is shown in
    curved : unknowns in which a class is not linear, so that readings are linearised where these have been found
    """

    name: str
    model: type[Model] = field(compare=False)
    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float
    wanders: tuple[float, float]
    site: Sited = "anywhere"
    contact: Contact = "free"
    light: bool = False
    display: bool = False
    park: tuple[tuple[str, float], ...] = ()
    approach: Approach = "+"
    type_b: tuple[tuple[str, float, str], ...] = ()
    curved: tuple[str, ...] = ()

    @property
    def all_round(self) -> bool:
        """Whether it touches a ball from all sides."""
        return self.site == "ball" and self.contact == "retracted"

    @property
    def against_length(self) -> bool:
        """Whether it compares positions with a length that is known."""
        return self.light or self.site == "length"


@dataclass(frozen=True, slots=True)
class Setup:
    """How one instrument stands on the machine.

    direction : unit vector in the workpiece frame, along which a length or about which an angle is read
    offset : of the point that is looked at from the tool point, along the tool's x, y, z, m; None where nobody said
    moves : indices of the axes that may move, in chain order
    park : (n_axes,) m or rad, where the axes stand that do not move; middle of travel for those that do
    noise : standard deviation of one reading, m or rad, what its display rounds off included
    setup_time, settle, reading_time : s
    raster : (n_axes,) m or rad, positions are multiples of it; 0 is continuous
    approach : directions from which a moving axis comes to a position; "both" is needed to see reversal
    station : where a tracker, tracer or ball bar stands, m, in the workpiece frame
    stations : of tracers that read at once, one number each; none where one instrument reads
    warmer : by how much the measured material is warmer than 20 °C, K; None where nobody says
    expansion : coefficient of thermal expansion of the measured material, 1/K
    at_20 : what is found of the machine refers to 20 °C, not to the temperature that it was read at
    stated : sizes of causes that no reading shows, by name, where no default holds (see `description.type_b`)
    found : how far from there its station has been found so far, m, or by how much a tracker is turned, rad; of several
        stations one after another; None is nowhere else
    base : how far apart the feet of a level stand that is stepped along the way of the axis that moves, m; its poses
        are those of the middle; None where it rides on what moves
    start : (n_axes,) m or rad, where the first end of a length is: what is read is how much farther from there the tool
        goes, and its poses are those of the second end; None where it reads no length
    drift : standard deviation of the rate at which its zero wanders while it stands, m/s or rad/s
    drift_said : who says so
    resolution : the step q of its display, m or rad; 0 where it shows everything
    bound : w, a reading is off by anything up to ± this beside its noise, m or rad; 0 where by nothing more
    one_sided : by how much a chip or burr usually shifts a reading, m or rad, with the side it shifts it to; 0: by none
    reach : (n_axes,) from where to where it can be read along each axis, m or rad; None is all travel
    nodes : along X and Y, of maps whose files carry no coordinates
    chart : where it can be read, where that is not any pose of the axes that move
    artefact, balls : what it reads, and which of its balls
    contact : how it goes from place to place; retract : how far off, m
    mean_sides : it reads the mean of coming from both sides along the linear axes, so that their reversal is zero
    three_touches : it reads a sphere by its pole and two sides, so that their size counts and the linear axes come from
        where they touch
    length : of a ball bar, m; stroke : by how much what it reads may differ from nominal, m
    driving : how programs go from place to place
    written : the instrument, where it is none of ours
    lacks : what is not said before readings can be asked for, and what to add, in words; None where nothing is lacking
    """

    name: str
    instrument: str
    direction: Vector
    moves: tuple[int, ...]
    park: tuple[float, ...]
    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float
    raster: tuple[float, ...]
    approach: Approach
    offset: Vector | None = None
    station: Vector | None = None
    stations: tuple[Vector, ...] = ()
    found: tuple[float, ...] | None = None
    warmer: float | None = None
    expansion: float = STEEL
    at_20: bool = False
    stated: tuple[tuple[str, float], ...] = ()
    base: float | None = None
    start: tuple[float, ...] | None = None
    drift: float = 0.0
    drift_said: SaidOfDrift = "nothing"
    resolution: float = 0.0
    bound: float = 0.0
    one_sided: float = 0.0
    reach: tuple[tuple[float, float], ...] | None = None
    nodes: tuple[Nodes, Nodes] | None = None
    chart: Chart | None = None
    artefact: Artefact | None = None
    balls: tuple[int, ...] = ()
    contact: Contact = "free"
    retract: float = 0.0
    mean_sides: bool = False
    three_touches: bool = False
    length: float | None = None
    stroke: float | None = None
    driving: Driving = USUAL
    lacks: tuple[str, str] | None = None
    written: Figures[Any] | None = None

    def sided(self, axes: Sequence[Axis]) -> tuple[int, ...]:
        """Return the axes that are approached from a side of their own: on a chart the linear ones follow.

        axes : of the machine
        """
        if self.chart is None or len(self.chart.coordinates) == len(self.moves):
            return self.moves
        return tuple(k for k in self.moves if axes[k].rotary and self.length is None)

    @property
    def title(self) -> str:
        """What its instrument is called: its name, or that of the class."""
        return self.instrument.rpartition(":")[2]

    @property
    def growth(self) -> float:
        """Thermal expansion of the measured material against 20 °C, as far as it is known, a strain."""
        return self.expansion * (self.warmer or 0.0)

    @property
    def standing(self) -> tuple[Vector, ...]:
        """Where its instruments stand: one place, several that read at once, or none that is stated."""
        return self.stations or (() if self.station is None else (self.station,))

    @property
    def sides_follow(self) -> bool:
        """Whether the linear axes come to a place of its chart from where its coordinates bring them."""
        return not (self.mean_sides or self.three_touches)

    @property
    def sides(self) -> tuple[int, ...]:
        """The directions from which a moving axis may come, +1 and −1; the usual one first."""
        return {"both": (1, -1), "+": (1,), "-": (-1,)}[self.approach]

    @property
    def rounding(self) -> float:
        """Standard deviation of what the display rounds off, q/√12, m or rad (GUM F.2.2.1)."""
        return self.resolution / math.sqrt(12.0)

    @property
    def lag(self) -> float:
        """Standard deviation of what it shows too little of the way it was moved last, m or rad; 0 for none."""
        return next((unknown.std for unknown in self.unknowns if unknown.name == "lag"), 0.0)

    @property
    def interval(self) -> float:
        """How wide an interval is within which a reading says nothing, m or rad: a step, or both sides of a bound."""
        return max(self.resolution, 2 * self.bound)

    @property
    def noise_alone(self) -> float:
        """Standard deviation of a reading without what a display rounds off and a bound leaves, m or rad."""
        if self.interval == 0:
            return self.noise
        return max(math.sqrt(max(self.noise**2 - self.rounding**2 - self.bound**2 / 3.0, 0.0)), FINEST)

    @property
    def scatter(self) -> float:
        """Standard deviation of a reading about its interval, m or rad."""
        if self.interval == 0:
            return self.noise
        beside = math.sqrt(max(self.noise**2 - self.interval**2 / 12.0, 0.0))
        return max(beside, _SOFT * self.bound, FINEST)

    @property
    def coarse(self) -> bool:
        """Whether readings say no more than an interval that is coarse beside their scatter."""
        return self.interval > COARSE * self.scatter

    def span(self, axis: Axis, index: int) -> tuple[float, float]:
        """Return from where to where it can be read along an axis, m or rad: its reach, for feet that stand within."""
        low, high = axis.travel if self.reach is None else self.reach[index]
        half = (self.base or 0.0) / 2 if index in self.moves else 0.0
        return low + half, high - half


@dataclass(frozen=True, eq=False, slots=True)
class About:
    """point : (k,) errors of the machine, then unknowns of the set-ups; bent : rows are those of the machine there"""

    point: Array
    bent: bool = False
