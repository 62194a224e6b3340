"""The next place where two axes act together."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.belief import Belief
from axiscal.estimation.knowledge import Knowledge
from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.measurement.setup import Setup
from axiscal.planning.gains.covariance import Covariance
from axiscal.planning.step.best_step import best_step
from tests.generators.planes import bed, centred, matern, poses_of, probe

SQUARE = """
chain = "w-b-X-Y-t"
[axes.X]
travel = ["0 m", "1 m"]
[axes.Y]
travel = ["0 m", "1 m"]
[errors]
EZX = { std = "1 m", knots = 7, length = "350 mm" }
EZY = { std = "1 m", knots = 7, length = "350 mm" }
EZXY = { std = "0.5 m", knots = 7, length = "350 mm" }
"""
PUBLISHED = (10.851987, 1.254458, 0.833950, 0.525160, 0.305727, 0.223775, 0.147871, 0.117389, 0.095845, 0.075619)
GRID = 0.273907


def _read(machine: Machine, count: int) -> tuple[Observation, Knowledge]:
    """Return what is known after some readings, cells of the plane among them."""
    observation = Observation(ErrorModel(machine), (probe(machine, (0.6, 0.0, 0.8)),))
    places = poses_of(machine, count, 1)
    readings = [Reading("probe", tuple(pose), (1,) * places.shape[1], 0.0) for pose in places]
    known = Knowledge.before(observation).read(readings)
    return known.observation, known


def test_no_place_of_many_gains_more() -> None:
    machine = bed()
    observation, known = _read(machine, 7)
    root = Root.of_gram(volume_moments(observation.errors, whole_travel(observation.errors)).gram)
    step = best_step(known, root, spread(machine, observation.setups, 1500))
    tried = poses_of(machine, 40_000, 11)
    best = (
        Covariance.from_factor(observation, known.belief.factor, root)
        .scorer()
        .gains_at(0, tried, np.ones_like(tried))
        .max()
    )
    assert best <= step.gain * (1 + 1e-9)


def test_the_exact_greedy_sequence_over_a_plane_is_the_published_one() -> None:
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
    found = [root.criterion(belief.factor)]
    lattice = spread(machine, (setup,), 400)
    for _ in range(9):
        step = best_step(Knowledge(observation, belief), root, lattice)
        belief = belief.update(step.row, 0.0, step.variance)
        found.append(root.criterion(belief.factor))
    np.testing.assert_allclose(found, PUBLISHED, rtol=2e-5)
    places = np.stack([g.ravel() for g in np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0])], axis=1)
    rows = observation.rows(0, places, np.ones_like(places)).rows
    even = Belief(np.zeros(model.size), covariance).update(rows, np.zeros(9), np.full(9, 1e-3))
    assert root.criterion(even.factor) == pytest.approx(GRID, abs=1e-6)
