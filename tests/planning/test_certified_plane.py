"""The next position in a plane against its certificate: nothing on the continuum is better by a millionth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.errors.model import ErrorModel
from axiscal.errors.volume import volume_moments, whole_travel
from axiscal.estimation.accuracy.criterion import Root
from axiscal.estimation.knowledge import Knowledge
from axiscal.machine import Machine, machine_from_text
from axiscal.measurement.candidates import spread
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Reading
from axiscal.planning.gains.gain import Scorer
from axiscal.planning.step.best_step import best_step, certified_gain
from tests.generators.planes import bed, poses_of, probe, table, warped


def _known(machine: Machine, count: int, moves: tuple[int, int] = (0, 1)) -> tuple[Knowledge, Scorer]:
    observation = Observation(ErrorModel(machine), (replace(probe(machine), moves=moves),))
    places = poses_of(machine, count, 4)
    readings = [Reading("probe", tuple(pose), (1,) * places.shape[1], 0.0) for pose in places]
    known = Knowledge.before(observation).read(readings)
    root = Root.of_gram(volume_moments(known.observation.errors, whole_travel(known.observation.errors)).gram)
    return known, Scorer.of(known.observation, known.belief, root)


@pytest.mark.parametrize("count", [0, 3, 9])
def test_the_step_reaches_what_is_certified(count: int) -> None:
    machine = machine_from_text(warped((7, 6)))
    known, scorer = _known(machine, count)
    root = Root.of_gram(volume_moments(known.observation.errors, whole_travel(known.observation.errors)).gram)
    step = best_step(known, root, spread(machine, known.observation.setups, 400))
    certified = certified_gain(scorer, 0, step.gain)
    assert certified.upper <= step.gain * (1 + 2e-6)
    tried = poses_of(machine, 30_000, 8)
    assert scorer.at(0, tried, np.ones_like(tried)).max() <= certified.upper


def test_with_lever_arms_the_degree_grows_and_the_certificate_holds() -> None:
    """X and Z of a bed whose Y and Z turn it together: two more degrees in each coordinate."""
    machine = bed()
    _, scorer = _known(machine, 4, (1, 2))
    certified = certified_gain(scorer, 0)
    tried = poses_of(machine, 30_000, 8)
    tried[:, 0] = certified.pose[0]
    best = scorer.at(0, tried, np.ones_like(tried)).max()
    assert best <= certified.upper
    assert certified.upper <= certified.lower * (1 + 2e-6)


def test_along_an_axis_that_turns_the_certificate_holds() -> None:
    machine = table()
    _, scorer = _known(machine, 1, (0, 1))
    certified = certified_gain(scorer, 0)
    tried = poses_of(machine, 30_000, 8)
    tried[:, 2:] = certified.pose[2:]
    best = scorer.at(0, tried, np.ones_like(tried)).max()
    assert certified.lower * (1 - 1e-3) <= best <= certified.upper
    assert certified.upper <= certified.lower * (1 + 2e-6)
