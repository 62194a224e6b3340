"""The thread that owns the campaign: one piece of work after another, the last of which can be broken off."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from threading import Lock, get_ident
from typing import TypeVar

_PATIENCE = 0.5
"""s that work which is nearly done is waited for."""
_Result = TypeVar("_Result")


class BrokenOffError(Exception):
    """Work that was waiting when the thread was ended."""


class OwnThread:
    """Does what it is given in turn, until it is ended."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="campaign")
        self._lock, self._ending = Lock(), False
        self._at_work: int | None = None

    def do(self, work: Callable[[], _Result]) -> Future[_Result]:
        """Return what becomes of a piece of work."""
        return self._pool.submit(self._done, work)

    def end(self, last: Callable[[], None]) -> bool:
        """Break off what is under way, leave what waits, do a last thing; return whether anything was broken off.

        It is ended as the main thread is by Ctrl-C, which may come anywhere: at the next step of Python.
        """
        with self._lock:
            self._ending = True
        free, broken_off = self._pool.submit(int), False
        while not wait([free], _PATIENCE).done:  # an interruption that comes while Python clears up is lost
            with self._lock:
                if self._at_work is not None:
                    interrupted = ctypes.c_ulong(self._at_work), ctypes.py_object(KeyboardInterrupt)
                    broken_off |= ctypes.pythonapi.PyThreadState_SetAsyncExc(*interrupted) == 1
        self._pool.submit(last).result()
        self._pool.shutdown()
        return broken_off

    def _done(self, work: Callable[[], _Result]) -> _Result:
        with self._lock:
            if self._ending:
                raise BrokenOffError
            self._at_work = get_ident()
        try:
            return work()
        finally:
            with self._lock:
                self._at_work = None
