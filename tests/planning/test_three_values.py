"""Planning of readings that have several values: gains against dense matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.measurement.instruments.distance import RTest, Tracer, of_each
from axiscal.measurement.observation import Observation
from axiscal.measurement.reading import Places
from axiscal.measurement.setup import Unknown
from axiscal.numerics import Array
from axiscal.planning.plan.scores import Scores
from axiscal.planning.plan.task import Task
from tests.generators import dense_gains as dense
from tests.generators.designs import levered, of_kind, random_poses

ZEROS = tuple(Unknown(f"zero_{axis}", 1e-4) for axis in "xyz")


STATIONS = ((0.9, -0.4, 0.3), (-0.5, 0.6, 0.1), (0.2, 0.7, 0.9), (0.1, -0.8, -0.4))
BEAMS = tuple(Unknown(name, 1e-4) for name in ("zero", "station_x", "station_y", "station_z"))


def mixed(candidates: int = 300, three: tuple[int, ...] = (0,), beams: dict[int, int] | None = None) -> Task:
    """Return the table under two slides with an R-test among its set-ups; the others are indicators.

    beams : by set-up how many tracers read at once in place of the R-test or indicator
    """
    asked = levered(candidates)
    setups = tuple(
        replace(of_kind(s, RTest), unknowns=ZEROS) if i in three else s for i, s in enumerate(asked.observation.setups)
    )
    setups = tuple(
        replace(of_kind(s, Tracer), stations=STATIONS[:count], unknowns=of_each(BEAMS, count)) if count else s
        for s, count in zip(setups, [(beams or {}).get(i, 0) for i in range(len(setups))], strict=True)
    )
    observation = Observation(asked.observation.errors, setups)
    belief = type(asked.belief)(np.zeros(observation.size), observation.prior_covariance())
    return Task(observation, belief, asked.root, asked.yardstick, asked.lattice)


def dense_value(asked: Task, places: Places) -> float:
    """Return J after readings, from one big matrix: no factors, no updates."""
    observation = asked.observation
    known = dense.DenseState(observation, observation.prior_covariance())
    return dense.value(dense.after_readings(known, places), asked.root.T @ asked.root)


def _falls(asked: Task, places: Places, indices: Array) -> Array:
    before = dense_value(asked, places)
    return np.array(
        [before - dense_value(asked, Places.joined([places, asked.lattice.single(int(i))])) for i in indices]
    )


@pytest.mark.parametrize(("three", "beams"), [((), {}), ((0,), {1: 4}), ((1,), {0: 2})])
def test_gains_are_the_falls_of_dense_matrices_while_readings_come_and_go(
    three: tuple[int, ...], beams: dict[int, int]
) -> None:
    asked = mixed(120, three, beams)
    scores, rng = Scores(asked), np.random.default_rng(0)
    looked_at = np.concatenate([np.arange(0, scores.count, 29), [3]])
    np.testing.assert_allclose(scores.gains[looked_at], _falls(asked, Places.none(3), looked_at), rtol=1e-6)
    for index in (3, 100, 40, 41, 90):
        scores.put(index)
    scores.put(Places.of_setup((*three, 0)[0], *random_poses(asked, rng, 1)))
    assert scores.value == pytest.approx(dense_value(asked, scores.places), rel=1e-7)
    np.testing.assert_allclose(scores.gains[looked_at], _falls(asked, scores.places, looked_at), rtol=1e-5)

    losses = scores.losses()
    for slot in range(6):
        others = scores.places.without(slot)
        rise = dense_value(asked, others) - dense_value(asked, scores.places)
        assert losses[slot] == pytest.approx(rise, rel=1e-5)
        gains, own = scores.without(slot)
        assert own == pytest.approx(rise, rel=1e-5)
        np.testing.assert_allclose(gains[looked_at], _falls(asked, others, looked_at), rtol=1e-4)

    gains, _ = scores.without(1)
    fewer = scores.fork()
    fewer.leave(1)
    assert fewer.value - scores.value == pytest.approx(losses[1], rel=1e-8)
    np.testing.assert_allclose(fewer.gains, gains, rtol=1e-7, atol=1e-13 * gains.max())  # by tables and by rows
    scores.put(int(asked.lattice.setups[100] == 0) * (scores.count - 1), 1)  # another count of values
    np.testing.assert_allclose(scores.gains[looked_at], _falls(asked, scores.places, looked_at), rtol=1e-4)
    scores.without(3)
    scores.leave(0)
    assert len(scores.places) == 5
    np.testing.assert_allclose(scores.gains[looked_at], _falls(asked, scores.places, looked_at), rtol=1e-4)
    assert scores.losses()[2] > 0
