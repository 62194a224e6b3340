"""What readings leave where two axes act together."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.yardstick import Root
from axiscal.estimation.belief import Belief
from axiscal.machine import machine_from_text
from axiscal.measurement.observation import Observation
from axiscal.measurement.setup import Setup
from tests.generators.planes import centred, matern
from tests.generators.texts import machine_text

_CURVE = 'std = "1 m", knots = 7, length = "350 mm"'
SQUARE = machine_text(
    "w-b-X-Y-t", {"X": (0, 1000), "Y": (0, 1000)}, {"EZX EZY": _CURVE, "EZXY": _CURVE.replace("1 m", "0.5 m")}
)
BEFORE = 10.851987
GRID = 0.273907


def test_nine_even_readings_of_a_plane_leave_what_is_published() -> None:
    """Constant of variance 10, centred curves, interaction a quarter of their product, noise 1e-3 (variance)."""
    machine = machine_from_text(SQUARE)
    model = ErrorModel(machine)
    assert model.size == 7 + 7 + 36
    setup = Setup("z", "probe", (0.0, 0.0, 1.0), (0, 1), (0.5, 0.5), np.sqrt(1e-3), (), 60, 1, 1, (0.0, 0.0), "+")
    observation = Observation(model, (setup,))
    covariance = model.prior_covariance()
    knots = np.linspace(0, 1, 7)
    for curve in model.functions:
        covariance[curve.columns, curve.columns] = centred(matern(knots, 0.35)) + 5.0
    belief, root = (
        Belief(np.zeros(model.size), covariance),
        Root.of_gram(volume_moments(model, whole_travel(model)).gram),
    )
    assert root.criterion(belief.factor) == pytest.approx(BEFORE, rel=2e-5)
    places = np.stack([g.ravel() for g in np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0])], axis=1)
    rows = observation.rows(0, places, np.ones_like(places)).rows
    even = Belief(np.zeros(model.size), covariance).update(rows, np.zeros(9), np.full(9, 1e-3))
    assert root.criterion(even.factor) == pytest.approx(GRID, abs=1e-6)
