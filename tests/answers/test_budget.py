"""The budget of the uncertainty: its squares add up, and each source is what it is without the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from axiscal.answers.budget import budget
from axiscal.estimation.case import Case
from axiscal.estimation.estimate import concluded
from tests.generators.campaigns import drawn, mixed


def test_sizes_that_are_learnt_are_a_source_of_their_own() -> None:
    case = mixed()
    case = Case(replace(case.description, target=replace(case.description.target, aligned=False)))
    known = concluded(case, drawn(case, 40))
    shares = {source.kind: source.rms for source in budget(known)}
    assert shares["sizes"] > 0.03 * known.accuracy.rms
    total = np.sqrt(sum(source.rms**2 for source in budget(known)))
    assert total == pytest.approx(known.accuracy.rms, rel=1e-9)
    assert max(shares.values()) <= known.accuracy.rms
