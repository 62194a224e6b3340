"""Four tracers on the same points: the classical evaluation in two steps, beside all unknowns together.

First step: every point and every station from the distances alone (multilateration). Second: the machine's errors from
the points, each as exact as the first step says, in a frame that may be shifted and turned against the machine's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from axiscal.estimation.case import Case
from axiscal.estimation.located import absorbed
from axiscal.estimation.stations import BentReadings, closed_form, polished, tips
from axiscal.machine.kinematics import frames
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from axiscal.numerics import Array
from axiscal_core.rigid import skew

_POSES = 150
_LOOSE, _TURNED = 1e-3, 1e-3
"""m, rad: what a point, or the frame, is free to be off."""


class Missed(NamedTuple):
    """At the tool, a rigid motion taken off, RMS, m."""

    together: float
    in_two_steps: float


def compared_evaluations(case: Case, points: int, seed: int) -> Missed:
    """Return how right both evaluations of the same readings are.  points : read from all four stations"""
    rng = np.random.default_rng((seed, 3))
    machine = Simulator(case.description.machine, case.description.setups).drawn(seed)
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    poses, sides = rng.uniform(low, high, (points, len(low))), np.ones((points, len(low)), dtype=int)
    pairs = [(tuple(pose), tuple(side)) for pose, side in zip(poses.tolist(), sides.tolist(), strict=True)]
    readings = [
        Reading(setup.name, pose, side, machine.read_all(setup, pose, side, rng)[0], time=0.0)
        for setup in case.description.setups
        for pose, side in pairs
    ]
    problem = BentReadings(case, readings)
    found = polished(problem, closed_form(case, readings, case.prior.mean)).point
    known = absorbed(case.linear_about(found), readings, {})
    together = known.knowledge.belief.mean[: case.errors.size]
    stepwise = _second_step(case, poses, sides, *_first_step(case, readings, points))
    return Missed(*(_missed(case, machine, mean) for mean in (together, stepwise)))


def _first_step(case: Case, readings: list[Reading], points: int) -> tuple[Array, Array]:
    """Return displacements of the points (points, 3) and their variances along x, y, z, from distances alone."""
    setups, nominal = case.description.setups, tips(case, readings[:points])
    stations = np.array([setup.station for setup in setups])
    lengths = np.array([reading.value for reading in readings]).reshape(len(setups), points)
    lengths = lengths + np.linalg.norm(nominal - stations[:, None], axis=2)
    start = closed_form(case, readings, case.prior.mean)[case.errors.size :]
    noise = setups[0].noise

    def left(x: Array) -> Array:
        own, moved = x[: 4 * len(setups)].reshape(-1, 4), x[4 * len(setups) :].reshape(points, 3)
        at = stations + own[:, 1:]
        seen = np.linalg.norm(nominal + moved - at[:, None], axis=2) + own[:, :1]
        return np.concatenate([((seen - lengths) / noise).ravel(), moved.ravel() / _LOOSE])

    solved = least_squares(left, np.concatenate([start, np.zeros(3 * points)]), x_scale="jac", method="trf")
    slopes = np.asarray(solved.jac, dtype=float)
    covariance = np.linalg.inv(slopes.T @ slopes)
    first, frame = 4 * len(setups), _rigid(nominal)
    inside = np.eye(3 * points) - frame @ np.linalg.pinv(frame)  # the frame of the stations is nobody's
    spread = np.diagonal(inside @ covariance[first:, first:] @ inside)
    return (inside @ solved.x[first:]).reshape(points, 3), spread.reshape(points, 3)


def _rigid(places: Array) -> Array:
    """Return what small shifts and turns about x, y, z do to places, (3 m, 6).  places : (m, 3)"""
    return np.concatenate([np.broadcast_to(np.eye(3), (len(places), 3, 3)), -skew(places)], axis=2).reshape(-1, 6)


def _second_step(case: Case, poses: Array, sides: Array, moved: Array, variances: Array) -> Array:
    """Return the mean of the errors from displacements, as independent readings; frame and errors together."""
    rows = case.errors.rows(poses, sides.astype(float))
    nominal = frames(case.description.machine, poses).tcp
    table = np.hstack([rows.reshape(-1, case.errors.size), _rigid(nominal)])
    root = np.zeros((case.errors.size + 6,) * 2)
    root[: case.errors.size, : case.errors.size] = case.errors.prior_root()
    root[case.errors.size :, case.errors.size :] = np.diag([_LOOSE] * 3 + [_TURNED] * 3)
    weighted = (table @ root) / np.sqrt(variances.ravel())[:, None]
    normal = np.eye(len(root)) + weighted.T @ weighted
    z = np.linalg.solve(normal, weighted.T @ (moved.ravel() / np.sqrt(variances.ravel())))
    return np.asarray((root @ z)[: case.errors.size], dtype=float)


def _missed(case: Case, machine: VirtualMachine, mean: Array) -> float:
    """Return the RMS at the tool of truth less estimate, the rigid motion that fits it best taken off."""
    low, high = np.array([axis.travel for axis in case.description.machine.axes]).T
    poses = np.random.default_rng(7).uniform(low, high, (_POSES, len(low)))
    sides = np.ones_like(poses)
    left = machine.deviation(poses, sides) - case.errors.rows(poses, sides) @ mean
    rigid = _rigid(frames(case.description.machine, poses).tcp)
    left = left.ravel() - rigid @ np.linalg.lstsq(rigid, left.ravel(), rcond=None)[0]
    return float(np.sqrt(3 * np.mean(left**2)))
