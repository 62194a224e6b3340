"""The loop on machines whose tables turn: in a file of its own, so that another worker waits for them meanwhile."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.linuxcnc.demo import MACHINES, close_loop
from tests.linuxcnc.lab import available
from tests.linuxcnc.test_closed_loop import MILLS, the_loop_holds

pytestmark = [
    pytest.mark.linuxcnc,
    pytest.mark.long,
    pytest.mark.skipif(not available(), reason="Debian package linuxcnc-uspace is not installed"),
]


@pytest.mark.parametrize("name", [name for name in MACHINES if name not in MILLS])
def test_the_error_is_gone_within_what_was_stated(name: str, tmp_path: Path) -> None:
    the_loop_holds(close_loop(name, tmp_path))
