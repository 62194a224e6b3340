"""Circular tests by ISO 230-4: readings of a ball bar or a grid plate along a circle, in one or both directions.

From the deviations of the radius, actual minus nominal, with the centre of least squares taken off (LSC):


    G     circular deviation of one direction: max e − min e, the radial width of the path about its own centre
    G_b   bidirectional circular deviation: the same of both paths together about their common centre
    F     radial deviation, largest and smallest deviation of the radius from the nominal one about that centre
    D     mean bidirectional radial deviation: mean of the radii of least squares of both paths, less the nominal one

The standard defines G by the two concentric circles of least separation. The width about the centre of least squares is
never smaller, and a few percent larger at most.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from axiscal.exceptions import ReadingError
from axiscal.numerics import Array
from axiscal.units import to_unit

_AROUND, _ROUNDING = 8, 1e-9
"""Angles that tell a centre from a lobed circle of two or three lobes; rad."""


@dataclass(frozen=True, slots=True)
class CircleFigures:
    """Figures by name, m."""

    figures: Mapping[str, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document, figures in um."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        return {"schema": "axiscal-iso230-4/1", "unit": "um", **figures, "warnings": list(self.warnings)}


def circular(rows: Array, file: str | None = None) -> CircleFigures:
    """Return G_plus (counter-clockwise), G_minus, G_b, F_max, F_min, D; raises ReadingError for less than a turn.

    rows : angles, rad, deviations of the radius, m, and directions, +1 counter-clockwise or −1, (3, m)
    """
    ways = {"plus": rows[:2, rows[2] > 0], "minus": rows[:2, rows[2] < 0]}
    measured = {name: _whole_turn(way) for name, way in ways.items() if way.size}
    for name, (angles, _) in measured.items():
        around = np.sort(np.mod(angles, 2 * np.pi))
        gaps = np.diff(around, append=around[:1] + 2 * np.pi)
        if len(around) < _AROUND or gaps.max() >= np.pi / 2:
            what = "the clockwise readings do not go all around"
            what = "the counter-clockwise readings do not go all around" if name == "plus" else what
            raise ReadingError(what, "Give eight angles or more, no quarter of the turn without one", file)
    radius, left = _centred(*np.concatenate(list(measured.values()), axis=1))
    each = {name: _centred(*own) for name, own in measured.items()}
    figures = {f"G_{name}": float(np.ptp(own)) for name, (_, own) in each.items()}
    if len(measured) == 2:
        figures["G_b"] = float(np.ptp(left))
        figures["D"] = float(np.mean([mean for mean, _ in each.values()]))
    figures |= {"F_max": radius + float(left.max()), "F_min": radius + float(left.min())}
    missing = () if len(measured) == 2 else ("Only one direction was measured: G_b and D are not known.",)
    return CircleFigures(figures, missing)


def _whole_turn(rows: Array) -> Array:
    """Return angles and deviations (2, m) on the turn in their middle, without feed-in and feed-out (ISO 230-4)."""
    angles = rows[0]
    begin = angles[angles >= (angles.min() + angles.max()) / 2 - np.pi - _ROUNDING].min()
    return rows[:, (angles >= begin) & (angles <= begin + 2 * np.pi + _ROUNDING)]


def _centred(angles: Array, deviations: Array) -> tuple[float, Array]:
    """Return r₀ and e (m,) of deviations r(θ) = r₀ + a cos θ + b sin θ + e(θ) (m,) of a radius by least squares, m.

    angles : (m,) rad, on at least half a turn or the centre is not told from the radius
    """
    columns = np.column_stack([np.ones_like(angles), np.cos(angles), np.sin(angles)])
    found = np.linalg.lstsq(columns, deviations, rcond=None)[0]
    return float(found[0]), deviations - columns @ found
