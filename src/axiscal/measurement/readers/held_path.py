"""A held point or a bar on its path: `test,angle_deg,direction`, and `deviation_um` or `x_um,y_um,z_um`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, CsvTable
from axiscal.measurement.readers.positioning import read_direction
from axiscal.numerics import Array


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
    table.allow({"test": TEXT, "angle": ANGLES, "direction": TEXT, **dict.fromkeys(names, LENGTHS)})
    test, angle = table.one_of("test", "test"), table.one_of("angle", "angle_deg")
    direction = table.one_of("direction", "direction")
    values = [table.one_of(name, f"{name}_um") for name in names]
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
