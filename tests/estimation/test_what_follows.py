"""What follows from few numbers: a curve's change, what is left of it, a target as RMS, the belief to plan by."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy import stats

from axiscal.answers.changes import _change
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal_core.normal import Normal
from tests.generators.laser_axis import CAMPAIGN, MACHINE


def known_with(seed: int, rest: float = 0.3e-6) -> Estimation:
    """Return a belief of the axis whose curve is any."""
    rng, described = np.random.default_rng(seed), campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m")
    errors = (replace(each, rest=rest) if each.name == "EXX" else each for each in described.machine.stated)
    case = Case(replace(described, machine=replace(described.machine, errors=tuple(errors))))
    size = case.knowledge.belief.size
    root = 1e-6 * rng.standard_normal((size, size))
    knowledge = Knowledge(case.observation, Normal(2e-6 * rng.standard_normal(size), root @ root.T))
    return cast("Estimation", SimpleNamespace(case=case, printed=knowledge))


def test_a_change_is_the_chi_square_of_the_difference_with_both_uncertainties() -> None:
    before, now = known_with(1), known_with(2, 0.5e-6)
    function = now.case.errors.by_name["EXX"]
    found = _change(before, now, function)
    means, covariances = [], []
    for each, rest in ((before, 0.3e-6), (now, 0.5e-6)):
        own = each.case.errors.by_name["EXX"]
        rows = own.spline.rows(function.spline.control_positions)
        covariance = each.printed.belief.covariance[own.columns, own.columns]
        means.append(rows @ each.printed.belief.mean[own.columns])
        covariances.append(rows @ covariance @ rows.T + rest**2 * np.eye(len(rows)))
    difference = means[1] - means[0]
    square = difference @ np.linalg.solve(covariances[0] + covariances[1], difference)
    assert found.chance == pytest.approx(stats.chi2(len(difference)).sf(square), rel=1e-6)
    beside = difference - np.mean(difference)
    worst = int(np.argmax(np.abs(beside)))
    assert found.size == pytest.approx(beside[worst])
    assert found.position == pytest.approx(function.spline.control_positions[worst])
    assert (found.name, found.angular, found.rotary) == ("EXX", False, False)
    single = _change(before, now, now.case.errors.by_name["EXX_reversal"])
    moved = now.printed.belief.mean - before.printed.belief.mean
    assert single.size == pytest.approx(float(moved[now.case.errors.by_name["EXX_reversal"].columns][0]))
