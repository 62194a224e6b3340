"""Bed maps as Marlin prints them: topographies, grids of M420 V, nodes of M421 and M503, points of G29 V4.

Lines of a terminal's log around the map do not count. Cells that nobody probed are `.`, `=====` or NAN, and nodes that
no line sets where the set-up says how many there are.
"""

from __future__ import annotations

import re
from dataclasses import replace

from axiscal.measurement.readers.bed_map import (
    Rows,
    grid,
    points_of,
    refuse_others,
    rows_below,
    told_lines,
    without_places,
)
from axiscal.measurement.readers.csv_readings import Around, Found
from axiscal.measurement.readers.text_file import TextFile
from axiscal.units import from_unit

_TOPOGRAPHY = "Bed Topography Report"
_LINEAR = "Bed Height Topography:"
_PRINTED = re.compile(r"Bilinear Leveling Grid:|Measured points:")
_LABELLED = re.compile(r"(\d{1,3}) ?\|(.*)")
_CORNER = re.compile(r"\(\s*(-?[\d.]+),\s*(-?[\d.]+)\)")
_NUMBERED = re.compile(r"(\d{1,3})((?:\s+(?:[-+]?[\d.]+|=+|nan))+)", re.IGNORECASE)
_NODE = re.compile(r"(?:N\d{1,9}\s+)?(M421|G29 [WS]3?)(?![\d.])([^;*]*)")
_INDEX = re.compile(r"\d{1,3}")
_WORD = re.compile(r"([A-Z]) ?([-+.\w]*)")
_POINT = re.compile(r"Bed X: ?(\S+) Y: ?(\S+) Z: ?(\S+)(.*)")
_INCHES = re.compile(r"G20\b")
_BUILT = re.compile(r"; mesh from X (\S+) to (\S+) and Y (\S+) to (\S+)")
_WHOLE = "copy the whole map as Marlin printed it"


def is_topography(file: TextFile) -> bool:
    """Return whether a line begins the topography of UBL (M420 V, G29 T)."""
    return any(_TOPOGRAPHY in line for line in file.lines)


def is_probed(file: TextFile) -> bool:
    """Return whether there are lines of G29 V4."""
    return any(_POINT.match(text) for _, text in told_lines(file))


def is_printed(file: TextFile) -> bool:
    """Return whether a line begins a grid of M420 V."""
    return any(_PRINTED.search(line) for line in file.lines)


def is_nodes(file: TextFile) -> bool:
    """Return whether a line sets a node: M421, or G29 W and G29 S3 of a report of M503."""
    return any(_NODE.match(text) for _, text in told_lines(file))


def topography(file: TextFile, around: Around) -> Found:
    """Return the readings of a topography: its corners are printed, or the set-up states them; raises ReadingError."""
    begins = [number for number, line in enumerate(file.lines, 1) if _TOPOGRAPHY in line]
    refuse_others(file, begins)
    if "CSV" in file.lines[begins[0] - 1]:
        lines = [(number, line) for number, line in enumerate(file.lines[begins[0] :], begins[0] + 1) if "\t" in line]
        return without_places(file, [(n, line.split()) for n, line in reversed(lines)], begins[0], around).readings()
    rows, corners = dict[int, tuple[int, list[str]]](), list[tuple[str, str]]()
    for number, text in (each for each in told_lines(file) if each[0] > begins[0]):
        if row := _LABELLED.match(text):
            if int(row[1]) in rows:
                raise file.fail("row {row} stands here twice", _WHOLE, number, row=row[1])
            rows[int(row[1])] = number, re.sub(r"[\[\]]", " ", row[2]).split()
        corners += _CORNER.findall(text)
    if len(corners) != 4 or rows.keys() != set(range(len(rows))) or not rows:
        what = "the map has {rows} rows that follow each other from 0 on, and {corners} of 4 corners"
        whole = next((count for count in range(len(rows) + 1) if count not in rows), 0)
        raise file.fail(what, _WHOLE, begins[0], rows=whole, corners=len(corners))
    keys = {"x_count": str(len(rows[0][1])), "y_count": str(len(rows))}
    for side, letter in enumerate("xy"):
        ends = sorted((corner[side] for corner in corners), key=lambda end: file.number(end, "corner", begins[0]))
        if ends[0] != ends[1] or ends[2] != ends[3]:
            raise file.fail("the corners are those of no rectangle", _WHOLE, begins[0])
        keys |= {f"min_{letter}": ends[0], f"max_{letter}": ends[-1]}
    return grid(file, keys, [rows[j] for j in range(len(rows))], begins[0]).readings()


def printed(file: TextFile, around: Around) -> Found:
    """Return the readings of the grid of M420 V, the first row along y; raises ReadingError."""
    begins = [number for number, line in enumerate(file.lines, 1) if _PRINTED.search(line)]
    refuse_others(file, begins)
    rows = Rows()
    for number, text in told_lines(file):
        row = _NUMBERED.fullmatch(text) if number > begins[0] else None
        if row and int(row[1]) == len(rows) and not re.fullmatch(r"[\d\s]+", text):
            rows.append((number, row[2].split()))
        elif rows:
            break
    return without_places(file, rows, begins[0], around).readings()


def nodes(file: TextFile, around: Around) -> Found:
    """Return the readings of commands that set nodes; raises ReadingError.

    A node that no command sets was not probed, where the set-up says how many there are; else it is refused.
    """
    file = replace(file, unit="in") if any(_INCHES.match(text) for _, text in told_lines(file)) else file
    found = dict[tuple[int, int], tuple[int, str]]()
    for number, text in told_lines(file):
        if command := _NODE.match(text):
            words = dict(_WORD.findall(command[2]))
            i, j, cell = (words.pop(letter, "") for letter in "IJZ")
            cell = "nan" if words == {"N": ""} and not cell else cell
            strange = words.keys() - {"N"} or _WORD.sub("", command[2]).strip()
            if strange or not (_INDEX.fullmatch(i) and _INDEX.fullmatch(j) and cell):
                remedy = "write it as in M421 I0 J0 Z0.05"
                raise file.fail("{text!r} says no height of a point", remedy, number, text=text[:40])
            node = int(i), int(j)
            if node in found:
                what = "node I{i} J{j} stands in line {earlier} too"
                raise file.fail(what, "keep one of them", number, i=i, j=j, earlier=found[node][0])
            found[node] = number, cell
    stated = next((setup.nodes for setup in around.setups if setup.nodes is not None), None)
    wide, high = (max(node[side] for node in found) + 1 for side in (0, 1))
    line = max(number for number, _ in found.values())
    if stated is not None:
        wide, high = max(wide, stated[0][2]), max(high, stated[1][2])
    elif len(found) < wide * high or min(wide, high) < 2:
        what = "the mesh of {wide} x {high} points has {count} values"
        remedy = "give the whole answer to M503, or state in the set-up how many were probed: map"
        raise file.fail(what, remedy, line, wide=wide, high=high, count=len(found))
    built = next((ends for text in file.lines if (ends := _BUILT.match(text))), None)
    if built and stated is None:
        low_x, top_x, low_y, top_y = (from_unit(file.number(end, "end", 1), "mm") for end in built.groups())
        around = replace(around, ends=((low_x, top_x), (low_y, top_y)))
    rows = [(line, [found.get((i, j), (0, "nan"))[1] for i in range(wide)]) for j in range(high)]
    return without_places(file, rows, line, around).readings()


def probed(file: TextFile, around: Around) -> Found:
    """Return the readings of lines of G29 V4; raises ReadingError."""
    return points_of(file, _POINT)


def is_linear(file: TextFile) -> bool:
    """Return whether a line begins the topography of a level plane (G29 T of a linear Marlin)."""
    return any(_LINEAR in line for line in file.lines)


def linear(file: TextFile, around: Around) -> Found:
    """Return the readings of that topography, from their mean, the last row first; raises ReadingError."""
    rows, begins = rows_below(file, _LINEAR)
    return without_places(file, rows[::-1], begins, around).readings()
