"""Ctrl-C at a moment that costs nothing: noted while a reading is being kept, heeded while one is waited for."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext


@contextmanager
def noted_interrupts() -> Iterator[Callable[[], AbstractContextManager[None]]]:
    """Note SIGINT instead of raising, and yield a context in which it interrupts at once, also if it was noted before.

    A second thread, which gets no signals, is left alone.
    """
    if threading.current_thread() is not threading.main_thread():
        yield nullcontext
        return
    noted = list[int]()

    @contextmanager
    def heeding() -> Iterator[None]:
        if noted:
            raise KeyboardInterrupt
        noting = signal.signal(signal.SIGINT, signal.default_int_handler)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, noting)

    before = signal.signal(signal.SIGINT, lambda number, frame: noted.append(number))
    try:
        yield heeding
    finally:
        signal.signal(signal.SIGINT, before)
