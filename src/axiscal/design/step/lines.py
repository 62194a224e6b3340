"""How the gain runs along one axis while the others stand still, for many lines at once.

Along axis k a row is λ(t)ᵀ times a few fixed vectors: the levers are affine in a linear coordinate and of first order
in sine and cosine of a rotary one, the other axes' splines do not change, and the own splines m(t) multiply the own
levers. So the products with [F, C Vᵀ], and of these with each other, are made once per line, and a position costs a
short vector and two small matrices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from axiscal.design.gains.gain import Scorer
from axiscal.design.gains.three_values import joint_forms
from axiscal.design.step.cell_rests import Rests, cells_along
from axiscal.design.step.line_forms import LineForms
from axiscal.error_model.model import ErrorModel
from axiscal.error_model.plane import PlaneError
from axiscal.measurement.observation import Observation, directions_of
from axiscal.measurement.setup import Setup
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
        self._noise, self._errors, self._axis = mounted.noise**2, scorer.observation.errors, axis
        self._numbers = [_Number(scorer, setup, axis, poses, approaches, d) for d in directions_of(mounted)]
        rests = Rests(scorer.observation, axis, poses, [number.effects for number in self._numbers], scorer.both)
        levers = self._numbers[0].far.shape[1]
        self._forms = LineForms([number.vectors for number in self._numbers], levers, rests, scorer.rank)

    def on(self, positions: Array) -> tuple[Array, Array]:
        """Return both forms of every line at the same positions, each (lines, p).  positions : (p,)."""
        count = self._forms.lines
        along = [np.broadcast_to(each, (count, *each.shape)) for each in self._along(positions)]
        return self._split(along, np.broadcast_to(positions, (count, len(positions))), np.arange(count))

    def forms(self, positions: Array, line: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return both forms at each line's own positions, each (b, k).  positions : (b, k); line : (b,)."""
        along = [each.reshape(*positions.shape, -1) for each in self._along(positions.ravel())]
        return self._split(along, positions, line)

    def _along(self, positions: Array) -> list[Array]:
        """Return for each number how much of each of its fixed vectors is seen at positions (p,), (p, vectors)."""
        levers = _levers(self._errors, self._axis, positions)
        return [np.hstack([levers, *(_spread(levers, own, positions) for own in n.own)]) for n in self._numbers]

    def _split(self, along: list[Array], positions: Array, line: NDArray[np.intp]) -> tuple[Array, Array]:
        above, below = self._forms.at(along, positions, line)
        every = np.arange(len(along))
        below[..., every, every] += self._noise
        return joint_forms(above, below, self._noise)


class _Number:
    """One number of the readings, that along a direction where there are several.

    far : (lines, levers, r + w) what does not change along the axis but by its levers; own : the moving axis' functions
    effects : (terms, lines, levers) what a unit of each error adds
    """

    def __init__(
        self, scorer: Scorer, setup: int, axis: int, poses: Array, approaches: Array, direction: Array | None
    ) -> None:
        observation = scorer.observation
        nodes = _nodes(observation.errors, axis)
        lines, levers = len(poses), len(nodes)
        at = np.repeat(poses, levers, axis=0)
        at[:, axis] = np.tile(nodes, lines)
        sides = np.repeat(approaches, levers, axis=0)
        (rows, _), effects = observation.rows_and_effects(setup, at, sides, direction)
        columns_of = _own_columns(observation.errors, axis)
        self.own = [_Own(basis, _vectors(rows, columns, scorer.both, (lines, levers))) for basis, columns in columns_of]
        self.effects = effects.reshape(-1, lines, levers)
        first = len(observation.errors.functions)
        self.own += [
            _Own(*_plane_vectors(plane, axis, poses, self.effects[index], scorer.both))
            for index, plane in enumerate(observation.errors.planes, first)
            if axis in plane.axes
        ]
        for _, columns in columns_of:
            rows[:, columns.ravel()] = 0.0
        for plane in observation.errors.planes:
            if axis in plane.axes:
                rows[:, plane.columns] = 0.0
        rows[:, cells_along(observation, axis)] = 0.0
        self.far: Array = (rows @ scorer.both).reshape(lines, levers, -1)

    @property
    def vectors(self) -> Array:
        """All fixed vectors, (lines, vectors, r + w), those of the levers first."""
        lines, _, width = self.far.shape
        return np.concatenate([self.far, *(own.vectors.reshape(lines, -1, width) for own in self.own)], axis=1)


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


def _straight(observation: Observation, setup: int, axis: int) -> bool:
    """Return whether what a unit of each unknown adds follows from its values at the nodes, looked at in two places."""
    return _straight_on(observation.errors, observation.setups[setup], axis)


@remembered
def _straight_on(errors: ErrorModel, mounted: Setup, axis: int) -> bool:
    """Return the same, which does not depend on what was read, nor on the other set-ups."""
    alone = Observation(errors, (mounted,))
    return mounted.base is None and all(_follows(alone, axis, direction) for direction in directions_of(mounted))


def _follows(observation: Observation, axis: int, direction: Array | None) -> bool:
    nodes = _nodes(observation.errors, axis)
    low, high = observation.machine.axes[axis].travel
    probes = low + (high - low) * np.array([0.31, 0.83])
    poses = np.tile(np.array(observation.setups[0].park), (len(nodes) + 2, 1))
    poses[:, axis] = np.concatenate([nodes, probes])
    (rows, _), effects = observation.rows_and_effects(0, poses, np.ones_like(poses), direction)
    seen = np.hstack([effects.T, rows[:, observation.unknowns_of(0)]])
    followed = _levers(observation.errors, axis, probes) @ seen[: len(nodes)]
    return bool(np.all(np.abs(followed - seen[len(nodes) :]) <= _FOLLOWS * np.abs(seen).max(axis=0) + _ROUNDING))


def _levers(errors: ErrorModel, axis: int, positions: Array) -> Array:
    """Return λ(t), (p, levers): 1 at its own node, 0 at the others."""
    nodes = _nodes(errors, axis)
    if errors.machine.axes[axis].rotary:
        turned: Array = (1 + 2 * np.cos(positions[:, None] - nodes)) / 3
        return turned
    share = (positions - nodes[0]) / (nodes[1] - nodes[0])
    return np.stack([1 - share, share], axis=1)


@remembered
def _nodes(errors: ErrorModel, axis: int) -> Array:
    """Return positions at which the levers are sampled: two on a linear axis, three around a rotary one."""
    low, high = errors.machine.axes[axis].travel
    if errors.machine.axes[axis].rotary:
        around: Array = (low + high) / 2 + 2 * np.pi / 3 * np.array([-1.0, 0.0, 1.0])
        return around
    return np.array([low, high])


@remembered
def _own_columns(errors: ErrorModel, axis: int) -> list[tuple[Spline, NDArray[np.intp]]]:
    """Return the splines of an axis, each with the columns (functions, size) of those that share it."""
    groups: dict[bytes, tuple[Spline, list[NDArray[np.intp]]]] = {}
    for function in errors.functions:
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
