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
from axiscal.language.stages import Stage, listening
from axiscal.present.whose_language import chosen

_QUIET = 2.0
"""Seconds in which nobody needs to be told; anything that feels like waiting would do."""
_LOOK = 0.25
"""Seconds between two looks; a matter of taste."""


class StageLine:
    """Listens to the work, and shows where it is.

    now : seconds, of any clock
    """

    def __init__(self) -> None:
        self._lock, self._stack = threading.Lock(), list[tuple[Stage, float]]()
        self._start, self._done = time.monotonic(), threading.Event()
        self._line, self._language = "", chosen(None)

    def begun(self, stage: Stage) -> None:
        """A stage begins."""
        with self._lock:
            self._stack.append((stage, time.monotonic()))

    def advanced(self, number: int) -> None:
        """So many things of the last stage are done."""
        with self._lock:
            stage, since = self._stack[-1]
            self._stack[-1] = stage._replace(number=number), since

    def ended(self) -> None:
        """The last stage ends; what stands of it on the screen goes."""
        with self._lock:
            self._stack.pop()
            if not self._stack:
                self._wipe()

    def show(self, now: float) -> None:
        """Show the stage that lasts, once the command has taken long enough."""
        with self._lock:
            if not self._stack or now - self._start < _QUIET:
                return
            stage, since = self._stack[-1]
            with speaking(self._language):  # of the thread that began
                passed = put("{seconds:.0f}", seconds=now - self._start)
                line = said("{stage}, {seconds} s so far", stage=stage_text(stage, now - since), seconds=passed)
            self._line, before = line, self._line
            rewrite(line.ljust(len(before)))

    def watch(self) -> None:
        """Look again and again, in a separate thread, until the end."""
        while not self._done.wait(_LOOK):
            self.show(time.monotonic())

    def end(self) -> None:
        """Show nothing more."""
        self._done.set()
        with self._lock:
            self._wipe()

    def _wipe(self) -> None:
        if self._line:
            rewrite(f"{' ' * len(self._line)}\r")
            self._line = ""


def stage_text(stage: Stage, seconds: float) -> str:
    """Return a stage in words: which of how many, and how many seconds are left where things are counted."""
    name = said(stage.name)
    if not stage.of:
        return name
    text = said("{name}, {number} of {last}", name=name, number=stage.number, last=stage.of)
    if stage.number and stage.of > _COUNTED:
        left = put("{seconds:.0f}", seconds=seconds * (stage.of - stage.number) / stage.number)
        return said("{text}, about {left} s left", text=text, left=left)
    return text


_COUNTED = 12
"""More are things of one kind, which take alike; fewer are stages, which do not."""


@contextmanager
def shown_stages() -> Iterator[None]:
    """Show what is done in this block on a terminal, unless AXISCAL_PROGRESS is "off"."""
    if os.environ.get("AXISCAL_PROGRESS") == "off" or not sys.stderr.isatty():
        yield
        return
    stages = StageLine()
    watcher = threading.Thread(target=stages.watch, daemon=True)
    watcher.start()
    try:
        with listening(stages):
            yield
    finally:
        stages.end()
        watcher.join()
