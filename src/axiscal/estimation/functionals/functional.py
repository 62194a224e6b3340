"""Rows as linear maps L of the tool's deviation d at the poses of a line: row = L d (ISO 230-1, -2).

    positioning   d along the axis, from both sides, less its mean
    scale         slope of the best-fit line of d along the axis
    backlash      mean of d from + less d from −, over the places read from both sides, else over the line
    straightness  d across the axis, less its best-fit line
    pitch ...     rotation of the tool about a direction, less its mean
    squareness    angle between the best-fit lines of both paths, less 90 degrees
    centre, tilt  e of the best fit d ≈ c − T e, T the turn of the tool on the workpiece since the axis stood at zero

e is where the line of a rotary axis lies, and which way it leans, across the axis.
Centre and tilt follow ISO 230-7 and ISO 10791-6; the tilt fits rotations instead of displacements.
Directions are those of the axis frame, as axes count (`ways_of`), wherever a table stands.
A line is where an axis was read, or is to be read, while the others stand still.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.description.target import ABOUT, ANGLES, Kind
from axiscal.estimation.accuracy.expanded import reach
from axiscal.machine.axis import letter_direction
from axiscal.machine.kinematics import in_frame
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal_core.axes import Axis
from axiscal_core.machine import Machine
from axiscal_core.normal import Normal

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

    def row(self, deviations: Array) -> Array:
        """Return the row of deviations (m, 3): (k,), m or rad."""
        row: Array = np.einsum("kmc,mc->k", self.weights, deviations)
        return row

    @remembered
    def rows(self, errors: Machine) -> Array:
        """Return the row as a map of the error coefficients, (k, size)."""
        rows = errors.rows_at(self.poses, self.sides, self.angular)
        mapped: Array = np.einsum("kmc,mcs->ks", self.weights, rows)
        return mapped

    def spectra(self, errors: Machine, factor: Array) -> Array:
        """Return the variances of each vector along its main directions, (k/d, d).

        factor : F (n, r) of what is not known, of the errors first; the rest of each cell is not known beside
        """
        each = self._unknown(errors, factor).reshape(len(self.weights) // self.dimensions, self.dimensions, -1)
        spectra: Array = np.maximum(np.linalg.eigvalsh(each @ each.transpose(0, 2, 1)), 0.0)
        return spectra

    def signed(self, row: Array, errors: Machine, belief: Normal) -> list[SignedSize]:
        """Return the numbers of a row (k,) that have a sign and that some error makes; none of a curve."""
        roots = self._unknown(errors, belief.factor)[: len(self.directions)]
        known = [reach(np.array([[float(root @ root)]]), belief.degrees) for root in roots]
        each = zip(self.directions, row.tolist(), known, strict=False)
        return [SignedSize(*parts) for parts in each if max(map(abs, parts[1:])) > NOUGHT]

    def _unknown(self, errors: Machine, factor: Array) -> Array:
        """Return what one standard deviation of all that is not known does to the row, (k, r)."""
        return np.hstack([self.rows(errors) @ factor[: errors.size], self._rests(errors)])

    @remembered
    def _rests(self, errors: Machine) -> Array:
        """Return what one standard deviation of the rest of each cell of each term does to the row, (k, cells)."""
        levers = errors.levers(self.poses, self.angular)
        ways = errors.effects(levers.transpose(2, 0, 1), self.sides)  # which halve those of reversals
        effects = np.einsum("kmc,ctm->tkm", self.weights, ways)
        parts = [np.zeros((len(self.weights), 0))]
        for term, effect in zip(errors.terms, effects, strict=True):
            if term.rest > 0:
                cells = term.cells(*term.at(self.poses))
                parts += [term.rest * effect[:, cells == cell].sum(axis=1)[:, None] for cell in np.unique(cells)]
        return np.hstack(parts)


class SignedSize(NamedTuple):
    """A number of a row with its sign, m or rad.  direction : its name; known : U of it alone"""

    direction: str
    value: float
    known: float


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
    axis = machine.axes[line.axis]
    angular = kind in ANGLES or axis.rotary
    poses, sides, weights = _along_one(kind, line)
    names = (axis.name,) if len(weights) == 1 else ()
    towards = weights[:, :, None] * ways_of(machine, line, angular=angular)[way]
    return Functional(poses, sides, towards, angular, names)


def ways_of(machine: Machine, line: AxisLine, *, angular: bool) -> Array:
    """Return the directions in which rows of a line are above zero, in the workpiece frame, a row each, (3, 3).

    Displacements have the directions x, y, z of the axis frame, turned round where an axis counts against ISO 841.
    angular : rotations about them, of which that about a rotary axis itself is turned round likewise
    """
    own, signs = machine.axes[line.axis], np.ones(3)
    for axis in machine.axes if not angular else [own]:
        if axis.rotary == angular and axis.reversed:
            signs[letter_direction(axis.letter)] = -1.0
    return signs[:, None] * in_frame(machine, line.axis, line.poses[0])


def _along_one(kind: Kind, line: AxisLine) -> tuple[Array, Array, Array]:
    """Return poses and sides (m, q) of a row along one direction, and its weights (k, m)."""
    if kind not in ("positioning", "backlash"):
        ramp, alone = _ramp(line.positions), np.eye(len(line.poses))
        fit: Array = np.asarray(np.linalg.pinv(ramp), dtype=float)
        straight = alone - ramp @ fit if kind == "straightness" else alone - 1 / len(alone)
        return line.poses, np.zeros_like(line.poses), fit[1:] if kind == "scale" else straight
    poses = line.poses_at(line.both) if kind == "backlash" and line.both else line.poses
    count, sides = len(poses), np.zeros((2 * len(poses), poses.shape[1]))
    sides[:count, line.axis], sides[count:, line.axis] = 1.0, -1.0
    mean = np.full(2 * count, 0.5 / count)
    weights = np.eye(2 * count) - mean if kind == "positioning" else 2 * mean[None] * sides[:, line.axis]
    return np.vstack([poses, poses]), sides, weights


def _squareness(lines: Sequence[AxisLine], machine: Machine, ways: Sequence[int]) -> Functional:
    """Return the slopes of both paths, added, with the other sign.  ways : of each line along the other's axis"""
    weights = list[Array]()
    for line, way in zip(lines, ways, strict=True):
        fit: Array = np.asarray(np.linalg.pinv(_ramp(line.positions)), dtype=float)
        weights.append(-fit[1:, :, None] * ways_of(machine, line, angular=False)[way])
    poses, names = np.vstack([line.poses for line in lines]), "".join(machine.axes[line.axis].name for line in lines)
    return Functional(poses, np.zeros_like(poses), np.concatenate(weights, axis=1), directions=(names,))


def _turning(line: AxisLine, machine: Machine, *, angular: bool) -> Functional:
    """Return e of the best fit d ≈ c − T e across the axis: a number along, or about, each of x, y, z that has one."""
    zero = line.poses_at([0.0])
    turns = machine.frames(line.poses).tool @ machine.frames(zero).tool[0].T
    across = np.linalg.svd(turns.mean(axis=0) - turns[0])[2][:2].T
    columns = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns @ across], axis=2).reshape(-1, 5)
    fit: Array = np.asarray(np.linalg.pinv(columns), dtype=float)[3:]
    ways = ways_of(machine, line, angular=angular) @ across
    weights = -(ways @ fit).reshape(3, -1, 3)
    told = np.linalg.norm(ways, axis=1) > _SQUARE
    names = tuple(name for name, has in zip("ABC" if angular else "XYZ", told, strict=True) if has)
    return Functional(line.poses, np.zeros_like(line.poses), weights[told], angular, names)


def _ramp(positions: Array) -> Array:
    """Return the columns of a best-fit line, (n, 2)."""
    return np.stack([np.ones(len(positions)), positions], axis=1)


PLACES = 41
"""Places of a line: what a spline of a dozen knots does between two of them is below a hundredth of its size."""
_ALONG = 0.999
"""Cosine of 2.5 degrees: a set-up that reads further off a direction of the axis frame reads something else."""
_SAME = 1e-6
"""m or rad: two readings at one place."""
_SQUARE = 1e-6
"""rad: a direction nearer than that to square to a plane has no part in it."""

Seen = tuple[Literal["length", "angle"], int]
"""Whether a set-up reads lengths or angles, and along, or about, which direction x, y, z of the axis frame."""


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


def seen_by(setup: Setup, machine: Machine, stands: Array) -> Seen | None:
    """Return what a set-up reads along a line; None where it reads no line, or no direction of the axis frame.

    stands : (q,) m or rad, where the other axes stand
    """
    several = len(setup.moves) != 1 or len(setup.names) > 1 or setup.base is not None
    if several or setup.chart is not None or setup.balls or setup.length is not None or setup.station is not None:
        return None
    direction = np.abs(in_frame(machine, setup.moves[0], stands) @ np.array(setup.direction))
    along = int(np.argmax(direction))
    return (setup.reads, along) if direction[along] >= _ALONG else None


def stand_of(setup: Setup, readings: Sequence[Reading]) -> Array:
    """Return the pose in which a set-up was read, (q,) m or rad; where it was not, the one it is parked in."""
    at = [reading.pose for reading in readings if reading.setup == setup.name]
    stands: Array = np.median(np.array(at or [setup.park]), axis=0)
    return stands


def line_of(setup: Setup, readings: Sequence[Reading], machine: Machine, whole: bool = False) -> AxisLine:
    """Return the line of a set-up that reads one: what was read of it, or may be where that is one place or none.

    whole : as far as it may be read, whatever was
    """
    (axis,) = setup.moves
    mine = [reading for reading in readings if reading.setup == setup.name]
    ends, at = setup.span(machine.axes[axis], axis), [reading.pose[axis] for reading in mine]
    if at and not whole and max(at) - min(at) > _SAME:
        ends = min(at), max(at)
    poses = np.tile(stand_of(setup, mine), (PLACES, 1))
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
    each = ({round(r.pose[axis] / _SAME): r.pose[axis] for r in readings if r.approach[axis] == k} for k in (1, -1))
    plus, minus = (dict(sorted(found.items())) for found in each)
    return (*plus.values(),), (*minus.values(),), tuple(at for place, at in plus.items() if place in minus)
