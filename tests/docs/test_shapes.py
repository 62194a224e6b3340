"""The look at shapes finds what contradicts a docstring."""

from __future__ import annotations

import numpy as np
import pytest

from axiscal.numerics import Array
from axiscal_core.eigen import settled
from tests.shapes import ShapeSaidError, checked, said


def of_rows(rows: Array, values: Array) -> int:
    """Return a number.  rows : (m, n) of something; values : (m,)"""
    return len(rows) + len(values)


def test_shapes_are_read_from_docstrings() -> None:
    notes = "weight : V (w, n) over n; rows, others : (..., 3); t : (m,) or a number; cubics : (n + 1, 4)"
    assert said(notes) == {"weight": "w n", "rows": "... 3", "others": "... 3", "cubics": "_ 4"}


@pytest.mark.parametrize(("rows", "values"), [((2, 3), (3,)), ((2,), (2,)), ((2, 3), (2, 1))])
def test_arrays_of_other_shapes_are_refused(rows: tuple[int, ...], values: tuple[int, ...]) -> None:
    with pytest.raises(ShapeSaidError, match=r"of_rows: \w+ is said to be"):
        checked(of_rows, of_rows.__doc__)(np.zeros(rows), values=np.zeros(values))


def test_the_package_is_looked_at() -> None:
    with pytest.raises(ShapeSaidError, match="settled: values is said to be"):
        settled(np.eye(2), np.eye(2))
