"""How a few random campaigns end, and what they say first, as `make certify` asks it of many."""

from __future__ import annotations

import pytest

from tests.certify import endings, first_lines


@pytest.mark.long
@pytest.mark.parametrize(
    "seed",
    [
        pytest.param(1, id="another set-up has to be mounted"),
        pytest.param(65, id="the worst place"),
        pytest.param(88, id="nine readings take sizes for twice as large"),
    ],
)
def test_a_target_that_a_plan_reaches_is_reached(seed: int) -> None:
    found = endings.feasible(seed)
    assert found is not None
    assert found.because.endswith(" target reached")
    assert found.reached


@pytest.mark.parametrize("seed", [2, 3])
def test_the_first_line_is_borne_out_by_the_truth(seed: int) -> None:
    found = first_lines.told(seed)
    assert found.verdict == found.kind
    assert found.right, found.line
