"""Rows as linear maps L of the tool's deviation d at the poses of a line: row = L d (ISO 230-1, -2).

    positioning   d along the axis, from both sides, less its mean
    scale         slope of the best-fit line of d along the axis
    backlash      mean of d from + less d from −, over the places read from both sides, else over the line
    straightness  d across the axis, less its best-fit line
    pitch ...     rotation of the tool about a direction, less its mean
    squareness    angle between the best-fit lines of both paths, less 90 degrees
    centre, tilt  e of the best fit d ≈ c − T e, T the turn of the tool on the workpiece since the axis stood at zero

e is where the line of a rotary axis lies, and which way it leans, across the axis in the workpiece frame at its zero.
Centre and tilt follow ISO 230-7 and ISO 10791-6; the tilt fits rotations instead of displacements.
A line is where an axis was read, or is to be read, while the others stand still.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import ABOUT, ANGLES, Kind
from axiscal.errors.model import ErrorModel
from axiscal.estimation.accuracy.expanded import reach
from axiscal.estimation.belief import Belief
from axiscal.machine.axis import Axis, letter_direction
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames
from axiscal.measurement.instrument import model_of, values_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered

NOUGHT = 1e-12
"""m or rad: rounding. No error that the machine describes makes such a number."""
_ABOUT = {"pitch": (1, 0, 0), "yaw": (2, 2, 1), "roll": (0, 1, 2)}
"""About which direction an axis along x, y, z pitches, yaws and rolls."""


@dataclass(frozen=True, eq=False)
class Functional:
    """A linear map of deviations of the tool.

    poses, sides : (m, q) where; weights : (k, m, 3) of displacements along, or of rotations about, x, y, z
    angular : it is about rotations
    directions : names of its d numbers with a sign, which are one vector; none of a curve, d = 1
    """

    poses: Array
    sides: Array
    weights: Array
    angular: bool = False
    directions: tuple[str, ...] = ()

    @property
    def dimensions(self) -> int:
        """d: so many numbers are one vector."""
        return len(self.directions) or 1

    def alone(self) -> Iterator[Functional]:
        """Yield the row of each number that has a sign."""
        for number, name in enumerate(self.directions):
            yield replace(self, weights=self.weights[[number]], directions=(name,))

    def row(self, deviations: Array) -> Array:
        """Return the row of deviations (m, 3): (k,), m or rad."""
        row: Array = np.einsum("kmc,mc->k", self.weights, deviations)
        return row

    @remembered
    def rows(self, errors: ErrorModel) -> Array:
        """Return the row as a map of the error coefficients, (k, size)."""
        found = errors.angular_rows if self.angular else errors.rows
        mapped: Array = np.einsum("kmc,mcs->ks", self.weights, found(self.poses, self.sides))
        return mapped

    def spectra(self, errors: ErrorModel, factor: Array) -> Array:
        """Return the variances of each vector along its main directions, (k/d, d).

        factor : F (n, r) of what is not known, of the errors first; the rest of each cell is not known beside
        """
        root = np.hstack([self.rows(errors) @ factor[: errors.size], self._rests(errors)])
        each = root.reshape(-1, self.dimensions, root.shape[1])
        spectra: Array = np.maximum(np.linalg.eigvalsh(each @ each.transpose(0, 2, 1)), 0.0)
        return spectra

    @remembered
    def _rests(self, errors: ErrorModel) -> Array:
        """Return what one standard deviation of the rest of each cell of each term does to the row, (k, cells)."""
        levers = (errors.angular_levers if self.angular else errors.levers)(self.poses)
        ways = errors.effects(levers.transpose(2, 0, 1), self.sides)  # which halve those of reversals
        effects = np.einsum("kmc,ctm->tkm", self.weights, ways)
        parts = [np.zeros((len(self.weights), 0))]
        for term, effect in zip(errors.terms, effects, strict=True):
            if term.rest > 0:
                cells = term.cells(term.coordinates(self.poses))
                parts += [term.rest * effect[:, cells == cell].sum(axis=1)[:, None] for cell in np.unique(cells)]
        return np.hstack(parts)


class SignedSize(NamedTuple):
    """A number of a row with its sign, m or rad.  direction : its name; known : U of it alone"""

    direction: str
    value: float
    known: float


def signed_numbers(functional: Functional, row: Array, errors: ErrorModel, belief: Belief) -> tuple[SignedSize, ...]:
    """Return the numbers of a row that have a sign and that some error makes; none of a curve.

    row : (k,) as estimated
    """
    spectra = [each.spectra(errors, belief.factor) for each in functional.alone()]
    known = [reach(each, belief.degrees) for each in spectra]
    each = zip(functional.directions, row.tolist(), known, strict=False)
    return tuple(SignedSize(*parts) for parts in each if max(map(abs, parts[1:])) > NOUGHT)


def direction_of(kind: Kind, axis: Axis, across: str = "") -> int:
    """Return along, or about, which direction x, y, z a row of an axis looks.  across : the other axis of two"""
    own = letter_direction(axis.letter)
    if kind in ANGLES:
        return _ABOUT[kind][own]
    return letter_direction(across) if across else own


def functional(kind: Kind, lines: Sequence[AxisLine], machine: Machine, ways: Sequence[int]) -> Functional:
    """Return the row of a kind along lines.  ways : the direction that counts on each of them"""
    if kind == "squareness":
        return _squareness(lines, machine, ways)
    if kind in ABOUT:
        return _turning(lines[0], machine, angular=kind == "tilt")
    (line,), (way,) = lines, ways
    found, axis = _ALONG_ONE[kind](line, way), machine.axes[line.axis]
    names = (axis.name,) if len(found.weights) == 1 else ()
    return replace(found, angular=kind in ANGLES or axis.rotary, directions=names)


def _positioning(line: AxisLine, way: int) -> Functional:
    count = 2 * len(line.poses)
    return _two_sided(line, line.poses, np.eye(count) - 1 / count, way)


def _backlash(line: AxisLine, way: int) -> Functional:
    poses = line.poses_at(line.both) if line.both else line.poses
    share = np.full((1, len(poses)), 1 / len(poses))
    return _two_sided(line, poses, np.hstack([share, -share]), way)


def _scale(line: AxisLine, way: int) -> Functional:
    fit: Array = np.asarray(np.linalg.pinv(_ramp(line.positions)), dtype=float)
    return _resting(line.poses, fit[1:], way)


def _straightness(line: AxisLine, way: int) -> Functional:
    ramp = _ramp(line.positions)
    return _resting(line.poses, np.eye(len(ramp)) - ramp @ np.linalg.pinv(ramp), way)


def _angle(line: AxisLine, way: int) -> Functional:
    return _resting(line.poses, np.eye(len(line.poses)) - 1 / len(line.poses), way)


def _squareness(lines: Sequence[AxisLine], machine: Machine, ways: Sequence[int]) -> Functional:
    """Return the slopes of both paths over where the tool goes, added, with the other sign.

    ways : of each line along the other's axis
    """
    weights = list[Array]()
    for line, way, along in zip(lines, ways, reversed(ways), strict=True):
        fit: Array = np.asarray(np.linalg.pinv(_ramp(frames(machine, line.poses).tcp[:, along])), dtype=float)
        weights.append(_towards(-fit[1:], way))
    poses, names = np.vstack([line.poses for line in lines]), "".join(machine.axes[line.axis].name for line in lines)
    return Functional(poses, np.zeros_like(poses), np.concatenate(weights, axis=1), directions=(names,))


def _turning(line: AxisLine, machine: Machine, *, angular: bool) -> Functional:
    """Return e of the best fit d ≈ c − T e across the axis: a number along, or about, each of x, y, z that has one."""
    zero = line.poses_at([0.0])
    turns = frames(machine, line.poses).tool @ frames(machine, zero).tool[0].T
    across = np.linalg.svd(turns.mean(axis=0) - turns[0])[2][:2].T
    columns = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns @ across], axis=2).reshape(-1, 5)
    fit: Array = np.asarray(np.linalg.pinv(columns), dtype=float)[3:]
    weights = -(across @ fit).reshape(3, -1, 3)
    told = np.linalg.norm(across, axis=1) > _SQUARE
    names = tuple(name for name, has in zip("ABC" if angular else "XYZ", told, strict=True) if has)
    return Functional(line.poses, np.zeros_like(line.poses), weights[told], angular, names)


_ALONG_ONE: dict[Kind, Callable[[AxisLine, int], Functional]] = {
    "positioning": _positioning,
    "scale": _scale,
    "backlash": _backlash,
    "straightness": _straightness,
    "pitch": _angle,
    "yaw": _angle,
    "roll": _angle,
}


def _ramp(positions: Array) -> Array:
    """Return the columns of a best-fit line, (n, 2)."""
    return np.stack([np.ones(len(positions)), positions], axis=1)


def _resting(poses: Array, weights: Array, way: int) -> Functional:
    """Return a row for which sides do not count.  weights : (k, m)"""
    return Functional(poses, np.zeros_like(poses), _towards(weights, way))


def _two_sided(line: AxisLine, poses: Array, weights: Array, way: int) -> Functional:
    """Return a row of the deviations from + and, after them, from −.  weights : (k, 2 m)"""
    sides = np.zeros((2 * len(poses), poses.shape[1]))
    sides[: len(poses), line.axis], sides[len(poses) :, line.axis] = 1.0, -1.0
    return Functional(np.vstack([poses, poses]), sides, _towards(weights, way))


def _towards(weights: Array, way: int) -> Array:
    """Return weights (k, m) of one direction as weights of all, (k, m, 3)."""
    wide = np.zeros((*weights.shape, 3))
    wide[:, :, way] = weights
    return wide


PLACES = 41
"""Places of a line: what a spline of a dozen knots does between two of them is below a hundredth of its size."""
_ALONG = 0.999
"""Cosine of 2.5 degrees: a set-up that reads further off a direction of the workpiece reads something else."""
_SAME = 1e-6
"""m or rad: two readings at one place."""
_SQUARE = 1e-6
"""rad: a direction nearer than that to square to a plane has no part in it."""

Seen = tuple[Literal["length", "angle"], int]
"""Whether a set-up reads lengths or angles, and along, or about, which direction x, y, z of the workpiece frame."""


@dataclass(frozen=True, eq=False)
class AxisLine:
    """Where one axis moves alone.

    axis : index of it; poses : (n, q) evenly from one end to the other, m or rad
    setup : the set-up that reads there, "" for none
    plus, minus : places read from either side, m or rad; both : places read from both
    """

    axis: int
    poses: Array
    setup: str = ""
    plus: tuple[float, ...] = ()
    minus: tuple[float, ...] = ()
    both: tuple[float, ...] = ()

    @property
    def positions(self) -> Array:
        """The coordinates of the axis along the line, (n,)."""
        return self.poses[:, self.axis]

    @property
    def read(self) -> int:
        """Number of places read."""
        return len(self.plus) + len(self.minus) - len(self.both)

    def poses_at(self, positions: Sequence[float]) -> Array:
        """Return poses of the line at other positions of the axis, (len, q)."""
        poses = np.tile(self.poses[0], (len(positions), 1))
        poses[:, self.axis] = positions
        return poses


def seen_by(setup: Setup) -> Seen | None:
    """Return what a set-up reads along a line; None where it reads no line, or no direction of the workpiece."""
    several = len(setup.moves) != 1 or values_of(setup) > 1 or setup.base is not None
    if several or setup.chart is not None or setup.balls or setup.length is not None:
        return None
    along = int(np.argmax(np.abs(setup.direction)))
    if abs(setup.direction[along]) < _ALONG or setup.station is not None:
        return None
    return model_of(setup).reads, along


def line_of(setup: Setup, readings: Sequence[Reading], machine: Machine, whole: bool = False) -> AxisLine:
    """Return the line of a set-up that reads one: what was read of it, or may be where that is one place or none.

    whole : as far as it may be read, whatever was
    """
    (axis,) = setup.moves
    mine = [reading for reading in readings if reading.setup == setup.name]
    stands, ends = np.array(setup.park), setup.span(machine.axes[axis], axis)
    if mine:
        at = np.array([reading.pose for reading in mine])
        stands = np.median(at, axis=0)
        if not whole and np.ptp(at[:, axis]) > _SAME:
            ends = float(at[:, axis].min()), float(at[:, axis].max())
    poses = np.tile(stands, (PLACES, 1))
    poses[:, axis] = np.linspace(*ends, PLACES)
    return AxisLine(axis, poses, setup.name, *_places(mine, axis))


def through_the_volume(description: CampaignDescription, axis: int, readings: Sequence[Reading] = ()) -> AxisLine:
    """Return the line along, or about, an axis through the middle of the target's volume.

    Other rotary axes stand at zero where that is inside.  readings : those count that were taken with others moving
    """
    machine, (low, high) = description.machine, np.array(description.target.volume).T
    zero = np.array([each.rotary for each in machine.axes]) & (low <= 0) & (high >= 0)
    poses = np.tile(np.where(zero, 0.0, (low + high) / 2), (PLACES, 1))
    poses[:, axis] = np.linspace(low[axis], high[axis], PLACES)
    moving = {setup.name for setup in description.setups if axis in setup.moves}
    mine = [reading for reading in readings if reading.setup in moving]
    return AxisLine(axis, poses, "", *_places(mine, axis))


def _places(readings: Sequence[Reading], axis: int) -> tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...]]:
    """Return the positions read from +, from − and from both, each once, in rising order."""
    plus, minus = (_once(reading.pose[axis] for reading in readings if reading.approach[axis] == k) for k in (1, -1))
    return plus, minus, tuple(place for place in plus if any(abs(place - other) < _SAME for other in minus))


def _once(positions: Iterable[float]) -> tuple[float, ...]:
    at = sorted(positions)
    return tuple(here for here, before in zip(at, [-np.inf, *at], strict=False) if here - before > _SAME)
