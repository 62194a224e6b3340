"""The exact next position where an error repeats with a period and steps, against twenty thousand positions."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.knowledge import Knowledge
from axiscal.measurement.candidates import spread
from axiscal.measurement.reading import Reading
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.best_step import best_step
from tests.generators.one_axis import MACHINE, observed

_PITCH = 'EXX_pitch = { std = "4 um", period = "90 mm", harmonics = 2 }\n'
_SHAPES = _PITCH + 'EXX_step = { std = "6 um", at = ["500 mm"] }\n'


@pytest.mark.parametrize("count", [0, 3, 8])
def test_no_position_of_twenty_thousand_gains_more(count: int) -> None:
    observation = observed('noise = "0.5 um"', MACHINE + _SHAPES)
    places = np.random.default_rng(count).uniform(0, 1, count)
    known = Knowledge.before(observation).read([Reading("it", (float(x),), (1,), 0.0) for x in places])
    errors = observation.errors
    root = Root.of_gram(volume_moments(errors, whole_travel(errors)).gram)
    step = best_step(known, root, spread(errors.machine, observation.setups, 400))
    scorer, at = Scorer.of(known.observation, known.belief, root), np.linspace(0, 1, 20_001)[:, None]
    assert step.gain >= float(np.max(scorer.at(0, at, np.ones_like(at)))) * (1 - 1e-9)
