"""Which readings cannot be, one by one and at once; what is taken for an interval; how a mixture and a zero stand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.estimation import paths
from axiscal.estimation.judged import judged
from axiscal.estimation.machine_estimate import Estimate
from axiscal.measurement.cells import wandered
from axiscal_core.normal import Normal
from tests.generators.laser_axis import CAMPAIGN, CASE, MACHINE, machine, read


def test_errors_that_are_to_be_learnt_may_be_four_times_as_large() -> None:
    """A reading 40 of their stds away: no error of the stated size makes it, one that is four times as large does."""
    readings = read(machine(2), 20)
    readings[11] = replace(readings[11], value=readings[11].value + 400e-6)
    well = Case(campaign_from_texts(f'sure = "well"\n{CAMPAIGN}', "c.toml", MACHINE, "m"))
    assert list(judged(well, readings)) == [11]
    assert judged(CASE, readings) == {}


def test_the_way_of_a_zero_is_what_the_readings_say_of_its_drift_and_begins_at_nothing() -> None:
    case = Case(campaign_from_texts(CAMPAIGN.replace('drift = "0 um/h"', 'drift = "6 um/h"'), "c.toml", MACHINE, "m"))
    readings = [replace(r, time=240.0 * i) for i, r in enumerate(read(machine(1), 16))]
    known = estimated(case, readings)
    setup = case.description.setups[0]
    (path,) = paths(known, setup)
    times = [240.0 * i for i in range(16)]
    assert path.times.tolist() == times
    rate = 6e-6 / 3600
    prior = [float(np.sqrt(wandered(rate, time))) for time in times]
    assert path.prior == pytest.approx(prior, rel=1e-9)
    assert (path.mean[0], path.std[0]) == (0.0, 0.0)
    belief, ((_, course),) = known.knowledge.belief, known.knowledge.observation.courses.items()
    columns = list(course.columns)
    rows = course.rows(np.array(times))
    assert path.mean == pytest.approx(rows @ belief.mean[columns])
    assert path.std**2 == pytest.approx(np.diag(rows @ belief.covariance[np.ix_(columns, columns)] @ rows.T), abs=1e-20)
    assert 0 < path.std[-1] < path.prior[-1]
    assert paths(estimated(CASE, readings), CASE.description.setups[0]) == []


@pytest.mark.parametrize(("left", "seen"), [(0.94, True), (0.96, False)])
def test_a_shape_is_seen_where_its_standard_deviation_is_less_by_a_twentieth(left: float, seen: bool) -> None:
    errors = CASE.errors
    belief = Normal(np.zeros(errors.size), left**2 * errors.covariance())
    estimate = Estimate(errors, belief, ((0.0, 1.0),))
    rows = errors.by_name["EXX"].spline.rows(np.linspace(0, 1, 9))
    rows = np.hstack([rows, np.zeros((9, errors.size - rows.shape[1]))])
    assert estimate.sees(rows) == seen
    assert not estimate.sees(np.tile(rows[:1], (9, 1)))
