"""The next measurement on random machines, against a dense lattice; `python -m tests.certify` does it at length."""

from __future__ import annotations

import numpy as np
import pytest

from tests.certify.machines import random_case, shortfall


@pytest.mark.parametrize("seed", [0, 1, 53, 63, 70, 88, 96, 139, 153, 238])
def test_no_pose_of_a_dense_lattice_gains_more(seed: int) -> None:
    assert shortfall(random_case(np.random.default_rng(seed)), 40_000) <= 1e-9
