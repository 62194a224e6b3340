"""Heights as probing programs of routers and mills write them: points X Y Z, and maps of Candle.

A list has one point a line, by blanks, tabs, commas or semicolons. That of bCNC begins with its two sides and the
depth; LinuxCNC (`smartprobe.ngc`) writes all nine axes, and coordinate measuring machines the direction of the face.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import islice

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.measurement.readers.bed_map import Rows, grid, height, noted, probed_of
from axiscal.measurement.readers.columns import STEMS, column_of
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading, read_times
from axiscal.measurement.readers.csv_table import NUMBER, plain, table_of
from axiscal.measurement.readers.text_file import LINES_OF, TextFile

_SLACK = 1e-6
"""m, of rounding."""
_SMALL = 0.05
"""Share of X: readings are far below it, and the sides of a bed are not."""
_HEIGHTS = 2e-3
"""m, further than those of a bed differ, and less than any bed is long."""
_LINES = LINES_OF["points"]
_AXES, _NORMAL = "XYZABCUVW", "XYZIJK"
"""In the order in which LinuxCNC writes them, and with the direction of a face."""
_WORDS = {word: stem for word, stem in STEMS.items() if stem in ("", "time", "Z")} | {"target": ""}
_WORDS |= {f"{delta}{axis}".lower(): axis for axis in _AXES + _NORMAL[3:] for delta in ("", "d")}
_WHOLE = "copy the whole file"

_NUMBER = r"\s*+[-+]?(?:\d++\.?\d*+|\.\d++)(?:[eE][-+]?\d++)?"
_SIDE = re.compile(rf"({_NUMBER})\s({_NUMBER})\s++(\d{{1,4}})\s*+")
_CANDLE = [re.compile(rf"{_NUMBER}\s*+(?:;{_NUMBER}\s*+){{{more}}}") for more in (3, 3, 2)]
"""Its first lines: four, four and three numbers."""


def _head(file: TextFile) -> list[tuple[int, str]]:
    """Return the first three lines that are no remarks, with their numbers."""
    told = ((number, line) for number, line in enumerate(file.lines, 1) if not _LINES["remark"].match(line))
    return [*islice(told, 3)]


def is_candle(file: TextFile) -> bool:
    """Return whether this is a map of Candle."""
    return len(file.lines) >= len(_CANDLE) and all(map(re.Pattern.fullmatch, _CANDLE, file.lines))


def is_bcnc(file: TextFile) -> bool:
    """Return whether the first lines are two sides, from, to and how many, which the depth of the probe follows."""
    sides = [side for _, line in _head(file)[:2] if (side := _SIDE.fullmatch(line)) and int(side[3]) > 1]
    return len(sides) == 2 and all(float(side[1]) < float(side[2]) for side in sides)


def is_list(file: TextFile) -> bool:
    """Return whether the first line is a point, behind its name or not, or names X, Y and Z and no more."""
    first = _cells("".join(line for _, line in _head(file)[:1]))[: 2 * len(_AXES)]  # no point has more
    head = {column_of(cell, words=_WORDS).stem for cell in first}
    return bool(_numbers(first)) or {*"XYZ"} <= head <= {*_AXES, *_NORMAL, "", "time"}


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
    return noted(file, grid(file, sides, rows, 2))


def _cells(line: str) -> list[str]:
    """Return the cells of a point or of the head of a list, by semicolons, tabs, blanks or commas."""
    if lettered := _LINES["letters"].fullmatch(line):
        return [cell.strip(",") for cell in lettered.groups()]
    line = _LINES["before_unit"].sub("", _LINES["remark_behind"].sub("", line).strip().rstrip(";"))
    blanks = line.split()
    if re.search("[;\t]", line):
        blanks = re.split("[;\t]", line)
    elif len(blanks) < 3 or (", " in line and not all(cell.endswith(",") for cell in blanks[:-1])):
        blanks = line.split(",")
    return [cell.strip().removesuffix(",") for cell in blanks]


def _numbers(cells: list[str]) -> list[str]:
    """Return the numbers of a point behind its name, none of another line."""
    known = [bool(NUMBER.fullmatch(plain(cell.replace(",", "."), "."))) for cell in cells[: 2 * len(_AXES)]]
    count = known.index(True) if True in known else 0
    whole = all(known[count:]) and len(cells) - count in (3, 6, 9) and all(map(_LINES["name"].fullmatch, cells[:count]))
    return cells[count:] if whole else []


def _unlike(found: Found, names: list[str]) -> bool:
    """Return whether lines without header may be places with two readings each, or the heights of a map.

    X of a table never comes again, and Y is far below it or as large; or its names are ways or axes.
    """
    x, y = np.array([[each.position[axis] for axis in "XY"] for each in found.readings]).T
    apart = np.abs([y, y - x]).max(axis=1).min()
    alike = len(set(x)) == len(x) and len(set(y)) > 1 and bool(apart < _SMALL * np.abs(x).max())
    return alike or (any(names) and len(set(names)) < len(names)) or 0 < max(np.ptp(x), np.ptp(y)) < _HEIGHTS


def listed(file: TextFile, around: Around, after: int = 0) -> Found:
    """Return the readings of a list behind some lines, other axes at 0; raises ReadingError."""
    points = [[] if _LINES["remark"].match(line) else _cells(line) for line in file.lines[after:]]
    first = _numbers(next(filter(None, points), []))
    names = ["\t".join(each[: -len(first)]) for each in points if each and first]
    cells = ["\t".join((first and _numbers(each)) or each) for each in points]
    lines, mark = tuple([""] * after + cells), "," if any("," in each for each in cells) else "."
    usual = _NORMAL if len(first) == 6 and number_or_none(first[-1]) == 1 else _AXES
    table = table_of(replace(file, lines=lines, unit=file.unit or "mm"), words=_WORDS, usual=usual)
    if file.unit and any(column.unit for column in table.columns):
        raise table.fail("the header names its unit, and --unit names another", "leave --unit out")
    table, readings = table.with_columns(replace(column, mark=mark) for column in table.columns), list[RawReading]()
    others = [axis for axis in _AXES[3:] + _NORMAL[3:] if table.all_of(axis)]
    for row, time in zip(table.rows, read_times(table), strict=True):
        if aside := [axis for axis in others if row.of(axis).number() != (axis == "K")]:
            what, remedy = "the point has {axes} beside X, Y and Z", "give a list that was probed along Z alone"
            raise row.fail(what, remedy, axes=", ".join(aside))
        z = row.of("Z")
        own = replace(file, unit=z.column.unit or z.column.stated)
        low = height(own, row.of("X").quantity(), row.of("Y").quantity(), plain(z.text, mark), row.line)
        readings += [replace(reading, time=time) for reading in low]
    found = probed_of(file, readings, len(table.rows), table.rows[-1].line)
    if first and not _LINES["letters"].match(file.lines[table.line - 1]) and _unlike(found, names):
        what = "these lines look like a place and two readings each, or heights of a map, and not like X, Y and Z"
        raise table.fail(what, "copy the whole map, or name the columns above them: X,Y,Z, or Pos_mm,1+_um,1-_um")
    return found if all(table.one_of(axis, axis).unit for axis in "XYZ") else noted(file, found)
