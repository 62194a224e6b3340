"""The stage of a running command, on stderr of a terminal: one line that changes, and goes with the last stage."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from axiscal.cli.printing import rewrite
from axiscal.language.spoken import put, said
from axiscal.language.stages import Listener, listening


class _Shown(list[str]):
    """Stages, of which the newest is shown."""

    def append(self, name: str) -> None:
        super().append(name)
        rewrite(put("{stage} …", stage=said(name)))


@contextmanager
def shown_stages() -> Iterator[None]:
    """Show on a terminal where the work in this block is, unless AXISCAL_PROGRESS is "off"."""
    if os.environ.get("AXISCAL_PROGRESS") == "off" or not sys.stderr.isatty():
        yield
        return
    with listening(Listener(_Shown(), lambda: rewrite(""))):
        yield
