"""How far the screws under a bed are to be turned, by the plane of the map that was read.

The plane is the nearest one to the map at places of an even grid. With R the rows of the map there and m the estimate,
z = G R m are its heights at the screws. Screw i is turned by (z_0 − z_i) / pitch: the first one stays.
"""

from __future__ import annotations

import numpy as np

from axiscal.estimation.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.present.answer import ScrewTurn

_SIDE = 12
"""Places along each side of the grid; of a plane any number would do."""
_ALONG = 1 - 1e-9
"""Rounding of a unit vector."""


def screw_turns(known: Estimation) -> list[ScrewTurn]:
    """Return the turns of all screws but the first; none where no screws are stated, or no map of the bed was read."""
    screws, description = known.stated.description.screws, known.stated.description
    names = {reading.setup for reading in known.readings}
    axes = {axis.name: k for k, axis in enumerate(description.machine.axes)}
    bed = [axes[name] for name in "XY" if name in axes]
    reads = [each for each in description.setups if set(bed) <= set(each.moves) and abs(each.direction[2]) > _ALONG]
    setup = next((each for each in reads if each.name in names), None)
    if screws is None or setup is None or len(bed) != 2:
        return []
    sides = [np.linspace(*setup.span(description.machine.axes[k], k), _SIDE) for k in bed]
    grid = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, 2)
    poses, plane = np.tile(np.array(setup.park), (len(grid), 1)), np.column_stack([np.ones(len(grid)), grid])
    poses[:, bed] = grid
    errors, belief = known.case.errors, known.printed.belief
    heights = -errors.rows_at(poses, np.zeros_like(poses))[:, 2]
    at = np.array([[1.0, x, y] for x, y in screws.places.values()])
    rows = at @ np.linalg.pinv(plane) @ heights
    turned = (rows[0] - rows[1:]) * screws.lifts / screws.pitch
    turns, stds = turned @ belief.mean[: errors.size], np.linalg.norm(turned @ belief.factor[: errors.size], axis=1)
    each = zip(list(screws.places)[1:], turns.tolist(), stds.tolist(), strict=True)
    return [ScrewTurn(screw=name, turns=turn, U=BAND * std) for name, turn, std in each]
