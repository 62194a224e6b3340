"""Bed maps of printers: RepRapFirmware (`heightmap.csv`), Klipper (`[bed_mesh NAME]`, its console) and Moonraker.

A height is where the bed lies, positive where it is high; a printer adds it to Z. Each node is one reading along z at X
and Y, of minus the height. Cells that nobody probed are no readings: RepRapFirmware's 0 without decimals, whatever lies
outside its radius, and the copies with which Klipper fills the rows of a round bed.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import hypot
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from axiscal.exceptions import ReadingError
from axiscal.language.spoken import joined
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading
from axiscal.measurement.readers.text_file import TextFile, begins, read_text
from axiscal.measurement.setup import Vector
from axiscal.units import from_unit

Side = tuple[float, float, float]
"""Of a map: first and last node, m, and how many."""
Rows = list[tuple[int, list[str]]]
"""Of a map, along y: line and cells."""
PlacedRows = Sequence[tuple[float, int, list[str]]]
Skipping = Callable[[TextFile, Sequence[float], PlacedRows], set[tuple[int, int]]]
"""What gives columns and rows of cells that are no readings, by x and rows with their y, m."""
_BLOCK = re.compile(r"(?:#\*#\s*)?\[bed_mesh\s+([^\]]+?)\s*\]")
_RECTANGLE, _ROUND = re.compile(r"\[bed_mesh\]"), re.compile(r"\s*mesh_radius\s*[:=]")
_OPTION = re.compile(r"([a-z_]+)\s*[=:]\s*(.*)")
_OF_MESH = re.compile(r"version|points|[xy]_count|mesh_[xy]_pps|algo|tension|(min|max)_[xy]")
_OF_STATUS = ("bed_mesh", "probed_matrix", "profiles")
_CONSOLE = re.compile("Mesh Leveling Probed Z positions:")
_AT_NOZZLE = re.compile(r"probe at ([^\s,]+),([^\s,]+) is z=(\S+)(.*)")
_AT_BED = re.compile(r"probe: at ([^\s,]+),([^\s,]+) bed will contact at z=(\S+)(.*)")
"""What Klipper prints of each touch, until 2025 and since."""
_AT_SCREW = re.compile(r"\S.*? : x=([^\s,]+), y=([^\s,]+), z=([^\s,]+)(?: : adjust C?CW \d+:\d+)?(.*)")
"""What SCREWS_TILT_CALCULATE prints of each screw, where the nozzle stood."""
_TIME = r"(?:[\d-]{10} )?\d\d?:\d\d(?::\d\d)?(?:[.,]\d+)?\s*(?:[AP]M\s*)?(?:- )?"
_LOG = re.compile(rf"^\s*(?:\[?{_TIME}\]?\s*(?::\s+)?)?(?:Recv:|<<<|>>>|[<>])?\s*(?:echo:|//)?\s*")
_NUMBER = re.compile(r"[-+]?[\d.]+(?:e[-+]?\d+)?|=+|nan", re.IGNORECASE)
_TRAMMED = re.compile("Making the following Z adjustments")
"""Behind it the gantry lies anew: what was probed before is no part of a map."""
_MAPPED = re.compile("Mesh Bed Leveling Complete|G29 Auto Bed Leveling")
"""Ends the map of a Klipper, and begins one of a Marlin."""
_NOT_PROBED = frozenset({"", ".", "nan"})
_PRINTED_TO = {"X": 1e-4, "Y": 1e-4}
"""m: places are printed in fewer digits than they have, some in whole millimetres."""
_SLACK = 1e-4
"""m, of a radius: Klipper cuts its distances to 0.01 mm."""
_MOST = 1000
"""Nodes along a side."""
_KEYS = "{0}min min{1} min_{0}", "{0}max max{1} max_{0}", "{0}num num{1} {0}_count", "{0}spacing spacing{1} spacing"
"""Of a side: as RepRapFirmware writes them today, in its newest version, and Klipper, or its first version."""


_Kind = TypeVar("_Kind")


def height(file: TextFile, x: float, y: float, cell: str, line: int) -> Iterator[RawReading]:
    """Yield the reading of a cell, nothing where nobody probed it; raises ReadingError.  x, y : m"""
    if cell.strip("=").lower() not in _NOT_PROBED:
        low = -file.length(cell, "height", line)
        yield RawReading("", {"X": x, "Y": y}, {}, low, None, "length", line, error="z", rounding=_PRINTED_TO)


def probed_of(file: TextFile, readings: Sequence[RawReading], cells: int, line: int) -> Found:
    """Return the readings of a map; raises ReadingError where nobody probed one.  cells : all that it has"""
    if not readings:
        raise file.fail("no node was probed", "probe the bed and save the map again", line)
    return Found(tuple(readings), cells)


def read_part(path: str | Path, unit: str = "") -> TextFile:
    """Return a file, of FILE#NAME with the mesh profile NAME alone; raises ReadingError."""
    whole, _, name = str(path).rpartition("#")
    if not whole or Path(path).exists():
        return read_text(path, unit)
    file, kept, section = read_text(whole, unit), list[str](), ""
    if is_moonraker(file):
        return replace(file, name=str(path))
    for line in file.lines:
        if line.removeprefix("#*#").lstrip().startswith("["):
            section = begin[1] if (begin := _BLOCK.match(line)) else ""
        kept.append(line if section in ("", name) else "")
    if name not in (known := list(_profiles(file).values())):
        raise _unsaved(file, name, known)
    return TextFile(str(path), tuple(kept), unit)


def _several(file: TextFile, names: Sequence[str], line: int) -> ReadingError:
    what, name = "{count} meshes are saved here: {names}", f"{Path(file.name).name}#{names[-1]}"
    remedy, known = "name one of them: {name}", ", ".join(names)
    return file.fail(what, remedy, line, count=len(names), names=known, name=name)


def _unsaved(file: TextFile, name: str, known: Sequence[str]) -> ReadingError:
    what, names = "no mesh {name} is saved here", ", ".join(known) or "-"
    return file.fail(what, "saved are: {known}", name=name[:40] or "in force", known=names)


def is_mesh(file: TextFile) -> bool:
    """Return whether a Klipper mesh is saved in this file."""
    return bool(_profiles(file))


def is_moonraker(file: TextFile) -> bool:
    """Return whether this is an answer of Moonraker with a mesh in it."""
    first = next((line for line in file.lines if line.strip()), "")
    return first.lstrip().startswith("{") and any(f'"{key}"' in line for line in file.lines for key in _OF_STATUS)


def _profiles(file: TextFile) -> dict[int, str]:
    """Return the names of the meshes by their lines."""
    return {number: begin[1] for number, line in enumerate(file.lines, 1) if (begin := _BLOCK.match(line))}


def height_map(file: TextFile, around: Around) -> Found:
    """Return the readings of the probed nodes of a RepRapFirmware map, any version of it; raises ReadingError."""
    if len(file.lines) < 4:
        raise file.fail("the height map is cut off", "copy the whole heightmap.csv", len(file.lines))
    head = dict(zip(_cells(file.lines[1]), _cells(file.lines[2]), strict=False))
    rows = [(n, _cells(line)) for n, line in enumerate(file.lines[3:], 4) if line.strip()]
    if (over := (head.get("axis0", "X"), head.get("axis1", "Y"))) != ("X", "Y"):  # named since version 3.3
        what, remedy = "the map is over {axes}, and that of a bed is over X and Y", "probe the bed by X and Y"
        raise file.fail(what, remedy, 3, axes=joined(over))
    radius = file.length(head.get("radius", "-1"), "radius", 3)

    def skipped(file: TextFile, along: Sequence[float], rows: PlacedRows) -> set[tuple[int, int]]:
        places = ((i, j, x, y, cells[i : i + 1]) for j, (y, _, cells) in enumerate(rows) for i, x in enumerate(along))
        return {(i, j) for i, j, x, y, cell in places if cell == ["0"] or 0 <= radius < hypot(x, y)}

    return grid(file, keyed(file, head, 3, spaced=True), rows, 3, skipped)


def mesh(file: TextFile, around: Around, whole: bool = False) -> Found:
    """Return the readings of the only mesh that is saved in a Klipper configuration; raises ReadingError.

    whole : with the cells that Klipper filled, as it corrects by them
    """
    names = _profiles(file)
    begin, *others = names
    if others:
        raise _several(file, list(names.values()), others[0])
    keys, points, inside = dict[str, str](), Rows(), False
    for number, line in enumerate(file.lines[begin:], begin + 1):
        text = line.removeprefix("#*#").partition("#")[0].strip()
        if text.startswith("["):
            break
        if option := _OPTION.fullmatch(text):
            if not _OF_MESH.fullmatch(option[1]):
                raise file.fail("{key} is not known of a mesh", "take it out", number, key=option[1][:40])
            inside, keys[option[1]] = option[1] == "points", option[2]
            text = option[2] if inside else ""
        if inside and text:
            points.append((number, _cells(text.rstrip(", "))))
    return grid(file, keyed(file, keys, begin), points, begin, None if whole else filled)


def moonraker(file: TextFile, around: Around) -> Found:
    """Return the readings of the mesh in force in an answer of Moonraker, or of FILE#NAME; raises ReadingError."""
    try:
        document = json.loads("\n".join(file.lines), parse_float=str, parse_int=str, parse_constant=str)
    except (ValueError, RecursionError):
        raise file.fail("this is no JSON", "save the whole answer of Moonraker", len(file.lines)) from None
    held = _status(document) or {}
    whole, _, named = file.name.rpartition("#")
    active = str(held.get("profile_name") or "")
    named = named if whole and not Path(file.name).exists() else ""
    name = named or active
    saved = {str(key): _as(dict, value) for key, value in _as(dict, held.get("profiles")).items()}
    if _as(list, held.get("probed_matrix")) not in ([], [[]]) and name == active:
        saved[name] = _in_force(held)
    if not name and len(saved) > 1:
        raise _several(file, list(saved), 1)
    if not saved or (name not in saved and named):
        raise _unsaved(file, name, list(saved))
    chosen = saved.get(name) or next(iter(saved.values()))
    points = [(1, [str(cell) for cell in _as(list, row)]) for row in _as(list, chosen.get("points"))]
    keys = {str(key): str(value) for key, value in _as(dict, chosen.get("mesh_params")).items()}
    return grid(file, keyed(file, keys, 1), points, 1, filled)


def _status(document: object) -> dict[str, Any] | None:
    """Return the table of an answer or a notice that holds a matrix or profiles, None where there is none."""
    if isinstance(document, dict) and {"probed_matrix", "profiles"} & document.keys():
        return document
    inside = document.values() if isinstance(document, dict) else _as(list, document)
    return next((found for each in inside if (found := _status(each)) is not None), None)


def _in_force(held: Mapping[str, Any]) -> dict[str, Any]:
    """Return the mesh in force as a profile is saved."""
    rows = _as(list, held["probed_matrix"])
    low, high = (_as(list, held.get(f"mesh_{end}")) for end in ("min", "max"))
    names = ("min_x", "min_y", "max_x", "max_y") if len(low) == len(high) == 2 else ()
    keys = dict(zip(names, (*low, *high), strict=False))
    return {"points": rows, "mesh_params": {**keys, "x_count": len(_as(list, rows[0])), "y_count": len(rows)}}


def _as(kind: type[_Kind], value: object) -> _Kind:
    """Return a value of that kind, an empty one in place of another."""
    return value if isinstance(value, kind) else kind()


def console(file: TextFile, around: Around) -> Found:
    """Return the readings of what BED_MESH_OUTPUT printed, rows along y; raises ReadingError."""
    return without_places(file, *rows_below(file, _CONSOLE), around, filled)


def rows_below(file: TextFile, title: re.Pattern[str]) -> tuple[Rows, int]:
    """Return the first lines of nothing but numbers below a title, and its line; raises ReadingError for two maps."""
    begin, below = below_title(file, title)
    rows = Rows()
    for number, text in below:
        if text and all(map(_NUMBER.fullmatch, text.split())):
            rows.append((number, text.split()))
        elif rows:
            break
    return rows, begin


def klipper_probed(file: TextFile, around: Around) -> Found:
    """Return the readings of points that Klipper printed; raises ReadingError.

    Older versions print where the nozzle stood: the probe stands beside it as the set-up says.
    """
    aside = next((setup.offset for setup in around.setups if setup.offset is not None), None) or (0.0, 0.0, 0.0)
    pattern = next(each for each in _PROBED if telling(each)(file))
    return points_of(file, pattern, aside if pattern is _AT_NOZZLE else (0.0, 0.0, 0.0))


def points_of(file: TextFile, pattern: re.Pattern[str], aside: Vector = (0.0, 0.0, 0.0)) -> Found:
    """Return the readings of lines with X, Y, Z and nothing behind; raises ReadingError.  aside : of each place, m"""
    found, count, line, whole = list[RawReading](), 0, 1, False
    for line, text in told_lines(file):
        whole |= bool(found and _MAPPED.match(text))
        if _TRAMMED.match(text):
            found, count = [], 0
        elif point := pattern.match(text):
            if whole:
                raise file.fail("there are {count} maps in this file", "keep the one that is to count", line, count=2)
            if point[4].strip():
                raise file.fail("{text!r} is not X, Y and Z", "give the lines as printed", line, text=text[:60])
            x, y = (
                file.length(each, "place", line) + off for each, off in zip(point.groups()[:2], aside, strict=False)
            )
            found += height(file, x, y, point[3], line)
            count += 1
    return probed_of(file, found, count, line)


def told_lines(file: TextFile) -> Iterator[tuple[int, str]]:
    """Yield the lines with their numbers, without what a terminal and the firmware write in front."""
    for number, line in enumerate(file.lines, 1):
        yield number, _LOG.split(line, maxsplit=1)[-1].rstrip()


def telling(*patterns: re.Pattern[str]) -> Callable[[TextFile], bool]:
    """Return what tells whether a line of a file begins with one of some patterns."""
    return lambda file: any(pattern.match(text) for _, text in told_lines(file) for pattern in patterns)


def below_title(file: TextFile, title: re.Pattern[str]) -> tuple[int, list[tuple[int, str]]]:
    """Return the line of a title, and the numbered lines below it; raises ReadingError for more than one map."""
    lines = list(told_lines(file))
    begins = [number for number, text in lines if title.match(text)]
    if len(begins) > 1:
        what = "there are {count} maps in this file"
        raise file.fail(what, "keep the one that is to count", begins[1], count=len(begins))
    return begins[0], lines[begins[0] :]


_PROBED = (_AT_BED, _AT_NOZZLE, _AT_SCREW)
is_height_map = partial(begins, ("RepRapFirmware height map file.*",))
is_console, is_klipper_probed = telling(_CONSOLE), telling(*_PROBED)
"""Whether a line is that by which BED_MESH_OUTPUT begins, or a point that Klipper probed."""


def without_places(file: TextFile, rows: Rows, line: int, around: Around, skipped: Skipping | None = None) -> Found:
    """Return the readings of a map that carries no coordinates; raises ReadingError.  rows : along y

    The set-up states by `map` where they lie; another number of nodes than it says is refused.
    """
    if not rows:
        raise file.fail("the height map is cut off", "copy the whole map", line)
    wide, high = len(rows[0][1]), len(rows)
    ends, stated = around.ends, {setup.nodes: setup.name for setup in around.setups if setup.nodes is not None}
    if len(stated) > 1:
        what = "the map does not say where it lies, and {names} state it differently"
        remedy, names = "keep the `map` of the set-up that the file is of", joined([*stated.values()])
        raise file.fail(what, remedy, line, names=names)
    for (x, y), name in stated.items():
        if (wide, high) != (x[2], y[2]):
            what = 'the map has {wide} x {high} nodes, and `map` of set-up "{setup}" says {x} x {y}'
            at = {"wide": wide, "high": high, "setup": name, "x": x[2], "y": y[2]}
            raise file.fail(what, "copy the whole map, or correct the set-up", line, **at)
        ends = x[:2], y[:2]
    if ends is None:
        what = "the map does not say where its {wide} x {high} nodes lie"
        remedy = (
            "state it in the set-up, from the first node to the last and how many: "
            'map = {{ X = ["20 mm", "280 mm", {wide}], Y = ["20 mm", "280 mm", {high}] }}'
        )
        raise file.fail(what, remedy, line, wide=wide, high=high)
    return grid(file, [(*side, count) for side, count in zip(ends, (wide, high), strict=True)], rows, line, skipped)


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split(",")]


def filled(file: TextFile, x: Sequence[float], rows: PlacedRows) -> set[tuple[int, int]]:
    """Return the cells that Klipper filled: off the circle, and all of them copies of their row's last inside.

    A [bed_mesh] without mesh_radius in the same file says that the bed is no circle.
    """
    lines, y = file.lines, [row[0] for row in rows]
    rectangle = any(map(_RECTANGLE.match, lines)) and not any(map(_ROUND.match, lines))
    radius, found = (x[-1] - x[0]) / 2 + _SLACK, set[tuple[int, int]]()
    if rectangle or abs(y[-1] - y[0] - x[-1] + x[0]) > _SLACK:
        return found
    for j, (at, _, cells) in enumerate(rows):
        off = [hypot(each - (x[0] + x[-1]) / 2, at - (y[0] + y[-1]) / 2) > radius for each in x]
        inside = [cell for cell, aside in zip(cells, off, strict=False) if not aside]
        if not inside or cells != [inside[0]] * off.index(False) + inside + [inside[-1]] * off[::-1].index(False):
            return set()
        found |= {(i, j) for i, aside in enumerate(off) if aside}
    return found


def grid(file: TextFile, sides: Sequence[Side], points: Rows, line: int, skipped: Skipping | None = None) -> Found:
    """Return the readings of the cells that were probed; raises ReadingError.

    sides : of x and of y; skipped : gives columns and rows of cells that are no readings
    """
    for low, high, count in sides:
        if not (float(count).is_integer() and 1 <= count <= _MOST and (high > low if count > 1 else high == low)):
            what, ends = "{count:g} nodes from {low:g} to {high:g} mm are no map", (1e3 * low, 1e3 * high)
            raise file.fail(what, "copy the whole map", line, count=count, low=ends[0], high=ends[1])
    at_x, at_y = (np.linspace(low, high, int(count)).tolist() for low, high, count in sides)
    if len(points) != len(at_y):
        what = "{count} rows are announced, and there are {rows}"
        raise file.fail(what, "copy the whole map", line, count=len(at_y), rows=len(points))
    rows = [(at, number, cells) for at, (number, cells) in zip(at_y, points, strict=True)]
    off, found = skipped(file, at_x, rows) if skipped else set(), list[RawReading]()
    for j, (y, number, cells) in enumerate(rows):
        if len(cells) != len(at_x):
            what = "the row has {count} heights, and {along} are announced"
            raise file.fail(what, "copy the whole file", number, count=len(cells), along=len(at_x))
        for i, (x, cell) in enumerate(zip(at_x, cells, strict=True)):
            if (i, j) not in off:
                found += height(file, x, y, cell, number)
    return probed_of(file, found, len(at_x) * len(rows), rows[0][1])


def keyed(file: TextFile, keys: Mapping[str, str], line: int, spaced: bool = False) -> list[Side]:
    """Return the sides that keys state; raises ReadingError.  spaced : by the distance between nodes"""
    sides = []
    for k, letter in enumerate("xy"):
        known = [each.format(letter, k).split() for each in _KEYS[: 3 + spaced]]
        found = [next((name for name in each if name in keys), "") for each in known]
        if "" in found:
            key = known[found.index("")][0 if spaced else -1]
            raise file.fail("the map has no {key}", "copy the whole map", line - spaced, key=key)
        low, high, count, *spacing = (file.number(keys[name], name, line) for name in found)
        last = low + (count - 1) * spacing[0] if spacing else high
        if last > high + sum(spacing):
            what = "{count:g} nodes from {low:g} to {high:g} mm, {spacing:g} mm apart, are no map"
            raise file.fail(what, "copy the whole map", line, count=count, low=low, high=high, spacing=spacing[0])
        sides.append((*from_unit(np.array([low, last]), file.unit or "mm").tolist(), count))
    return sides
