"""Instruments as they stand on a machine: their balls and stations, and the line along which they read.

Every instrument is drawn by what its set-up says, somebody's own as ours.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from axiscal.language.spoken import said
from axiscal.measurement.instrument import model_of
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.present.drawing.scene import Caption, Part, RoundMark, Stroke
from axiscal.present.machine_drawing.standing_machine import Measures, up


class MountedSetup:
    """A set-up on a machine, everything in the room.

    tip : where the tool point is; direction : along which, or about which, the set-up reads
    table : height of the top of the table as it stands, m
    """

    def __init__(self, sizes: Measures, setup: Setup) -> None:
        self.sizes, self.setup = sizes, setup
        self.room, self.tip = sizes.room, sizes.room.tip_now
        self.direction = self.room.direction_on_table(setup.direction)
        foot = self.room.tip * [1, 1, 0] + up(sizes.table)
        self.table = float((self.room.part_motion(self.room.table) @ np.append(foot, 1.0))[2])

    def post(self, at: Array) -> Stroke:
        """Return a post from the table up to a place, (3,) m."""
        return Stroke(np.array([at * [1, 1, 0] + up(self.table), at]), "stone", 3.5)


def instrument_parts(stand: MountedSetup) -> Iterator[Part]:
    """Yield balls and stations on their posts, the ways from stations to the tool, and the line of what is read."""
    s, tip, setup = stand.sizes.whole, stand.tip, stand.setup
    if (artefact := setup.artefact) is not None:
        radius = 0.5 * (artefact.diameter or 0.05 * s)
        for ball, at in zip(artefact.balls, stand.room.on_table(artefact.points), strict=True):
            yield stand.post(at)
            yield RoundMark(at, radius, "gold", 5.0)
            yield Caption(at + up(1.2 * radius), ball.name)
    for station in setup.standing:
        at = stand.room.on_table(np.array(station))[0]
        yield stand.post(at)
        yield Stroke(np.array([at, tip]), "beam", 2.2)
        yield RoundMark(at, 0.03 * s, "gold", 5.0)
    if model_of(setup).directed:
        yield Stroke(tip + 0.14 * s * np.outer([-1.0, 1.0], stand.direction), "beam", 2.2)
    yield RoundMark(tip, 0.018 * s, "beam", 4.0)
    yield Caption(tip, said(setup.title))


def reading_parts(stand: MountedSetup, tips: Array, approaches: Array, colour: str, size: float) -> Iterator[Part]:
    """Yield a dot where each reading is taken, with a tail to the side its one linear axis comes from.

    tips : (n, 3) m, in the room; approaches : (n, q) +1, −1, or 0 where the side does not count
    size : radius of a dot, pixels
    """
    axes, moves = stand.room.machine.axes, stand.setup.moves
    for at, sides in zip(tips, approaches, strict=True):
        if len(moves) == 1 and not axes[moves[0]].rotary and sides[moves[0]]:
            along = stand.room.direction_on_table(axes[moves[0]].direction) * float(sides[moves[0]])
            yield Stroke(np.array([at - 0.045 * stand.sizes.whole * along, at]), colour, 2.4)
        yield RoundMark(at, 0.0, colour, size)
