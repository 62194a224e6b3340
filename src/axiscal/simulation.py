"""Virtual machines with a hidden truth: drawn from the prior, or given as curves that the model need not contain.

Readings come from the full non-linear kinematics, so what is estimated is never simulated by the formula that
estimates it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from axiscal.error_model.model import ErrorFunction, ErrorModel
from axiscal.exceptions import ReadingError
from axiscal.machine.description import Machine
from axiscal.machine.entry import ErrorEntry
from axiscal.machine.kinematics import SmallMotions, tool_motion
from axiscal.machine.names import parse_error_name
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.instruments.model import Actual, Place
from axiscal.measurement.readers.truth import TruthCurve, read_truth
from axiscal.measurement.setup import Setup
from axiscal.numerics import Array
from axiscal.numerics.rigid import Motion

Curve = Callable[[Array], Array]
"""Positions (m,) of the error's axis -> values (m,), m or rad."""


@dataclass(frozen=True, eq=False, slots=True)
class VirtualMachine:
    """A machine whose errors are known to the simulation only.

    model : names the errors it has; curves : one for each; offsets : per set-up name the values of its own unknowns
    """

    model: ErrorModel
    curves: tuple[Curve, ...]
    offsets: Mapping[str, Mapping[str, float]]

    def values(self, poses: Array) -> Array:
        """Return the value of every error at poses (m, q): (functions, m)."""
        pairs = zip(self.model.functions, self.curves, strict=True)
        return np.array([curve(poses[:, f.axis]) for f, curve in pairs]).reshape(len(self.curves), len(poses))

    def deviation(self, poses: Array, approaches: Array) -> Array:
        """Return the TCP deviation in the workpiece frame, m.  poses, approaches : (m, q); returns (m, 3)."""
        actual, nominal = self._motions(poses, approaches)
        shift: Array = actual.translation - nominal.translation
        return shift

    def rotation(self, poses: Array, approaches: Array) -> Array:
        """Return the orientation deviation of the tool in the workpiece frame, rad, to second order.  Returns (m,
        3).
        """
        actual, nominal = self._motions(poses, approaches)
        turn = actual.rotation @ np.swapaxes(nominal.rotation, 1, 2)
        skew = (turn - np.swapaxes(turn, 1, 2)) / 2
        return np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)

    def read(self, setup: Setup, pose: tuple[float, ...], approach: tuple[int, ...], rng: np.random.Generator) -> float:
        """Return the first number of what the set-up would show."""
        return self.read_all(setup, pose, approach, rng)[0]

    def read_all(
        self, setup: Setup, pose: tuple[float, ...], approach: tuple[int, ...], rng: np.random.Generator
    ) -> tuple[float, ...]:
        """Return what the set-up would show: the truth, its own unknowns, nothing linearised, and noise."""
        at, come = np.array([pose]), np.array([approach], dtype=float)
        model, place = INSTRUMENTS[setup.instrument].model, Place(self.model.machine, at, setup.moves)
        actual = Actual(self.deviation(at, come), self.rotation(at, come))
        directions = [np.array(setup.direction)] if model.values == 1 else list(np.eye(3))
        own = self.offsets.get(setup.name, {})
        shown = [float(model.shown(setup, direction, place, actual, own)[0]) for direction in directions]
        return tuple(value + setup.noise * rng.standard_normal() for value in shown)

    def _motions(self, poses: Array, approaches: Array) -> tuple[Motion, Motion]:
        small = self.model.compose(self.values(poses), approaches)
        still = SmallMotions(*(np.zeros_like(part) for part in small))
        return tool_motion(self.model.machine, poses, small), tool_motion(self.model.machine, poses, still)


@dataclass(frozen=True, slots=True)
class Simulator:
    """Makes virtual machines for a machine and its set-ups."""

    machine: Machine
    setups: tuple[Setup, ...]

    def drawn(self, seed: int) -> VirtualMachine:
        """Return a machine whose errors, rests included, are drawn from the prior."""
        model, rng = ErrorModel(self.machine), np.random.default_rng((seed, 1))
        return VirtualMachine(model, tuple(_drawn(f, rng) for f in model.functions), self._offsets(seed))

    def from_curves(self, path: Path, seed: int) -> VirtualMachine:
        """Return a machine whose errors are the curves of a file, linear between the points given.

        Raises ReadingError with file and line.
        """
        return self.with_curves(read_truth(path), seed, path)

    def with_curves(self, curves: Mapping[str, TruthCurve], seed: int, path: Path | None = None) -> VirtualMachine:
        """Return a machine with the given curves; errors that have none are zero."""
        names = {axis.name for axis in self.machine.axes}
        for name in curves:
            axis = parse_error_name(name).axis
            if axis not in names:
                what = f'"{name}" is an error of axis {axis}, which "{self.machine.name}" does not have'
                raise ReadingError(what, f"Take the curve out; the axes are {', '.join(sorted(names))}", path)
        model = ErrorModel(replace(self.machine, errors=tuple(ErrorEntry(name, std=1.0, knots=4) for name in curves)))
        return VirtualMachine(model, tuple(_through(curve) for curve in curves.values()), self._offsets(seed))

    def _offsets(self, seed: int) -> Mapping[str, Mapping[str, float]]:
        rng = np.random.default_rng((seed, 2))
        return {s.name: {u.name: u.std * rng.standard_normal() for u in s.unknowns} for s in self.setups}


def _through(curve: TruthCurve) -> Curve:
    return lambda positions: np.interp(positions, curve.positions, curve.values)


def _drawn(function: ErrorFunction, rng: np.random.Generator) -> Curve:
    values, vectors = np.linalg.eigh(function.covariance)
    control = vectors @ (np.sqrt(np.maximum(values, 0)) * rng.standard_normal(len(values)))
    start, stop = function.basis.knots[0], function.basis.knots[-1]
    cells = function.rest * rng.standard_normal(max(1, round((stop - start) / function.cell)))

    def curve(positions: Array) -> Array:
        drawn: Array = function.basis.rows(positions) @ control + cells[function.cells(positions)]
        return drawn

    return curve
