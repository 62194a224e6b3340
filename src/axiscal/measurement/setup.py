"""A set-up: one instrument, mounted in one way. Its class says what it shows (`sees`), and what is usual of it.

Rows are derivatives of that by complex steps (`axiscal_core.instrument.slopes`); simulated readings are its values.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np

from axiscal.machine.motion import USUAL, Driving
from axiscal.measurement.charts.room import Coordinate
from axiscal_core.axes import Axis
from axiscal_core.instrument import Approach, At, Slopes, Unknowns, numbers, own_slopes, slopes
from axiscal_core.machine import Machine

if TYPE_CHECKING:
    from axiscal.measurement.artefact import Artefact
    from axiscal.measurement.charts.room import Chart

from axiscal.machine.kinematics import Deviation
from axiscal.numerics import Array
from axiscal.numerics.displays import COARSE

Reads = Literal["length", "angle"]
Contact = Literal["free", "held", "retracted"]
"""Between two places nothing is in the way, or the tool keeps in touch, or it goes off and comes back."""
Sited = Literal["anywhere", "line", "sight", "reach", "ball", "bar", "length"]
"""What says where an instrument reads: one axis or a line alone, what it sees, its reach, a ball, a bar, two ends."""
SaidOfDrift = Literal["nothing", "usual", "stated", "denied"]
"""Of how fast a zero wanders: nothing, what is usual of its instrument, a rate, or that it does not."""
Vector = tuple[float, float, float]
Nodes = tuple[float, float, int]
"""Of a map along an axis: the first node, the last, m, and how many there are."""

FINEST = 1e-10
"""No reading is known better than this, m or rad: an atom's width. Smaller noise is a slip, and ends in rounding."""

MOST = 4
"""Stations that read at once; no more are known to be bought together."""
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

    @classmethod
    def each(cls, names: Iterable[str], std: float) -> tuple[Self, ...]:
        """Return one of each name."""
        return tuple(cls(name, std) for name in names)


ZERO = Unknown("zero", 1e-3)
LASER, GAUGE, INCLINED = ((5e-6 / 3600, 3e-6 / 3600), (10e-6 / 3600, 3e-6 / 3600), (2e-6 / 3600, 2e-6 / 3600))
"""Drifts of zeros by the hour, as a rule and where all is warm: of a laser 1 ppm/K of 0.2 m of dead path at 1 K/h,
0.2 um/h (user's guides of HP 5528A and Agilent 5530), and of the machine 5 um/h, an assumption; of what touches 10 um/h
in the first hour after power-up or a spindle run and 3 um/h after, an assumption, as ISO 230-3 and ISO/TR 16015 define
a test and give no number; 2 urad/h is one as well."""
CARRIED = 1e-4
"""m, std along each of `TOOL` where nothing is said (an assumption)."""
TRUED = 5e-6
"""m: what is set in the spindle to be read is made to run true with a dial (an assumption)."""
SQUARE = ("square_x", "square_y", "square_z")
"""By how much the square is turned that a leg belongs to."""


def reads_as(unknown: str) -> Reads:
    """Return whether an unknown is a length, or a turn or strain."""
    return "angle" if unknown in ("slope", "growth", "scale") or unknown.startswith(("turn_", "square_")) else "length"


def known(*unknowns: str) -> Mapping[str, Reads]:
    """Return what each of some unknowns is."""
    return MappingProxyType({name: reads_as(name) for name in unknowns})


class Usual(NamedTuple):
    """What is usual of a class of instruments, where the description of a set-up is silent.

    noise : standard deviation of one reading, m or rad
    unknowns : what each new mounting leaves open, with prior standard deviations
    setup_time, settle, reading_time : s
    wanders : std of the rate of its zero, m/s or rad/s: as a rule, and where machine and instrument are warm
    contact : at the balls of an artefact; approach : from which sides it is read
    park : where other axes stand, m or rad by name
    """

    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float
    wanders: tuple[float, float] = (0.0, 0.0)
    contact: Contact = "free"
    approach: Approach = "+"
    park: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True)
class Setup:
    """An instrument as it stands on a machine. A class of instruments derives from it and writes `sees`.

    Of each class:
    instrument : its name; usual : figures; reads : lengths or angles
    numbers : what those of a reading are told apart by
    directed : it reads along or about a direction that has to be stated
    unknown_reads : by name of each possible unknown of a set-up, whether it is a length or an angle
    site : what says where it reads; all_round : it touches a ball from all sides
    light, against_length : whether it compares positions with the wavelength; with a length that is known
    display : whether a person reads a display that follows the tool, so that a jog shows on it
    written : it is none of ours; alike : whether all its numbers are equally noisy; type_b : `TypeB` of it

    Of each set-up:
    machine : on which it stands
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
    reach : (n_axes,) from where to where it can be read along each axis, m or rad; None is all travel
    nodes : along X and Y, of maps whose files carry no coordinates
    chart : where it can be read, where that is not any pose of the axes that move
    artefact, balls : what it reads, and which of its balls
    contact : how it goes from place to place; retract : how far off, m
    length : of a ball bar, m; stroke : by how much what it reads may differ from nominal, m
    driving : how programs go from place to place
    curved : unknowns in which it is not linear, so that readings are linearised where these have been found
    lacks : what is not said before readings can be asked for, and what to add, in words; None where nothing is lacking
    """

    instrument: ClassVar[str]
    usual: ClassVar[Usual]
    reads: ClassVar[Reads] = "length"
    numbers: ClassVar[tuple[str, ...]] = ("",)
    directed: ClassVar[bool] = True
    unknown_reads: ClassVar[Mapping[str, Reads]] = MappingProxyType({})
    site: ClassVar[Sited] = "anywhere"
    all_round: ClassVar[bool] = False
    light: ClassVar[bool] = False
    against_length: ClassVar[bool] = False
    display: ClassVar[bool] = False
    written: ClassVar[bool] = False
    alike: ClassVar[bool] = True
    type_b: ClassVar[tuple[Any, ...]] = ()

    name: str
    machine: Machine = field(compare=False, repr=False)
    direction: Vector
    moves: tuple[int, ...]
    park: tuple[float, ...]
    noise: float
    unknowns: tuple[Unknown, ...]
    setup_time: float
    settle: float
    reading_time: float
    raster: tuple[float, ...]
    approach: Approach = "+"
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
    reach: tuple[tuple[float, float], ...] | None = None
    nodes: tuple[Nodes, Nodes] | None = None
    chart: Chart | None = None
    artefact: Artefact | None = None
    balls: tuple[int, ...] = ()
    contact: Contact = "free"
    retract: float = 0.0
    length: float | None = None
    stroke: float | None = None
    driving: Driving = USUAL
    lacks: tuple[str, str] | None = None
    curved: tuple[str, ...] = ()

    def sees(self, at: At, u: Unknowns) -> Sequence[Array]:
        """Return what it shows, nothing linearised, noise left out, (m,) each, m or rad.  u : all its unknowns"""
        raise NotImplementedError

    def check(self) -> None:
        """Raise DescriptionError for a set-up that makes no sense on its machine; as a rule every one does."""

    @property
    def names(self) -> tuple[str, ...]:
        """What the numbers of a reading are told apart by; "" of a single one."""
        return self.numbers

    @property
    def reads_each(self) -> tuple[Reads, ...]:
        """What each number of a reading is."""
        return (self.reads,) * len(self.names)

    @property
    def scales(self) -> Array:
        """By what each number of a reading is multiplied within rows, so that all are equally noisy, (k,)."""
        return np.ones(len(self.names))

    def column(self, name: str) -> str:
        """Return what a file of readings calls the column of a number, its unit left out."""
        return f"value_{name}" if name else "value"

    @property
    def located(self) -> tuple[str, ...]:
        """The unknowns that say where it stands, which `found` has values of; as a rule none."""
        return tuple(unknown.name for unknown in self.unknowns if unknown.name in self.curved)

    @property
    def found_at(self) -> dict[str, float]:
        """Where these have been found so far: there its rows are taken, and at zero of all others."""
        return dict(zip(self.located, self.found or (), strict=False))

    @cached_property
    def _nothing(self) -> dict[str, float]:
        return dict.fromkeys((*self.unknown_reads, *(unknown.name for unknown in self.unknowns)), 0.0)

    def places(self, poses: Array, sides: Array | None = None, deviation: Deviation | None = None) -> At:
        """Return places of readings.

        poses : (m, q) m or rad; sides : (m, q) from which each axis came, +1 or −1, 0 where nobody said
        deviation : what the tool does there
        """
        come = np.zeros_like(poses) if sides is None else sides
        moved, turned = np.zeros((2, len(poses), 3)) if deviation is None else deviation
        nominal = self.machine.frames(poses)
        return At(poses, come, nominal.tcp, nominal.tool, moved, turned)

    def shown(self, at: At, own: Unknowns) -> Array:
        """Return all that it shows, (m, k).  own : values of its unknowns, zero where none is given"""
        return numbers(self, at, {**self._nothing, **own})

    def slopes(self, at: At) -> Slopes:
        """Return the derivatives of what it shows by what the tool does."""
        return slopes(self, at, {**self._nothing, **self.found_at})

    def own_slopes(self, at: At, names: Sequence[str] | None = None) -> Array:
        """Return those by its own unknowns, (m, k, names).  names : None for those of the set-up"""
        own = [unknown.name for unknown in self.unknowns] if names is None else names
        return own_slopes(self, at, {**self._nothing, **self.found_at}, own)

    def middle(self, at: At) -> Array:
        """Return from where its lengths count, (1, 3) m: the middle of what is read."""
        return np.asarray(at.tcp.mean(axis=0, keepdims=True))

    def travelled(self, poses: Array) -> Array:
        """Return how far the linear axis that moves is from the middle of its travel, (m,) m; zero where none does."""
        if self.slide is None:
            return np.zeros(len(poses))
        return poses[:, self.slide] - sum(self.machine.axes[self.slide].travel) / 2

    def ways(self, poses: Array) -> Array:
        """Return the way that this axis goes in the workpiece frame, (m, 3); zero where none moves."""
        if self.slide is None:
            return np.zeros((len(poses), 3))
        along = np.array(self.machine.axes[self.slide].direction)
        return np.asarray(self.machine.frames(poses).rotations[self.slide] @ along)

    @cached_property
    def slide(self) -> int | None:
        """The index of the linear axis that moves; None where none does."""
        return next((k for k in self.moves if not self.machine.axes[k].rotary), None)

    def grown(self, at: At) -> Array:
        """Return how much farther a machine that is warmer than 20 °C takes the tool from the middle, (m, 3) m."""
        away: Array = self.growth * (at.tcp - self.machine.frames(np.array([self.park])).tcp)
        return away

    def tip(self, at: At, u: Unknowns) -> Array:
        """Return where the actual tool's point is from the nominal TCP, and from its ball, (m, 3) m."""
        tip, artefact = at.tip(u) + self.grown(at) if self.growth else at.tip(u), self.artefact
        return tip if artefact is None else tip - artefact.displacements(u, artefact.nearest(at.tcp, self.balls))

    @cached_property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """What its places differ in: the coordinates of its chart, or the axes that move."""
        if self.chart is not None:
            return self.chart.coordinates
        axes = [(self.machine.axes[k], k) for k in self.moves]
        return tuple(Coordinate(*self.span(axis, k), self.raster[k], axis.overrun) for axis, k in axes)

    @property
    def sided(self) -> tuple[int, ...]:
        """The axes that are approached from a side of their own: on a chart the linear ones follow."""
        if len(self.coordinates) == len(self.moves):
            return self.moves
        return tuple(k for k in self.moves if self.machine.axes[k].rotary and self.length is None)

    @property
    def mean_sides(self) -> bool:
        """Whether it reads the mean of coming from both sides along the linear axes, so that their reversal is zero."""
        return self.all_round and self.chart is not None

    def coming(self, approaches: Array) -> Array:
        """Return approaches (m, q) as its coordinates decide them: none of linear axes where sides are evened."""
        return np.where([axis.rotary for axis in self.machine.axes], approaches, 0.0) if self.mean_sides else approaches

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
    def sides(self) -> tuple[int, ...]:
        """The directions from which a moving axis may come, +1 and −1; the usual one first."""
        return {"both": (1, -1), "+": (1,), "-": (-1,)}[self.approach]

    @property
    def rounding(self) -> float:
        """Standard deviation of what the display rounds off, q/√12, m or rad (GUM F.2.2.1)."""
        return self.resolution / math.sqrt(12.0)

    @property
    def scatter(self) -> float:
        """Standard deviation of a reading without what its display rounds off, m or rad."""
        if self.resolution == 0:
            return self.noise
        return max(math.sqrt(max(self.noise**2 - self.rounding**2, 0.0)), FINEST)

    @property
    def coarse(self) -> bool:
        """Whether readings say no more than a step that is coarse beside their scatter."""
        return self.resolution > COARSE * self.scatter

    def span(self, axis: Axis, index: int) -> tuple[float, float]:
        """Return from where to where it can be read along an axis, m or rad: its reach, for feet that stand within."""
        low, high = axis.travel if self.reach is None else self.reach[index]
        half = (self.base or 0.0) / 2 if index in self.moves else 0.0
        return low + half, high - half
