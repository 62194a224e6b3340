"""What two axes do together, and how much of it files leave: a table over one axis holds nothing of it, a mesh does."""

from __future__ import annotations

import numpy as np

from axiscal.compensation.effect import Control, left_by, rms
from axiscal.estimation.machine_estimate import Estimate
from axiscal.numerics import Array
from axiscal.units import format_quantity

_HELD = 0.9
"""Share from which a plane counts as held: a mesh of straight lines leaves some of a bend."""


def planes_left(estimate: Estimate, control: Control, poses: Array, approaches: Array) -> str:
    """Return in a sentence what files leave of errors of two axes; empty where they hold them, or there are none.

    poses, approaches : (m, q) spread over the volume
    """
    errors = estimate.model
    if not errors.planes:
        return ""
    levers = errors.levers(poses)
    levers[: len(errors.functions)] = 0.0
    own = np.stack([errors.along(levers[:, :, c], poses, approaches) @ estimate.mean for c in range(3)], axis=1)
    shape = own - own.mean(axis=0)
    found = left_by(estimate.machine, estimate.deviation, control, poses, approaches)
    held = 1.0 - float(np.sum(shape * found) / max(np.sum(shape**2), np.finfo(float).tiny))
    if held > _HELD:
        return ""
    names = ", ".join(plane.name for plane in errors.planes)
    size = format_quantity(rms(own), "um", 3)
    most = "" if held < 1 - _HELD else " Part of it is held."
    return f"what two axes do together ({names}: {size} RMS over the volume): no table over one axis holds it.{most}"
