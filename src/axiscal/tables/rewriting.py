"""A part program whose places are moved against the estimated deviation, for controls that take no tables.

A way p(s) is sent as c(s) = p(s) + Δ(c(s)), with Δ what takes the deviation away there. It is cut where one straight
line, or one arc through its ends and middle, would leave c by more than the chord error. Arcs are cut in quarters
first, so that no axis turns round within a piece.

An axis comes from the side towards which the tool last moved along it, by more than the chord error. Where that side
changes, the axis first takes up its reversal on the spot.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from axiscal.estimation.machine_estimate import Estimate
from axiscal.exceptions import TableError
from axiscal.machine.axis import travel_text
from axiscal.machine.kinematics import solved
from axiscal.measurement.readers.text_file import TextFile
from axiscal.numerics import Array
from axiscal.programs.part_program import PartLine, PartMotion, Spot, read_program
from axiscal.units import format_quantity, to_unit
from axiscal_core.machine import Machine

_ROUNDS = 2
"""Of c = p + Δ(c): the second changes it by the deviation times its slope."""
_PARTS = 8
"""Parts of a piece at whose ends it is looked at."""
_HALVINGS = 14
"""A piece is not cut more often: it is shorter than a move of the control then."""
_ARCS = 5
"""Quarters of an arc halved so often are cut as lines."""
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
        self.columns = [names.index(letter) if letter in names else -1 for letter in "XYZ"]
        if max(self.columns) < 0:
            raise TableError(
                'the machine has no axis "{name}"', "Name the linear axes of the machine so", name="X, Y, Z"
            )
        self._shift = np.zeros(3)
        self._shift = self.added(np.zeros((1, 3)), np.zeros((1, 3)))[0]

    def poses(self, places: Array) -> Array:
        """Return the poses (m, q) of places (m, 3) of the program; other axes stand at zero, and X, Y, Z if unknown."""
        poses = np.tile(np.array(self._machine.zero), (len(places), 1))
        at = np.where(np.isnan(places), 0.0, places) + self._origin
        for letter, column in enumerate(self.columns):
            if column >= 0:
                poses[:, column] = at[:, letter]
        return poses

    def added(self, places: Array, sides: Array) -> Array:
        """Return what is added to places (m, 3) that are come to from sides (m, 3), +1, −1, 0, (m, 3) m."""
        poses, ways = self.poses(places), np.zeros((len(places), len(self._machine.axes)))
        for letter, column in enumerate(self.columns):
            if column >= 0:
                ways[:, column] = sides[:, letter]
        sent = [k for k in self.columns if k >= 0]
        rotations = self._machine.frames(poses).rotations
        moves = np.stack([rotations[k] @ np.array(self._machine.axes[k].direction) for k in sent], axis=2)
        added = np.zeros_like(poses)
        for _ in range(_ROUNDS):
            added[:, sent] = -solved(moves, self._estimate.deviation(poses + added, ways))
        return np.stack([added[:, k] if k >= 0 else np.zeros(len(poses)) for k in self.columns], axis=1) - self._shift


class Piece(NamedTuple):
    """A part of a motion, from one share of it to another.  arc : it goes as an arc"""

    motion: int
    first: float
    last: float
    arc: bool


def places_on(motion: PartMotion, shares: Array) -> Array:
    """Return the places of shares (m,) of a motion, (m, 3) m."""
    end, shares = np.array(motion.end), shares[:, None]
    start = np.where(np.isnan(motion.start), end, motion.start)
    straight: Array = start + shares * (end - start)
    if motion.code < 2:
        return straight
    u, v, _ = motion.plane
    first, turn = motion.turn
    radii = [math.dist((p[u], p[v]), (motion.centre[u], motion.centre[v])) for p in (motion.start, motion.end)]
    angle, radius = first + turn * shares[:, 0], radii[0] + (radii[1] - radii[0]) * shares[:, 0]
    straight[:, u] = motion.centre[u] + radius * np.cos(angle)
    straight[:, v] = motion.centre[v] + radius * np.sin(angle)
    return straight


def cut(motions: Sequence[PartMotion], sent: Sent, chord: float) -> list[Piece]:
    """Return the pieces of motions in their order, each within the chord error, m, of where it should go."""
    open_pieces = [piece for number, motion in enumerate(motions) for piece in _begun(number, motion)]
    done, shares = list[Piece](), np.linspace(0.0, 1.0, _PARTS + 1)
    for halved in range(_HALVINGS + 1):
        if not open_pieces:
            break
        looked = [
            places_on(motions[piece.motion], piece.first + shares * (piece.last - piece.first)) for piece in open_pieces
        ]
        flat = np.concatenate(looked)
        each = [flat + sent.added(flat, np.full_like(flat, side)) for side in (1.0, -1.0)]
        ways = np.stack(each).reshape(2, len(open_pieces), _PARTS + 1, 3)
        left = list[Piece]()
        for piece, paths in zip(open_pieces, ways.swapaxes(0, 1), strict=True):
            motion = motions[piece.motion]
            fits = max(_off_arc(path, motion) if piece.arc else _off_line(path) for path in paths) <= chord
            if fits or motion.code == 0 or not motion.known or halved == _HALVINGS:
                done.append(piece)
                continue
            middle, arc = (piece.first + piece.last) / 2, piece.arc and halved < _ARCS
            left += [piece._replace(last=middle, arc=arc), piece._replace(first=middle, arc=arc)]
        open_pieces = left
    return sorted(done)


def _begun(number: int, motion: PartMotion) -> list[Piece]:
    """Return a motion whole, an arc in its quarters."""
    if motion.code < 2:
        return [Piece(number, 0.0, 1.0, arc=False)]
    first, turn = motion.turn
    quarter = math.pi / 2
    low, high = sorted((first, first + turn))
    at = [quarter * k for k in range(math.ceil(low / quarter), math.floor(high / quarter) + 1)]
    shares = sorted({0.0, 1.0, *((angle - first) / turn for angle in at)})
    kept = [share for share in shares if 1e-9 < share < 1 - 1e-9]
    return [Piece(number, a, b, arc=True) for a, b in zip([0.0, *kept], [*kept, 1.0], strict=True)]


def _off_line(path: Array) -> float:
    """Return how far a path (p, 3) leaves the straight line between its ends, m."""
    way = path[-1] - path[0]
    long = float(np.linalg.norm(way))
    if long < _STILL:
        return float(np.max(np.linalg.norm(path - path[0], axis=1)))
    return float(np.max(np.linalg.norm(np.cross(path - path[0], way / long), axis=1)))


def _off_arc(path: Array, motion: PartMotion) -> float:
    """Return how far a path (p, 3) leaves the helix through its ends and middle, m; infinite where there is none."""
    u, v, w = motion.plane
    plane, centre = path[:, [u, v]], _centre(path[[0, _PARTS // 2, -1]][:, [u, v]])
    if centre is None:
        return math.inf
    away = plane - centre
    radii, angles = np.hypot(*away.T), np.unwrap(np.arctan2(away[:, 1], away[:, 0]))
    turned = angles - angles[0]
    if turned[-1] * motion.turn[1] <= 0 or abs(turned[-1]) > 0.75 * math.pi:
        return math.inf
    rise = path[0, w] + (path[-1, w] - path[0, w]) * turned / turned[-1]
    return float(np.max(np.hypot(radii - radii[0], path[:, w] - rise)))


def _centre(three: Array) -> Array | None:
    """Return the centre of the circle through three points (3, 2), None where they are in line."""
    ways = three[1:] - three[0]
    if abs(np.linalg.det(ways)) <= _STILL * float(np.linalg.norm(ways[1])):
        return None
    found: Array = three[0] + np.linalg.solve(ways, np.sum(ways**2, axis=1) / 2)
    return found


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


def rewrite(file: TextFile, unit: Literal["mm", "in"], estimate: Estimate, origin: Spot, chord: float) -> Rewritten:
    """Return a program whose places are moved against the estimated deviation.

    unit : of lengths before G20 or G21; origin : where the machine stands at the program's zero, m; chord : m
    Raises ReadingError at a line with a word that is not known, or that leaves the travel.
    """
    blocks, sent = read_program(file, unit), Sent(estimate, origin)
    moving = [block for block in blocks if block.motion is not None]
    motions = [block.motion for block in moving if block.motion is not None]
    _refuse_outside(file, moving, sent, estimate.machine)
    pieces = cut(motions, sent, chord)
    starts, ends = (
        np.concatenate([places_on(motions[p.motion], np.array([share])) for p, share in each] or [np.zeros((0, 3))])
        for each in ([(p, p.first) for p in pieces], [(p, p.last) for p in pieces])
    )
    sides = _sides(ends + sent.added(ends, np.zeros_like(ends)), chord)
    into, onto = starts + sent.added(starts, sides), ends + sent.added(ends, sides)
    middles = np.stack([places_on(motions[p.motion], np.array([(p.first + p.last) / 2]))[0] for p in pieces])
    through = middles + sent.added(middles, sides)
    writer = _PartWriter(blocks)
    by_motion = dict[int, list[int]]()
    for index, piece in enumerate(pieces):
        by_motion.setdefault(piece.motion, []).append(index)
    lines, number = list[str](), 0
    for block in blocks:
        if block.motion is None:
            lines += writer.passed_on(block)
            continue
        lines += [block.text] if block.text.strip() else []
        for index in by_motion[number]:
            turned = index > 0 and bool(np.any(sides[index] * sides[index - 1] < 0))
            first = into[index] if turned and block.motion.code else None
            lines += writer.moved(block, pieces[index].arc, first, onto[index], through[index])
        lines += [block.after] if block.after else []
        number += 1
    feeds = np.array([motions[p.motion].code > 0 for p in pieces])
    added = (through - middles)[feeds]
    size = float(np.sqrt(np.mean(np.sum(added**2, axis=1)))) if len(added) else 0.0
    return Rewritten(tuple(lines), size, int(feeds.sum()), sum(motion.code > 0 for motion in motions))


def _refuse_outside(file: TextFile, moving: Sequence[PartLine], sent: Sent, machine: Machine) -> None:
    for block in moving:
        assert block.motion is not None
        pose = sent.poses(places_on(block.motion, np.array([0.0, 0.25, 0.5, 0.75, 1.0])))
        for column in (k for k in sent.columns if k >= 0):
            axis, at = machine.axes[column], pose[:, column]
            low, high = axis.travel
            if at.min() < low - _STILL or at.max() > high + _STILL:
                far = format_quantity(float(at.min() if at.min() < low else at.max()), "mm", 7)
                what = "{axis} goes to {far} of the machine, outside the travel"
                remedy = "It goes from {travel}: say by --origin where the program's zero lies"
                told = {"axis": axis.name, "far": far, "travel": travel_text(axis)}
                raise file.fail(what, remedy, block.line, **told)


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

    def __init__(self, blocks: Sequence[PartLine]) -> None:
        self._last: dict[str, str] = {}
        arcs = any(block.motion is not None and block.motion.code > 1 for block in blocks)
        self._counted = iter(["G90 G91.1" if arcs else "G90"])  # how places are counted: once, before the first motion

    def passed_on(self, block: PartLine) -> Iterator[str]:
        """Yield a line that moves nothing, and before the first that does something how places are counted."""
        bare = block.text.strip()
        if bare and bare[0] not in "%(;":
            yield from self._counted
        if any(code in bare for code in ("G28", "G30", "G53", "G20", "G21")):
            self._last.clear()
        yield from filter(None, (block.text, block.after))

    def moved(self, block: PartLine, arc: bool, first: Array | None, end: Array, through: Array) -> Iterator[str]:
        """Yield a piece of a motion: what takes up the reversal, then the way.

        first : where it begins from another side, None where from the same; through : the middle of an arc
        """
        motion = block.motion
        assert motion is not None
        yield from self._counted
        if first is not None and (words := self._words(block, first)):
            yield f"G1 {words}"
        begin = [float(self._last.get(letter, "nan")) for letter in "XYZ"]
        words = self._words(block, end)
        if not arc:
            if words:
                yield f"G{min(motion.code, 1)} {words}"
            return
        stop = np.array([float(self._last[letter]) for letter in "XYZ"])
        yield f"G{motion.code} {words} {self._aside(block, motion, np.array(begin), stop, through)}"

    def _words(self, block: PartLine, place: Array) -> str:
        words = []
        for letter, at in zip("XYZ", place.tolist(), strict=True):
            if math.isnan(at):
                continue
            text = _number(to_unit(at, block.unit), block.unit)
            if self._last.get(letter) != text:
                self._last[letter] = text
                words.append(letter + text)
        return " ".join(words)

    def _aside(self, block: PartLine, motion: PartMotion, begin: Array, end: Array, through: Array) -> str:
        """Return the centre from the start, equally far from both ends as they are written."""
        u, v, _ = motion.plane
        three = np.array([begin[[u, v]], to_unit(through, block.unit)[[u, v]], end[[u, v]]])
        centre = _centre(three)
        assert centre is not None  # as a piece that is one arc has one
        aside = centre - three[0]
        parts = sorted(zip((u, v), aside.tolist(), strict=True))
        return " ".join("IJK"[k] + _number(size, block.unit) for k, size in parts)


def _number(value: float, unit: str) -> str:
    return f"{round(value, _DECIMALS[unit]) + 0.0:.{_DECIMALS[unit]}f}"
