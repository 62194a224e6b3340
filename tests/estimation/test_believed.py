"""Which readings can speak of a drift: those of which it is told from which side a reversal came, where it shows."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded, estimated
from axiscal.estimation.zero_drift import sides_told, with_sides
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.measurement.simulation import Simulator
from axiscal.present.demo.five_axis import description

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


@pytest.mark.long
def test_a_probe_that_evens_out_both_sides_needs_none_of_the_linear_axes() -> None:
    case = Case(description())
    setup = next(each for each in case.description.setups if each.mean_sides)
    turned = [axis.rotary for axis in case.errors.machine.axes]
    told = tuple(int(rotary) for rotary in turned)
    kept = Reading(setup.name, setup.park, told, 0.0, others=(0.0, 0.0))
    silent = Reading(setup.name, setup.park, tuple(0 for _ in turned), 0.0, others=(0.0, 0.0))
    assert with_sides(estimated(case, [kept, silent])) == [estimated(case, [kept, silent]).readings[0]]


def test_an_axis_that_stands_while_a_bar_goes_round_needs_no_side() -> None:
    """Of a bar in xy only a place where X or Y turns, and the bar lies along it, hangs on a side that nobody knows."""
    case = Case(campaign_from_texts(BAR, "c.toml", MILL, "m"))
    places = spread(case.description.machine, case.description.setups, 144)
    assert np.all(places.approaches[:, 2] == 0)
    taken = [
        Reading("bar", tuple(pose), tuple(int(side) for side in sides), 0.0)
        for pose, sides in zip(places.poses.tolist(), places.approaches.tolist(), strict=True)
    ]
    kept = {reading.place for reading in with_sides(estimated(case, taken))}
    turning = {reading.place for reading in taken if 0 in reading.approach[:2]}
    assert kept == {reading.place for reading in taken} - turning
    assert len(kept) > 0.8 * len(taken)


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


def test_what_is_of_note_is_a_share_of_the_noise_that_is_stated_of_the_reading_itself() -> None:
    """A reversal of 3 um is within a tenth of 100 um, whatever the other readings of the bar scatter by."""
    case = Case(campaign_from_texts(BAR, "c.toml", MILL, "m"))
    middle = tuple(sum(axis.travel) / 2 for axis in case.errors.machine.axes)
    pose = (middle[0] + 0.15, *middle[1:])
    told, silent = (Reading("bar", pose, (side, 1, 0), 0.0) for side in (1, 0))
    coarse = Reading("bar", pose, (0, 1, 0), 0.0, std=100e-6)
    assert sides_told([told, silent, coarse], case) == [told, coarse]
