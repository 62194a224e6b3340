"""Where only one axis moves: the best readings under several covariances, by one search over all their lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.gain import Scorer
from axiscal.design.step.lines import GrownLines, straight
from axiscal.measurement.breaks import breaks_along, smoothness_along
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.place import Places
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.chebyshev import node_count
from axiscal.numerics.exact_step import maximise_along
from axiscal.numerics.ties import TIE, first_best_each


def parked(mounted: Setup) -> tuple[Array, Array]:
    """Return poses and approaches (sides, q) of a set-up at its park pose, one for each side."""
    signs = np.array(mounted.sides, dtype=float)
    poses = np.tile(np.array(mounted.park), (len(signs), 1))
    approaches = np.zeros_like(poses)
    approaches[:, list(mounted.moves)] = signs[:, None]
    return poses, approaches


def one_line_each(observation: Observation, setups: Sequence[int]) -> bool:
    """Return whether in each set-up one axis moves, without a raster, along which its fixed vectors give the gain."""
    mounted = [observation.setups[setup] for setup in setups]
    alone = all(s.chart is None and len(s.moves) == 1 and len(directions_of(s)) == 1 for s in mounted)
    return alone and all(
        s.raster[s.moves[0]] == 0 and straight(observation, setup, s.moves[0])
        for setup, s in zip(setups, mounted, strict=True)
    )


def best_of_each(scorer: Scorer, setups: Sequence[int], columns: Array, reach: Array) -> Places:
    """Return the reading that gains most under each of several covariances C + d dᵀ, (s,) places.

    scorer : under C, of cells none of which was visited; setups : as `one_line_each` finds them
    columns : d (n, s); reach : V d (w, s)
    """
    found = [_best_on_lines(scorer, setup, columns, reach) for setup in setups]
    best = first_best_each(np.stack([gains for _, gains in found], axis=1), TIE)
    order = best * columns.shape[1] + np.arange(columns.shape[1])
    return Places.joined([places for places, _ in found]).within(order)


def _best_on_lines(scorer: Scorer, setup: int, columns: Array, reach: Array) -> tuple[Places, Array]:
    """Return the same of one set-up, and the gains (s,)."""
    observation = scorer.observation
    (axis,), (poses, approaches) = observation.setups[setup].moves, parked(observation.setups[setup])
    lines = GrownLines(scorer, setup, axis, poses, approaches, columns, reach)
    breaks, count, sides = breaks_along(observation, axis, setup), columns.shape[1], len(poses)
    line = np.repeat(np.arange(count * sides), len(breaks) - 1)

    def forms(positions: Array, interval: NDArray[np.intp]) -> tuple[Array, Array]:
        return lines.forms(positions, line[interval])

    left, right = (np.tile(ends, count * sides) for ends in (breaks[:-1], breaks[1:]))
    nodes = node_count(*smoothness_along(observation, axis, setup))
    position, gain = maximise_along(forms, left, right, nodes, line // sides)
    each = first_best_each(gain.reshape(count, -1), TIE)
    here = np.arange(count) * (len(line) // count) + each
    side = line[here] % sides
    there = poses[side]
    there[:, axis] = position[here]
    return Places.of_setup(setup, there, approaches[side]), gain[here]
