"""The belief, whatever it is fed: more readings never widen it, order never matters, nothing is ever negative."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from axiscal.estimation.belief import Belief
from axiscal.numerics import Array


@st.composite
def fed(draw: st.DrawFn) -> tuple[Belief, Array, Array, Array]:
    """Draw a prior of any rank and scales, and readings with noise of any size, some of them twice."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size, readings = draw(st.integers(1, 12)), draw(st.integers(1, 20))
    root = rng.standard_normal((size, draw(st.integers(1, size)))) * 10.0 ** draw(st.integers(-6, 2))
    rows = rng.standard_normal((readings, size)) * (rng.random((readings, size)) < draw(st.sampled_from([0.3, 1.0])))
    rows[rng.integers(0, readings, readings // 3)] = rows[0]
    noise = 10 ** rng.uniform(-14, 2, readings)
    belief = Belief(rng.standard_normal(size), root @ root.T)
    return belief, rows, belief.sample(rng, 1)[0] @ rows.T + np.sqrt(noise) * rng.standard_normal(readings), noise


@given(fed())
def test_readings_never_widen_a_belief(drawn: tuple[Belief, Array, Array, Array]) -> None:
    belief, rows, values, noise = drawn
    probes = np.vstack([np.eye(belief.size), rows])
    before = belief.predict(probes).std
    for row, value, variance in zip(rows, values, noise, strict=True):
        belief = belief.update(row, value, variance)
        after = belief.predict(probes).std
        assert np.all(after <= before * (1 + 1e-9) + 1e-14 * before.max(initial=0.0))
        before = after


@given(fed())
def test_order_never_matters(drawn: tuple[Belief, Array, Array, Array]) -> None:
    belief, rows, values, noise = drawn
    order = np.argsort(np.random.default_rng(len(values)).random(len(values)))
    one, other = belief.update(rows, values, noise), belief.update(rows[order], values[order], noise[order])
    scale = np.sqrt(np.diagonal(belief.covariance)).max(initial=0.0)
    spread = np.abs(one.covariance - other.covariance).max()
    assert spread <= 1e-8 * scale**2 + 1e-300
