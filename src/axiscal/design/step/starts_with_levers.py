"""Where to start on a machine of a few axes with lever arms: the peaks of a dense lattice, looked at line by line."""

from __future__ import annotations

import itertools

import numpy as np

from axiscal.design.gains.gain import Scorer
from axiscal.design.step.lines import lines_along
from axiscal.design.step.starts_stacked import Starts, peaks
from axiscal.measurement.candidates import knot_lattice, raster_positions
from axiscal.measurement.observation import Observation
from axiscal.numerics import Array

_POINTS = 60_000
_FINEST = 16
_LINES = 256
"""Lines looked at at once: of memory, not of the result."""


def dense_starts(scorer: Scorer, setup: int) -> Starts:
    """Return the points of a tensor lattice, as fine as _POINTS allow, that no neighbour beats, from every side."""
    found = [_from_side(scorer, setup, approach) for approach in sides(scorer.observation, setup)]
    return Starts(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def sides(observation: Observation, setup: int) -> list[Array]:
    """Return the approaches (q,) that differ in what a reading sees."""
    mounted = observation.setups[setup]
    usual = np.zeros(len(mounted.park))
    usual[list(mounted.moves)] = mounted.sides[0]
    reverses = observation.errors.reversing & set(mounted.moves)
    if len(mounted.sides) == 1 or not reverses:
        return [usual]
    flipped = []
    for signs in itertools.product([1.0, -1.0], repeat=len(reverses)):
        approach = usual.copy()
        approach[sorted(reverses)] = signs
        flipped.append(approach)
    return flipped


def _from_side(scorer: Scorer, setup: int, approach: Array) -> tuple[Array, Array, Array]:
    mounted = scorer.observation.setups[setup]
    positions = _lattice(scorer, setup)
    longest = int(np.argmax([len(p) for p in positions]))
    others = [p for k, p in enumerate(positions) if k != longest]
    across = np.stack([g.ravel() for g in np.meshgrid(*others, indexing="ij")], axis=1)
    poses = np.tile(np.array(mounted.park), (len(across), 1))
    poses[:, [k for i, k in enumerate(mounted.moves) if i != longest]] = across
    approaches = np.tile(approach, (len(poses), 1))
    gains = _along(scorer, setup, mounted.moves[longest], poses, approaches, positions[longest])
    lattice = np.moveaxis(gains.reshape(*(len(p) for p in others), -1), -1, longest)
    where, best = peaks(lattice)
    found = np.tile(np.array(mounted.park), (len(where), 1))
    found[:, list(mounted.moves)] = np.stack([p[w] for p, w in zip(positions, where.T, strict=True)], axis=1)
    return found, np.tile(approach, (len(found), 1)), best


def _lattice(scorer: Scorer, setup: int) -> list[Array]:
    observation = scorer.observation
    mounted, machine = observation.setups[setup], observation.machine
    for parts in range(_FINEST, 0, -1):
        positions = [
            raster_positions(machine, mounted, k)
            if mounted.raster[k] > 0
            else knot_lattice(observation, setup, k, parts)
            for k in mounted.moves
        ]
        if np.prod([len(p) for p in positions]) <= _POINTS:
            break
    return [p[:: max(1, len(p) * len(positions) // 1024)] for p in positions]


def _along(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array, positions: Array) -> Array:
    gains = np.empty((len(poses), len(positions)))
    for start in range(0, len(poses), _LINES):
        part = slice(start, start + _LINES)
        above, below = lines_along(scorer, setup, axis, poses[part], approaches[part]).on(positions)
        gains[part] = above / below
    return gains
