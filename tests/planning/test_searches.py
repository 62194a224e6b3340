"""Searches from other starts: they find what a plan that was spoilt lacks, and nothing better than a good one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.measurement.reading import Places
from axiscal.planning.plan import searches
from axiscal.planning.plan.plan import make_plan
from axiscal.planning.plan.searches import searched
from axiscal.planning.plan.task import Limits
from tests.generators.designs import levered


@pytest.mark.long
@pytest.mark.parametrize("limits", [Limits(8), Limits(budget=700.0)])
def test_a_spoilt_plan_is_beaten_and_a_good_one_hardly(limits: Limits, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searches, "_MOST", 3)
    asked = levered(60)
    one = replace(asked, lattice=asked.lattice.within(asked.lattice.setups == 0))
    places = make_plan(one, limits, bounded=False).places
    good = searched(one, limits, places, usual=False)
    assert good.count == 3
    assert good.share > 0.97
    spoilt = Places.joined([places.within(np.zeros(len(places), dtype=np.intp))])
    found = searched(one, limits, spoilt, usual=False)
    assert found.better == found.count == 3
    assert found.share < 0.5
