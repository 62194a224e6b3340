"""A machine that runs on with the tables of its last campaign: its deviations after a time.

The tool point is off by H (a' − m) + ℓ and the rests. Its errors after Δt are a' (`wearing`). The tables could not
hold ℓ on the day of the campaign. The mean square over the volume is a closed form.

Deviations with the tables of a control, for the years after a campaign.

A table holds what its control can hold. After a time ℓ - (1 - ρ) k - f is left over the volume. Here k is the mean of
errors that age and f that of renewed ones, both less what never changes. The mean square needs the six products of
the three alone. All three are in the directions that count, less one shift of everything and what probing the part
takes off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from axiscal.estimation.estimation import Estimation
from axiscal.machine.description import Machine
from axiscal.machine.kinematics import frames, turn_between
from axiscal.measurement.instrument import model_of
from axiscal.measurement.instruments.kind import Nominal
from axiscal.measurement.observation import directions_of
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.ports.fleet.wearing import Aging, Wearing, found_by
from axiscal.tables import registry
from axiscal.tables.effect import Control, left_by
from axiscal.tables.export_options import ExportOptions
from axiscal.tables.offer import spread_poses
from axiscal.tables.on_top import informed


class WornMachine:
    """One machine and its last campaign.

    known : what that came to; aging : how machines change; renewed : axes of which nothing is as it was found
    tables : of which control; None where all that was found is taken away
    Raises TableError where no tables can be made for the control.
    """

    def __init__(
        self,
        known: Estimation,
        aging: Aging,
        renewed: Sequence[str] = (),
        tables: str | None = None,
    ) -> None:
        errors, self._root = known.case.errors, known.case.yardstick.root
        self._known, self._aging = known, aging
        self._fresh = np.zeros(errors.size, dtype=bool)
        for term in errors.terms:
            self._fresh[term.columns] = any(errors.machine.axes[axis].name in renewed for axis in term.axes)
        self._found, self._wears = found_by(known), Wearing.of(known)
        self._control = None if tables is None else control_of(known, tables)
        if self._control is None:
            moving = self._found.mean - self._wears.mean
            fields = np.array([self._root.matrix @ (moving * share) for share in (0.0, ~self._fresh, self._fresh)])
            self._products = fields @ fields.T
        else:
            self._products = products_left(known, self._control, self._fresh, self._wears.mean)

    def rms(self, years: float) -> float:
        """Return the RMS over the volume after a time in years, m."""
        rho, square = self._aging.kept(years)
        once = np.array([1.0, rho - 1.0, -1.0])
        moved = once @ self._products @ once + (square - rho**2) * self._products[1, 1]
        drifted = np.sum(self._root.gram * self._wears.covariance(self._found, square, self._fresh))
        return self._known.case.yardstick.rms_of(float(drifted + moved))


def control_of(known: Estimation, controller: str) -> Control:
    """Return what a control does with the tables of a campaign; raises TableError where none can be made for it."""
    options = informed(ExportOptions(), known.case.description, controller)
    return registry.export(known.estimate(), controller, options).control


def _counted(known: Estimation, poses: Array, field: Array) -> Array:
    """Return deviations (m, 3) less what probing the part takes off and one shift, in the directions that count."""
    alignment = known.case.yardstick.alignment
    left = field if alignment is None else alignment.left(poses, field)
    counted: Array = (left - left.mean(axis=0)) * np.array(known.case.yardstick.counted, dtype=float)
    return counted


def products_left(known: Estimation, control: Control, renewed: NDArray[np.bool_], stays: Array) -> Array:
    """Return the means over the volume of the products of ℓ, k and f, (3, 3), m².

    renewed : (n,) bool, of the unknowns of the errors; stays : (n,) the part of their mean that never changes
    """
    estimate = known.estimate()
    poses, approaches = spread_poses(estimate)
    rows, moving = estimate.model.rows(poses, approaches), estimate.mean - stays
    whole = left_by(estimate.machine, estimate.deviation, control, poses, approaches)
    fields = [whole, rows @ (moving * ~renewed), rows @ (moving * renewed)]
    centred = np.array([_counted(known, poses, each) for each in fields])
    products: Array = np.einsum("apc,bpc->ab", centred, centred) / len(poses)
    return products


def without_tables(
    readings: Sequence[Reading], machine: Machine, setups: Sequence[Setup], control: Control
) -> list[Reading]:
    """Return readings less what a control adds to each of their numbers.  setups : of the campaign, by name"""
    named = {setup.name: setup for setup in setups}
    found = list[Reading]()
    for reading in readings:
        added = _added(reading, machine, named[reading.setup], control)
        value, *others = (value - float(each) for value, each in zip(reading.values, added, strict=True))
        found.append(replace(reading, value=value, others=tuple(others)))
    return found


def _added(reading: Reading, machine: Machine, setup: Setup, control: Control) -> Array:
    """Return what the control adds to each number of a reading, m or rad."""
    pose, approach = np.array([reading.pose]), np.array([reading.approach], dtype=float)
    before, after = frames(machine, pose), frames(machine, pose + control(pose, approach))
    each = directions_of(setup)
    if setup.base is not None:  # what stands on a way shows the way's own shape, wherever the control sends the axes
        return np.zeros(len(each))
    model = model_of(setup)
    moved = after.tcp - before.tcp if model.reads == "length" else turn_between(before.tool, after.tool)
    nominal = Nominal(machine, pose, setup.moves, approaches=approach)
    ways = [model.direction_of(setup, np.array(setup.direction) if d is None else d, nominal)[0] for d in each]
    added: Array = np.array(ways) @ moved[0]
    return added
