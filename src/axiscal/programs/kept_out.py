"""On every way of a program tool, holder and nose stay out of what stands there.

Both ends and the middle of each piece of a way are looked at. The tool is within half of its way from one of both ends:
there it meets by so much sooner what stands in its way. Pieces that are not free by that are halved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from axiscal.document import shown
from axiscal.exceptions import TravelError
from axiscal.language.spoken import said
from axiscal.measurement.bodies import lever
from axiscal.measurement.charts.room import Room
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.programs.scale import AxisScale, ReadingTarget
from axiscal.programs.steps import Move, Step
from axiscal.units import from_unit
from axiscal_core.machine import Machine

_LIMIT = 2e-6
"""m, by which a way may enter a box: angles are written with four decimals, and some controls take three."""
_FIRST = np.radians(2.0)
"""Turn of the first pieces."""
_MOST_TRIED = 20_000
"""Pieces of one way: of time. Only a way that grazes a limit for a long time needs more, and it is not gone."""
_LONGER = 1.001
"""Of an arc than its chords; over two degrees it is far less."""


def free(room: Room, start: Array, stop: Array) -> bool:
    """Return whether the axes can go straight from pose to pose, (q,), and stay out of what is to be kept out."""
    turn = float(np.abs(stop - start)[[axis.rotary for axis in room.machine.axes]].sum())
    edges, longest = np.linspace(0.0, 1.0, 2 + int(turn / _FIRST)), lever(room.machine)
    left, right, tried = edges[:-1], edges[1:], 0
    while len(left):
        tried += len(left)
        middle = (left + right) / 2
        shares = np.concatenate([left, middle, right])
        seen = room.machine.frames(start + shares[:, None] * (stop - start))
        if tried > _MOST_TRIED or room.hit(seen.tcp, seen.stem, -_LIMIT).any():
            return False
        tips, stems = (each.reshape(3, -1, 3) for each in (seen.tcp, seen.stem))
        gone, turned = (np.linalg.norm(np.diff(each, axis=0), axis=2).sum(axis=0) for each in (tips, stems))
        far = _LONGER * (gone + longest * turned) / 2
        met = [room.hit(*each, far - _LIMIT) for each in ((tips[0], stems[0]), (tips[2], stems[2]))]
        found = (far <= _LIMIT) | ~np.any(met, axis=0)
        left, right = np.concatenate([[left, middle], [middle, right]], axis=1)[:, np.tile(~found, 2)]
    return True


def refuse_kept_out(
    machine: Machine, setup: Setup, balls: Mapping[int, int], scales: Sequence[AxisScale], run: Sequence[Step]
) -> None:
    """Raise TravelError for the first way of a program that leads into what stands there.

    balls : by the number of each reading, the one that it touches
    Ways on which it is not known where every axis is, before all of them have been sent somewhere, are not looked at.
    """
    at, around = np.full(len(scales), np.nan), [balls[s.number] for s in run if isinstance(s, ReadingTarget) and balls]
    room = Room.among(machine, setup.artefact, {*around[:1]}, setup.contact != "retracted")
    for place, step in enumerate(run):
        before = at.copy()
        if isinstance(step, ReadingTarget) and balls:  # the tool may come to the balls of the readings around it
            room = Room.among(machine, setup.artefact, {*around[:2]}, setup.contact != "retracted")
            around = around[1:]
        if isinstance(step, Move):
            for axis, value in step.to.items():
                at[axis] = from_unit(float(value), scales[axis].unit)
        known = np.all(np.isfinite(before)) and not np.all(before == at)
        if known and room.occupied and not free(room, before, at):
            reached = next((each for each in run[place:] if isinstance(each, ReadingTarget)), None)
            break
    else:
        return
    way = said("the way from the last reading")
    way = said("the way to reading {number}", number=reached.number) if reached else way
    what = "{way} of the set-up {setup} leads into {artefact}: into a ball, a post, or what is to be kept out"
    remedy = (
        "Say what goes clear before others move (--clearance), read the place from another side, move the artefact, or "
        "correct length, reach, radius and head in [tool]"
    )
    artefact = shown(setup.artefact.name if setup.artefact else "")
    raise TravelError(what, remedy, way=way, setup=shown(setup.name), artefact=artefact)
