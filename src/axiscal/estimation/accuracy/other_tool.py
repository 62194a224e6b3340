"""What the same knowledge is worth with a tool of another length: angular errors that one length cannot show.

With one length an angular error and a displacement of the same axis may look alike at the tool point. With another they
differ by the difference of the lengths. The belief knows by how much.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import EVERY_WAY, Box, Counted
from axiscal.estimation.belief import Belief
from axiscal.numerics import Array
from axiscal.numerics.spread import even_points
from axiscal.units import format_quantity

LONGER = 0.07
"""m by which the other tool is longer: from a short mill to a long drill."""
_POSES = 400
"""An RMS over so many even poses is known to a few percent."""
_WORTH = 1.25
"""A loss of a quarter is said."""


@dataclass(frozen=True, slots=True)
class OtherTool:
    """RMS standard deviation of the tool point over the volume, m, one shift taken off, with both tools."""

    stated: float
    longer: float

    @property
    def costs(self) -> bool:
        """Whether the other tool is known less well by a quarter or more."""
        return self.longer > _WORTH * self.stated

    @property
    def words(self) -> str:
        """Sentences on the cost of the other tool and on what would help; "" where it costs little."""
        if not self.costs:
            return ""
        stated, longer = (format_quantity(value, "um", 3) for value in (self.stated, self.longer))
        return (
            f"With a tool {format_quantity(LONGER, 'mm')} longer the same readings leave {longer} instead of {stated}: "
            "one length cannot show every angular error. Read with the tool that works, or add readings of angles "
            "(a level, an autocollimator)."
        )


def other_tool(
    model: ErrorModel, belief: Belief, box: Box, longer: float = LONGER, counted: Counted = EVERY_WAY
) -> OtherTool:
    """Return what a belief over the coefficients first, other unknowns after them, is worth with both tools.

    box : the volume, bounds per axis; longer : m, by which the other tool is longer; counted : the directions
    in which deviations count
    """
    low, high = np.array(box).T
    poses: Array = low + (high - low) * even_points(_POSES, len(low))
    factor = belief.factor[: model.size]
    other = ErrorModel(replace(model.machine, tool=model.machine.tool + longer))
    return OtherTool(*(_rms(each, factor, poses, counted) for each in (model, other)))


def _rms(model: ErrorModel, factor: Array, poses: Array, counted: Counted) -> float:
    rows = model.rows(poses, np.ones_like(poses))[:, list(counted)]
    spread = (rows - rows.mean(axis=0)) @ factor
    return float(np.sqrt(np.sum(spread**2) / len(poses)))
