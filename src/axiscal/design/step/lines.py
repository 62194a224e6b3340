"""How the gain runs along one axis while the others stand still, for many lines at once.

Along axis k a row is λ(t)ᵀ times a few fixed vectors: the levers are affine in a linear coordinate and of first order
in sine and cosine of a rotary one, the other axes' splines do not change, and the own splines m(t) multiply the own
levers. So the products with [F, C Vᵀ] are made once per line, and a position costs a short vector.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.gain import Scorer
from axiscal.design.gains.three_values import joint_forms
from axiscal.design.step.cell_rests import Rests
from axiscal.error_model.plane import PlaneError
from axiscal.measurement.observation import Observation, directions_of
from axiscal.numerics import Array
from axiscal.numerics.cubic import Spline
from axiscal.numerics.remembered import remembered

_SAME = 1e-14
"""Rounding: levers that do not change along an axis."""
_FOLLOWS = 1e-9
"""Rounding of a lever that is as the line says; one that is not is off by a thousandth at least."""
_ROUNDING = 1e-12
"""A lever of this size counts as none: m/rad, 1, or rad/rad."""


class _Own(NamedTuple):
    """Functions of the moving axis that share their knots: fixed vectors (lines, levers, size, r + w)."""

    basis: Spline
    vectors: Array


class Lines:
    """Numerator and denominator of the gain along one axis.

    poses, approaches : (lines, q); the moving axis' own coordinate in them does not matter
    """

    def __init__(self, scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array) -> None:
        mounted = scorer.observation.setups[setup]
        self._scorer, self._noise = scorer, mounted.noise**2
        self._numbers = [_Number(scorer, setup, axis, poses, approaches, d) for d in directions_of(mounted)]

    def on(self, positions: Array) -> tuple[Array, Array]:
        """Return both forms of every line at the same positions, each (lines, p).  positions : (p,)."""
        return self._split([number.on(positions) for number in self._numbers])

    def forms(self, positions: Array, line: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return both forms at each line's own positions, each (b, k).  positions : (b, k); line : (b,)."""
        return self._split([number.at(positions, line) for number in self._numbers])

    def _split(self, parts: list[_LinePart]) -> tuple[Array, Array]:
        if len(parts) == 1:
            return self._scorer.split(parts[0].seen, self._noise + np.sum(parts[0].open_rests ** 2, axis=0))
        seen = np.stack([part.seen for part in parts], axis=2)
        rests = np.stack([part.open_rests for part in parts])
        covariances = np.einsum("ifbk,jfbk->bkij", rests, rests) + self._noise * np.eye(len(parts))
        return joint_forms(*self._scorer.products(seen, covariances), self._noise)


class _LinePart(NamedTuple):
    """What one number of the readings sees.

    seen : (b, k, r + w) its rows times [F, C Vᵀ]; open_rests : (functions, b, k) stds of the rests of cells not visited
    """

    seen: Array
    open_rests: Array


class _Number:
    """One number of the readings, that along a direction where there are several."""

    def __init__(
        self, scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array, direction: Array | None
    ) -> None:
        observation = scorer.observation
        self._scorer, self._axis, nodes = scorer, axis, _nodes(observation, axis)
        lines, levers = len(poses), len(nodes)
        at = np.repeat(poses, levers, axis=0)
        at[:, axis] = np.tile(nodes, lines)
        sides = np.repeat(approaches, levers, axis=0)
        rows = observation.rows(setup, at, sides, direction).rows
        self._own = [
            _Own(basis, _vectors(rows, columns, scorer.both, (lines, levers)))
            for basis, columns in _own_columns(observation, axis)
        ]
        effects = observation.effects(setup, at, sides, direction)
        first = len(observation.errors.functions)
        self._own += [
            _Own(*_plane_vectors(plane, axis, poses, effects[index].reshape(lines, levers), scorer.both))
            for index, plane in enumerate(observation.errors.planes, first)
            if axis in plane.axes
        ]
        self._rests = Rests(observation, axis, at, effects, levers, scorer.both)
        self._far = self._fixed(rows, axis).reshape(lines, levers, -1)

    def _fixed(self, rows: Array, axis: int) -> Array:
        for _, columns in _own_columns(self._scorer.observation, axis):
            rows[:, columns.ravel()] = 0.0
        for plane in self._scorer.observation.errors.planes:
            if axis in plane.axes:
                rows[:, plane.columns] = 0.0
        rows[:, self._rests.own_columns] = 0.0
        fixed: Array = rows @ self._scorer.both
        return fixed

    def on(self, positions: Array) -> _LinePart:
        """Return what is seen on every line at the same positions.  positions : (p,)."""
        levers = _levers(self._scorer.observation, self._axis, positions)
        seen = levers @ self._far
        for own in self._own:
            seen += _spread(levers, own, positions) @ own.vectors.reshape(len(seen), -1, seen.shape[2])
        every = np.arange(len(seen))
        self._rests.add(seen, np.broadcast_to(positions, seen.shape[:2]), every, levers)
        return _LinePart(seen, self._rests.open_rests(positions[None], every, levers))

    def at(self, positions: Array, line: NDArray[np.intp]) -> _LinePart:
        """Return what is seen at each line's own positions.  positions : (b, k); line : (b,)."""
        shape = positions.shape
        levers = _levers(self._scorer.observation, self._axis, positions.ravel()).reshape(*shape, -1)
        seen = levers @ self._far[line]
        for own in self._own:
            spread = _spread(levers.reshape(positions.size, -1), own, positions.ravel()).reshape(*shape, -1)
            for one in np.unique(line):
                mine = line == one
                seen[mine] += spread[mine] @ own.vectors[one].reshape(-1, seen.shape[2])
        self._rests.add(seen, positions, line, levers)
        return _LinePart(seen, self._rests.open_rests(positions, line, levers))


class SampledLines:
    """The same where no such vectors give the gain: the lever is another function of the axis, as for an instrument
    that looks towards a station, or feet stand aside of the position.
    """

    def __init__(self, scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array) -> None:
        self._scorer, self._setup, self._axis = scorer, setup, axis
        self._poses, self._approaches = poses, approaches

    def on(self, positions: Array) -> tuple[Array, Array]:
        """Return both forms of every line at the same positions, each (lines, p).  positions : (p,)."""
        every = np.arange(len(self._poses))
        return self.forms(np.broadcast_to(positions, (len(every), len(positions))), every)

    def forms(self, positions: Array, line: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return both forms at each line's own positions, each (b, k).  positions : (b, k); line : (b,)."""
        owner = np.repeat(line, positions.shape[1])
        poses = self._poses[owner]
        poses[:, self._axis] = positions.ravel()
        above, below = self._scorer.forms(self._setup, poses, self._approaches[owner])
        return above.reshape(positions.shape), below.reshape(positions.shape)


def lines_along(scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array) -> Lines | SampledLines:
    """Return the lines through poses (lines, q) along an axis."""
    kind = Lines if _straight(scorer.observation, setup, axis) else SampledLines
    return kind(scorer, setup, axis, poses, approaches)


@remembered
def _straight(observation: Observation, setup: int, axis: int) -> bool:
    """Return whether what a unit of each unknown adds follows from its values at the nodes, looked at in two places."""
    if observation.setups[setup].base is not None:
        return False
    return all(_follows(observation, setup, axis, direction) for direction in directions_of(observation.setups[setup]))


def _follows(observation: Observation, setup: int, axis: int, direction: Array | None) -> bool:
    nodes = _nodes(observation, axis)
    low, high = observation.machine.axes[axis].travel
    probes = low + (high - low) * np.array([0.31, 0.83])
    poses = np.tile(np.array(observation.setups[setup].park), (len(nodes) + 2, 1))
    poses[:, axis] = np.concatenate([nodes, probes])
    approaches = np.ones_like(poses)
    own = observation.rows(setup, poses, approaches, direction).rows[:, observation.unknowns_of(setup)]
    seen = np.hstack([observation.effects(setup, poses, approaches, direction).T, own])
    followed = _levers(observation, axis, probes) @ seen[: len(nodes)]
    return bool(np.all(np.abs(followed - seen[len(nodes) :]) <= _FOLLOWS * np.abs(seen).max(axis=0) + _ROUNDING))


def _levers(observation: Observation, axis: int, positions: Array) -> Array:
    """Return λ(t), (p, levers): 1 at its own node, 0 at the others."""
    nodes = _nodes(observation, axis)
    if observation.machine.axes[axis].rotary:
        turned: Array = (1 + 2 * np.cos(positions[:, None] - nodes)) / 3
        return turned
    share = (positions - nodes[0]) / (nodes[1] - nodes[0])
    return np.stack([1 - share, share], axis=1)


def _nodes(observation: Observation, axis: int) -> Array:
    """Return positions at which the levers are sampled: two on a linear axis, three around a rotary one."""
    low, high = observation.machine.axes[axis].travel
    if observation.machine.axes[axis].rotary:
        around: Array = (low + high) / 2 + 2 * np.pi / 3 * np.array([-1.0, 0.0, 1.0])
        return around
    return np.array([low, high])


def _own_columns(observation: Observation, axis: int) -> list[tuple[Spline, NDArray[np.intp]]]:
    """Return the splines of an axis, each with the columns (functions, size) of those that share it."""
    groups: dict[bytes, tuple[Spline, list[NDArray[np.intp]]]] = {}
    for function in observation.errors.functions:
        if function.axis == axis:
            key = bytes([function.basis.size == 1]) + function.basis.knots.tobytes()
            columns = np.arange(function.columns.start, function.columns.stop)
            groups.setdefault(key, (function.basis, []))[1].append(columns)
    return [(basis, np.array(columns)) for basis, columns in groups.values()]


def _vectors(rows: Array, columns: NDArray[np.intp], both: Array, shape: tuple[int, int]) -> Array:
    """Return the own levers times the own part of [F, C Vᵀ].  The rows of a spline sum to one, so their sum is the
    lever.
    """
    levers = _fewest(rows[:, columns].sum(axis=2).reshape(*shape, -1))
    flat = levers.reshape(-1, len(columns)) @ both[columns].reshape(len(columns), -1)
    vectors: Array = flat.reshape(*levers.shape[:2], columns.shape[1], both.shape[1])
    return vectors


def _fewest(levers: Array) -> Array:
    """Return levers (lines, nodes, …), those of one node where they do not change along the lines."""
    same = np.ptp(levers, axis=1).max(initial=0.0) <= _SAME * np.abs(levers).max(initial=0.0)
    return levers[:, :1] if same else levers


def _plane_vectors(plane: PlaneError, axis: int, poses: Array, levers: Array, both: Array) -> tuple[Spline, Array]:
    """Return the spline of a plane's moving axis, and the other axis' part times its levers and its part of [F, C Vᵀ].

    levers : (lines, nodes)
    """
    moving = plane.axes.index(axis)
    side, other = plane.sides[moving], plane.sides[1 - moving]
    held = other.rows(poses[:, plane.axes[1 - moving]])[:, plane.pairs[:, 1 - moving]]
    values = side.basis[:, plane.pairs[:, moving]] * held[:, None, :] @ both[plane.columns]
    return side.spline, _fewest(levers)[:, :, None, None] * values[:, None]


def _spread(levers: Array, own: _Own, positions: Array) -> Array:
    """Return λ(t) ⊗ m(t), or m(t) where the own levers are constant: (p, levers · size)."""
    values = own.basis.rows(positions)
    if own.vectors.shape[1] == 1:
        return values
    spread: Array = (levers[:, :, None] * values[:, None, :]).reshape(len(positions), -1)
    return spread
