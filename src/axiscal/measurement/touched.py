"""A sphere touched from all sides, one linear way after the other, and the centre that its touches show.

The cycle: the pole from above, four sides at the equator, the pole again. Rotary axes stand. The reading is the stated
place of the sphere less the found one, y = b − p. The tip is at p + δp when the control says that it is at p.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import DescriptionError, ReadingError
from axiscal.machine.kinematics import linear_axes, tip_at
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.units import format_quantity, from_unit
from axiscal_core.machine import Machine

_KINDRED = 1e-6
"""Sines nearer than this are alike: the first one is taken."""
_RESERVE = 0.5
"""A coordinate of the workpiece is taken for an axis only where that has a sine less by so much: it is 0.8 at least."""

TOUCHES = 6
"""In a cycle."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """How a sphere is touched; m and m/s.

    radius : of sphere and stylus together; clear : off its surface where a touch begins; past : how far beyond its
        surface a touch goes before it finds nothing; back : off it before the slow touch; fast, slow : speeds
    """

    radius: float
    clear: float = 4e-3
    past: float = 4e-3
    back: float = 0.3e-3
    fast: float = float(from_unit(300.0, "mm/min"))
    slow: float = float(from_unit(60.0, "mm/min"))


@dataclass(frozen=True, eq=False, slots=True)
class SideTouch:
    """One side touched, in poses (q,).

    way : over what it is come to
    beside : where the touch begins; into : where it ends if nothing is met; back : (q,) off the surface, a step
    """

    way: tuple[Array, ...]
    beside: Array
    into: Array
    back: Array


@dataclass(frozen=True, slots=True)
class Sphere:
    """The sphere that touches show, in the unit of the hits.

    centre : where it is; radius : by its sides; apart : how far the pole was from itself when it was touched again
    """

    centre: tuple[float, float, float]
    radius: float
    apart: float


def cycle_of(machine: Machine, setup: Setup) -> Cycle:
    """Return how the spheres of a set-up are touched from all sides.

    Raises DescriptionError where nobody says how large they are.
    """
    if setup.artefact is None or setup.artefact.diameter is None:
        what = "nobody says how large each ball of {artefact} is, and it is to be touched"
        what = what if setup.artefact else "nobody says how large the sphere is, and it is to be touched"
        remedy = 'Give it under [[artefacts]], as in diameter = "25 mm"'
        raise DescriptionError(what, remedy, artefact=shown(setup.artefact.name if setup.artefact else ""))
    if machine.nose.stylus <= 0:
        what = "nobody says how large the ball of the stylus is, and it is to touch spheres"
        raise DescriptionError(what, 'Give it in machine.toml under [tool], as in stylus = "6 mm"')
    return Cycle((setup.artefact.diameter + machine.nose.stylus) / 2)


def stated(setup: Setup, machine: Machine, pose: Array) -> Array:
    """Return where the ball that the tip is at in a pose (q,) is said to stand, (3,) m, workpiece frame."""
    tip = machine.frames(pose[None]).tcp
    place: Array = (
        tip[0] if setup.artefact is None else setup.artefact.points[setup.artefact.nearest(tip, setup.balls)[0]]
    )
    return place


ALL_ROUND = np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1)], dtype=np.float64)
"""From where a sphere is met, in its touch frame: the pole, four sides across the stem, the pole again."""


def touches(machine: Machine, pose: Array, cycle: Cycle) -> tuple[SideTouch, ...]:
    """Return the touches of the sphere that the tip is at in a pose (q,); NaN where the linear axes do not reach."""
    centre, frame = machine.frames(pose[None]).tcp[0], touch_frames(machine, pose[None])[0]
    found = []
    for side in ALL_ROUND:
        stops = centre + _stops(cycle, side) @ frame
        *way, beside, into, backed = tip_at(machine, np.tile(pose, (len(stops), 1)), stops)
        found.append(SideTouch(tuple(way), beside, into, backed - beside))
    return tuple(found)


def gone_to(machine: Machine, cycle: Cycle, poses: Array) -> Array:
    """Return where the axes go as they touch spheres, (stops, m, q), each once; NaN where they do not reach.

    poses : (m, q) with the tip at the centres.  The axes follow the tip evenly: p + e leads to t + J⁻¹ e.
    """
    stops = np.unique(np.concatenate([_stops(cycle, side) for side in ALL_ROUND]), axis=0)
    at = machine.frames(poses).tcp
    ways = [tip_at(machine, poses, at + way) - poses for way in np.swapaxes(touch_frames(machine, poses), 0, 1)]
    return poses + np.tensordot(stops, np.array(ways), axes=1)


def _stops(cycle: Cycle, side: Array) -> Array:
    """Return the stops of a touch from the centre, (k, 3) m, touch frame: its way, beside, into, and off again."""
    off = cycle.radius + cycle.clear
    top = np.array([0.0, 0.0, off])
    way = [top] if side[2] else [top, top + off * side]
    return np.array([*way, off * side, (cycle.radius - cycle.past) * side, (off + cycle.back) * side])


def met_from(machine: Machine, pose: Array) -> Array:
    """Return from where a cycle meets the sphere, (6, 3) unit vectors, workpiece frame.  pose : (q,)"""
    met: Array = ALL_ROUND @ touch_frames(machine, pose[None])[0] + 0.0
    return met


def centred(hits: Array, sides: Array, radius: float) -> Sphere:
    """Return the sphere of a known radius that is nearest to where it was hit, (m, 3) (Gauss-Newton).

    sides : (m, 3) unit vectors, from where it was met
    """
    centre = hits.mean(axis=0) - radius * sides.mean(axis=0)
    for _ in range(10):
        spokes = hits - centre
        lengths = np.linalg.norm(spokes, axis=1)
        centre += np.linalg.lstsq(spokes / lengths[:, None], lengths - radius, rcond=None)[0]
    around = np.linalg.norm(hits[1:-1] - centre, axis=1)
    x, y, z = centre.tolist()
    return Sphere((x, y, z), float(around.mean()), float(np.linalg.norm(hits[-1] - hits[0])))


_OTHER = 0.2e-3
"""m: a stylus gives way by less, and no two sizes of balls that are sold are so near each other."""
_LOOSE = 0.05e-3
"""m, of the pole touched twice: a ball or a stylus that is fixed comes back within less."""
_AFAR = 0.01
"""m from where the cycle looks for it: nothing that it touches is there."""


def found(machine: Machine, setup: Setup, pose: Array, hits: Sequence[Array], met: Array) -> Sphere:
    """Return the sphere of a cycle, workpiece frame, m.

    hits : poses (q,) in which it was met, one for each touch; met : (6, 3) unit vectors, from where
    Raises ReadingError where the touches are not those of a sphere of this size near its stated place.
    """
    cycle, at = cycle_of(machine, setup), stated(setup, machine, pose)
    tips = machine.frames(np.array(hits)).tcp
    off = tips - (at + cycle.radius * met)
    if (far := np.linalg.norm(off, axis=1)).max() > _AFAR:
        x, y, z = (format_quantity(each, "mm", 4) for each in off[far.argmax()].tolist())
        what = "touch {touch} met something {x}, {y}, {z} along x, y, z from where the ball is stated"
        remedy = "Look whether coordinates are the machine's, without tool length and offsets, and the plan is this one"
        raise ReadingError(what, remedy, touch=far.argmax() + 1, x=x, y=y, z=z)
    sphere = centred(tips, met, cycle.radius)
    if abs(sphere.radius - cycle.radius) > _OTHER:
        seen, said = (format_quantity(each, "mm", 5) for each in (sphere.radius, cycle.radius))
        what = "the four sides show a radius of {seen}, and ball and stylus make {stated}"
        remedy = "Look at the diameters of ball and stylus, or whether it slips"
        raise ReadingError(what, remedy, seen=seen, stated=said)
    if sphere.apart > _LOOSE:
        apart = format_quantity(sphere.apart, "um", 3)
        what = "the pole, touched first and last, was {apart} from itself"
        raise ReadingError(what, "Look whether ball and stylus are fixed, and touch it again", apart=apart)
    return sphere


def read_as(
    machine: Machine, setup: Setup, pose: Array, hits: Sequence[Array], met: Array
) -> tuple[float, float, float]:
    """Return the three values of a reading, m, by the touches of its cycle.  Raises ReadingError as `found` does."""
    x, y, z = (stated(setup, machine, pose) - np.array(found(machine, setup, pose, hits, met).centre)).tolist()
    return x, y, z


def off_ball(machine: Machine, setup: Setup, pose: Array, met: Sequence[float]) -> list[float]:
    """Return how far the tool point is off the ball of a pose (q,), (3,) m, workpiece frame.

    met : X, Y, Z of the machine where a control found the ball, m. Raises ReadingError where there is none.
    """
    if setup.artefact is None:
        what = 'found_x, found_y and found_z are where a ball was found, and "{setup}" reads none'
        raise ReadingError(
            what, "Name an artefact in the set-up, or give value_x, value_y and value_z", setup=setup.name
        )
    names = [machine.axes[k].name for k in linear_axes(machine)]
    if sorted(names) != ["X", "Y", "Z"]:
        what = "found_x, found_y and found_z are places of X, Y and Z, and the linear axes are {names}"
        raise ReadingError(what, "Give value_x, value_y and value_z", names=", ".join(names))
    at = pose.copy()
    at[[machine.index(name) for name in "XYZ"]] = met
    off: list[float] = (stated(setup, machine, pose) - machine.frames(at[None]).tcp[0]).tolist()
    return off


def touch_frames(machine: Machine, poses: Array) -> Array:
    """Return where a sphere is met, (m, 3, 3): unit vectors of its first side, its second side and its pole.

    poses : (m, q).  The pole is towards the spindle, the first side where the linear axis goes that is most across it;
    where none goes across it, the coordinate of the workpiece that does.
    """
    at, every = machine.frames(poses), np.arange(len(poses))
    axes = [at.rotations[k] @ np.array(machine.axes[k].direction) for k in linear_axes(machine)]
    ways = np.stack([*axes, *np.broadcast_to(np.eye(3)[:, None], (3, len(poses), 3))], axis=1)
    level = ways - np.sum(ways * at.stem[:, None], axis=2)[:, :, None] * at.stem[:, None]
    across = np.linalg.norm(level, axis=2)
    preferred = across - np.where(np.arange(ways.shape[1]) < len(axes), 0.0, _RESERVE)
    chosen = np.argmax(preferred > preferred.max(axis=1)[:, None] - _KINDRED, axis=1)
    first = level[every, chosen] / across[every, chosen][:, None]
    return np.stack([first, np.cross(at.stem, first), at.stem], axis=1) + 0.0
