"""A file of the component, read as the component reads it, from the layout of the file and not from the writer."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import TableError
from axiscal.numerics import Array
from axiscal.tables.old_files import OldFile
from axiscal.tables.surface import Mesh
from axiscal.tables.vcomp.applying import AXES, JOINTS, KNOTS, MOTIONS, VcompAxis, VcompFile, fnv1a
from axiscal.units import from_unit

_NUMBER = re.compile(r"-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?")
_LONGEST = 31
"""By the component's source: characters of a word."""
_AXIS = re.compile(r"([A-Z]) ([xyz]) rotary ([01]) side (1|-1) sense (1|-1) joints ([0-8]) (-1|[0-8])")
_KNOTS = re.compile(r"(\d+) cyclic ([01]) reversal ([01]) (\S+)")
_BED = re.compile(r"([2-9]|[1-9]\d) ([2-9]|[1-9]\d)")
_SECONDS = (0.001, 10.0)
"""By the component's source: what a reversal may take, s."""
_AGAIN = "export it again; nothing in it may be changed"


def read(text: str, name: str = "axiscal.vcomp", with_bed: bool = False) -> VcompFile:
    """Return what a file holds; raises TableError with the line where it is none.

    with_bed : of a control that has the height of a bed behind its axes
    """
    lines = _Lines(_numbered(text, name), name)
    lines.exactly("axiscal-vcomp 1")
    campaign, unit = lines.one("campaign"), lines.one("units")
    if unit not in ("mm", "inch"):
        raise lines.refusal("units are mm or inch")
    limit, limit_deg = map(float, lines.numbers(2, "limits"))
    if not (limit > 0 and limit_deg > 0):
        raise lines.refusal("limits are above zero")
    tool = lines.numbers(3, "tool")
    count = lines.one("axes")
    if not (count.isdigit() and 3 <= int(count) <= AXES):
        raise lines.refusal("there are 3 to {most} axes", most=AXES)
    axes = tuple(_axis(lines) for _ in range(int(count)))
    if sum(not axis.rotary for axis in axes) != 3:
        raise lines.refusal("three axes have to be linear")
    _refuse_joints(lines, [joint for axis in axes for joint in axis.joints])
    bed = _bed(lines) if with_bed else None
    before = text.encode().rpartition(b"end ")[0]
    if lines.one("end") != f"{fnv1a(before):08x}":
        raise lines.refusal("the checksum is wrong: the file was changed")
    if next(lines.rest, None) is not None:
        raise lines.refusal("something stands behind the end")
    return VcompFile(campaign, unit, limit, limit_deg, tool, axes, bed)


def read_among(files: Sequence[OldFile], with_bed: bool = False) -> tuple[VcompFile, ...]:
    """Return what those of the files hold that are called .vcomp; raises TableError where none is."""
    own = [file for file in files if file.name.lower().endswith(".vcomp")]
    if not own:
        names = ", ".join(dict.fromkeys(file.name for file in files))
        raise TableError("{names} is no file of the whole correction", "give axiscal.vcomp", names=names)
    return tuple(read(file.text, file.name, with_bed) for file in own)


@dataclass(slots=True)
class _Lines:
    """The lines of a file that are no comment, one after the other."""

    rest: Iterator[tuple[int, str]]
    name: str
    number: int = 0

    def after(self, key: str) -> str:
        """Return what stands behind the key of the next line; an empty key is none."""
        self.number, line = next(self.rest, (self.number + 1, ""))
        word, _, behind = line.partition(" ") if key else ("", "", line)
        if word != key or not behind:
            raise self.refusal("a line {key} is expected" if key else "a line of numbers is expected", key=key)
        return behind

    def exactly(self, line: str) -> None:
        key, _, behind = line.partition(" ")
        if self.after(key) != behind:
            raise self.refusal("this is no file of the form {form}", form=line)

    def one(self, key: str) -> str:
        word = self.after(key)
        if " " in word or len(word) > _LONGEST:
            raise self.refusal("{key} has one word", key=key)
        return word

    def matched(self, key: str, pattern: re.Pattern[str]) -> Sequence[str]:
        found = pattern.fullmatch(self.after(key))
        if found is None:
            raise self.refusal("the line {key} is not in its form", key=key)
        return found.groups()

    def numbers(self, count: int, key: str = "") -> Array:
        words = self.after(key).split(" ")
        if len(words) != count:
            raise self.refusal("{count} numbers are expected", count=count)
        return np.array([self.number_of(word) for word in words])

    def number_of(self, word: str) -> float:
        value = float(word) if _NUMBER.fullmatch(word) and len(word) <= _LONGEST else np.nan
        if not np.isfinite(value):
            raise self.refusal("a word is not a finite number")
        return value

    def refusal(self, what: str, **values: object) -> TableError:
        return TableError(what, _AGAIN, self.name, self.number, **values)


def _numbered(text: str, name: str) -> Iterator[tuple[int, str]]:
    if not text.endswith("\n") or not all(c == "\n" or " " <= c <= "~" for c in text):
        raise TableError("the file is not plain text whose lines end with LF", _AGAIN, name)
    return ((number, line) for number, line in enumerate(text.split("\n")[:-1], 1) if not line.startswith("#"))


def _axis(lines: _Lines) -> VcompAxis:
    name, along, rotary, side, sense, *joints = lines.matched("axis", _AXIS)
    origin, place, tilt = lines.numbers(3, "origin"), lines.numbers(6, "location"), lines.numbers(3, "travel-tilt")
    if rotary == "1" and np.any(tilt):
        raise lines.refusal("a rotary axis has no tilt of its travel")
    count, cyclic, reverses, seconds = lines.matched("knots", _KNOTS)
    if not 2 <= int(count) <= KNOTS:
        raise lines.refusal("an axis has 2 to {most} knots", most=KNOTS)
    time = lines.number_of(seconds)
    if not _SECONDS[0] <= time <= _SECONDS[1]:
        raise lines.refusal("a reversal takes 1 ms to 10 s")
    knots, curves = _curves(lines, int(count), 2 * MOTIONS if reverses == "1" else MOTIONS)
    if cyclic == "1" and not (rotary == "1" and abs(np.ptp(knots) - 360) <= 1e-6):
        raise lines.refusal("a cyclic axis turns by 360 deg")
    return VcompAxis(
        name,
        "xyz".index(along),
        rotary == "1",
        int(side),
        int(sense),
        tuple(int(joint) for joint in joints if joint != "-1"),
        origin,
        place,
        tilt,
        cyclic == "1",
        time,
        knots,
        curves[:, :MOTIONS],
        curves[:, MOTIONS:],
    )


def _curves(lines: _Lines, count: int, curves: int) -> tuple[Array, Array]:
    """Return the knots (n,) and the coefficients (n - 1, curves, 4); the last knot has none."""
    knots, found = np.empty(count), np.empty((count - 1, curves, 4))
    for i in range(count):
        knots[i] = lines.numbers(1, "knot")[0]
        if i and not knots[i] > knots[i - 1]:
            raise lines.refusal("knots do not increase")
        if i < count - 1:
            found[i] = [lines.numbers(4) for _ in range(curves)]
    return knots, found


def _bed(lines: _Lines) -> Mesh:
    wide, deep = (int(count) for count in lines.matched("bed", _BED))
    x, y = lines.numbers(wide), lines.numbers(deep)
    if not (np.all(np.diff(x) > 0) and np.all(np.diff(y) > 0)):
        raise lines.refusal("the places of the bed do not increase")
    return Mesh(*(from_unit(values, "mm") for values in (x, y, np.array([lines.numbers(wide) for _ in range(deep)]))))


def _refuse_joints(lines: _Lines, joints: Sequence[int]) -> None:
    if len(set(joints)) < len(joints):
        raise lines.refusal("a joint number is given twice")
    if sorted(joints) != list(range(len(joints))) or len(joints) > JOINTS:
        raise lines.refusal("joint numbers have a gap")
