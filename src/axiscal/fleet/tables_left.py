"""What the tables of a control leave of what a campaign found, for the years after it.

A table holds what its control can hold. Over the volume, in the directions that count, less one shift of everything
and what probing the part takes off, with ℓ what is left on the day of the campaign, k the mean of errors that age and
f that of errors that were renewed, both less what never changes, what is left later is ℓ - (1 - ρ) k - f; its mean
square needs the six products of the three alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from axiscal.compensation import registry
from axiscal.compensation.effect import Control, left_by
from axiscal.compensation.export_options import ExportOptions
from axiscal.compensation.offer import spread_poses
from axiscal.compensation.on_top import informed
from axiscal.estimation.estimation import Estimation
from axiscal.numerics import Array


def control_of(known: Estimation, controller: str) -> Control:
    """Return what a control does with the tables of a campaign; raises TableError where none can be made for it."""
    options = informed(ExportOptions(), known.case.description, controller)
    return registry.export(known.estimate(), controller, options).control


def left_at(known: Estimation, control: Control, poses: Array, approaches: Array) -> Array:
    """Return what a control leaves at poses, in the directions that count, less one shift of everything, (m, 3) m."""
    estimate = known.estimate()
    return _counted(known, poses, left_by(estimate.machine, estimate.deviation, control, poses, approaches))


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
