"""Bed maps of printers, as RepRapFirmware (`heightmap.csv`) and Klipper (`[bed_mesh NAME]`) keep them.

A height is where the bed lies, positive where it is high; a printer adds it to Z. Each node is one reading along z at X
and Y, of minus the height. Cells that nobody probed are no readings: RepRapFirmware's 0 without decimals, whatever lies
outside its radius, and the copies with which Klipper fills the rows of a round bed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import hypot
from pathlib import Path

from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.readers.csv_table import TextFile, read_text
from axiscal.units import from_unit

_RRF = "RepRapFirmware height map file"
_BLOCK = re.compile(r"(?:#\*#\s*)?\[bed_mesh\s+([^\]]+?)\s*\]")
_RECTANGLE, _ROUND = re.compile(r"\[bed_mesh\]"), re.compile(r"\s*mesh_radius\s*[:=]")
_NOT_PROBED = frozenset({"", ".", "nan"})
_SLACK = 1e-4
"""m, of a radius: Klipper cuts its distances to 0.01 mm."""
_KEYS = "{0}min min{1} min_{0}", "{0}max max{1} max_{0}", "{0}num num{1} {0}_count", "{0}spacing spacing{1} spacing"
"""Of a side: as RepRapFirmware writes them today, in its newest version, and Klipper, or its first version."""


@dataclass(frozen=True, slots=True)
class _Grid:
    """The cells of a map.  x : m; rows : y, m, the line and its cells"""

    file: TextFile
    x: list[float]
    rows: list[tuple[float, int, list[str]]]

    def readings(self, skipped: set[tuple[int, int]]) -> tuple[RawReading, ...]:
        """Return the readings of the cells that were probed.  skipped : column and row of others"""
        found = []
        for j, (y, number, cells) in enumerate(self.rows):
            if len(cells) != len(self.x):
                what = "the row has {count} heights, and {along} are announced"
                raise self.file.fail(what, "copy the whole file", number, count=len(cells), along=len(self.x))
            for i, (x, cell) in enumerate(zip(self.x, cells, strict=True)):
                if (i, j) not in skipped and cell.lower() not in _NOT_PROBED:
                    low = -from_unit(self.file.number(cell, "height", number), "mm")
                    found.append(RawReading("", {"X": x, "Y": y}, {}, low, None, "length", number, error="z"))
        if not found:
            raise self.file.fail("no node was probed", "probe the bed and save the map again", 3)
        return tuple(found)

    def filled(self) -> set[tuple[int, int]]:
        """Return the cells that Klipper filled: off the circle, and all of them copies of their row's last inside.

        A [bed_mesh] without mesh_radius in the same file says that the bed is no circle.
        """
        lines, x, y = self.file.lines, self.x, [row[0] for row in self.rows]
        rectangle = any(map(_RECTANGLE.match, lines)) and not any(map(_ROUND.match, lines))
        radius, found = (x[-1] - x[0]) / 2 + _SLACK, set[tuple[int, int]]()
        if rectangle or abs(y[-1] - y[0] - x[-1] + x[0]) > _SLACK:
            return found
        for j, (at, _, cells) in enumerate(self.rows):
            off = [hypot(each - (x[0] + x[-1]) / 2, at - (y[0] + y[-1]) / 2) > radius for each in x]
            inside = [cell for cell, aside in zip(cells, off, strict=False) if not aside]
            if not inside or cells != [inside[0]] * off.index(False) + inside + [inside[-1]] * off[::-1].index(False):
                return set()
            found |= {(i, j) for i, aside in enumerate(off) if aside}
        return found


def read_part(path: str | Path) -> TextFile:
    """Return a file, of FILE#NAME with the mesh profile NAME alone; raises ReadingError."""
    whole, _, name = str(path).rpartition("#")
    if not whole or Path(path).exists():
        return read_text(path)
    file, kept, section = read_text(whole), list[str](), ""
    for line in file.lines:
        if line.removeprefix("#*#").lstrip().startswith("["):
            section = begin[1] if (begin := _BLOCK.match(line)) else ""
        kept.append(line if section in ("", name) else "")
    if name not in _profiles(file).values():
        known = ", ".join(_profiles(file).values()) or "-"
        raise file.fail("no mesh {name} is saved here", "saved are: {known}", name=name[:40], known=known)
    return TextFile(str(path), tuple(kept))


def is_height_map(file: TextFile) -> bool:
    """Return whether this is a height map of RepRapFirmware."""
    return file.lines[0].startswith(_RRF)


def is_mesh(file: TextFile) -> bool:
    """Return whether a Klipper mesh is saved in this file."""
    return bool(_profiles(file))


def _profiles(file: TextFile) -> dict[int, str]:
    """Return the names of the meshes by their lines."""
    return {number: begin[1] for number, line in enumerate(file.lines, 1) if (begin := _BLOCK.match(line))}


def height_map(file: TextFile) -> tuple[RawReading, ...]:
    """Return the readings of the probed nodes of a RepRapFirmware map, any version of it; raises ReadingError."""
    if len(file.lines) < 4:
        raise file.fail("the height map is cut off", "copy the whole heightmap.csv", len(file.lines))
    head = dict(zip(_cells(file.lines[1]), _cells(file.lines[2]), strict=False))
    grid = _grid(file, head, [(n, _cells(line)) for n, line in enumerate(file.lines[3:], 4) if line.strip()], 3, True)
    radius = from_unit(file.number(head.get("radius", "-1"), "radius", 3), "mm")
    places = ((i, j, x, cells[i : i + 1], y) for j, (y, _, cells) in enumerate(grid.rows) for i, x in enumerate(grid.x))
    return grid.readings({(i, j) for i, j, x, cell, y in places if cell == ["0"] or 0 <= radius < hypot(x, y)})


def mesh(file: TextFile, filled: bool = False) -> tuple[RawReading, ...]:
    """Return the readings of the only mesh that is saved in a Klipper configuration; raises ReadingError.

    filled : with the cells that Klipper filled, as it corrects by them
    """
    names = _profiles(file)
    begin, *others = names
    if others:
        what, known = "{count} meshes are saved here: {names}", ", ".join(names.values())
        name = f"{Path(file.name).name}#{names[others[-1]]}"
        raise file.fail(what, "name one of them: {name}", others[0], count=len(names), names=known, name=name)
    keys, points, inside = dict[str, str](), list[tuple[int, list[str]]](), False
    for number, line in enumerate(file.lines[begin:], begin + 1):
        text = line.removeprefix("#*#").strip()
        if text.startswith("["):
            break
        key, equals, value = text.partition("=")
        if equals:
            inside = key.strip() == "points"
            keys[key.strip()] = value.strip()
        elif inside and text:
            points.append((number, _cells(text.rstrip(", "))))
    grid = _grid(file, keys, points, begin, False)
    return grid.readings(set() if filled else grid.filled())


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split(",")]


def _grid(file: TextFile, keys: dict[str, str], points: list[tuple[int, list[str]]], line: int, spaced: bool) -> _Grid:
    """Return the cells at their places; raises ReadingError.  spaced : by a distance that is stated"""
    x, y = (_side(file, keys, [each.format("xy"[k], k).split() for each in _KEYS], line, spaced) for k in (0, 1))
    if len(points) != len(y):
        what = "{count} rows are announced, and there are {rows}"
        raise file.fail(what, "copy the whole map", line, count=len(y), rows=len(points))
    return _Grid(file, x, [(at, number, cells) for at, (number, cells) in zip(y, points, strict=True)])


def _side(file: TextFile, keys: dict[str, str], names: list[list[str]], line: int, spaced: bool) -> list[float]:
    """Return the coordinates of one side, m."""
    found = [next((name for name in each if name in keys), "") for each in names[: 3 + spaced]]
    if "" in found:
        key = names[found.index("")][0 if spaced else -1]
        raise file.fail("the map has no {key}", "copy the whole map", line - spaced, key=key)
    low, high, count, *stated = (file.number(keys[name], name, line) for name in found)
    spacing = stated[0] if stated else (high - low) / max(count - 1, 1)
    if not 2 - spaced <= count <= 1000 or spacing <= 0 or low + (count - 1) * spacing > high + spacing:
        what = "{count:g} nodes from {low:g} to {high:g} mm, {spacing:g} mm apart, are no map"
        raise file.fail(what, "copy the whole map", line, count=count, low=low, high=high, spacing=spacing)
    return [from_unit(low + i * spacing, "mm") for i in range(int(count))]
