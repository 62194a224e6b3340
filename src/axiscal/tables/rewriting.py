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
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import travel_text
from axiscal.machine.kinematics import solved
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.programs.part_program import PartLine, PartMotion, Spot, Unit, read_program
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
        self.columns = {letter: names.index(axis) for letter, axis in enumerate("XYZ") if axis in names}
        if not self.columns:
            what, remedy = 'the machine has no axis "{name}"', "Name the linear axes of the machine so"
            raise TableError(what, remedy, name="X, Y, Z")
        self._shift = np.zeros(3)
        self._shift = self.added(np.zeros((1, 3)), np.zeros((1, 3)))[0]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) of places (m, 3) of the program; other axes stand at zero, and X, Y, Z if unknown."""
        at = np.where(np.isnan(places), 0.0, places) + self._origin
        return self._spread(at, np.tile(np.array(self._machine.zero), (len(places), 1)))

    def _spread(self, values: Array, over: Array) -> Array:
        over[:, [*self.columns.values()]] = values[:, [*self.columns]]
        return over

    def added(self, places: Array, sides: Array) -> Array:
        """Return what is added to places (m, 3) that are come to from sides (m, 3), +1, −1, 0, (m, 3) m."""
        poses, sent = self.poses(places), [*self.columns.values()]
        ways, added = self._spread(sides, np.zeros_like(poses)), np.zeros_like(poses)
        rotations = self._machine.frames(poses).rotations
        moves = np.stack([rotations[k] @ np.array(self._machine.axes[k].direction) for k in sent], axis=2)
        for _ in range(_ROUNDS):
            added[:, sent] = -solved(moves, self._estimate.deviation(poses + added, ways))
        found = np.zeros_like(places)
        found[:, [*self.columns]] = added[:, sent]
        return found - self._shift

    def refuse_outside(self, file: TextFile, line: PartLine) -> None:
        """Raise ReadingError where a motion leaves the travel."""
        assert line.motion is not None
        pose = self.poses(line.motion.places(np.linspace(0.0, 1.0, 5)))
        for axis, at in ((self._machine.axes[k], pose[:, k]) for k in self.columns.values()):
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


@dataclass(frozen=True, eq=False, slots=True)
class Rewritten:
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
    program, sent = read_program(file, unit), Sent(estimate, origin)
    for line in (line for line in program if line.motion is not None):
        sent.refuse_outside(file, line)
    motions = [line.motion for line in program if line.motion is not None]
    pieces = cut(motions, sent, chord)
    ends = [motions[p.motion].places(np.array([p.first, p.last])) for p in pieces]
    starts, stops = np.array(ends).reshape(-1, 2, 3).swapaxes(0, 1)
    sides = _sides(stops + sent.added(stops, np.zeros_like(stops)), chord)
    into, added = starts + sent.added(starts, sides), sent.added(stops, sides)
    onto, ways = stops + added, np.vstack([np.zeros(3), sides])
    turned = np.any(ways[1:] * ways[:-1] < 0, axis=1)  # another side than that of the piece before
    lines, writer, number = list[str](), _PartWriter(), 0
    for line in program:
        if line.motion is None:
            lines += writer.passed_on(line)
            continue
        lines += [line.text] if line.text.strip() else []
        while number < len(pieces) and motions[pieces[number].motion] is line.motion:
            first = into[number] if turned[number] and not line.motion.rapid else None
            lines += writer.moved(line, first, onto[number])
            number += 1
        lines += [line.after] if line.after else []
    feeds = np.array([not motions[p.motion].rapid for p in pieces], dtype=bool)
    size = float(np.sqrt(np.mean(np.sum(added[feeds] ** 2, axis=1)))) if feeds.any() else 0.0
    return Rewritten(tuple(lines), size, int(feeds.sum()), sum(not motion.rapid for motion in motions))


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


class _PartWriter:
    """Writes lines, with the axes that go elsewhere than before."""

    def __init__(self) -> None:
        self._last: dict[str, str] = {}
        self._counted = iter(["G90"])  # how places are counted: once, before the first motion

    def passed_on(self, line: PartLine) -> Iterator[str]:
        """Yield a line that moves nothing, and before the first that does something how places are counted."""
        bare = line.text.strip()
        if bare and bare[0] not in "%(;":
            yield from self._counted
        if any(code in bare for code in ("G28", "G30", "G53", "G20", "G21")):
            self._last.clear()
        yield from filter(None, (line.text, line.after))

    def moved(self, line: PartLine, first: Array | None, end: Array) -> Iterator[str]:
        """Yield a piece of a motion: what takes up the reversal, then the way.

        first : where it begins from another side, None where from the same
        """
        assert line.motion is not None
        yield from self._counted
        if first is not None and (words := self._words(line, first)):
            yield f"G1 {words}"
        if words := self._words(line, end):
            yield f"G{0 if line.motion.rapid else 1} {words}"

    def _words(self, line: PartLine, place: Array) -> str:
        texts = {}
        for letter, at in zip("XYZ", place.tolist(), strict=True):
            decimals = _DECIMALS[line.unit]
            if not math.isnan(at):
                texts[letter] = f"{round(to_unit(at, line.unit), decimals) + 0.0:.{decimals}f}"
        words = " ".join(letter + text for letter, text in texts.items() if self._last.get(letter) != text)
        self._last |= texts
        return words
