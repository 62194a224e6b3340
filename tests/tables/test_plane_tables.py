"""Tables over one axis where two axes act together: each holds the mean over the other axis, counted once."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.machine import Machine
from axiscal.tables.conditional import mean_along, turned
from tests.generators.planes import bed, table


@pytest.mark.parametrize(
    ("machine", "over"),
    [pytest.param(bed(), 2, marks=pytest.mark.long), (bed(), 0), (table(), 1)],
    ids=["X", "Y'", "X of a table"],
)
def test_a_table_holds_the_mean_over_the_other_axes(machine: Machine, over: int) -> None:
    """Over a part of the travel, where the mean of what two axes do together is not nought."""
    model = ErrorModel(machine)
    box = tuple((low + 0.1 * (high - low), low + 0.6 * (high - low)) for low, high in (a.travel for a in machine.axes))
    at = np.linspace(*box[over], 4)
    moved = [k for k, axis in enumerate(machine.axes) if axis.name == "Z"]
    rows = mean_along(model, box, moved, over, at, 1)[0]
    rng, count = np.random.default_rng(0), 60_000
    low, high = np.array(box).T
    for position, found in zip(at, rows, strict=True):
        poses = rng.uniform(low, high, (count, len(low)))
        poses[:, over] = position
        mean = model.rows(poses, np.zeros_like(poses))[:, 2].mean(axis=0)
        for plane in model.planes:
            if over in plane.axes:
                own = found[plane.columns]
                assert own == pytest.approx(mean[plane.columns], abs=0.02 * np.abs(mean).max())


def test_what_a_rotary_axis_turns_too_far_needs_no_plane() -> None:
    model = ErrorModel(table())
    box = tuple(axis.travel for axis in model.machine.axes)
    rows = turned(model, box, 0, np.linspace(0, 6, 5), 1)
    assert rows.shape == (5, model.size)
    assert not np.any(rows[:, model.planes[0].columns])
