"""The table model, and files of text that are read and written again: nothing is lost."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from axiscal.exceptions import TableError
from axiscal.tables.controllers import plain_csv
from axiscal.tables.table import CompensationTable
from tests.tables.test_linuxcnc import table


def test_sizes_of_the_reversal_step() -> None:
    assert table().reversal == pytest.approx((1e-6, 2e-6))
    assert table(reverse=[2e-6, 1e-6, -1e-6]).reversal == pytest.approx((0, 2e-6))
    assert table(reverse=[1e-6, 3e-6, -1e-6]).reversal == (0, 0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"axis": "X\nG0"}, r"'X\\nG0' is not the name of an axis"),
        ({"axis": ""}, "is not the name of an axis"),
        ({"positions": [0.0, 0.1, 0.1]}, "positions of X are no row"),
        ({"positions": [0.0, np.nan, 0.1]}, "positions of X are no row"),
        ({"forward": [0.0, np.inf, 0.1]}, "forward of X are no row"),
        ({"std": [0.0, 1.0]}, "std of X are no row"),
        ({"positions": [], "forward": [], "reverse": [], "std": []}, "which increase"),
        ({"reverse": [[0.0, 1.0, 2.0]]}, "reverse of X are no row"),
    ],
)
def test_what_no_controller_could_hold_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(TableError, match=message):
        table(**changes)


@given(
    st.lists(st.floats(-10, 10), min_size=1, max_size=20, unique_by=lambda x: round(x, 6)).map(sorted),
    st.booleans(),
    st.data(),
)
def test_csv_comes_back_as_written(positions: list[float], rotary: bool, data: st.DataObject) -> None:
    values = st.lists(st.floats(-1e-3, 1e-3), min_size=len(positions), max_size=len(positions))
    drawn = np.array(data.draw(values))
    written = CompensationTable("C" if rotary else "X", np.array(positions), drawn, drawn, drawn)
    back = plain_csv.parse(plain_csv.text_of(written))
    assert (back.axis, back.rotary) == (written.axis, rotary)
    assert back.positions == pytest.approx(written.positions, abs=1e-9)
    for name in ("forward", "reverse", "std"):
        assert getattr(back, name) == pytest.approx(getattr(written, name), abs=2.5e-10 if rotary else 0.6e-10)
