"""Ctrl-C at a moment that costs nothing: noted while a reading is being kept, heeded while one is waited for."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Interrupts:
    """SIGINT noted; `heed` raises KeyboardInterrupt if there was one."""

    def __init__(self) -> None:
        self._noted = False

    def note(self, number: int, frame: FrameType | None) -> None:
        """Remember the signal."""
        self._noted = True

    def heed(self) -> None:
        """Raise KeyboardInterrupt if a signal came."""
        if self._noted:
            raise KeyboardInterrupt

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """While this lasts, a signal interrupts at once."""
        self.heed()
        if not _in_main_thread():
            yield
            return
        noting = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, noting)


@contextmanager
def noted_interrupts() -> Iterator[Interrupts]:
    """Note SIGINT instead of raising; a second thread, which gets no signals, is left alone."""
    interrupts = Interrupts()
    if not _in_main_thread():
        yield interrupts
        return
    before = signal.signal(signal.SIGINT, interrupts.note)
    try:
        yield interrupts
    finally:
        signal.signal(signal.SIGINT, before)


def _in_main_thread() -> bool:
    return threading.current_thread() is threading.main_thread()
