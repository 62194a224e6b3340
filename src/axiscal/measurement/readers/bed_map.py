"""Bed maps of printers, as RepRapFirmware (`heightmap.csv`) and Klipper (saved blocks of `printer.cfg`) keep them.

A height is where the bed lies, positive where it is high; a printer adds it to Z. Each node is one reading along z at X
and Y, of minus the height. RepRapFirmware writes 0 without decimals where it did not probe: that is no reading.
"""

from __future__ import annotations

from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.readers.csv_table import TextFile
from axiscal.units import from_unit

_RRF = "RepRapFirmware height map file"
_BLOCK = "#*# [bed_mesh "
_NOT_PROBED = ("0", "")


def is_height_map(file: TextFile) -> bool:
    """Return whether this is a height map of RepRapFirmware."""
    return file.lines[0].startswith(_RRF)


def is_mesh(file: TextFile) -> bool:
    """Return whether a Klipper mesh is saved in this file."""
    return any(line.startswith(_BLOCK) for line in file.lines)


def height_map(file: TextFile) -> tuple[RawReading, ...]:
    """Return the readings of the probed nodes of a RepRapFirmware map, both versions of it; raises ReadingError."""
    if len(file.lines) < 4:
        raise file.fail("the height map is cut off", "copy the whole heightmap.csv", len(file.lines))
    head = dict(zip(_cells(file.lines[1]), _cells(file.lines[2]), strict=False))
    x, y = (_axis(file, head, number) for number in (0, 1))
    rows = [(number, line) for number, line in enumerate(file.lines[3:], 4) if line.strip()]
    if len(rows) != len(y):
        remedy = "copy the whole heightmap.csv"
        raise file.fail("{count} rows are announced, and there are {rows}", remedy, 3, count=len(y), rows=len(rows))
    return _nodes(file, x, [(at, number, _cells(line)) for at, (number, line) in zip(y, rows, strict=True)])


def mesh(file: TextFile) -> tuple[RawReading, ...]:
    """Return the readings of the only mesh that is saved in a Klipper configuration; raises ReadingError."""
    begins = [number for number, line in enumerate(file.lines, 1) if line.startswith(_BLOCK)]
    if len(begins) > 1:
        names = ", ".join(file.lines[number - 1][len(_BLOCK) :].rstrip("] ") for number in begins)
        remedy = "keep one of them"
        raise file.fail("{count} meshes are saved here: {names}", remedy, begins[1], count=len(begins), names=names)
    keys, points = _block(file, begins[0])
    sides = []
    for name in "xy":
        low, high, count = (
            _value(file, keys, key, begins[0]) for key in (f"min_{name}", f"max_{name}", f"{name}_count")
        )
        sides.append(_spread(file, low, high, int(count), begins[0]))
    if len(points) != len(sides[1]):
        what = "{count} rows are announced, and there are {rows}"
        raise file.fail(what, "copy the whole block", begins[0], count=len(sides[1]), rows=len(points))
    rows = [(at, number, cells) for at, (number, cells) in zip(sides[1], points, strict=True)]
    return _nodes(file, sides[0], rows, zero_is_height=True)


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split(",")]


def _axis(file: TextFile, head: dict[str, str], which: int) -> list[float]:
    """Return the coordinates of one axis of a height map, m; v1 has one spacing, v3 names the axes."""
    name, number = "xy"[which], str(which)
    low, high, spacing, count = (
        _first(file, head, keys)
        for keys in (
            (f"{name}min", f"min{number}"),
            (f"{name}max", f"max{number}"),
            (f"{name}spacing", f"spacing{number}", "spacing"),
            (f"{name}num", f"num{number}"),
        )
    )
    if not 1 <= count <= 1000 or spacing <= 0 or low + (count - 1) * spacing > high + spacing:
        what = "{count:g} nodes {spacing:g} mm apart do not fit the range"
        raise file.fail(what, "copy the whole heightmap.csv", 3, count=count, spacing=spacing)
    return [from_unit(low + i * spacing, "mm") for i in range(int(count))]


def _first(file: TextFile, head: dict[str, str], keys: tuple[str, ...]) -> float:
    for key in keys:
        if key in head:
            return file.number(head[key], key, 3)
    raise file.fail("there is no {key} in the second line", "copy the whole heightmap.csv", 2, key=keys[0])


def _nodes(
    file: TextFile, x: list[float], rows: list[tuple[float, int, list[str]]], zero_is_height: bool = False
) -> tuple[RawReading, ...]:
    found = []
    for y, number, cells in rows:
        if len(cells) != len(x):
            what = "the row has {count} heights, and {along} are announced"
            raise file.fail(what, "copy the whole file", number, count=len(cells), along=len(x))
        for at, cell in zip(x, cells, strict=True):
            if zero_is_height or cell not in _NOT_PROBED:
                low = -from_unit(file.number(cell, "height", number), "mm")
                found.append(RawReading("", {"X": at, "Y": y}, {}, low, None, "length", number, error="z"))
    if not found:
        raise file.fail("no node was probed", "probe the bed and save the map again", 3)
    return tuple(found)


def _block(file: TextFile, begin: int) -> tuple[dict[str, str], list[tuple[int, list[str]]]]:
    """Return the keys of a saved block, and its rows of points with their lines."""
    keys, points, inside = dict[str, str](), list[tuple[int, list[str]]](), False
    for number, line in enumerate(file.lines[begin:], begin + 1):
        text = line.removeprefix("#*#").strip()
        if not line.startswith("#*#") or text.startswith("["):
            break
        key, equals, value = text.partition("=")
        if equals:
            inside = key.strip() == "points"
            keys[key.strip()] = value.strip()
        elif inside and text:
            points.append((number, _cells(text.rstrip(", "))))
    return keys, points


def _value(file: TextFile, keys: dict[str, str], key: str, line: int) -> float:
    if key not in keys:
        raise file.fail("the mesh has no {key}", "copy the whole block", line, key=key)
    return file.number(keys[key], key, line)


def _spread(file: TextFile, low: float, high: float, count: int, line: int) -> list[float]:
    if not 2 <= count <= 1000 or high <= low:
        what = "{count} nodes from {low:g} to {high:g} mm are no mesh"
        raise file.fail(what, "copy the whole block", line, count=count, low=low, high=high)
    return [from_unit(low + i * (high - low) / (count - 1), "mm") for i in range(count)]
