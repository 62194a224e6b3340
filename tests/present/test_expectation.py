"""What a reading should show, against the conditional Gaussian written out."""

import numpy as np
import pytest

from axiscal.description.campaign import campaign_from_texts
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import estimated
from axiscal.estimation.prediction import expectation
from axiscal.measurement.reading import Place, Reading
from tests.generators.texts import campaign_text, machine_text, setup_text

MACHINE = machine_text("w-b-X-t", {"X": (0, 1000)}, {"EXX": 'std = "10 um", length = "200 mm", rest = "2 um"'})
CAMPAIGN = campaign_text(
    "m",
    setup_text("dial", "indicator", direction="x", noise="1 um", drift="0 um/h", unknowns={"zero": "50 um"}),
    target={"readings": 9},
    usual="off",
    sure="exactly",
)


def case() -> Case:
    """Return an axis with one curve and a rest, read by a dial with an unknown zero."""
    return Case(campaign_from_texts(CAMPAIGN, "campaign.toml", MACHINE, "m"))


def test_it_is_what_the_readings_so_far_say_of_the_place() -> None:
    axis, taken = case(), {0.1: 4e-6, 0.45: -3e-6, 0.8: 7e-6}
    readings = [Reading("dial", (x,), (0,), value) for x, value in taken.items()]
    found = expectation(estimated(axis, readings), Place("dial", (0.62,), (0,)))

    (curve,) = axis.errors.curves
    places = np.array([*taken, 0.62])
    basis = curve.spline.rows(places)
    joint = basis @ curve.covariance @ basis.T + 50e-6**2 + (2e-6**2 + 1e-6**2) * np.eye(4)
    weights = np.linalg.solve(joint[:3, :3], joint[:3, 3])
    assert found.mean[0] == pytest.approx(weights @ list(taken.values()), rel=1e-6)
    assert found.std[0] == pytest.approx(np.sqrt(joint[3, 3] - weights @ joint[:3, 3]), rel=1e-6)
