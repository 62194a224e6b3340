"""U of right machines that numpy draws: near that of who knows every size, and never larger for more readings."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.trust.attacks import ATTACKS
from benchmarks.trust.benches import Changes
from benchmarks.trust.width import FIRST, Found, found

_MACHINES = 6
_DRIFT: Changes = (('drift = "0 um/h"', ""),)


def _cell(places: str, count: int = 24, changes: Changes = ()) -> tuple[float, float, float]:
    """Return U over the oracle's, share inside and U, µm, in the mean of some machines."""
    each = [found(ATTACKS[0], places, FIRST + seed, count, changes) for seed in range(_MACHINES)]
    return float(np.mean([one.over for one in each])), _mean(each), 1e6 * float(np.mean([one.expanded for one in each]))


def _mean(each: list[Found]) -> float:
    return float(np.mean([one.inside for one in each]))


@pytest.mark.parametrize(("places", "most"), [("planned", 1.6), ("even", 2.0), ("random", 1.5)])
def test_a_right_machine_costs_little_more_than_an_oracle_promises(places: str, most: float) -> None:
    over, inside, _ = _cell(places)
    assert 1 < over < most
    assert inside > 0.93


@pytest.mark.parametrize("usual", ["on", "off"])
def test_more_readings_never_make_u_larger(usual: str) -> None:
    """With the drift that its instrument may have, which this one has not: it is learnt."""
    sizes = [_cell("even", count, (*_DRIFT, ('"on"', f'"{usual}"')))[2] for count in (24, 48, 96)]
    assert sizes == sorted(sizes, reverse=True)


def test_noise_five_times_too_large_as_stated_leaves_u_nearly_where_it_is() -> None:
    """What is a multiple of the noise is told by readings, too, once the noise is known."""
    right, stated = (_cell("even", 96, changes)[2] for changes in ((), (('"0.5 um"', '"2.5 um"'),)))
    assert stated < 1.4 * right
