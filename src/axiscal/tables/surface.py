"""What a control with tables does to the TCP: over the volume, and as a mesh of heights over the plane.

The mesh has the mean deviation along z at places (x, y), with planes between.

A control is a function from commands to how far beyond them it sends each axis. Whatever its tables look like, that
is all they can do.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from axiscal.errors.volume import EVERY_WAY, Alignment, Box, Counted
from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import iso_axis, letter_direction
from axiscal.machine.kinematics import Deviation, solved, turn_between
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.simulation import VirtualMachine
from axiscal.numerics import Array
from axiscal.numerics.remembered import remembered
from axiscal.tables.sampling import cross_tables, hats_along
from axiscal.tables.table import between
from axiscal.units import format_quantity
from axiscal_core.machine import Machine
from axiscal_core.splines import gauss

Field = Callable[[Array, Array], Array]
"""(poses (m, q), approaches (m, q)) -> TCP deviation (m, 3), m."""

Control = Callable[[Array, Array], Array]
"""(commands (m, q), approaches (m, q)) -> what is added to the command of each axis, (m, q), m or rad."""

_HELD = 0.9
"""Share from which a plane counts as held: a mesh of straight lines leaves some of a bend."""


class Effect(NamedTuple):
    """RMS of the TCP deviation over the volume, m, before and after the tables, less what no one counts (`rms`)."""

    before: float
    after: float


def effect_of_control(
    machine: Machine,
    deviation: Field,
    control: Control,
    poses: Array,
    box: Box,
    alignment: Alignment | None = None,
    counted: Counted = EVERY_WAY,
) -> Effect:
    """Return what a control leaves of a deviation.

    poses : (m, q) spread over the volume; each is approached from alternating directions
    alignment : what probing the part takes off; counted : the directions in which deviations count
    The axes go to where the control sends them, and the machine deviates there.
    """
    inside, approaches = tour(poses, box)
    found, left = deviation(inside, approaches), left_by(machine, deviation, control, inside, approaches)
    if alignment is not None:
        found, left = (alignment.left(inside, each) for each in (found, left))
    return Effect(rms(found, counted), rms(left, counted))


def tour(poses: Array, box: Box) -> tuple[Array, Array]:
    """Return the poses inside the box, and alternating directions from which they are approached."""
    inside = np.clip(poses, *np.array(box).T)
    approaches = np.where(np.arange(len(poses))[:, None] % 2 == 0, 1.0, -1.0) * np.ones_like(poses)
    return inside, approaches


def left_by(machine: Machine, deviation: Field, control: Control, poses: Array, approaches: Array) -> Array:
    """Return the TCP deviation (m, 3) that is left when the control sends the axes elsewhere."""
    sent = poses + control(poses, approaches)
    shifted: Array = machine.frames(sent).tcp - machine.frames(poses).tcp
    return shifted + deviation(sent, approaches)


def turned_by(machine: Machine, rotation: Field, control: Control, poses: Array, approaches: Array) -> Array:
    """Return the rotation of the tool (m, 3) that is left when the control sends the axes elsewhere, rad."""
    sent = poses + control(poses, approaches)
    turned: Array = turn_between(machine.frames(poses).tool, machine.frames(sent).tool)
    return turned + rotation(sent, approaches)


def spanning_axes(machine: Machine, fewest: int) -> list[int]:
    """Return the linear axes; raises TableError where there are not so many, or two along one direction."""
    linear = [k for k, axis in enumerate(machine.axes) if not axis.rotary]
    if not fewest <= len({letter_direction(machine.axes[k].letter) for k in linear}) == len(linear):
        what = "the linear axes of the machine are {names}"
        remedy = "volumetric compensation needs {fewest} and more, each along x, y or z, and no two along one"
        names = ", ".join(machine.axes[k].name for k in linear)
        raise TableError(what, remedy, names=names, fewest=fewest)
    return linear


def by_linear_axes(machine: Machine, linear: list[int]) -> Callable[[Array, Array], Array]:
    """Return what takes TCP deviations (m, 3) at poses (m, q) away by some linear axes alone, (m, q), m.

    [u_x u_y u_z] Δ = -δp, as near as two axes come to it
    """

    def added(poses: Array, deviation: Array) -> Array:
        rotations = machine.frames(poses).rotations
        moves = np.stack([rotations[k] @ np.array(machine.axes[k].direction) for k in linear], axis=2)
        found = np.zeros_like(poses)
        found[:, linear] = -solved(moves, deviation)
        return found

    return added


def rms(deviation: Array, counted: Counted = EVERY_WAY) -> float:
    """Return the RMS of TCP deviations (m, 3), their constant part taken off, m: that is the workpiece's zero.

    counted : the directions in which they count
    """
    centred = (deviation - deviation.mean(axis=0))[:, list(counted)]
    return float(np.sqrt(np.mean(np.sum(centred**2, axis=1))))


def planes_left(estimate: Estimate, control: Control, poses: Array, approaches: Array) -> str:
    """Return in a sentence what files leave of errors of two axes; empty where they hold them, or there are none.

    poses, approaches : (m, q) spread over the volume
    """
    errors = estimate.model
    if not errors.planes:
        return ""
    levers = errors.levers(poses)
    levers[: len(errors.curves)] = 0.0
    own = (errors.along(levers.transpose(2, 0, 1), poses, approaches) @ estimate.mean).T
    shape = own - own.mean(axis=0)
    found = left_by(estimate.machine, estimate.deviation, control, poses, approaches)
    held = 1.0 - float(np.sum(shape * found) / max(np.sum(shape**2), np.finfo(float).tiny))
    if held > _HELD:
        return ""
    names = ", ".join(plane.name for plane in errors.planes)
    size = format_quantity(rms(own), "um", 3)
    most = "" if held < 1 - _HELD else " Part of it is held."
    return f"what two axes do together ({names}: {size} RMS over the volume): no table over one axis holds it.{most}"


@dataclass(frozen=True, eq=False, slots=True)
class CommandedMachine(VirtualMachine):
    """The machine as an instrument sees it that knows the commands only.  control : what is added to them"""

    control: Control = field(kw_only=True)

    @classmethod
    def behind(cls, truth: VirtualMachine, control: Control) -> CommandedMachine:
        """Return the machine of a truth behind a control."""
        return cls(truth.model, truth.curves, truth.offsets, truth.drifts, control=control)

    def does(self, poses: Array, approaches: Array) -> Deviation:
        """Return how the tool deviates from commands (m, q)."""
        sent = poses + self.control(poses, approaches)
        straight, turned = VirtualMachine.does(self, sent, approaches)
        nominal, reached = (self.model.frames(each) for each in (poses, sent))
        return Deviation(reached.tcp - nominal.tcp + straight, turn_between(nominal.tool, reached.tool) + turned)


_GAUSS = 6
"""Points of Gauss: exact for degree 11, and the products of hats, cubics and levers have fewer."""
_FEWEST, _FINEST = 5, 50
"""Points a side where the options say none: fewer show no bend, more take a printer's probe too long."""
_SAMPLE = 5
"""Places a side at which is looked whether a surface is worth a mesh: it bends a few times at most."""


@dataclass(frozen=True, eq=False, slots=True)
class Mesh:
    """Heights added to z, m.  x : (n,), y : (k,) m, increasing; added : (k, n), rows along y."""

    x: Array
    y: Array
    added: Array

    def at(self, x: Array, y: Array) -> Array:
        """Return what is added at places (m,): bilinear between the points, constant outside."""
        (columns, u), (rows, v) = between(self.x, x), between(self.y, y)
        u, v = np.clip(u, 0, 1), np.clip(v, 0, 1)
        low = (1 - u) * self.added[rows, columns] + u * self.added[rows, columns + 1]
        high = (1 - u) * self.added[rows + 1, columns] + u * self.added[rows + 1, columns + 1]
        return (1 - v) * low + v * high

    def zeroed(self, x: float, y: float) -> Mesh:
        """Return the mesh that adds nothing at a place, m."""
        return replace(self, added=self.added - self.at(np.array([x]), np.array([y])))


def mesh_of_nodes(nodes: Sequence[RawReading]) -> Mesh:
    """Return the mesh of readings at nodes of a grid; where there is none their plane, as RepRapFirmware has it."""
    (x, columns), (y, rows) = (np.unique([node.position[a] for node in nodes], return_inverse=True) for a in "XY")
    tilt = np.column_stack([x[columns], y[rows], np.ones(len(nodes))])
    a, b, c = np.linalg.lstsq(tilt, np.array([-node.value for node in nodes]))[0]
    added = a * x[None, :] + b * y[:, None] + c
    added[rows, columns] = [-node.value for node in nodes]
    return Mesh(x, y, added)


def plane_axes(machine: Machine) -> tuple[int, int, int]:
    """Return where X, Y and Z stand in a pose; raises TableError for a machine that is more, or less, than these."""
    names = sorted(axis.name for axis in machine.axes)
    if names != ["X", "Y", "Z"]:
        raise TableError("the machine has axes {names}", "this control is for X, Y and Z", names=", ".join(names))
    x, y, z = (machine.index(name) for name in "XYZ")
    return x, y, z


def with_height(estimate: Estimate) -> Estimate:
    """Return the estimate of a machine that has Z as well, without errors, where it has X and Y only.

    A plane whose height was read needs no Z in its description, and a mesh moves one.
    """
    machine = estimate.machine
    if sorted(axis.name for axis in machine.axes) != ["X", "Y"]:
        return estimate
    upright = iso_axis("Z", False, (0.0, 1e-3))
    taller = replace(machine, axes=(*machine.axes, upright))
    return Estimate(taller, estimate.belief, (*estimate.box, (0.0, 0.0)), estimate.grid)


def height_seen(estimate: Estimate) -> bool:
    """Return whether the readings say anything of the height over the plane."""
    x, y, _ = plane_axes(estimate.machine)
    places = [np.linspace(*estimate.box[axis], _SAMPLE) for axis in (x, y)]
    poses = np.tile(np.mean(estimate.box, axis=1), (_SAMPLE**2, 1))
    poses[:, x], poses[:, y] = (grid.ravel() for grid in np.meshgrid(*places))
    rows = estimate.model.along(estimate.model.levers(poses)[:, :, 2], poses, np.zeros_like(poses))
    return estimate.sees(rows)


@remembered
def mesh_of(estimate: Estimate, count: int | None = None) -> Mesh:
    """Return the mesh that is nearest to minus the mean deviation along z, over the volume.

    count : of points along each side, over the travel; None takes the map that was read, or as many as the curves have
    """
    (x, y, z), places = plane_axes(estimate.machine), estimate.grid
    if count is not None or places is None:
        knots = [max((len(each) for each in estimate.model.knots_along(axis)), default=0) for axis in (x, y)]
        travels = zip((x, y), [count or min(max(each, _FEWEST), _FINEST) for each in knots], strict=True)
        across, along = (np.linspace(*estimate.machine.axes[k].travel, n) for k, n in travels)
        places = across, along
    sides = [hats_along(estimate, axis, at) for axis, at in zip((x, y), places, strict=True)]
    heights, weights = np.array(estimate.box[z][:1]), np.ones(1)
    if np.ptp(estimate.box[z]):
        heights, weights = (each.ravel() for each in gauss(np.array(estimate.box[z]), _GAUSS))
    found = np.empty((len(sides[1].nodes), len(sides[0].nodes)))
    poses = np.empty((len(heights), len(sides[0].nodes), 3))
    for row, place in zip(found, sides[1].nodes, strict=True):  # the mean over the heights, at the nodes
        poses[..., x], poses[..., y], poses[..., z] = sides[0].nodes, place, heights[:, None]
        at = poses.reshape(-1, 3)
        seen = estimate.model.along(estimate.model.levers(at)[:, :, 2], at, np.zeros_like(at)) @ estimate.mean
        row[:] = weights / weights.sum() @ seen.reshape(len(heights), -1)
    return Mesh(sides[0].points, sides[1].points, -sides[0].best(sides[1].best(found).T).T)


def remainder(whole: Control, part: Control) -> Control:
    """Return the control that does what the whole does, less a part of it."""
    return lambda poses, approaches: whole(poses, approaches) - part(poses, approaches)


PLANES = ("XY", "XZ", "YZ")
Skew = Mapping[str, float]
"""Tangents by plane: by which Y leans towards X, Z towards X, and Z towards Y; none where no reading has seen it."""


def skew_of(estimate: Estimate) -> Skew:
    """Return the slopes that are nearest to the mean deviation along x over y and z, and along y over z.

    A plane that no reading has seen has none: a zero would take away what the control holds already.
    """
    tables, slopes = {table.axis + table.over: table for table in cross_tables(estimate)}, dict[str, float]()
    for plane in (plane for plane in PLANES if plane in tables):
        at = np.linspace(*estimate.box[estimate.machine.index(plane[1])], 1001)
        line = np.polynomial.polynomial.polyfit(at - at.mean(), tables[plane].deviation(at, 0), 1)
        slopes[plane] = float(line[1])
    return slopes
