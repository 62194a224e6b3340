"""Which readings cannot be, one by one and at once; what is taken for an interval; how a mixture and a zero stand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.judged import judged
from axiscal.estimation.machine_estimate import Estimate
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
    """A line and Brownian motion over T, r²T²(x − 1 + exp(−x)) of each at the end, by the kernels of all readings."""
    case = Case(campaign_from_texts(CAMPAIGN.replace('drift = "0 um/h"', 'drift = "6 um/h"'), "c.toml", MACHINE, "m"))
    case = Case(replace(case.description, usual=False, sure="exactly"))
    readings = [replace(r, time=240.0 * i) for i, r in enumerate(read(machine(1), 16))]
    (path,) = estimated(case, readings).history.drifts("laser")
    times = np.array([240.0 * i for i in range(16)])
    assert path.times.tolist() == times.tolist()
    x = times[-1] / 3600
    share, size = times / times[-1], 6e-6**2 * (x - 1 + np.exp(-x))
    kernel = size * (np.outer(share, share) + np.minimum(share[:, None], share))
    curve, backlash = case.errors.by_name["EXX"], case.errors.by_name["EXX_reversal"]
    at, sides = np.array([r.pose[0] for r in readings]), np.array([r.approach[0] for r in readings])
    rows = curve.spline.rows(at)
    whole = kernel + rows @ curve.covariance @ rows.T + 1e-3**2
    whole += backlash.covariance[0, 0] * np.outer(sides, sides) / 4
    whole += np.diag(np.full(16, 0.5e-6**2 + curve.rest**2))  # no two in one cell
    mean = kernel @ np.linalg.solve(whole, [r.value for r in readings])
    left = np.sqrt(np.diagonal(kernel - kernel @ np.linalg.solve(whole, kernel)))
    prior = np.sqrt(np.diagonal(kernel))  # of which twenty functions lack 0.5 % of the variance
    assert path.prior == pytest.approx(prior, abs=0.02 * prior.max())
    assert path.mean == pytest.approx(mean, abs=0.05 * left.max())
    assert path.std == pytest.approx(left, abs=0.05 * left.max())
    assert (path.mean[0], path.std[0]) == (0.0, 0.0)
    assert estimated(CASE, readings).history.drifts("laser") == []


@pytest.mark.parametrize(("left", "seen"), [(0.94, True), (0.96, False)])
def test_a_shape_is_seen_where_its_standard_deviation_is_less_by_a_twentieth(left: float, seen: bool) -> None:
    errors = CASE.errors
    belief = Normal(np.zeros(errors.size), left**2 * errors.covariance())
    estimate = Estimate(errors, belief, ((0.0, 1.0),))
    rows = errors.by_name["EXX"].spline.rows(np.linspace(0, 1, 9))
    rows = np.hstack([rows, np.zeros((9, errors.size - rows.shape[1]))])
    assert estimate.sees(rows) == seen
    assert not estimate.sees(np.tile(rows[:1], (9, 1)))
