"""Heights as probing programs of routers and mills write them: points X Y Z, and maps of Candle and OpenCNCPilot.

A list has one point a line, by blanks, tabs, commas or semicolons. That of bCNC begins with its two sides and the
depth; LinuxCNC (`smartprobe.ngc`) writes all nine axes; grbl answers `[PRB:X,Y,Z:1]` to each touch.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from axiscal.document.file import number_or_none
from axiscal.language.spoken import said
from axiscal.measurement.readers.bed_map import Rows, grid, height, points_of, probed_of, telling
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading
from axiscal.measurement.readers.text_file import TextFile

_SLACK = 1e-6
"""m, of rounding."""
_REMARK = re.compile(r"\s*(?:[#%(;]|//|$)")
_UNIT, _FINER = r"[ _]?[\[(]?(?:mm|in|inch)[\])]?|", r"[ _]?[\[(]?[uµμ]m[\])]?"
_NAMED = r"(?P<named>[^\s,;]+[\s,;]+)?"
_HEAD = re.compile(
    rf"\s*{_NAMED}X(?P<unit>{_UNIT})[\s,;]+Y(?P=unit)[\s,;]+d?Z(?:(?P<height>{_FINER})|(?P=unit))\s*", re.IGNORECASE
)
"""Above a list: the columns, the first of which may name the points; heights may have a unit of their own."""
_NAME = re.compile(r"^\s*[^\s,]+[\s,]+")
_LETTERS = re.compile("".join(rf"\s*{axis}\s*[:=]?\s*([-+.,\d]+)[\s,;]*" for axis in "XYZ"), re.IGNORECASE)
"""A point with its letters: `X20 Y20 Z0.1`."""
_BRACKETS = re.compile(r"[\W_]")
_NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_COUNT = re.compile(r"\d{1,4}")
_XML = re.compile(r"<heightmap\b([^>]*)>")
_POINT = re.compile(r'<point\s+X="(\d{1,4})"\s+Y="(\d{1,4})"\s*>([^<]*)</point>')
_ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
_OF_XML = {"MinX": "min_x", "MaxX": "max_x", "MinY": "min_y", "MaxY": "max_y", "SizeX": "x_count", "SizeY": "y_count"}
_WHOLE = "copy the whole file"
_TOUCH = re.compile(r"(?:\[PRB:([^,\]]+),([^,\]]+),([^,:\]]+)(?:,-?0\.?0*(?=[,:]))*:1]|(?=\[PRB:(?![^][]*:0])))(.*)")
"""The answer of grbl to G38.2, other axes at 0. One with :0 met nothing. Of a broken answer all is the rest."""

is_grbl = telling(re.compile(r"\[PRB:"))
"""Whether a line is such an answer."""


def is_list(file: TextFile) -> bool:
    """Return whether the first line is a point: three numbers, or nine of LinuxCNC; X Y Z may stand above."""
    first = next((line for _, line in _lines(file)), "")
    return len(cells := _numbers(first, _named(file))) in (3, 9) and all(map(_NUMBER.fullmatch, cells))


def is_bcnc(file: TextFile) -> bool:
    """Return whether the first lines are two sides, from, to and how many, and a depth, and then an empty line."""
    if len(file.lines) < 4 or file.lines[3].strip():
        return False
    sides = [line.split() for line in file.lines[:3]]
    return [len(side) for side in sides] == [3, 3, 3] and all(_COUNT.fullmatch(side[2]) for side in sides[:2])


def is_candle(file: TextFile) -> bool:
    """Return whether the first lines are four, four and three numbers between semicolons."""
    head = [line.split(";") for line in file.lines[:3]]
    numbers = all(number_or_none(cell) is not None for line in head for cell in line)
    return [len(line) for line in head] == [4, 4, 3] and numbers


def is_xml(file: TextFile) -> bool:
    """Return whether there is an element `heightmap`."""
    return any(_XML.search(line) for line in file.lines[:10])


def listed(file: TextFile, around: Around) -> Found:
    """Return the readings of a list; raises ReadingError.  Axes beside X, Y and Z that are not at 0 are named."""
    heads = [(number, head) for number, line in enumerate(file.lines, 1) if (head := _HEAD.fullmatch(line))]
    heights = file
    for number, head in heads[:1]:
        if file.unit and (head["unit"] or head["height"]):
            raise file.fail("the header names its unit, and --unit names another", "leave --unit out", number)
        units = (each or file.unit for each in (head["unit"], head["height"] or head["unit"]))
        file, heights = (replace(file, unit=_BRACKETS.sub("", each).lower()) for each in units)
    return _noted(file, _points(file, list(_lines(file)), _named(file), heights))


def grbl(file: TextFile, around: Around) -> Found:
    """Return the readings of touches in the log of a sender; raises ReadingError."""
    return _noted(file, points_of(file, _TOUCH))


def bcnc(file: TextFile, around: Around) -> Found:
    """Return the readings of a list whose sides stand above it; raises ReadingError."""
    found = _points(file, [(number, line) for number, line in _lines(file) if number > 3])
    (low_x, high_x, wide), (low_y, high_y, high) = (line.split() for line in file.lines[:2])
    if found.cells != int(wide) * int(high):
        what = "{count} points are announced, and there are {points}"
        raise file.fail(what, _WHOLE, 1, count=int(wide) * int(high), points=found.cells)
    for axis, low, top in (("X", low_x, high_x), ("Y", low_y, high_y)):
        ends = file.length(low, "side", 1) - _SLACK, file.length(top, "side", 1) + _SLACK
        if off := [each for each in found.readings if not ends[0] <= each.position[axis] <= ends[1]]:
            what = "the point lies outside of the side of {axis}, {low} to {high}"
            raise file.fail(what, _WHOLE, off[0].line, axis=axis, low=low, high=top)
    return _noted(file, found)


def candle(file: TextFile, around: Around) -> Found:
    """Return the readings of a map of Candle: corner and size, nodes, and rows along y; raises ReadingError."""
    keys = dict[str, str]()
    corner, nodes = (file.lines[line].split(";") for line in (0, 1))
    for side, letter in enumerate("xy"):
        low, size = (file.number(corner[at], "border", 1) for at in (side, side + 2))
        keys |= {f"min_{letter}": repr(low), f"max_{letter}": repr(low + size), f"{letter}_count": nodes[side]}
    rows: Rows = [(n, [c.strip() for c in line.split(";")]) for n, line in enumerate(file.lines[3:], 4) if line.strip()]
    return _noted(file, grid(file, keys, rows, 2).readings())


def xml(file: TextFile, around: Around) -> Found:
    """Return the readings of a map of OpenCNCPilot or ioSender; a point that is left out was not probed.

    Raises ReadingError, also for an attribute that says more.
    """
    head = next((number, found[1]) for number, line in enumerate(file.lines, 1) if (found := _XML.search(line)))
    attributes = dict(_ATTRIBUTE.findall(head[1]))
    for name, value in attributes.items():
        if name not in _OF_XML and number_or_none(value) != 0:
            raise file.fail("{name} is not known of a height map", "export it without", head[0], name=name[:40])
    if not any("</heightmap>" in line for line in file.lines):
        raise file.fail("the height map is cut off", _WHOLE, len(file.lines))
    cells = dict[tuple[int, int], tuple[int, str]]()
    for number, line in enumerate(file.lines, 1):
        points = _POINT.findall(line)
        if len(points) != line.count("<point"):
            raise file.fail("{text!r} is no point of a map", _WHOLE, number, text=line.strip()[:60])
        cells |= {(int(i), int(j)): (number, cell.strip()) for i, j, cell in points}
    keys = {key: attributes[name] for name, key in _OF_XML.items() if name in attributes}
    counts = [keys.get("x_count", ""), keys.get("y_count", "")]
    wide, high = (int(each) if _COUNT.fullmatch(each) else 0 for each in counts)
    if outside := [number for (i, j), (number, _) in cells.items() if i >= wide or j >= high]:
        what = "the point lies outside of the map of {wide} x {high}"
        raise file.fail(what, _WHOLE, outside[0], wide=wide, high=high)
    rows: Rows = [(head[0], [cells.get((i, j), (0, ""))[1] for i in range(wide)]) for j in range(high)]
    return _noted(file, grid(file, keys, rows, head[0]).readings())


def _noted(file: TextFile, found: Found) -> Found:
    """Return readings with the unit that was taken, for these files name none."""
    return replace(found, note=said("in {unit}", unit=file.unit or "mm"))


def _lines(file: TextFile) -> Iterator[tuple[int, str]]:
    """Yield the lines of a list with their numbers, without remarks and a head."""
    for number, line in enumerate(file.lines, 1):
        if not _REMARK.match(line) and not _HEAD.fullmatch(line):
            yield number, line


def _named(file: TextFile) -> bool:
    """Return whether a head stands above the first point and has a column before X: names or numbers of the points."""
    head = _HEAD.fullmatch(next((line for line in file.lines if not _REMARK.match(line)), ""))
    return head is not None and bool(head["named"])


def _numbers(line: str, named: bool = False) -> list[str]:
    """Return the numbers of a point; a comma is a decimal one where blanks or semicolons separate all of them.

    named : the first cell is the point's name
    """
    if named:
        line = line.partition(";")[2] if ";" in line else _NAME.sub("", line)
    if lettered := _LETTERS.fullmatch(line):
        line = " ".join(lettered.groups())
    cells = line.replace(";", " ").split()
    if len(cells) in (3, 9):
        return [cell.removesuffix(",").replace(",", ".") for cell in cells]
    return [cell.strip() for cell in line.split(",")]


def _points(
    file: TextFile, lines: list[tuple[int, str]], named: bool = False, heights: TextFile | None = None
) -> Found:
    """Return the readings of points.  named : the first cell names the point; heights : the file with their unit"""
    found = list[RawReading]()
    for number, line in lines:
        cells = _numbers(line, named)
        if len(cells) not in (3, 9):
            what = "{text!r} is not X, Y and Z"
            raise file.fail(what, "write one point a line, three numbers", number, text=line.strip()[:60])
        x, y, *others = (file.length(cell, "place", number) for cell in [*cells[:2], *cells[3:]])
        if aside := [letter for letter, value in zip("ABCUVW", others, strict=False) if value]:
            what, remedy = "the point has {axes} beside X, Y and Z", "give a list that was probed without moving them"
            raise file.fail(what, remedy, number, axes=", ".join(aside))
        found += height(heights or file, x, y, cells[2], number)
    return probed_of(file, found, len(lines), lines[0][0] if lines else 1)
