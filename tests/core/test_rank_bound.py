"""The bound: below every design that brute force tries, reached by readings without noise, silent where it is far."""

from itertools import combinations_with_replacement

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import axiscal_core as ac
from axiscal_core.rank_bound import rank_bound
from tests.core.strangers import mill


@given(st.integers(0, 2**32 - 1), st.floats(-4.0, 1.0), st.integers(1, 3))
def test_no_design_beats_it_and_the_principal_directions_reach_it(seed: int, decade: float, count: int) -> None:
    generator = np.random.default_rng(seed)
    factor, rows = generator.normal(size=(5, 5)), generator.normal(size=(6, 5))
    prior, root = factor @ factor.T, generator.normal(size=(4, 5))

    def left(h: ac.Array, noise: float) -> float:
        k = h @ prior @ h.T + noise**2 * np.eye(len(h))
        return float(np.trace(root @ (prior - prior @ h.T @ np.linalg.solve(k, h @ prior)) @ root.T))

    spread = root @ prior @ root.T
    bound = rank_bound(spread, count)
    designs = combinations_with_replacement(range(len(rows)), count)
    noise = 10.0**decade * float(np.sqrt(np.trace(spread)))
    assert bound <= min(left(rows[[*each]], noise) for each in designs) * (1 + 1e-6)
    values, vectors = np.linalg.eigh(spread)
    assert left(vectors[:, ::-1][:, :count].T @ root, 0.0) == pytest.approx(bound, rel=1e-5, abs=1e-9 * values[-1])


def test_no_two_readings_of_a_machine_beat_the_bound_that_an_evaluation_states() -> None:
    case = ac.Case(mill().stated, [ac.Laser("x", "X", noise="0.01 um")])
    lattice = case.lattice(12)
    tried = [case.evaluate(lattice.at(each)) for each in combinations_with_replacement(range(len(lattice)), 2)]
    bounds = {each.bound for each in tried}
    assert len(bounds - {None}) == 1
    assert max(each or 0.0 for each in bounds) <= min(each.rms for each in tried)


def test_a_bound_below_half_of_the_plan_is_not_stated() -> None:
    case = ac.Case(mill().stated, [ac.Laser("x", "X", noise="1 mm")])
    assert case.evaluate(case.lattice(40)).bound is None
