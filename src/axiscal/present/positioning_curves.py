"""Positioning as ISO 230-2 draws it, from the estimate: both directions of approach, found and left, where it was read.

picture = positioning_figure(curve)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from axiscal.description.campaign import CampaignDescription
from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import asked_rows
from axiscal.estimation.functionals.functional import Functional
from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.reading import Reading
from axiscal.numerics import Array
from axiscal.tables.effect import Control, left_by
from axiscal.units import to_unit


@dataclass(frozen=True, slots=True)
class PositioningCurve:
    """Deviations along the line on which an axis was read, the mean of both directions taken off, in display units.

    found : as estimated, from below and from above; half : ± of it, 95 %; left : with the tables of `controller`
    """

    axis: str
    position_unit: str
    value_unit: str
    position: Sequence[float]
    found: tuple[Sequence[float], Sequence[float]]
    half: tuple[Sequence[float], Sequence[float]]
    left: tuple[Sequence[float], Sequence[float]] | None
    controller: str = ""


def positioning_curves(
    description: CampaignDescription,
    readings: Sequence[Reading],
    estimation: Estimation,
    controller: str = "",
    control: Control | None = None,
) -> list[PositioningCurve]:
    """Return the positioning of every axis that was read along, or about, itself.

    control : what the tables of `controller` do, None where there are none
    """
    estimate, found = estimation.estimate(), list[PositioningCurve]()
    for row in asked_rows(description, readings):
        if row.want.row.kind != "positioning" or row.map is None:
            continue
        (line,), axis = row.lines, description.machine.axes[row.lines[0].axis]
        unit = "urad" if axis.rotary else "um"
        left = None if control is None or axis.rotary else _sides(_left(estimate, control, row.map), unit)
        half = BAND * np.sqrt(row.map.spectra(estimate.model, estimate.factor)[:, 0])
        positions = to_unit(line.positions, axis.unit).tolist()
        own = (axis.name, axis.unit, unit, positions)
        found.append(
            PositioningCurve(*own, _sides(_found(estimate, row.map), unit), _sides(half, unit), left, controller)
        )
    return found


def _found(estimate: Estimate, row: Functional) -> Array:
    if row.angular:
        turned: Array = row.rows(estimate.model) @ estimate.mean
        return turned
    return row.of(estimate.deviation(row.poses, row.sides))


def _left(estimate: Estimate, control: Control, row: Functional) -> Array:
    return row.of(left_by(estimate.machine, estimate.deviation, control, row.poses, row.sides))


def _sides(values: Array, unit: str) -> tuple[list[float], list[float]]:
    """Return what comes from below and what comes from above, of which the second follows the first."""
    up, down = np.split(np.asarray(to_unit(values, unit)), 2)
    return up.tolist(), down.tolist()
