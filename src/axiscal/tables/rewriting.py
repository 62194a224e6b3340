"""A part program whose places are moved against the estimated deviation, for controls that take no tables.

A way p(s) is sent as c(s) = p(s) + Δ(c(s)), with Δ what takes the deviation away there. It is cut where one straight
line would leave c by more than the chord error. Arcs are cut in quarters first, so that no axis turns round within a
piece.

An axis comes from the side towards which the tool last moved along it, by more than the chord error. Where that side
changes, the axis first takes up its reversal on the spot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import travel_text
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.programs.part_program import PartLine, PartMotion, Spot, Unit, read_program
from axiscal.tables.surface import by_linear_axes
from axiscal.units import format_quantity, to_unit

_ROUNDS = 2
"""Of c = p + Δ(c): the second changes it by the deviation times its slope."""
_PARTS = 8
"""Parts of a piece at whose ends it is looked at."""
_HALVINGS = 14
"""A piece is not cut more often: it is shorter than a move of the control then."""
_STILL = 1e-9
"""m: rounding of a way that goes nowhere."""
_DECIMALS = {"mm": 4, "in": 5}
"""Behind the point: a tenth of a micrometre, which is finer than any deviation that is corrected."""


class Sent:
    """Where axes are sent so that the tool is where a program has it.

    origin : where X, Y and Z of the machine stand at the program's zero, m; nothing is added there
    Raises TableError where the machine has no such axis.
    """

    def __init__(self, estimate: Estimate, origin: Spot) -> None:
        self._estimate, self._machine, self._origin = estimate, estimate.machine, np.array(origin)
        names = [axis.name for axis in self._machine.axes]
        self._letters = [k for k, axis in enumerate("XYZ") if axis in names]
        self._axes = [names.index("XYZ"[k]) for k in self._letters]
        if not self._axes:
            what, remedy = 'the machine has no axis "{name}"', "Name the linear axes of the machine so"
            raise TableError(what, remedy, name="X, Y, Z")
        self._taken = by_linear_axes(self._machine, self._axes)
        self._shift = np.zeros(3)
        self._shift = self.added(np.zeros((1, 3)), np.zeros((1, 3)))[0]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) of places (m, 3) of the program; other axes stand at zero, and X, Y, Z if unknown."""
        poses = np.tile(np.array(self._machine.zero), (len(places), 1))
        poses[:, self._axes] = (np.where(np.isnan(places), 0.0, places) + self._origin)[:, self._letters]
        return poses

    def added(self, places: Array, sides: Array) -> Array:
        """Return what is added to places (m, 3) that are come to from sides (m, 3), +1, −1, 0, (m, 3) m."""
        poses, found = self.poses(places), np.zeros_like(places)
        ways, added = np.zeros_like(poses), np.zeros_like(poses)
        ways[:, self._axes] = sides[:, self._letters]
        for _ in range(_ROUNDS):
            added = self._taken(poses, self._estimate.deviation(poses + added, ways))
        found[:, self._letters] = added[:, self._axes]
        return found - self._shift

    def refuse_outside(self, file: TextFile, line: PartLine, motion: PartMotion) -> None:
        """Raise ReadingError where a motion leaves the travel."""
        pose = self.poses(motion.places(np.linspace(0.0, 1.0, 5)))
        for axis, at in ((self._machine.axes[k], pose[:, k]) for k in self._axes):
            low, high = axis.travel
            if at.min() < low - _STILL or at.max() > high + _STILL:
                far = format_quantity(float(at.min() if at.min() < low else at.max()), "mm", 7)
                what = "{axis} goes to {far} of the machine, outside the travel"
                remedy = "It goes from {travel}: say by --origin where the program's zero lies"
                raise file.fail(what, remedy, line.line, axis=axis.name, far=far, travel=travel_text(axis))


class Piece(NamedTuple):
    """A part of a motion, from one share of it to another."""

    motion: int
    first: float
    last: float


def cut(motions: Sequence[PartMotion], sent: Sent, chord: float) -> list[Piece]:
    """Return the pieces of motions in their order, each within the chord error, m, of where it should go."""
    left = [Piece(number, *ends) for number, motion in enumerate(motions) for ends in pairwise(motion.quarters)]
    done, shares = list[Piece](), np.linspace(0.0, 1.0, _PARTS + 1)
    for halved in range(_HALVINGS + 1):
        if not left:
            break
        flat = [motions[piece.motion].places(piece.first + shares * (piece.last - piece.first)) for piece in left]
        looked = np.concatenate(flat)
        each = [looked + sent.added(looked, np.full_like(looked, side)) for side in (1.0, -1.0)]
        off, again = np.max([_off_line(ways.reshape(-1, _PARTS + 1, 3)) for ways in each], axis=0), list[Piece]()
        for piece, far in zip(left, off, strict=True):
            motion, middle = motions[piece.motion], (piece.first + piece.last) / 2
            if far <= chord or motion.rapid or not motion.known or halved == _HALVINGS:
                done.append(piece)
            else:
                again += [piece._replace(last=middle), piece._replace(first=middle)]
        left = again
    return sorted(done)


def _off_line(paths: Array) -> Array:
    """Return how far paths (n, p, 3) leave the straight lines between their ends, (n,) m."""
    off, way = paths - paths[:, :1], paths[:, -1:] - paths[:, :1]
    long = np.linalg.norm(way, axis=2, keepdims=True)
    across = np.where(long < _STILL, off, np.cross(off, way / np.maximum(long, _STILL)))
    return np.asarray(np.linalg.norm(across, axis=2).max(axis=1, initial=0.0))


class Rewritten(NamedTuple):
    """A program as it is sent.

    lines : its text; added : RMS of what is added over its feed motions, m: the deviation as estimated
    pieces, motions : how many feed motions it has, and had
    """

    lines: tuple[str, ...]
    added: float
    pieces: int
    motions: int


def rewrite(file: TextFile, unit: Unit, estimate: Estimate, origin: Spot, chord: float) -> Rewritten:
    """Return a program whose places are moved against the estimated deviation.

    unit : of lengths before G20 or G21; origin : where the machine stands at the program's zero, m; chord : m
    Raises ReadingError at a line with a word that is not known, or that leaves the travel.
    """
    program, sent, motions = read_program(file, unit), Sent(estimate, origin), list[PartMotion]()
    for line in program:
        if line.motion is not None:
            sent.refuse_outside(file, line, line.motion)
            motions.append(line.motion)
    pieces = cut(motions, sent, chord)
    ends = [motions[p.motion].places(np.array([p.first, p.last])) for p in pieces]
    starts, stops = np.array(ends).reshape(-1, 2, 3).swapaxes(0, 1)
    sides = _sides(stops + sent.added(stops, np.zeros_like(stops)), chord)
    into, added = starts + sent.added(starts, sides), sent.added(stops, sides)
    rapid = np.array([motions[p.motion].rapid for p in pieces], dtype=bool)
    turned = np.any(sides * np.vstack([np.zeros(3), sides])[:-1] < 0, axis=1)  # another side than the piece before
    moves = [[*([into[k]] if turned[k] and not rapid[k] else []), stops[k] + added[k]] for k in range(len(pieces))]
    size = float(np.sqrt(np.mean(np.sum(added[~rapid] ** 2, axis=1)))) if not rapid.all() else 0.0
    lines = tuple(_written(program, [(motions[p.motion], each) for p, each in zip(pieces, moves, strict=True)]))
    return Rewritten(lines, size, int((~rapid).sum()), sum(not motion.rapid for motion in motions))


def _sides(places: Array, still: float) -> Array:
    """Return from which side each axis comes to places (m, 3) that are gone to in turn: +1, −1, 0 before it moved."""
    sides, side = np.zeros_like(places), np.zeros(3)
    turning = np.full(3, np.nan)
    for row, place in enumerate(places):
        for k in range(3):
            if math.isnan(turning[k]) or math.isnan(place[k]):
                turning[k] = place[k] if math.isnan(turning[k]) else turning[k]
            elif side[k] and (place[k] - turning[k]) * side[k] >= 0:
                turning[k] = place[k]
            elif abs(place[k] - turning[k]) > still:
                side[k], turning[k] = math.copysign(1.0, place[k] - turning[k]), place[k]
        sides[row] = side
    return sides


def _written(program: Sequence[PartLine], moves: Sequence[tuple[PartMotion, list[Array]]]) -> Iterator[str]:
    """Yield the lines, with the axes that go elsewhere than before; how places are counted before what does something.

    moves : of each motion, in their order, its pieces: where it goes, after what takes up the reversal
    """
    last, counted, left = dict[str, str](), iter(["G90"]), iter(moves)
    motion, places = next(left, (None, list[Array]()))
    for line in program:
        if line.motion is not None or line.text.strip()[:1] not in ("", "%", "(", ";"):
            yield from counted if line.motion is None else ()
        if line.motion is None and any(code in line.text for code in ("G28", "G30", "G53", "G20", "G21")):
            last.clear()
        yield from [line.text] if line.text.strip() or (line.motion is None and line.text) else []
        while line.motion is not None and motion is line.motion:
            yield from counted
            for number, place in enumerate(places, 1):
                decimals, words = _DECIMALS[line.unit], list[str]()
                for letter, at in zip("XYZ", place.tolist(), strict=True):
                    text = f"{round(to_unit(at, line.unit), decimals) + 0.0:.{decimals}f}"
                    if not math.isnan(at) and last.get(letter) != text:
                        words.append(letter + text)
                        last[letter] = text
                rapid = line.motion.rapid and number == len(places)
                yield from [f"G{0 if rapid else 1} {' '.join(words)}"] if words else []
            motion, places = next(left, (None, list[Array]()))
        yield from [line.after] if line.after else []
