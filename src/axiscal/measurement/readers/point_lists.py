"""Heights as probing programs of routers and mills write them: points X Y Z, and maps of Candle and OpenCNCPilot.

A list has one point a line, by blanks, tabs, commas or semicolons. That of bCNC begins with its two sides and the
depth; LinuxCNC (`smartprobe.ngc`) writes all nine axes; grbl answers `[PRB:X,Y,Z:1]` to each touch.
"""

from __future__ import annotations

import json
import re
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import islice

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.language.spoken import said
from axiscal.measurement.readers.bed_map import Rows, grid, height, keyed, points_of, probed_of
from axiscal.measurement.readers.columns import STEMS, column_of
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, read_times
from axiscal.measurement.readers.csv_table import CsvTable, table_of
from axiscal.measurement.readers.table_cells import NUMBER, plain
from axiscal.measurement.readers.text_file import TextFile, begins, telling

_SLACK = 1e-6
"""m, of rounding."""
_SMALL = 0.05
"""Share of X: readings are far below it, and the sides of a bed are not."""
_REMARK = re.compile(r"\s*(?:[#%(;]|//|$|BEGIN .* MM\s*$|\[END\])")
"""A line that is no point; HEIDENHAIN begins and ends its tables of points so."""
_BEHIND = re.compile(r"(?<=[\d.])\s*(?:[#%(]|//|;\s*[^\W\d]).*")
"""A remark behind numbers."""
_AXES = "XYZABCUVW"
"""In the order in which LinuxCNC writes them."""
_WORDS = {word: stem for word, stem in STEMS.items() if stem in ("", "time")}
_WORDS |= {f"{delta}{axis}".lower(): axis for axis in _AXES for delta in ("", "d")}
_WIDTHS = (3, 4, 5, 9, 10)
"""Cells of a point with three or nine axes, its name, and its time."""
_LETTERS = re.compile("".join(rf"\s*{axis}\s*[:=]?\s*([-+.,\d]+)[\s,;]*" for axis in "XYZ"), re.IGNORECASE)
_INCHES = re.compile(r"\b(?:inch(?:es)?|zoll|pouces?|thou|mils?)\b", re.IGNORECASE)
_BEFORE_UNIT = re.compile(r"\s+(?=[\[(])")
_COUNT = re.compile(r"\d{1,4}")
_XML = re.compile(r"<heightmap\b([^>]*)>")
_OF_XML = {"MinX": "min_x", "MaxX": "max_x", "MinY": "min_y", "MaxY": "max_y", "SizeX": "x_count", "SizeY": "y_count"}
_WHOLE = "copy the whole file"
_TOUCH = re.compile(r"(?:\[PRB:([^,\]]+),([^,\]]+),([^,:\]]+)(?:,-?0\.?0*(?=[,:]))*:1]|(?=\[PRB:(?![^][]*:0])))(.*)")
"""The answer of grbl to G38.2, other axes at 0. One with :0 met nothing. Of a broken answer all is the rest."""

_NUMBER = r"\s*[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_SIDE = re.compile(rf"({_NUMBER})\s({_NUMBER})\s+(\d{{1,4}})\s*")
is_candle = partial(begins, tuple(rf"{_NUMBER}\s*(?:;{_NUMBER}\s*){{{more}}}" for more in (3, 3, 2)))
"""Whether the first lines are four, four and three numbers."""
is_grbl = telling(re.compile(r"\[PRB:"))
"""Whether a line is such an answer."""


def _head(file: TextFile) -> list[tuple[int, str]]:
    """Return the first three lines that are no remarks, with their numbers."""
    told = ((number, line) for number, line in enumerate(file.lines, 1) if not _REMARK.match(line))
    return [*islice(told, 3)]


def is_bcnc(file: TextFile) -> bool:
    """Return whether the first lines are two sides, from, to and how many, which the depth of the probe follows."""
    sides = [side for _, line in _head(file)[:2] if (side := _SIDE.fullmatch(line)) and int(side[3]) > 1]
    return len(sides) == 2 and all(float(side[1]) < float(side[2]) for side in sides)


def is_list(file: TextFile) -> bool:
    """Return whether the first line is a point, three numbers or nine of LinuxCNC, or names X, Y and Z and no more."""
    first = next((_cells(line) for _, line in _told(file) if not _REMARK.match(line)), [])
    numbers = all(NUMBER.fullmatch(plain(cell.replace(",", "."), ".")) for cell in first)
    head = [column_of(cell, words=_WORDS).stem for cell in first]
    return (len(first) in (3, 9) and numbers) or sorted(stem for stem in head if stem not in ("", "time")) == [*"XYZ"]


def is_xml(file: TextFile) -> bool:
    """Return whether there is an element `heightmap`."""
    return any(map(_XML.search, file.lines[:10]))


def grbl(file: TextFile, around: Around) -> Found:
    """Return the readings of touches in the log of a sender, in inches where it has $13=1; raises ReadingError."""
    file = replace(file, unit=file.unit or "in" * any(line.strip() == "$13=1" for line in file.lines))
    return _noted(file, points_of(file, _TOUCH))


def bcnc(file: TextFile, around: Around) -> Found:
    """Return the readings of a list whose sides stand above it; raises ReadingError."""
    head = _head(file)
    found, sides = listed(file, around, head[-1][0]), [line.split() for _, line in head[:2]]
    if found.cells != (count := int(sides[0][2]) * int(sides[1][2])):
        what = "{count} points are announced, and there are {points}"
        raise file.fail(what, _WHOLE, head[0][0], count=count, points=found.cells)
    for axis, (low, top, _), (line, _) in zip("XY", sides, head, strict=False):
        ends = file.length(low, "side", line) - _SLACK, file.length(top, "side", line) + _SLACK
        if off := [each for each in found.readings if not ends[0] <= each.position[axis] <= ends[1]]:
            what = "the point lies outside of the side of {axis}, {low} to {high}"
            raise file.fail(what, _WHOLE, off[0].line, axis=axis, low=low, high=top)
    return found


def candle(file: TextFile, around: Around) -> Found:
    """Return the readings of a map of Candle: corner and size, nodes, and rows along y; raises ReadingError."""
    *corner, width, depth = (file.length(each, "border", 1) for each in file.lines[0].split(";"))
    counts = (file.number(each, "count", 2) for each in file.lines[1].split(";")[:2])
    sides = [(low, low + size, count) for low, size, count in zip(corner, (width, depth), counts, strict=True)]
    rows: Rows = [(n, [c.strip() for c in line.split(";")]) for n, line in enumerate(file.lines[3:], 4) if line.strip()]
    return _noted(file, grid(file, sides, rows, 2))


def xml(file: TextFile, around: Around) -> Found:
    """Return the readings of a map of OpenCNCPilot or ioSender; a point that is left out was not probed.

    Raises ReadingError, also for an attribute that says more.
    """
    from xml.etree import ElementTree  # by whom such a file is read: the others start without

    head = next(number for number, line in enumerate(file.lines, 1) if _XML.search(line))
    try:
        root = ElementTree.fromstring("\n".join(file.lines[head - 1 :]))
    except ElementTree.ParseError as fault:
        raise file.fail("the height map is cut off or edited", _WHOLE, head - 1 + fault.position[0]) from None
    for name, value in root.attrib.items():
        if name not in _OF_XML and number_or_none(value) != 0:
            raise file.fail("{name} is not known of a height map", "export it without", head, name=name[:40])
    keys = {key: root.attrib[name] for name, key in _OF_XML.items() if name in root.attrib}
    wide, high = (int(each) if _COUNT.fullmatch(each := keys.get(f"{k}_count", "")) else 0 for k in "xy")
    cells = {(each.get("X", ""), each.get("Y", "")): (each.text or "").strip() for each in root.iter("point")}
    rows: Rows = [(head, [cells.pop((str(i), str(j)), "") for i in range(wide)]) for j in range(high)]
    for x, y in cells:
        what = "point {x}, {y} lies outside of the map of {wide} x {high}"
        raise file.fail(what, _WHOLE, head, x=x[:20], y=y[:20], wide=wide, high=high)
    return _noted(file, grid(file, keyed(file, keys, head), rows, head))


def _noted(file: TextFile, found: Found) -> Found:
    """Return readings with the unit that was taken; raises ReadingError where a remark names another.

    Their numbers name none.
    """
    named = (number for number, line in enumerate(file.lines, 1) if _INCHES.search(line))
    if not file.unit and (line := next(named, 0)):
        raise file.fail("this line names inches, and the numbers name no unit", "say it: --unit inch or mm", line)
    return replace(found, note=said("in {unit}", unit=file.unit or "mm"))


def _cells(line: str) -> list[str]:
    """Return the cells of a point or of the head of a list, by semicolons, tabs, blanks or commas."""
    if lettered := _LETTERS.fullmatch(line):
        return [cell.strip(",") for cell in lettered.groups()]
    line = _BEFORE_UNIT.sub("", _BEHIND.sub("", line).strip().rstrip(";"))
    cells = re.split("[;\t]", line) if re.search("[;\t]", line) else [cell.removesuffix(",") for cell in line.split()]
    return [cell.strip() for cell in (cells if len(cells) in _WIDTHS else line.split(","))]


def _told(file: TextFile) -> list[tuple[int, str]]:
    """Return the lines with their numbers; of a list in JSON one for each point, below its keys if it has any."""
    with suppress(ValueError, RecursionError, TypeError, LookupError):
        held = json.loads("\n".join(file.lines), parse_float=str, parse_int=str, parse_constant=str)
        head = [*held[0]] if isinstance(held[0], dict) else []
        points = [[each[key] for key in head] if head else each for each in held]
        places = [number for number, line in enumerate(file.lines, 1) for sign in line if sign in "[{"]
        if len(set(map(len, held))) == 1:
            texts = ("\t".join("nan" if cell is None else str(cell) for cell in each) for each in points)
            return [(1, "\t".join(head))] * bool(head) + [*zip(places[1:], texts, strict=True)]
    return [*enumerate(file.lines, 1)]


def _two_readings(table: CsvTable, found: Found) -> bool:
    """Return whether three columns that nobody named look like places with two readings each.

    X never comes again, and Y is far below it or as large.
    """
    (x, y), headless = np.array([[each.position[axis] for axis in "XY"] for each in found.readings]).T, table.rows[0]
    apart = np.abs([y, y - x]).max(axis=1).min()
    alike = len(set(x)) == len(x) and len(set(y)) > 1 and bool(apart < _SMALL * np.abs(x).max())
    return alike and table.line == headless.line and len(table.columns) == 3


def listed(file: TextFile, around: Around, after: int = 0) -> Found:
    """Return the readings of a list behind some lines, other axes at 0; raises ReadingError."""
    told = _told(file)
    cells = ["" if _REMARK.match(line) else "\t".join(_cells(line)) for _, line in told[after:]]
    lines, mark = tuple([""] * after + cells), "," if any("," in each for each in cells) else "."
    table = table_of(replace(file, lines=lines, unit=file.unit or "mm"), words=_WORDS, usual=_AXES)
    if file.unit and any(column.unit for column in table.columns):
        raise table.fail("the header names its unit, and --unit names another", "leave --unit out")
    table, readings = table.with_columns(replace(column, mark=mark) for column in table.columns), list[RawReading]()
    others = [axis for axis in _AXES[3:] if table.all_of(axis)]
    for each, time in zip(table.rows, read_times(table), strict=True):
        row = replace(each, line=told[each.line - 1][0])
        if aside := [axis for axis in others if row.of(axis).number()]:
            what, remedy = "the point has {axes} beside X, Y and Z", "give a list that was probed without moving them"
            raise row.fail(what, remedy, axes=", ".join(aside))
        z = row.of("Z")
        unit = z.column.unit or z.column.stated
        x, y = row.of("X").quantity(), row.of("Y").quantity()
        low = height(replace(file, unit=unit), x, y, plain(z.text, mark), row.line)
        readings += [replace(reading, time=time) for reading in low]
    found = probed_of(file, readings, len(table.rows), table.rows[-1].line)
    if not _LETTERS.match(file.lines[table.line - 1]) and _two_readings(table, found):
        what = "these lines look like a place and two readings each, and not like X, Y and Z"
        raise table.fail(what, "name the columns above them: X,Y,Z, or Pos_mm,1+_um,1-_um")
    return found if all(table.one_of(axis, axis).unit for axis in "XYZ") else _noted(file, found)
