"""Readings from any side are judged by what they see of it, whatever the set-up allows."""

import numpy as np
import pytest

from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from tests.generators.campaigns import on
from tests.generators.texts import Said, machine_text, setup_text

MACHINE = machine_text(
    "w-b-X-Y-t",
    {"X": (0, 700), "Y": (0, 100)},
    {"EXX": 'std = "10 um", knots = 13, length = "150 mm"', "EXX_reversal": "3 um"},
)


def case(approach: Said) -> Case:
    laser = setup_text(
        "laser", "interferometer", direction="x", moves=["X"], unknowns={"zero": "1 mm"}, approach=approach
    )
    return Case(on(MACHINE, laser, target={"readings": 9, "aligned": False}, usual="off", sure="exactly"))


def read(stated: Case, sides: tuple[int, ...]) -> Estimation:
    places = enumerate(np.linspace(0.05, 0.65, 8).tolist())
    return estimated(stated, [Reading("laser", (x, 0.05), (sides[n % len(sides)], 0), 1e-6 * n) for n, x in places])


@pytest.mark.parametrize("sides", [(1, -1), (0,), (1, 0)])
def test_readings_from_other_sides_than_allowed_are_judged_by_what_they_see(sides: tuple[int, ...]) -> None:
    narrow, wide = (read(case(approach), sides) for approach in ("+", "both"))
    assert narrow.accuracy == pytest.approx(wide.accuracy, rel=1e-9)
    assert narrow.accuracy.rms >= narrow.case.yardstick.unseen_rms
    assert narrow.case.yardstick.rms_floor <= narrow.accuracy.rms
    assert narrow.case.description.setups[0].approach == "+"
