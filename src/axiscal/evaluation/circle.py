"""Circular tests, and which test a file holds: of a circle or of positioning.

Circular tests by ISO 230-4: readings of a ball bar or a grid plate along a circle, in one or both directions. From the
deviations of the radius, actual minus nominal, with the centre of least squares taken off (LSC):

    G     circular deviation of one direction: max e − min e, the radial width of the path about its own centre
    G_b   bidirectional circular deviation: the same of both paths together about their common centre
    F     radial deviation, largest and smallest deviation of the radius from the nominal one about that centre
    D     mean bidirectional radial deviation: mean of the radii of least squares of both paths, less the nominal one

The standard defines G by the two concentric circles of least separation. The width about the centre of least squares is
never smaller, and a few percent larger at most. The least-squares centre of readings around a turn is that of
r(θ) = r₀ + a cos θ + b sin θ + e(θ).

(Formulas after ISO 230-4:2005, quoted from memory.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axiscal.evaluation.one_axis import Positioning, evaluate, positioning_test
from axiscal.exceptions import EvaluationError
from axiscal.measurement.readers.csv_readings import read_direction
from axiscal.measurement.readers.csv_table import ANGLES, LENGTHS, TEXT, CsvTable, read_text, table_of
from axiscal.measurement.readers.renishaw import is_rtl
from axiscal.numerics import Array
from axiscal.units import to_unit

_AROUND = 8
"""Angles that tell a centre from a lobed circle of two or three lobes."""
_CIRCLE = frozenset({"angle", "direction", "deviation"})


@dataclass(frozen=True, slots=True, eq=False)
class CircularTest:
    """A circular test: angles (m,) rad, deviations of the radius (m,) m, directions (m,) +1 counter-clockwise or −1."""

    angles: Array
    deviations: Array
    directions: Array
    file: str | None = None


@dataclass(frozen=True, slots=True)
class CircleFigures:
    """Figures by name, m, and the centre of both paths together, m."""

    figures: Mapping[str, float]
    centre: tuple[float, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document, figures in um."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        return {"schema": "axiscal-iso230-4/1", "unit": "um", **figures, "warnings": list(self.warnings)}


def figures_of(path: str | Path) -> Positioning | CircleFigures:
    """Return the figures of the test that a file holds; raises ReadingError, EvaluationError."""
    file = read_text(path)
    table = None if is_rtl(file) else table_of(file)
    if table is not None and {column.stem for column in table.columns} >= _CIRCLE:
        return circular(circle_of(table))
    return evaluate(positioning_test(file))


def circle_of(table: CsvTable) -> CircularTest:
    """Interpret a table as a circular test; raises ReadingError."""
    layout = {"angle": ANGLES, "direction": TEXT, "deviation": LENGTHS}
    angle, direction, deviation = table.needed(layout, "angle_deg", "direction", "deviation_um")
    rows = [(row.quantity(angle), row.quantity(deviation), read_direction(row, direction)) for row in table.rows]
    angles, deviations, directions = np.array(rows, dtype=float).reshape(-1, 3).T
    return CircularTest(angles, deviations, directions, table.file)


def circular(test: CircularTest) -> CircleFigures:
    """Return G_plus (counter-clockwise), G_minus, G_b, F_max, F_min, D; raises EvaluationError for less than a turn."""
    ways = {"plus": test.directions > 0, "minus": test.directions < 0}
    measured = {name: mine for name, mine in ways.items() if np.any(mine)}
    for name, mine in measured.items():
        around = np.sort(np.mod(test.angles[mine], 2 * np.pi))
        gaps = np.diff(around, append=around[:1] + 2 * np.pi)
        if len(around) < _AROUND or gaps.max() >= np.pi / 2:
            what = "the clockwise readings do not go all around"
            what = "the counter-clockwise readings do not go all around" if name == "plus" else what
            raise EvaluationError(what, "Give eight angles or more, no quarter of the turn without one", test.file)
    radius, centre, left = _centred(test.angles, test.deviations)
    each = {name: _centred(test.angles[mine], test.deviations[mine]) for name, mine in measured.items()}
    figures = {f"G_{name}": float(np.ptp(own)) for name, (_, _, own) in each.items()}
    radial = radius + left
    if len(measured) == 2:
        figures["G_b"] = float(np.ptp(left))
        figures["D"] = float(np.mean([mean for mean, _, _ in each.values()]))
    figures |= {"F_max": float(radial.max()), "F_min": float(radial.min())}
    missing = () if len(measured) == 2 else ("Only one direction was measured: G_b and D are not known.",)
    return CircleFigures(figures, centre, missing)


def _centred(angles: Array, deviations: Array) -> tuple[float, tuple[float, float], Array]:
    """Return r₀, (a, b) and e (m,) of deviations (m,) of a radius by least squares, all m.

    angles : (m,) rad, on at least half a turn or the centre is not told from the radius
    """
    columns = np.column_stack([np.ones_like(angles), np.cos(angles), np.sin(angles)])
    radius, a, b = np.linalg.lstsq(columns, deviations, rcond=None)[0].tolist()
    return radius, (a, b), deviations - columns @ np.array([radius, a, b])
