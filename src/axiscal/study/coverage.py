"""How much of a known truth lies in the bands that an estimate prints."""

from __future__ import annotations

import numpy as np

from axiscal.accuracy.expanded import BAND
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.prediction import tcp_prediction
from axiscal.numerics import Array
from axiscal.simulation import Curve, VirtualMachine

_POSITIONS = 101
"""Of each curve; any number that is finer than its knots would do."""


def curves_held(estimation: Estimation, machine: VirtualMachine) -> float:
    """Return the share of all error curves, at 101 positions each, that lies in their 95 % bands."""
    names = [term.name for term in machine.model.terms]
    inside = [
        _curve(estimation, name, machine.curves[names.index(name)])
        for name in estimation.banded.case.errors.names
        if name in names
    ]
    return float(np.mean(np.concatenate(inside)))


def _curve(estimation: Estimation, name: str, truth: Curve) -> Array:
    function = estimation.banded.case.errors.names[name]
    positions = np.linspace(function.basis.knots[0], function.basis.knots[-1], _POSITIONS)
    mean, std = estimation.estimate().curve(name, positions)
    held: Array = (np.abs(truth(positions) - mean) <= BAND * std).astype(float)
    return held


def tcp_held(estimation: Estimation, machine: VirtualMachine, poses: Array, approaches: Array) -> float:
    """Return the share of the TCP deviations along x, y, z at poses (m, q) that lies in their 95 % bands."""
    mean, std = tcp_prediction(estimation, poses, approaches)
    moves = std > 0
    inside = np.abs(machine.deviation(poses, approaches) - mean)[moves] <= BAND * std[moves]
    return float(inside.mean())
