"""Files that somebody named, and what is named in their place."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from axiscal.document.file import bounded_content


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


def test_a_pipe_is_read_to_its_end_and_one_that_nobody_writes_into_is_refused(tmp_path: Path) -> None:
    if not hasattr(os, "mkfifo"):
        pytest.skip("needs pipes with names")
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(OSError, match="nobody writes"):
        bounded_content(path, 1000)
    writer = threading.Thread(target=lambda: path.write_bytes(b"a" * 100_000))
    writer.start()
    assert bounded_content(path, 1_000_000) == b"a" * 100_000
    writer.join()
