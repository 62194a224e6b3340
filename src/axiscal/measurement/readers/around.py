"""Readings around a turn: `angle_deg,direction,deviation_um` of a circular test, or `angle_deg,turn,deviation_um`."""

from __future__ import annotations

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
    table.allow({"angle": ANGLES, "direction": TEXT, "deviation": LENGTHS})
    angle, direction = table.one_of("angle", "angle_deg"), table.one_of("direction", "direction")
    deviation = table.one_of("deviation", "deviation_um")
    rows = [(row.quantity(angle), row.quantity(deviation), read_direction(row, direction)) for row in table.rows]
    angles, deviations, directions = np.array(rows, dtype=float).reshape(-1, 3).T
    return CircularTest(angles, deviations, directions, table.file)


def turns_of(table: CsvTable) -> Turns:
    """Interpret a table as turns of a spindle, each read at the same angles; raises ReadingError."""
    table.allow({"angle": ANGLES, "turn": TEXT, "deviation": LENGTHS})
    angle, turn = table.one_of("angle", "angle_deg"), table.one_of("turn", "turn")
    deviation = table.one_of("deviation", "deviation_um")
    read: dict[tuple[float, int], float] = {}
    for row in table.rows:
        key = row.quantity(angle), read_run(row, turn)
        if key in read:
            raise row.fail(f"angle {row.text(angle)} of turn {key[1]} was read before", "give each turn its own number")
        read[key] = row.quantity(deviation)
    angles, turns = sorted({at for at, _ in read}), sorted({number for _, number in read})
    for at in angles:
        for number in turns:
            if (at, number) not in read:
                what = f"turn {number} has no reading at {np.degrees(at):.6g} deg"
                raise table.fail(what, "every turn is read at every angle: add the reading or take out the turn")
    return Turns(np.array(angles), np.array([[read[at, n] for n in turns] for at in angles]), table.file)
