"""What an estimate promises where something is wrong: a drift, a step, nonsense."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.simulation import VirtualMachine
from tests.generators.laser_axis import CASE, machine, plus, read

_STEP = 0.43
"""m, where a machine has a step."""


def _missed(known: Estimation, machine: VirtualMachine, step: float = 0.0) -> float:
    """Return the RMS that an estimate is wrong by over the travel, a constant taken off, m.

    step : of the machine at _STEP, besides
    """
    poses = np.linspace(0, 1, 200)[:, None]
    sides = np.where(np.arange(200)[:, None] % 2 == 0, 1.0, -1.0)
    left = (machine.deviation(poses, sides) - known.estimate().deviation(poses, sides))[:, 0]
    return float(np.std(left + step * (poses[:, 0] > _STEP)))


@pytest.mark.parametrize(("seed", "count"), [(1, 24), (3, 28), (4, 24)])
def test_a_step_between_the_readings_is_within_the_promise(seed: int, count: int) -> None:
    drawn = machine(seed)
    readings = read(drawn, count)
    known = concluded(CASE, plus(readings, [15e-6 * (each.pose[0] > _STEP) for each in readings]))
    assert _missed(known, drawn, 15e-6) <= 1.5 * known.accuracy.rms
    assert len(known.outliers) <= 1


def test_nonsense_leaves_no_small_promise() -> None:
    rng, readings = np.random.default_rng(1), read(machine(1), 40)
    right, nonsense = concluded(CASE, readings), concluded(CASE, plus(readings, 60e-6 * rng.standard_cauchy(40)))
    assert nonsense.agreement.withheld or nonsense.accuracy.rms > 5 * right.accuracy.rms
