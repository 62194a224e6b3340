"""The stage of a running command, on stderr of a terminal, from its second second on: one line that changes."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from axiscal.cli.printing import rewrite
from axiscal.language.spoken import put, said, speaking
from axiscal.language.stages import Listener, listening
from axiscal.present.whose_language import chosen

_QUIET = 2.0
"""Seconds in which nobody needs to be told; anything that feels like waiting would do."""
_LOOK = 0.25
"""Seconds between two looks; a matter of taste."""


@contextmanager
def shown_stages() -> Iterator[None]:
    """Show on a terminal where the work in this block is, unless AXISCAL_PROGRESS is "off"."""
    if os.environ.get("AXISCAL_PROGRESS") == "off" or not sys.stderr.isatty():
        yield
        return
    stages, start, language = list[str](), time.monotonic(), chosen(None)
    over, writing = threading.Event(), threading.Lock()

    def wipe() -> None:
        with writing:
            if time.monotonic() - start >= _QUIET:
                rewrite("")

    def watch() -> None:
        while not over.wait(_LOOK):
            now = time.monotonic()
            with writing, speaking(language):  # of the thread that began
                if stages and now - start >= _QUIET:
                    so_far = put("{s:.0f}", s=now - start)
                    rewrite(said("{stage}, {seconds} s so far", stage=said(stages[-1]), seconds=so_far))

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        with listening(Listener(stages, wipe)):
            yield
    finally:
        over.set()
        watcher.join()
