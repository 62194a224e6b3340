"""Readings that stand out at the scales as stated: slips stay out of what scales are learnt from, a curve does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from axiscal.inference.fit import fit
from axiscal.inference.slips_or_scales import fit_without_slips

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.learnt import learnt
from axiscal.measurement.reading import Reading
from axiscal.simulation import Simulator

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "LENGTH", knots = 21, rest = "estimate" }
"""
CAMPAIGN = """machine = "m"
scales = "estimate"
[target]
readings = 24
[[setups]]
name = "laser"
instrument = "interferometer"
direction = "x"
noise = "0.5 um"
unknowns = { zero = "1 mm" }
drift = "0"
"""


def case(length: str) -> Case:
    return Case(campaign_from_texts(CAMPAIGN, "c.toml", MACHINE.replace("LENGTH", length), "m"))


def readings(actual: Case, seed: int) -> list[Reading]:
    """Return twenty-four readings of a machine drawn from a prior, in order along the axis."""
    setup, rng = actual.description.setups[0], np.random.default_rng(seed)
    drawn = Simulator(actual.description.machine, (setup,)).drawn(seed)
    along = np.linspace(0.01, 0.99, 24)
    return [Reading("laser", (float(x),), (1,), drawn.read(setup, (float(x),), (1,), rng)) for x in along]


@pytest.mark.parametrize("seed", range(3))
def test_a_slip_is_no_reason_for_other_scales(seed: int) -> None:
    stated = case("300 mm")
    good = readings(stated, seed)
    spoilt = replace(good[11], value=good[11].value + 15e-6)
    trusted = [*good[:11], *good[12:]]
    found = fit_without_slips(stated.observation, trusted, [spoilt], stated.variable)
    alone = fit(stated.observation, trusted, stated.variable)
    assert found.scales == alone.scales
    known = learnt(stated, [*good[:11], spoilt, *good[12:]], {})
    assert [doubt.reading for doubt in known.verdict.doubts if doubt.rejected] == [11]


@pytest.mark.parametrize("seed", range(3))
def test_a_rough_curve_is_learnt_from_what_stands_out_of_a_smooth_one(seed: int) -> None:
    """A tenth as smooth as stated: readings that contradict the smooth curve are the curve."""
    stated = case("600 mm")
    rough = readings(case("60 mm"), seed)
    outside = [3, 8, 14, 19]
    others = [rough[index] for index in outside]
    trusted = [each for index, each in enumerate(rough) if index not in outside]
    found = fit_without_slips(stated.observation, trusted, others, stated.variable)
    whole = fit(stated.observation, [*trusted, *others], stated.variable)
    assert found.scales == whole.scales


def test_without_any_that_stand_out_the_scales_are_those_of_all() -> None:
    stated = case("300 mm")
    good = readings(stated, 5)
    found = fit_without_slips(stated.observation, good, [], stated.variable)
    assert found.scales == fit(stated.observation, good, stated.variable).scales
