"""Writing alone: of several processes that want to write to one file, one does, and the others wait for a while."""

from __future__ import annotations

import math
import os
import random
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

_NAP = 0.002
"""Seconds between two looks, at most; by chance, so that nobody is always too late."""
_AGAIN = 0.05
"""Seconds within which whoever has held a file does not come first again; any longer than a nap would do."""
_LOOKS = 500
"""Looks before anybody gives up: a process that the system left without a processor for seconds has waited for that,
not for the file. An idle machine makes thousands of them in the usual patience; a tenth or ten times as many would do.
"""

if sys.platform == "win32":
    import msvcrt

    _FAR = 2**30

    def _taken(handle: int) -> bool:
        os.lseek(handle, _FAR, os.SEEK_SET)
        try:
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

    def _left(handle: int) -> None:
        os.lseek(handle, _FAR, os.SEEK_SET)
        msvcrt.locking(handle, msvcrt.LK_UNLCK, 1)

else:
    import fcntl

    def _taken(handle: int) -> bool:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _left(handle: int) -> None:
        fcntl.flock(handle, fcntl.LOCK_UN)


_last_left: dict[int, float] = {}


class HeldError(Exception):
    """Another process holds the file."""


@contextmanager
def alone(handle: int, patience: float) -> Iterator[None]:
    """Hold an open file, so that no other process is in such a block of the same file; the system lets go at a kill.

    Raises HeldError if another one holds it for longer than `patience` seconds and at each of many looks, OSError where
    files cannot be held.
    """
    until, looks = time.monotonic() + patience, 0
    if time.monotonic() - _last_left.get(handle, -math.inf) < _AGAIN:  # others may be waiting: they get their turn
        time.sleep(_NAP * random.random())
    while not _taken(handle):
        looks += 1
        if looks > _LOOKS and time.monotonic() > until:
            raise HeldError
        time.sleep(_NAP * random.random())
    try:
        yield
    finally:
        _left(handle)
        _last_left[handle] = time.monotonic()
