"""A promise that was made larger: every figure by the same factor, everywhere it is said, and not where it need not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from axiscal.estimation.ruled import _raised, ruled, ruling_of
from axiscal.estimation.vouching import defended

from axiscal.accuracy.expanded import expanded
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import standing
from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.bands import Banded
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.knowledge import Knowledge
from axiscal.report.curves import constants
from axiscal.report.result_document import result_json
from axiscal.report.summarising import Extras, summarise
from benchmarks.trust.benches import case_of
from tests.generators.laser_axis import CAMPAIGN, CASE, MACHINE, in_two_rounds, machine, read

MILL = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 mm", "400 mm"]
[axes.Y]
travel = ["0 mm", "300 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", knots = 5 }
EXY = { std = "15 um", length = "200 mm", knots = 5 }
"""
ALONG_X = """machine = "m"
[target]
readings = 20
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
moves = ["X"]
park = { Y = "100 mm" }
"""
"""Readings along X tell a little of the mean of EXY over the travel of Y; the shift that they do not is no error."""


@pytest.fixture(scope="module")
def nearly() -> Estimation:
    """Return what is known from readings that nearly hold their promise, without the verdict."""
    return concluded(CASE, in_two_rounds(read(machine(3), 30)))


@pytest.mark.parametrize("case", [case_of("five axes", "stated"), Case(campaign_from_texts(ALONG_X, "c", MILL, "m"))])
def test_bands_are_wider_by_one_factor_whatever_no_reading_sees(case: Case) -> None:
    """A constant shift that no reading sees is not counted: it is as much larger as everything else is."""
    model, times = Banded(case, Knowledge(case.observation, case.prior)), 1.1
    wide = _raised(model, times)
    before, after = (each.case.yardstick.measure(each.knowledge.belief) for each in (model, wide))
    assert case.yardstick.unseen_rms > 0.2 * before.rms
    assert after == pytest.approx([times * figure for figure in before], rel=1e-4)
    narrow, large = (expanded(each.case.yardstick, each.knowledge.belief) for each in (model, wide))
    assert large.space == pytest.approx(times * narrow.space, rel=1e-6)


def test_an_error_that_no_reading_sees_stays_one(nearly: Estimation) -> None:
    wide = replace(nearly, banded=_raised(nearly.banded, 1.2))
    before, after = ([each.seen for each in constants(known, None)] for known in (nearly, wide))
    assert before == after


def test_where_a_target_counts_by_the_promise_as_it_is_nothing_is_made_larger(nearly: Estimation) -> None:
    """Else a target that the model's promise reaches would be missed although that was to count."""
    promise, description = nearly.accuracy.rms, CASE.description
    assert promise < defended(nearly).held_from < 1.2 * promise
    for unchecked, verdict in ((True, "unchecked"), (False, "holds")):
        target = replace(description.target, rms=1.01 * promise, unchecked=unchecked)
        known = replace(nearly, stated=replace(CASE, description=replace(description, target=target)))
        assert ruling_of(known).verdict == verdict
        assert (ruled(known).accuracy.rms == promise) == unchecked
        assert (standing(target, known) == "rms target reached") == unchecked
        assert (standing(target, ruled(known)) == "rms target reached") == unchecked


def test_all_figures_of_a_result_are_of_the_larger_promise(nearly: Estimation, tmp_path: Path) -> None:
    description = campaign_from_texts(CAMPAIGN, "c.toml", MACHINE, "m")
    with Campaign.create(tmp_path / "c.axiscal", description) as campaign:
        campaign.adopt(nearly.readings)
        known = campaign.ruled()
        found = result_json(summarise(campaign, known, Extras()))
    assert found["verdict"] == "holds"
    assert found["rms_um"] == pytest.approx(1e6 * known.accuracy.rms, rel=1e-4)
    assert found["worst_um"] == pytest.approx(1e6 * known.accuracy.worst, rel=1e-4)
    assert found["rms_um"] > 1.05 * 1e6 * nearly.accuracy.rms
    assert found["history"][-1]["rms_um"] == found["rms_um"]
    assert np.hypot.reduce([row["rms_um"] for row in found["budget"]]) == pytest.approx(found["rms_um"], rel=1e-3)
