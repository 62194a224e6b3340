"""The loop on machines whose tables turn: in a file of its own, so that another worker waits for them meanwhile."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.linuxcnc.demo import MACHINES, close_loop
from tests.linuxcnc.needed import LONG
from tests.linuxcnc.test_closed_loop import MILLS, the_loop_holds

pytestmark = LONG


@pytest.mark.parametrize("name", [name for name in MACHINES if name not in MILLS])
def test_the_error_is_gone_within_what_was_stated(name: str, tmp_path: Path) -> None:
    the_loop_holds(close_loop(name, tmp_path))
