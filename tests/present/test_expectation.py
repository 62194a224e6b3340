"""What a reading should show: against the conditional Gaussian written out, rests and noise included."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.measurement.place import Place
from axiscal.measurement.reading import Reading
from axiscal.present.guide.question import expectation

MACHINE = """
chain = "w-b-X-t"
[axes.X]
travel = ["0 mm", "1000 mm"]
[errors]
EXX = { std = "10 um", length = "200 mm", rest = "2 um" }
"""
CAMPAIGN = """
machine = "m"
usual = "off"
sure = "exactly"
[target]
readings = 9
[[setups]]
name = "dial"
instrument = "indicator"
direction = "x"
noise = "1 um"
drift = "0 um/h"
unknowns = { zero = "50 um" }
"""


def case() -> Case:
    """Return an axis with one curve and a rest, read by a dial with an unknown zero."""
    return Case(campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "m"))


def test_it_is_what_the_readings_so_far_say_of_the_place() -> None:
    axis, taken = case(), {0.1: 4e-6, 0.45: -3e-6, 0.8: 7e-6}
    readings = [Reading("dial", (x,), (0,), value) for x, value in taken.items()]
    found = expectation(estimated(axis, readings), Place("dial", (0.62,), (0,)))

    (curve,) = axis.errors.functions
    places = np.array([*taken, 0.62])
    basis = curve.basis.rows(places)
    joint = basis @ curve.covariance @ basis.T + 50e-6**2 + (2e-6**2 + 1e-6**2) * np.eye(4)
    weights = np.linalg.solve(joint[:3, :3], joint[:3, 3])
    assert found.mean[0] == pytest.approx(weights @ list(taken.values()), rel=1e-6)
    assert found.std[0] == pytest.approx(np.sqrt(joint[3, 3] - weights @ joint[:3, 3]), rel=1e-6)


def test_where_a_reading_was_taken_the_rest_of_the_cell_is_not_new() -> None:
    axis = case()
    reading = Reading("dial", (0.5,), (0,), 3e-6)
    again = expectation(estimated(axis, [reading] * 50), reading.place)
    assert again.mean[0] == pytest.approx(3e-6, abs=0.05e-6)
    assert again.std[0] == pytest.approx(1e-6, rel=0.02)  # the noise alone: curve, rest and zero are in the mean
