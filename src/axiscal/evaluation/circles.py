"""Circular tests by ISO 230-4: readings of a ball bar or a grid plate along a circle, in one or both directions.

From the deviations of the radius, actual minus nominal, with the centre of least squares taken off (LSC):

    G     circular deviation of one direction: max e − min e, the radial width of the path about its own centre
    G_b   bidirectional circular deviation: the same of both paths together about their common centre
    F     radial deviation, largest and smallest deviation of the radius from the nominal one about that centre
    D     mean bidirectional radial deviation: mean of the radii of least squares of both paths, less the nominal one

The standard defines G by the two concentric circles of least separation. The width about the centre of least squares is
never smaller, and a few percent larger at most. (Formulas after ISO 230-4:2005, quoted from memory.)
The least-squares centre of readings around a turn is that of r(θ) = r₀ + a cos θ + b sin θ + e(θ).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from axiscal.exceptions import EvaluationError
from axiscal.measurement.readers.around import CircularTest
from axiscal.numerics import Array
from axiscal.units import to_unit


@dataclass(frozen=True, slots=True)
class Circular:
    """Figures by name, m: G_plus (counter-clockwise), G_minus, G_b, F_max, F_min, D; centre : of both paths, m."""

    figures: Mapping[str, float]
    centre: tuple[float, float]
    warnings: tuple[str, ...] = ()

    def as_json(self) -> dict[str, object]:
        """Return the document `axiscal-iso230-4/1`, figures in um."""
        figures = {name: to_unit(value, "um") for name, value in self.figures.items()}
        return {"schema": "axiscal-iso230-4/1", "unit": "um", **figures, "warnings": list(self.warnings)}


def circular(test: CircularTest) -> Circular:
    """Return the figures of a circular test; raises EvaluationError for less than a whole turn."""
    sides = {"plus": test.directions > 0, "minus": test.directions < 0}
    measured = {name: mine for name, mine in sides.items() if np.any(mine)}
    for name, mine in measured.items():
        if not covers_a_turn(test.angles[mine]):
            what = "the clockwise readings do not go all around"
            what = "the counter-clockwise readings do not go all around" if name == "plus" else what
            raise EvaluationError(what, "Give eight angles or more, no quarter of the turn without one", test.file)
    whole = centred(test.angles, test.deviations)
    each = {name: centred(test.angles[mine], test.deviations[mine]) for name, mine in measured.items()}
    figures = {f"G_{name}": float(np.ptp(one.left)) for name, one in each.items()}
    radial = whole.radius + whole.left
    if len(measured) == 2:
        figures["G_b"] = float(np.ptp(whole.left))
        figures["D"] = float(np.mean([one.radius for one in each.values()]))
    figures |= {"F_max": float(radial.max()), "F_min": float(radial.min())}
    missing = () if len(measured) == 2 else ("Only one direction was measured: G_b and D are not known.",)
    return Circular(figures, whole.centre, missing)


class Centred(NamedTuple):
    """radius : r₀; centre : (a, b); left : (m,) e, all m"""

    radius: float
    centre: tuple[float, float]
    left: Array


def centred(angles: Array, deviations: Array) -> Centred:
    """Return deviations (m,) of a radius without what the place of the centre does, by least squares.

    angles : (m,) rad, on at least half a turn or the centre is not told from the radius
    """
    columns = np.column_stack([np.ones_like(angles), np.cos(angles), np.sin(angles)])
    radius, a, b = np.linalg.lstsq(columns, deviations, rcond=None)[0].tolist()
    return Centred(radius, (a, b), deviations - columns @ np.array([radius, a, b]))


def covers_a_turn(angles: Array) -> bool:
    """Whether no gap between neighbouring angles is as large as a quarter of a turn."""
    around = np.sort(np.mod(angles, 2 * np.pi))
    gaps = np.diff(around, append=around[:1] + 2 * np.pi)
    return bool(len(around) >= _FEWEST and gaps.max() < np.pi / 2)


_FEWEST = 8
"""Angles that tell a centre from a lobed circle of two or three lobes."""
