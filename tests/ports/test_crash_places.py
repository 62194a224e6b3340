"""A check is read where crashes show: by how much they do is compared with dense algebra, number by number."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.estimation.case import Case
from axiscal.estimation.promise.problem import Inherited
from axiscal.machine import machine_from_text
from axiscal.measurement.place import Places
from axiscal.numerics import Array
from axiscal.ports.fleet.quick_check import _CrashRows, crashes, showing_crashes
from tests.generators.campaigns import mixed
from tests.generators.sisters import MACHINE, slide

SECOND = """[axes.U]
travel = ["0 mm", "100 mm"]
[errors]
EXU = { std = "5 um", knots = 4, length = "50 mm" }
EYU = { std = "5 um", knots = 4, length = "50 mm" }
"""


TURNING = """chain = "w-C'-b-Y-t"
[axes.C]
travel = TRAVEL
[axes.Y]
travel = ["0 mm", "100 mm"]
[errors]
C0Y = { std = "40 urad" }
ECC = { std = "20 urad", knots = 12, length = "60 deg" }
"""


def _loss(case: Case, places: Places) -> float:
    """Return the sum over the crashes, by a Cholesky root of the scatter of all numbers."""
    rows, variances = list[Array](), list[Array]()
    for index in range(len(places)):
        one = places.at(index)
        for seen in case.observation.rows_each(int(one.setups[0]), one.poses, one.approaches):
            rows.append(seen.rows)
            variances.append(seen.variances)
    whole = np.concatenate(rows)
    root = np.linalg.cholesky(whole @ case.prior.covariance @ whole.T + np.diag(np.concatenate(variances)))
    looked_for = crashes(case.errors)
    off = np.linalg.solve(root, whole[:, : looked_for.shape[1]] @ looked_for.T)
    return float(np.sum(np.exp(-np.sum(off**2, axis=0) / 12.0)))


def test_how_far_crashes_stand_out_is_what_dense_algebra_says() -> None:
    case = mixed()
    first, second = (np.flatnonzero(case.lattice.setups == setup) for setup in (0, 1))
    places = case.lattice.within(np.concatenate([first[[0, 3, 9]], second[[0, 5, 11, 40]]]))
    assert len(set(places.setups.tolist())) == 2  # of one value and of three
    found = _CrashRows(case, places, crashes(case.errors)).losses([0, 2, 3, 4])
    assert np.isinf(found[[0, 2, 3, 4]]).all()
    for index in (1, 5, 6):
        np.testing.assert_allclose(found[index], _loss(case, places.within(np.array([0, 2, 3, 4, index]))), rtol=1e-8)


def test_readings_that_would_not_show_a_scale_are_moved_until_they_do() -> None:
    case = Case(slide())
    names = [term.name for term in case.errors.terms]
    assert names == ["EXX", "EXX_reversal"]
    looked_for = crashes(case.errors)
    assert looked_for.shape == (1, case.errors.size)
    np.testing.assert_allclose(looked_for[0, [0, -2]], [-60e-6, 60e-6], rtol=1e-6)
    middle = np.argsort(np.abs(case.lattice.poses[:, 0] - 0.25))[:5]
    before = case.lattice.within(middle)
    after = showing_crashes(case, before)
    assert len(after) == 5
    assert np.ptp(before.poses[:, 0]) < 0.02
    assert np.ptp(after.poses[:, 0]) > 0.4
    assert _loss(case, after) < 0.5 * _loss(case, before)
    assert showing_crashes(case, Places.none(1)).poses.shape == (0, 1)


def test_the_scale_of_a_second_slide_along_one_direction_is_looked_for_too() -> None:
    machine = MACHINE.format(serial="", travel=500).replace("-X-", "-X-U-").replace("[errors]", SECOND)
    errors = ErrorModel(machine_from_text(machine))
    columns = {term.name: term.columns for term in errors.terms}
    shown = [{name for name, own in columns.items() if np.any(each[own])} for each in crashes(errors)]
    assert sorted(map(list, shown)) == [["EXU"], ["EXX"]]


@pytest.mark.parametrize(
    ("travel", "looked_for"), [('["-180 deg", "180 deg"]', ["C0Y"]), ('["-100 deg", "100 deg"]', ["C0Y", "ECC"])]
)
def test_around_an_axis_that_turns_round_there_is_no_scale(travel: str, looked_for: list[str]) -> None:
    errors = ErrorModel(machine_from_text(TURNING.replace("TRAVEL", travel)))
    columns = {term.name: term.columns for term in errors.terms}
    shown = [name for each in crashes(errors) for name, own in columns.items() if np.any(each[own])]
    assert sorted(shown) == looked_for


def test_where_crashes_show_already_readings_stay_where_drifts_show_most() -> None:
    described = slide()
    stated = Case(described).errors.prior_covariance()
    drifted = Case(described, Inherited(np.zeros(len(stated)), 0.19 * stated))
    even = np.array([np.argmin(np.abs(drifted.lattice.poses[:, 0] - x)) for x in np.linspace(0.01, 0.49, 12)])
    before = drifted.lattice.within(even)
    assert _loss(drifted, before) < 0.02
    assert sorted(showing_crashes(drifted, before).poses[:, 0]) == sorted(before.poses[:, 0])
