"""Samples of `make trust`: priors wrong by three and drifts over a plan leave bands that hold."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy import stats

from axiscal.estimation.estimate import concluded
from axiscal.measurement.reading import Places, Reading
from axiscal.measurement.simulation import Simulator
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.task import Limits
from benchmarks.trust.virtual import covered
from tests.planning.test_out_and_back import minutes, one_axis


@pytest.mark.long
@pytest.mark.parametrize(("wrong", "curves"), [(1 / 3, 0.8), (3.0, 0.93)])
def test_bands_hold_when_the_prior_is_wrong_by_three(wrong: float, curves: float) -> None:
    """The tool point's hold; one constant, of which fifteen readings tell little, is half of the curves."""
    found = covered("one-axis", wrong, "estimate", 25)
    assert found.tcp > 0.9
    assert found.curves > curves


@pytest.mark.long
def test_the_report_says_so_where_the_prior_is_three_times_too_small() -> None:
    assert covered("one-axis", 1 / 3, "estimate", 25).misfit > 0.7


@cache
def planned() -> Places:
    """Return twenty planned places."""
    return make_plan(one_axis()[1], Limits(readings=20), bounded=False, usual=True).places


@cache
def missed(seed: int) -> float:
    """Return what a machine is missed by, over what is promised."""
    case, task = one_axis()
    places = planned()
    truth = Simulator(case.description.machine, case.description.setups).drawn(seed)
    rng, setup, times = np.random.default_rng(seed), case.description.setups[0], minutes(task, places)
    readings = []
    for pose, side, time in zip(places.poses.tolist(), places.approaches.astype(int).tolist(), times, strict=True):
        drifted = 10e-6 * (time - times[0]) / np.ptp(times)
        value = truth.read_all(setup, tuple(pose), tuple(side), rng)[0] + drifted
        readings.append(Reading("laser", tuple(pose), tuple(side), value, time=float(time)))
    known = concluded(case, readings)
    function, at = case.errors.functions[0], np.linspace(0.0, 1.0, 401)
    mean, _ = known.estimate().curve(function.name, at)
    assert known.accuracy.rms < 4e-6  # of a drift of ten more than half is told from the curve
    return float(np.std(truth.curves[0](at) - mean)) / known.accuracy.rms


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in range(1, 4))])
def test_ten_micrometres_of_drift_are_taken_off_or_counted(seed: int) -> None:
    assert missed(seed) < 1.5


@pytest.mark.long
def test_what_is_promised_is_no_less_than_what_is_missed_on_the_whole() -> None:
    """Of some eight directions in which a curve may be missed each; one in a thousand by chance is beyond."""
    several = 12
    limit = stats.chi2.isf(1e-3, 8 * several) / (8 * several)
    assert np.mean([missed(seed) ** 2 for seed in range(several)]) < limit
