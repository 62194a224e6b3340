"""Files that somebody named and what is named in their place; values as Python's own reader finds them."""

import math
import os
import threading
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from axiscal.document.file import bounded_content
from axiscal.document.quoting import toml_value


def test_a_file_is_read_whole_up_to_its_limit(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"x" * 2_000_000)
    assert bounded_content(path, 2_000_000) == path.read_bytes()
    with pytest.raises(OSError, match="more than 1 MB"):
        bounded_content(path, 1_999_999)


@pytest.mark.parametrize(("name", "says"), [("/dev/zero", "a device"), (".", "a folder"), ("nowhere", "No such file")])
def test_what_is_no_file_is_refused(name: str, says: str) -> None:
    if name == "/dev/zero" and not os.path.exists(name):
        pytest.skip("needs /dev/zero")
    with pytest.raises(OSError, match=says):
        bounded_content(name, 1000)


def test_a_pipe_is_read_to_its_end(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("needs pipes with names")
    path = tmp_path / "pipe"
    os.mkfifo(path)
    writer = threading.Thread(target=lambda: path.write_bytes(b"a" * 100_000))
    writer.start()
    assert bounded_content(path, 1_000_000) == b"a" * 100_000
    writer.join()


SCALARS = (
    st.text() | st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False, allow_infinity=False)
)
VALUES: st.SearchStrategy[Any] = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4), max_leaves=12
)


@given(VALUES)
@example([{"name": "a", "park": {"Y": "1 mm"}, "at": math.pi}, {"name": "b", "part": {}}])
@example("an axis \U0001f9ed of \x7f and \x00")
def test_a_value_is_read_as_it_was(value: Any) -> None:
    assert tomllib.loads(f"key = {toml_value(value)}") == {"key": value}
