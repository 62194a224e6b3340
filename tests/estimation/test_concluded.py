"""What an estimate promises where something is wrong: drifts, steps, slips, few readings, another machine."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator, VirtualMachine
from tests.generators.laser_axis import CASE, machine, plus, read
from tests.generators.texts import machine_text

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


@pytest.mark.parametrize("seed", [1, 2])
def test_a_drift_that_nobody_stated_is_within_the_promise(seed: int) -> None:
    drawn = machine(seed)
    known = concluded(CASE, plus(read(drawn, 28), 10e-6 * np.linspace(0, 1, 28)))
    assert not known.agreement.withheld
    assert _missed(known, drawn) <= 1.5 * known.accuracy.rms


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


MILL = machine_text(
    "w-b-X-Y-Z-t",
    {"X": (0, 400), "Y": (0, 400), "Z": (0, 400)},
    {"EXX EYY": 'std = "5 um", length = "200 mm"', "C0Y": "30 urad", "EXX_reversal EYY_reversal EZZ_reversal": "3 um"},
)
BAR = """machine = "m"
tool_length = "0 um"
[target]
readings = 40
[[setups]]
name = "bar"
instrument = "ballbar"
length = "150 mm"
station = ["200 mm", "200 mm", "200 mm"]
plane = "xy"
raster = { arc = "5 deg" }
approach = "both"
"""


def test_a_circle_of_another_machine_is_contradicted() -> None:
    """Of a circle with the sign turned in part no reading agrees with the others; of a right one all do."""
    case = Case(campaign_from_texts(BAR, "c.toml", MILL, "m"))
    setup, places = case.description.setups[0], spread(case.description.machine, case.description.setups, 40)
    machine, rng = Simulator(case.description.machine, case.description.setups).drawn(3), np.random.default_rng(3)
    found = []
    for sign in (1.0, -1.0):
        taken = []
        for at, (pose, sides) in enumerate(zip(places.poses.tolist(), places.approaches.tolist(), strict=True)):
            visit = tuple(pose), tuple(int(side) for side in sides)
            shown = (sign if at % 3 else 1.0) * machine.read_all(setup, *visit, rng)[0]
            taken.append(Reading("bar", *visit, shown, time=10.0 * at))
        found.append(concluded(case, taken))
    right, wrong = found
    assert not right.agreement.contradicts
    assert right.agreement.agreeing == right.agreement.count == 40
    assert wrong.agreement.contradicts or wrong.accuracy.rms > 3 * right.accuracy.rms
