"""The skew of a plane is that of the mean of both directions of travel: a control takes away one number."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.estimation.machine_estimate import Estimate
from axiscal.tables import surface
from axiscal.tables.table import CompensationTable
from tests.tables.test_refusals import THREE, read_of


def test_a_skew_is_the_mean_of_both_directions(monkeypatch: pytest.MonkeyPatch) -> None:
    at = np.linspace(0.0, 0.2, 9)
    up, down = 3e-4 * at, 1e-4 * at + 5e-6

    def tables(_: Estimate) -> tuple[CompensationTable, ...]:
        return (CompensationTable("X", False, at, up, down, 0 * at, "Y"),)

    monkeypatch.setattr(surface, "cross_tables", tables)
    found = surface.skew_of(read_of(THREE))
    assert found.seen == {"XY": pytest.approx(2e-4)}
