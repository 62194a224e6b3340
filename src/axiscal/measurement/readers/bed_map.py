"""Bed maps of printers: RepRapFirmware (`heightmap.csv`), Klipper (`[bed_mesh NAME]`, its console), Moonraker, Marlin.

A height is where the bed lies, positive where it is high; a printer adds it to Z. Each node is one reading along z at X
and Y, of minus the height. Cells that nobody probed are no readings: RepRapFirmware's 0 without decimals, whatever lies
outside its radius, the copies with which Klipper fills the rows of a round bed, Marlin's `.`, `=====` and NAN, and
nodes that no M421 sets where the set-up says how many there are. Lines of a terminal's log do not count.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import compress
from math import hypot
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from axiscal.document.file import number_or_none
from axiscal.language.spoken import joined, said
from axiscal.measurement.readers.columns import unread
from axiscal.measurement.readers.csv_readings import Around, Found, RawReading
from axiscal.measurement.readers.probe_offset import objects_in
from axiscal.measurement.readers.text_file import LINES_OF, TextFile, has_line, newest_first, read_text
from axiscal.units import from_unit

Side = tuple[float, float, float]
"""Of a map: first and last node, m, and how many."""
Rows = list[tuple[int, list[str]]]
"""Of a map, along y: line and cells."""
_LINES, _TOUCHES, _MARLIN = LINES_OF["maps"], LINES_OF["touches"], LINES_OF["marlin"]
is_height_map, is_console = (partial(has_line, [_LINES[name]]) for name in ("height_map", "console"))
is_printed, is_nodes = (partial(has_line, [_MARLIN[name]]) for name in ("printed", "node"))
is_touched = partial(has_line, [*_TOUCHES.values()])
"""Whether a line is that by which such a map begins, sets a node, or is a touch."""
_PRINTED_TO = {"X": 1e-4, "Y": 1e-4}
"""m: places are printed in fewer digits than they have, some in whole millimetres."""
_SLACK = 1e-4
"""m, of a radius: Klipper cuts its distances to 0.01 mm."""
_Saved = TypeVar("_Saved")
_MOST = 1000
"""Nodes along a side."""
_WHOLE, _ONE = "copy the whole map", "keep the one that is to count"
_KEYS = "{0}min min{1} min_{0}", "{0}max max{1} max_{0}", "{0}num num{1} {0}_count", "{0}spacing spacing{1} spacing"
"""Of a side: as RepRapFirmware writes them today, in its newest version, and Klipper, or its first version."""


def height(file: TextFile, x: float, y: float, cell: str, line: int) -> Iterator[RawReading]:
    """Yield the reading of a cell, nothing where nobody probed it; raises ReadingError.  x, y : m"""
    if not unread(cell):
        low = -file.length(cell, "height", line)
        yield RawReading("", {"X": x, "Y": y}, {}, low, None, "length", line, error="z", rounding=_PRINTED_TO)


def probed_of(file: TextFile, readings: Sequence[RawReading], cells: int, line: int) -> Found:
    """Return the readings of a map; raises ReadingError where nobody probed one.  cells : all that it has"""
    if not readings:
        raise file.fail("no node was probed", "probe the bed and save the map again", line)
    return Found(tuple(readings), cells)


def _profile(file: TextFile) -> str:
    """Return the NAME of a mesh behind the name of its file, as in `printer.cfg#NAME`; "" where none is named."""
    whole, _, name = file.name.rpartition("#")
    return name if whole and not Path(file.name).exists() else ""


def read_part(path: str | Path, unit: str = "") -> TextFile:
    """Return a file; raises ReadingError where FILE#NAME names no mesh that is saved in it."""
    part = _profile(TextFile(str(path), ()))
    file = replace(read_text(str(path).removesuffix(f"#{part}") if part else path, unit), name=str(path))
    if part and not is_moonraker(file):
        _chosen(file, _profiles(file))
    return file


def _chosen(file: TextFile, saved: Mapping[str, _Saved], active: str = "", line: int = 1) -> _Saved:
    """Return the saved mesh that FILE#NAME names, the one in force, or the only one; raises ReadingError for another.

    saved : by name; line : of the last one
    """
    known, part = ", ".join(saved), _profile(file)
    name = part or active
    if not saved or (part and name not in saved):
        what = "no mesh {name} is saved here"
        raise file.fail(what, "saved are: {known}", name=name[:40] or "in force", known=known or "-")
    if name not in saved and len(saved) > 1:
        what, name = "{count} meshes are saved here: {names}", f"{Path(file.name).name}#{[*saved][-1]}"
        raise file.fail(what, "name one of them: {name}", line, count=len(saved), names=known, name=name)
    return saved[name] if name in saved else next(iter(saved.values()))


def is_mesh(file: TextFile) -> bool:
    """Return whether a Klipper mesh is saved in this file."""
    return bool(_profiles(file))


def is_moonraker(file: TextFile) -> bool:
    """Return whether this is an answer of Moonraker with a mesh in it."""
    first = next((line for line in file.lines if line.strip()), "")
    return first.lstrip().startswith(("{", "[")) and any(map(_LINES["moonraker"].match, file.lines))


def _profiles(file: TextFile) -> dict[str, int]:
    """Return the lines of the meshes by their names."""
    return {begin[1]: number for number, line in enumerate(file.lines, 1) if (begin := _LINES["block"].match(line))}


def height_map(file: TextFile, around: Around) -> Found:
    """Return the readings of the probed nodes of a RepRapFirmware map, any version of it; raises ReadingError."""
    texts = [line.rstrip(",;\t ") for line in (*file.lines, "", "")]  # a spreadsheet fills lines up
    if not texts[1].count(","):
        texts = [re.sub("[;\t]", ",", line.replace(",", ".")) for line in texts]
    head = dict(zip(_cells(texts[1]), _cells(texts[2]), strict=False))
    lines = ((n, line) for n, line in enumerate(texts[3:], 4) if line)
    rows = [(n, ["" if cell == "0" else cell for cell in _cells(line)]) for n, line in lines]
    if (over := (head.get("axis0", "X"), head.get("axis1", "Y"))) != ("X", "Y"):  # named since version 3.3
        what, remedy = "the map is over {axes}, and that of a bed is over X and Y", "probe the bed by X and Y"
        raise file.fail(what, remedy, 3, axes=joined(over))
    radius = file.length(head.get("radius", "-1"), "radius", 3)
    found = grid(file, _keyed(file, head, 3, spaced=True), rows, 3)
    inside = [each for each in found.readings if not 0 <= radius < hypot(*each.position.values())]
    return probed_of(file, inside, found.cells, 3)


def mesh(file: TextFile, around: Around, whole: bool = False) -> Found:
    """Return the readings of the only mesh that is saved in a Klipper configuration; raises ReadingError.

    whole : with the cells that Klipper filled, as it corrects by them
    """
    profiles = _profiles(file)
    begin = _chosen(file, profiles, line=[*profiles.values()][-1])
    keys, points, inside = dict[str, str](), Rows(), False
    for number, line in enumerate(file.lines[begin:], begin + 1):
        text = line.removeprefix("#*#").partition("#")[0].strip()
        if text.startswith("["):
            break
        if option := _LINES["option"].fullmatch(text):
            if not _LINES["of_mesh"].fullmatch(option[1]):
                raise file.fail("{key} is not known of a mesh", "take it out", number, key=option[1][:40])
            inside, keys[option[1]] = option[1] == "points", option[2]
            text = option[2] if inside else ""
        if inside and text:
            points.append((number, _cells(text.rstrip(", "))))
    found = grid(file, _keyed(file, keys, begin), points, begin)
    return found if whole else _unfilled(file, found)


def moonraker(file: TextFile, around: Around) -> Found:
    """Return the readings of the mesh in force in an answer of Moonraker, or of FILE#NAME; raises ReadingError."""
    held = dict[str, Any]()
    for each in objects_in("\n".join(file.lines)):
        held |= {key: value for key, value in each.items() if {"probed_matrix", "profiles"} & each.keys()}
    active = str(held.get("profile_name") or held.get("name") or "")
    saved = {str(name): _as(dict, each) for name, each in _as(dict, held.get("profiles")).items()}
    rows = _as(list, held.get("probed_matrix"))
    if rows not in ([], [[]]) and _profile(file) in ("", active):
        ends = [*_as(list, held.get("mesh_min")), *_as(list, held.get("mesh_max"))]
        corners = dict(zip(("min_x", "min_y", "max_x", "max_y"), ends, strict=True)) if len(ends) == 4 else {}
        sizes = {"x_count": len(_as(list, rows[0])), "y_count": len(rows)}
        saved[active] = {"points": rows, "mesh_params": (_as(dict, held.get("mesh_params")) or corners) | sizes}
    chosen = _chosen(file, saved, active)
    points = [(1, [str(cell) for cell in _as(list, row)]) for row in _as(list, chosen.get("points"))]
    keys = {str(key): str(value) for key, value in _as(dict, chosen.get("mesh_params")).items()}
    return _unfilled(file, grid(file, _keyed(file, keys, 1), points, 1))


def _as(kind: type, value: object) -> Any:
    """Return a value of that kind, an empty one in place of another."""
    return value if isinstance(value, kind) else kind()


def console(file: TextFile, around: Around) -> Found:
    """Return the readings of what BED_MESH_OUTPUT printed, rows along y; raises ReadingError."""
    return _unfilled(file, grid(file, around, *_rows_below(file, _LINES["console"])))


def _rows_below(file: TextFile, title: re.Pattern[str]) -> tuple[Rows, int]:
    """Return the first lines of nothing but numbers below a title, and its line; raises ReadingError for two maps."""
    begins, rows = [number for number, text in file.told if title.match(text)], Rows()
    if len(begins) > 1:
        raise file.fail("there are {count} maps in this file", _ONE, begins[1], count=len(begins))
    for number, text in file.told[begins[0] :]:
        cells = text.split()
        if cells and all(map(_LINES["number"].fullmatch, cells)):
            rows.append((number, cells))
        elif rows:
            break
    return rows, begins[0]


def printed(file: TextFile, around: Around) -> Found:
    """Return the readings of a grid of Marlin, rows along y, those of a Prusa backwards; raises ReadingError."""
    rows, begin = _rows_below(file, _MARLIN["printed"])
    numbered = [(line, cells[1:]) for j, (line, cells) in enumerate(rows[1:]) if cells[0] == str(j)]
    if len(numbered) >= len(rows) - 1:
        return grid(file, around, _visited(numbered), begin)
    if not has_line([_MARLIN["unlabelled"]], file):
        what = "these heights lie between the probed ones: they are those that the printer corrects by"
        remedy = "give what was probed: the mesh of printer.cfg, or the answer to BED_MESH_OUTPUT or to M420 V"
        raise file.fail(what, remedy, begin)
    prusa = has_line([_MARLIN["prusa"]], file)
    found = grid(file, around, rows[:: -1 if prusa else 1], begin)
    return replace(found, note=said("as if all were probed") if prusa else "")


def _visited(rows: Rows) -> Rows:
    """Return rows without numbers in those of zeros alone: three and more are where Marlin did not come."""
    zeros = [len(cells) > 2 and all(number_or_none(cell) == 0 for cell in cells) for _, cells in rows]
    return [(line, ["nan"] * len(cells) if zero else cells) for (line, cells), zero in zip(rows, zeros, strict=True)]


def nodes(file: TextFile, around: Around, zeros: bool = False) -> Found:
    """Return the readings of commands that set nodes; raises ReadingError.  zeros : with their rows, too

    A node that no command sets was not probed, where the set-up says how many there are; else it is refused.
    """
    file = replace(file, unit="in" if has_line([_MARLIN["inches"]], file) else "mm")  # inches behind G20
    found, line = dict[tuple[int, int], tuple[int, str]](), 1
    for number, text in file.told:
        if command := _MARLIN["node"].match(text):
            whole = _MARLIN["of_node"].fullmatch(command[2])
            if not whole or (int(whole[1]), int(whole[2])) in found:
                what, remedy = "{text!r} says no height of a point, or one again", "write each as in M421 I0 J0 Z0.05"
                raise file.fail(what, remedy, number, text=text[:40])
            found[int(whole[1]), int(whole[2])], line = (number, whole[3] or "nan"), number
    stated = next((setup.nodes for setup in around.setups if setup.nodes is not None), None)
    wide, high = (max(node[side] for node in found) + 1 for side in (0, 1))
    if stated is not None:
        wide, high = max(wide, stated[0][2]), max(high, stated[1][2])
    elif len(found) < wide * high or min(wide, high) < 2:
        what = "the mesh of {wide} x {high} points has {count} values"
        remedy = "give the whole answer to M503, or state in the set-up how many were probed: map"
        raise file.fail(what, remedy, line, wide=wide, high=high, count=len(found))
    built = next((ends for text in file.lines if (ends := _MARLIN["built"].match(text))), None)
    if built and stated is None:
        low_x, top_x, low_y, top_y = (from_unit(file.number(end, "end", 1), "mm") for end in built.groups())
        around = replace(around, ends=((low_x, top_x), (low_y, top_y)))
    rows = [(line, [found.get((i, j), (0, "nan"))[1] for i in range(wide)]) for j in range(high)]
    return grid(file, around, rows if zeros else _visited(rows), line)


def touched(file: TextFile, around: Around) -> Found:
    """Return the readings of touches that a firmware printed, in inches where grbl has $13=1; raises ReadingError.

    Where it prints the place of the nozzle, the probe stands beside it as the set-up says.
    """
    name, pattern = next((name, each) for name, each in _TOUCHES.items() if has_line([each], file))
    stated = (setup.offset for setup in around.setups if setup.offset is not None and name == "nozzle")
    aside = next(stated, (0.0, 0.0, 0.0))
    file = replace(file, unit=file.unit or "in" * any(line.strip() == "$13=1" for line in file.lines))
    found, count, line, whole = list[RawReading](), 0, 1, False
    for line, text in file.told[:: -1 if newest_first(file) else 1]:
        whole |= bool(found and _LINES["mapped"].match(text))
        if _LINES["trammed"].match(text):
            found, count = [], 0
        elif point := pattern.match(text):
            if whole:
                raise file.fail("there are {count} maps in this file", _ONE, line, count=2)
            if point[4].strip():
                raise file.fail("{text!r} is not X, Y and Z", "give the lines as printed", line, text=text[:60])
            x, y = (file.length(point[1 + k], "place", line) + aside[k] for k in (0, 1))
            found += height(file, x, y, point[3], line)
            count += 1
    return noted(file, probed_of(file, found, count, line))


def noted(file: TextFile, found: Found) -> Found:
    """Return readings whose numbers name no unit with that taken; raises ReadingError where a remark names another."""
    named = (number for number, line in enumerate(file.lines, 1) if _LINES["inches"].match(line))
    if not file.unit and (line := next(named, 0)):
        raise file.fail("this line names inches, and the numbers name no unit", "say it: --unit inch or mm", line)
    return replace(found, note=said("in {unit}", unit=file.unit or "mm"))


def _stated(file: TextFile, wide: int, high: int, line: int, around: Around) -> list[Side]:
    """Return the sides of a map that carries no coordinates, as the set-up states them by `map`.

    Raises ReadingError for another number of nodes than it says.
    """
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
    return [(*side, count) for side, count in zip(ends, (wide, high), strict=True)]


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split(",")]


def _unfilled(file: TextFile, found: Found) -> Found:
    """Return a map without the cells that Klipper filled: off the circle, all copies of their row's last inside.

    A [bed_mesh] without mesh_radius in the same file says that the bed is no circle.
    """
    rectangle = any(map(_LINES["rectangle"].match, file.lines)) and not any(map(_LINES["round"].match, file.lines))
    places = np.array([(each.position["X"], each.position["Y"]) for each in found.readings])
    middle, (wide, high) = (places.min(0) + places.max(0)) / 2, np.ptp(places, axis=0)
    if rectangle or abs(high - wide) > _SLACK:
        return found
    inside = np.hypot(*(places - middle).T) <= wide / 2 + _SLACK
    rows = dict[float, list[RawReading]]()
    for each in compress(found.readings, inside):
        rows.setdefault(each.position["Y"], []).append(each)
    for each in compress(found.readings, ~inside):
        row = rows.get(each.position["Y"])
        if row is None or each.value != row[0 if each.position["X"] < middle[0] else -1].value:
            return found
    return replace(found, readings=tuple(compress(found.readings, inside)))


def grid(file: TextFile, places: Sequence[Side] | Around, points: Rows, line: int) -> Found:
    """Return the readings of the cells that were probed; raises ReadingError.

    places : sides of x and of y, or who states them
    """
    if not points:
        raise file.fail("the height map is cut off", _WHOLE, line)
    sides = _stated(file, len(points[0][1]), len(points), line, places) if isinstance(places, Around) else places
    for low, high, count in sides:
        if not (float(count).is_integer() and 1 <= count <= _MOST and (high > low if count > 1 else high == low)):
            what, ends = "{count:g} nodes from {low:g} to {high:g} mm are no map", (1e3 * low, 1e3 * high)
            raise file.fail(what, _WHOLE, line, count=count, low=ends[0], high=ends[1])
    at_x, at_y = (np.linspace(low, high, int(count)).tolist() for low, high, count in sides)
    found = list[RawReading]()
    for number, cells in points:
        if (len(points), len(cells)) != (len(at_y), len(at_x)):
            what = "{high} rows of {wide} heights are announced, and {rows} of {count} are there"
            sizes = {"high": len(at_y), "wide": len(at_x), "rows": len(points), "count": len(cells)}
            raise file.fail(what, _WHOLE, number, **sizes)
    for y, (number, cells) in zip(at_y, points, strict=True):
        for x, cell in zip(at_x, cells, strict=True):
            found += height(file, x, y, cell, number)
    return probed_of(file, found, len(at_x) * len(at_y), points[0][0])


def _keyed(file: TextFile, keys: Mapping[str, str], line: int, spaced: bool = False) -> list[Side]:
    """Return the sides that keys state; raises ReadingError.  spaced : by the distance between nodes"""
    sides = []
    for k, letter in enumerate("xy"):
        known = [each.format(letter, k).split() for each in _KEYS[: 3 + spaced]]
        found = [next((name for name in each if name in keys), "") for each in known]
        if "" in found:
            key = known[found.index("")][0 if spaced else -1]
            raise file.fail("the map has no {key}", _WHOLE, line - spaced, key=key)
        low, high, count, *spacing = (file.number(keys[name], name, line) for name in found)
        last = low + (count - 1) * spacing[0] if spacing else high
        if last > high + sum(spacing):
            what = "{count:g} nodes from {low:g} to {high:g} mm are no map"
            raise file.fail(what, _WHOLE, line, count=count, low=low, high=high)
        sides.append((*from_unit(np.array([low, last]), file.unit or "mm").tolist(), count))
    return sides
