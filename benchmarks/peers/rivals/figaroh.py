"""FIGAROH: the D-optimal exchange over fixed candidates, by which it chooses calibration poses."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
from figaroh.optimal.base_optimal_calibration import Detmax

from benchmarks.peers import evaluator
from benchmarks.peers.problems import Array, Posed


class _Remembering(Detmax):
    """The library keeps the criterion of its final choice, not the choice: the last set that it asked about."""

    asked: tuple[int, ...] = ()

    def get_critD(self, set: list[int]) -> float:  # noqa: N802 - the library's name
        """Return the criterion of a set."""
        self.asked = tuple(set)
        return float(super().get_critD(set))


def planner(posed: Posed) -> Callable[[], Array]:
    """Return its choice; the prior's information is shared out evenly over the readings, so that it is counted once."""
    random.seed(1)
    case, candidates = posed.case, posed.candidates
    prior = np.eye(case.size) / case.readings
    pool = {i: prior + np.outer(row, row) / case.noise**2 for i, row in enumerate(evaluator.rows(case, candidates))}

    def plan() -> Array:
        exchange = _Remembering(pool, case.readings)
        exchange.main_algo()
        chosen: Array = candidates[list(exchange.asked)]
        return chosen

    return plan
