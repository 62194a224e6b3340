"""What a campaign predicts of the TCP at poses that a person names, and of the next reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from axiscal.errors.volume import deviation_of
from axiscal.estimation.case import timed
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.functionals.asked import beside_the_line
from axiscal.estimation.machine_estimate import Band
from axiscal.exceptions import ReadingError
from axiscal.machine.axis import travel_text
from axiscal.measurement.readers.csv_readings import RawReading
from axiscal.measurement.reading import Place, in_radii
from axiscal.measurement.reading_rows import blank_readings
from axiscal.numerics import Array
from axiscal.units import to_unit
from axiscal_core.machine import Machine
from axiscal_core.threads import one_thread

_SLACK = 1e-9
"""Rounding of a position at the end of a travel, m or rad."""


@one_thread()
def predict_poses(estimation: Estimation, wanted: Sequence[RawReading], file: Path) -> tuple[Array, Array]:
    """Return what `tcp_prediction` does at each pose; axes that a pose leaves out stand at the middle of their travel.

    Raises ReadingError with file and line for an unknown axis or a position outside the travel.
    """
    machine = estimation.case.description.machine
    poses, approaches = np.zeros((2, len(wanted), len(machine.axes)))
    for i, raw in enumerate(wanted):
        try:
            poses[i] = _pose(machine, in_radii(raw.position, machine.axes), [*raw.position, *raw.approach])
        except ReadingError as failure:
            raise failure.placed(file, raw.line) from None
        approaches[i] = [raw.approach.get(axis.name, 0) for axis in machine.axes]
    return tcp_prediction(estimation, poses, approaches)


def tcp_prediction(estimation: Estimation, poses: Array, approaches: Array) -> tuple[Array, Array]:
    """Return mean and standard deviation of the TCP deviation, (m, 3) m, rests included; the mean by the exact chain.

    poses, approaches : (m, q); where an approach is 0 the reversal of that axis counts in the deviation
    """
    errors, belief = estimation.case.errors, estimation.printed.belief
    root, levers = errors.rows_at(poses, approaches) @ belief.factor[: errors.size], errors.levers(poses)
    loose = np.array([term.rest**2 for term in errors.terms])[:, None] * np.ones(len(poses))
    for k, function in enumerate(errors.curves):
        if function.kind == "reversal":
            basis = function.spline.rows(poses[:, function.axis])
            square = (basis @ belief.mean[function.columns]) ** 2
            square += np.sum((basis @ belief.factor[function.columns]) ** 2, axis=1)
            loose[k] += np.where(approaches[:, function.axis] == 0, square / 4, 0.0)
    mean = deviation_of(errors, belief.mean[: errors.size], poses, approaches).displacement
    beside = beside_the_line(estimation.case.description, estimation.readings, poses)
    variances = np.sum(root**2, axis=2) + np.einsum("kmi,km->mi", levers**2, loose) + beside**2
    return mean, np.sqrt(variances)


def _pose(machine: Machine, position: Mapping[str, float], named: Sequence[str]) -> list[float]:
    """Return a pose, (q,); raises ReadingError for an axis that is not there, or a place outside.

    position : by axis, m or rad; one that is left out stands in the middle of its travel; named : axes
    """
    if unknown := [name for name in named if name not in machine.axis_names]:
        what = 'the machine has no axis "{name}"'
        raise ReadingError(what, "Its axes are {known}", name=unknown[0], known=", ".join(machine.axis_names))
    pose = [position.get(axis.name, sum(axis.travel) / 2) for axis in machine.axes]
    for at, axis in zip(pose, machine.axes, strict=True):
        if not axis.travel[0] - _SLACK <= at <= axis.travel[1] + _SLACK:
            what, shown = "{axis} = {shown} is outside the travel", f"{to_unit(at, axis.unit):g} {axis.unit}"
            raise ReadingError(what, "{axis} goes from {travel}", axis=axis.name, shown=shown, travel=travel_text(axis))
    return pose


def expectation(known: Estimation, place: Place) -> Band:
    """Return what the readings so far say of the next one: ŷ = h·m and s² = h C hᵀ + rests + σ² (method.md 2).

    mean, std : (k,) of each number of the reading, its noise included, m or rad
    """
    readings, setup = known.history.normal, known.case.description.setup(place.setup)
    every = timed(known.case, [*readings, *blank_readings(known.case.description.setups, [place])]).readings
    before = replace(known.history, readings=every, left_out=known.left_out | {len(readings)})
    away, std = before.surprises[before.problem.reading == len(readings)].T
    return Band(-away / setup.scales, std / setup.scales)
