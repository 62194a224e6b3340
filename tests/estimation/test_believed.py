"""Which readings can speak of a drift: those of which it is told from which side a reversal came, where it shows."""

from __future__ import annotations

from axiscal.demo.five_axis import description
from axiscal.estimation.believed import with_sides
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.measurement.reading import Reading


def test_a_probe_that_evens_out_both_sides_needs_none_of_the_linear_axes() -> None:
    case = Case(description())
    setup = next(each for each in case.description.setups if each.mean_sides)
    turned = [axis.rotary for axis in case.errors.machine.axes]
    told = tuple(int(rotary) for rotary in turned)
    kept = Reading(setup.name, setup.park, told, 0.0, others=(0.0, 0.0))
    silent = Reading(setup.name, setup.park, tuple(0 for _ in turned), 0.0, others=(0.0, 0.0))
    assert with_sides(estimated(case, [kept, silent])) == [estimated(case, [kept, silent]).readings[0]]
