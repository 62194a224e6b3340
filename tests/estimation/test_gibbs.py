"""What sisters share is drawn from its posterior: by Geweke's joint test, and against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.data_equation import DataEquation
from axiscal.numerics import Array
from axiscal.ports.fleet.gibbs import half_covariance, swept
from axiscal.ports.fleet.hierarchy import (
    CERTAINTY,
    LEVEL,
    MEANS,
    SCALE,
    SHAPE,
    SPREAD,
    Hierarchy,
    Sisters,
    blocks_of,
)
from axiscal_core.threads import one_thread

HIERARCHY = Hierarchy(blocks_of([("EXX", "length", 2, 1.0), ("B0Z", "location", 1, 1.0)]), 1)
COUNT, PRIOR_DRAWS, SWEEPS, BATCHES = 2, 6000, 3000, 30


def _figures(state: Sisters) -> Array:
    """Return bounded figures of a state that are sensitive to every conditional of the sampler."""
    own, common = state.own[0], state.common
    return np.concatenate([
        np.tanh(np.log(state.scales)), state.shares, [np.tanh(state.level)], state.means, np.tanh(common**2),
        np.tanh(own**2), [np.tanh(own[0] * own[1]), np.tanh(own[0] * common[0]), np.tanh(own[0] * state.own[1][0])],
        [np.log(state.width)], np.tanh(np.sum(state.together**2, axis=1)), np.tanh(state.along[:, 0] ** 2),
    ])  # fmt: skip


def drawn_sisters(hierarchy: Hierarchy, count: int, rng: np.random.Generator) -> Sisters:
    """Return a type and so many machines of it, drawn from what is believed before any of them has been read."""
    level = LEVEL * rng.standard_normal()
    scales = np.exp(level + SPREAD * rng.standard_normal(len(hierarchy.parts)))
    means = rng.choice(MEANS, len(hierarchy.kinds))
    of_part = means[hierarchy.kind_of]
    shares = rng.beta(CERTAINTY * of_part, CERTAINTY * (1 - of_part))
    width = SCALE / rng.gamma(SHAPE)
    together = np.sqrt(width) * rng.standard_normal((hierarchy.unknowns, hierarchy.directions))
    owner = hierarchy.owner
    common = np.sqrt(scales * shares)[owner] * rng.standard_normal(hierarchy.unknowns)
    along = rng.standard_normal((count, hierarchy.directions))
    free = rng.standard_normal((count, hierarchy.unknowns))
    own = np.sqrt(scales * (1 - shares))[owner] * (along @ together.T + free)
    return Sisters(scales, shares, level, means, common, own, together, along, width)


@pytest.mark.long
@one_thread()
def test_readings_drawn_anew_after_each_sweep_leave_the_prior_as_it_is() -> None:
    """Geweke 2004: sweeping and drawing readings in turn has the joint prior as its stationary distribution."""
    rng = np.random.default_rng(1)
    rows = [rng.standard_normal((2, HIERARCHY.unknowns)) for _ in range(COUNT)]
    before = np.array([_figures(drawn_sisters(HIERARCHY, COUNT, rng)) for _ in range(PRIOR_DRAWS)])
    state, after = drawn_sisters(HIERARCHY, COUNT, rng), list[Array]()
    for _ in range(SWEEPS):
        read = [R @ (state.common + own) + rng.standard_normal(2) for R, own in zip(rows, state.own, strict=True)]
        state, _ = swept(state, [DataEquation(*pair) for pair in zip(rows, read, strict=True)], HIERARCHY, rng)
        after.append(_figures(state))
    batches = np.array(after).reshape(BATCHES, -1, before.shape[1]).mean(axis=1)
    error = np.sqrt(batches.var(axis=0, ddof=1) / BATCHES + before.var(axis=0) / PRIOR_DRAWS)
    away = (batches.mean(axis=0) - before.mean(axis=0)) / error
    assert np.max(np.abs(away)) < 4.5
    assert np.sqrt(np.mean(away**2)) < 1.8


def test_what_is_common_is_the_posterior_of_a_dense_normal() -> None:
    rng = np.random.default_rng(2)
    state = drawn_sisters(HIERARCHY, COUNT, rng)
    data = [DataEquation(rng.standard_normal((4, HIERARCHY.unknowns)), rng.standard_normal(4)) for _ in range(COUNT)]
    _, common = swept(state, data, HIERARCHY, rng)
    roots, joint = half_covariance(state, HIERARCHY)
    own = np.diag(roots**2) + joint @ joint.T
    prior = np.diag((state.scales * state.shares)[HIERARCHY.owner])
    rows, values = np.vstack([each.rows for each in data]), np.concatenate([each.values for each in data])
    noise = np.eye(len(values))
    for j in range(COUNT):
        noise[4 * j : 4 * j + 4, 4 * j : 4 * j + 4] += data[j].rows @ own @ data[j].rows.T
    gain = prior @ rows.T @ np.linalg.inv(rows @ prior @ rows.T + noise)
    np.testing.assert_allclose(common.mean, gain @ values, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(common.covariance, prior - gain @ rows @ prior, rtol=1e-8, atol=1e-10)
