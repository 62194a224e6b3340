"""A circle of which some readings are those of another machine."""

from __future__ import annotations

import numpy as np

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator

MILL = """
chain = "w-b-X-Y-Z-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "400 mm"]
[axes.Z]
travel = ["0 mm", "400 mm"]
[errors]
EXX = { std = "5 um", length = "200 mm" }
EYY = { std = "5 um", length = "200 mm" }
C0Y = { std = "30 urad" }
EXX_reversal = { std = "3 um" }
EYY_reversal = { std = "3 um" }
EZZ_reversal = { std = "3 um" }
"""
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
            shown = (sign if at % 3 else 1.0) * machine.read(setup, *visit, rng)
            taken.append(Reading("bar", *visit, shown, time=10.0 * at))
        found.append(concluded(case, taken))
    right, wrong = found
    assert not right.agreement.contradicts
    assert right.agreement.agreeing == right.agreement.count == 40
    assert wrong.agreement.contradicts or wrong.accuracy.rms > 3 * right.accuracy.rms
