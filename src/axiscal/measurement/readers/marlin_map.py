"""Bed maps as Marlin prints them: grids of M420 V, nodes of M421 and M503.

Lines of a terminal's log around the map do not count. Cells that nobody probed are `.`, `=====` or NAN, and nodes that
no line sets where the set-up says how many there are.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from axiscal.document.file import number_or_none
from axiscal.language.spoken import said
from axiscal.measurement.readers.bed_map import Rows, grid, rows_below
from axiscal.measurement.readers.csv_readings import Around, Found
from axiscal.measurement.readers.text_file import LINES_OF, TextFile, has_line
from axiscal.units import from_unit

_LINES = LINES_OF["marlin"]
is_printed, is_nodes = (partial(has_line, [_LINES[name]]) for name in ("printed", "node"))
"""Whether a line is that by which a grid begins, or sets a node."""


def printed(file: TextFile, around: Around) -> Found:
    """Return the readings of a grid, rows along y, those of a Prusa backwards; raises ReadingError."""
    rows, begin = rows_below(file, _LINES["printed"])
    numbered = [(line, cells[1:]) for j, (line, cells) in enumerate(rows[1:]) if cells[0] == str(j)]
    if len(numbered) >= len(rows) - 1:
        return grid(file, around, _visited(numbered), begin)
    if not has_line([_LINES["unlabelled"]], file):
        what = "these heights lie between the probed ones: they are those that the printer corrects by"
        remedy = "give what was probed: the mesh of printer.cfg, or the answer to BED_MESH_OUTPUT or to M420 V"
        raise file.fail(what, remedy, begin)
    prusa = has_line([_LINES["prusa"]], file)
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
    file = replace(file, unit="in" if has_line([_LINES["inches"]], file) else "mm")  # inches behind G20
    found = dict[tuple[int, int], tuple[int, str]]()
    for number, text in file.told:
        if command := _LINES["node"].match(text):
            if not (whole := _LINES["of_node"].fullmatch(command[2])):
                remedy = "write it as in M421 I0 J0 Z0.05"
                raise file.fail("{text!r} says no height of a point", remedy, number, text=text[:40])
            i, j, node = whole[1], whole[2], (int(whole[1]), int(whole[2]))
            if node in found:
                what = "node I{i} J{j} stands in line {earlier} too"
                raise file.fail(what, "keep one of them", number, i=i, j=j, earlier=found[node][0])
            found[node] = number, whole[3] or "nan"
    stated = next((setup.nodes for setup in around.setups if setup.nodes is not None), None)
    wide, high = (max(node[side] for node in found) + 1 for side in (0, 1))
    line = max(number for number, _ in found.values())
    if stated is not None:
        wide, high = max(wide, stated[0][2]), max(high, stated[1][2])
    elif len(found) < wide * high or min(wide, high) < 2:
        what = "the mesh of {wide} x {high} points has {count} values"
        remedy = "give the whole answer to M503, or state in the set-up how many were probed: map"
        raise file.fail(what, remedy, line, wide=wide, high=high, count=len(found))
    built = next((ends for text in file.lines if (ends := _LINES["built"].match(text))), None)
    if built and stated is None:
        low_x, top_x, low_y, top_y = (from_unit(file.number(end, "end", 1), "mm") for end in built.groups())
        around = replace(around, ends=((low_x, top_x), (low_y, top_y)))
    rows = [(line, [found.get((i, j), (0, "nan"))[1] for i in range(wide)]) for j in range(high)]
    return grid(file, around, rows if zeros else _visited(rows), line)
