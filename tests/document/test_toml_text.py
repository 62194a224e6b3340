"""Values written as TOML are those that Python's own reader finds."""

from __future__ import annotations

import math
import tomllib
from typing import Any

from hypothesis import example, given
from hypothesis import strategies as st

from axiscal.document.quoting import toml_document, toml_value

SCALARS = (
    st.text() | st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False, allow_infinity=False)
)
VALUES: st.SearchStrategy[Any] = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4), max_leaves=12
)


@given(VALUES)
@example("an axis \U0001f9ed of \x7f and \x00")
def test_a_value_is_read_as_it_was(value: Any) -> None:
    assert tomllib.loads(f"key = {toml_value(value)}") == {"key": value}


@given(st.dictionaries(st.text(), VALUES, max_size=5))
@example({"setups": [{"name": "a", "park": {"Y": "1 mm"}}, {"name": "b"}], "target": {"rms": math.pi, "part": {}}})
def test_a_document_is_read_as_it_was(data: dict[str, Any]) -> None:
    assert tomllib.loads(toml_document(data)) == data
