"""What a few random campaigns say first, as `make certify` asks it of many."""

from __future__ import annotations

import pytest

from tests.certify import first_lines


@pytest.mark.parametrize("seed", [2, 3])
def test_the_first_line_is_borne_out_by_the_truth(seed: int) -> None:
    found = first_lines.told(seed)
    assert found.verdict == found.kind
    assert found.right, found.line
