"""The plain formula of the gain, every fast way to it, and the columns of a plan, against plain tables."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.measurement.reading import Places
from axiscal.numerics import Array
from axiscal.planning.gains.candidate_rows import Pool
from axiscal.planning.gains.covariance import Scorer
from axiscal.planning.gains.running_gains import Scores
from axiscal.planning.plan.task import Task
from tests.generators import dense_gains as dense
from tests.generators.designs import levered, read
from tests.planning.test_three_values import mixed


def _asked(seed: int, nest: bool) -> Task:
    """A machine after a few readings in random places; with an R-test, which reads three numbers, or without."""
    return read(mixed(60, (0,) if nest else ()), np.random.default_rng(seed), seed)


def _known(asked: Task) -> dense.DenseState:
    return dense.DenseState(asked.observation, asked.belief.covariance)


def _gains(asked: Task, places: Places) -> Array:
    """The gain of each place alone, plainly."""
    return np.array([dense.gain(_known(asked), asked.root.weights, places.single(i)) for i in range(len(places))])


def gains_of(scorer: Scorer, lattice: Places) -> Array:
    """Return the gain of every candidate, (m,)."""
    result = np.empty(len(lattice))
    for setup in np.unique(lattice.setups).tolist():
        result[lattice.setups == setup] = scorer.gains_at(setup, *lattice.in_setup(setup))
    return result


def test_the_gain_of_one_number_is_the_ratio_of_the_paper() -> None:
    """ΔJ = gᵀCWCg / (σ² + gᵀCg) (B&H eq. 27, 37), and J falls by it."""
    asked = levered(10)
    known, place = dense.opened(_known(asked), asked.lattice.single(3)), asked.lattice.single(3)
    row = known.observation.rows(int(place.setups[0]), place.poses, place.approaches).rows[0]
    noise, size = asked.observation.setups[place.setups[0]].noise, asked.root.unknowns
    h = known.covariance @ row
    expected = h[:size] @ asked.root.weights @ h[:size] / (noise**2 + row @ h)
    assert dense.gain(_known(asked), asked.root.weights, place) == pytest.approx(expected, rel=1e-12)
    after = dense.value(dense.after_readings(_known(asked), place), asked.root.weights)
    assert dense.value(_known(asked), asked.root.weights) - after == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("nest", [False, True])
@pytest.mark.parametrize("seed", [0, 3])
def test_every_fast_way_brings_the_plain_gain(seed: int, nest: bool) -> None:
    """A scorer, the state by Potter and by Cholesky, gains that are kept up to date, and lines along an axis."""
    asked = _asked(seed, nest)
    places = asked.lattice.within(np.arange(0, 60, 7))
    expected = _gains(asked, places)
    np.testing.assert_allclose(gains_of(asked.state.scorer(), places), expected, rtol=1e-6)
    for i in range(len(places)):
        entered, change = asked.state.entered(places.single(i))
        assert change.gain == pytest.approx(expected[i], rel=1e-6)
        assert asked.state.value - entered.value == pytest.approx(expected[i], rel=1e-5)
        fall = asked.state.value - asked.state.after_readings(places.single(i)).value
        assert fall == pytest.approx(expected[i], rel=1e-5)
    pool = Pool(asked.observation, asked.lattice)
    np.testing.assert_allclose(Scores(pool, asked.state).gains, _gains(asked, pool.lattice), rtol=1e-6)
