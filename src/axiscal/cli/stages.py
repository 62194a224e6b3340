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
from axiscal.language.stages import Listener, Stage, listening, stage_text
from axiscal.present.whose_language import chosen

_QUIET = 2.0
"""Seconds in which nobody needs to be told; anything that feels like waiting would do."""
_LOOK = 0.25
"""Seconds between two looks; a matter of taste."""


class StageLine:
    """Shows on stderr where the work is, in the language of whoever began it.

    stages : that last; over : whether nothing more is to be shown
    """

    def __init__(self) -> None:
        self.stages, self.start, self.over = list[Stage](), time.monotonic(), threading.Event()
        self._lock, self._language = threading.Lock(), chosen(None)

    def show(self, now: float) -> None:
        """Show the stage that lasts, once the command has taken long enough.  now : s, as of its start"""
        with self._lock:
            if self.stages and now - self.start >= _QUIET:
                with speaking(self._language):  # of the thread that began
                    stage = stage_text(self.stages[-1], now - self.stages[-1].since)
                    passed = put("{seconds:.0f}", seconds=now - self.start)
                    rewrite(said("{stage}, {seconds} s so far", stage=stage, seconds=passed))

    def wipe(self) -> None:
        """Let nothing stand on the screen that could have been shown."""
        with self._lock:
            if time.monotonic() - self.start >= _QUIET:
                rewrite("")

    def watch(self) -> None:
        """Look again and again, in a separate thread, until the end."""
        while not self.over.wait(_LOOK):
            self.show(time.monotonic())


@contextmanager
def shown_stages() -> Iterator[None]:
    """Show what is done in this block on a terminal, unless AXISCAL_PROGRESS is "off"."""
    if os.environ.get("AXISCAL_PROGRESS") == "off" or not sys.stderr.isatty():
        yield
        return
    line = StageLine()
    watcher = threading.Thread(target=line.watch, daemon=True)
    watcher.start()
    try:
        with listening(Listener(line.stages, line.wipe)):
            yield
    finally:
        line.over.set()
        watcher.join()
