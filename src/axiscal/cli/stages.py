"""The stage of a running command, on stderr of a terminal: one line that changes, and goes with the last stage."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from axiscal.cli.printing import rewrite
from axiscal.language.spoken import put, said
from axiscal.language.stages import Listener, listening


@contextmanager
def shown_stages() -> Iterator[None]:
    """Show on a terminal where the work in this block is, unless AXISCAL_PROGRESS is "off"."""
    if os.environ.get("AXISCAL_PROGRESS") == "off" or not sys.stderr.isatty():
        yield
        return
    with listening(Listener([], lambda newest: rewrite(put("{stage} …", stage=said(newest)) if newest else ""))):
        yield
