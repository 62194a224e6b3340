"""Readings around a turn: `angle_deg,direction,deviation_um` of a circular test, or `angle_deg,turn,deviation_um`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, CsvTable
from axiscal.measurement.readers.positioning import read_direction, read_run
from axiscal.numerics import Array


@dataclass(frozen=True, slots=True, eq=False)
class CircularTest:
    """A circular test: angles (m,) rad, deviations of the radius (m,) m, directions (m,) +1 counter-clockwise or −1."""

    angles: Array
    deviations: Array
    directions: Array
    file: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Turns:
    """Readings of a rotating axis: angles (n,) rad, deviations (n, turns) m."""

    angles: Array
    deviations: Array
    file: str | None = None


CIRCLE, TURNS = frozenset({"angle", "direction", "deviation"}), frozenset({"angle", "turn", "deviation"})


def circle_of(table: CsvTable) -> CircularTest:
    """Interpret a table as a circular test; raises ReadingError."""
    layout = {"angle": ANGLES, "direction": TEXT, "deviation": LENGTHS}
    angle, direction, deviation = table.needed(layout, "angle_deg", "direction", "deviation_um")
    rows = [(row.quantity(angle), row.quantity(deviation), read_direction(row, direction)) for row in table.rows]
    angles, deviations, directions = np.array(rows, dtype=float).reshape(-1, 3).T
    return CircularTest(angles, deviations, directions, table.file)


def turns_of(table: CsvTable) -> Turns:
    """Interpret a table as turns of a spindle, each read at the same angles; raises ReadingError."""
    layout = {"angle": ANGLES, "turn": TEXT, "deviation": LENGTHS}
    angle, turn, deviation = table.needed(layout, "angle_deg", "turn", "deviation_um")
    read: dict[tuple[float, int], float] = {}
    for row in table.rows:
        key = row.quantity(angle), read_run(row, turn)
        if key in read:
            remedy = "give each turn its own number"
            raise row.fail("angle {text} of turn {key} was read before", remedy, text=row.text(angle), key=key[1])
        read[key] = row.quantity(deviation)
    angles, turns = sorted({at for at, _ in read}), sorted({number for _, number in read})
    for at in angles:
        for number in turns:
            if (at, number) not in read:
                what = "turn {number} has no reading at {angle:.6g} deg"
                remedy = "every turn is read at every angle: add the reading or take out the turn"
                raise table.fail(what, remedy, number=number, angle=np.degrees(at))
    return Turns(np.array(angles), np.array([[read[at, n] for n in turns] for at in angles]), table.file)


@dataclass(frozen=True, slots=True, eq=False)
class HeldPath:
    """A kinematic test.

    angles : (m,) rad; directions : (m,) +1 where the angle grows, −1 where it falls
    deviations : m, by what is read: "x", "y", "z", or "" for the length of a bar
    """

    angles: Array
    directions: Array
    deviations: Mapping[str, Array]
    file: str | None = None


HELD, THREE, ONE = frozenset({"test", "angle", "direction"}), frozenset("xyz"), frozenset({"deviation"})


def held_paths(table: CsvTable) -> dict[str, HeldPath]:
    """Interpret a table as kinematic tests by name; raises ReadingError."""
    stems = {column.stem for column in table.columns}
    names = sorted(THREE) if stems >= THREE else sorted(ONE)
    layout = {"test": TEXT, "angle": ANGLES, "direction": TEXT, **dict.fromkeys(names, LENGTHS)}
    examples = [f"{name}_um" for name in names]
    test, angle, direction, *values = table.needed(layout, "test", "angle_deg", "direction", *examples)
    read: dict[str, list[list[float]]] = {}
    for row in table.rows:
        place = [row.quantity(angle), float(read_direction(row, direction))]
        read.setdefault(row.text(test), []).append([*place, *(row.quantity(value) for value in values)])
    found = {}
    for name, rows in read.items():
        angles, directions, *columns = np.array(rows).T
        shown = dict(zip(("" if len(names) == 1 else each for each in names), columns, strict=True))
        found[name] = HeldPath(angles, directions, shown, table.file)
    return found
