"""Writing that lasts: what these functions have written is on the disk when they return, and outlives the power."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import random
import re
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_NAP = 0.002
"""Seconds between two looks, at most; by chance, so that nobody is always too late."""
_AGAIN = 0.05
"""Seconds within which whoever has held a file does not come first again; any longer than a nap would do."""
_LOOKS = 500
"""Looks before anybody gives up: a process that the system left without a processor for seconds has waited for that,
not for the file. An idle machine makes thousands of them in the usual patience; a tenth or ten times as many would do.
"""

_PIECE = 1 << 24
"""Bytes read at once, so that no more are asked for than there are; any would do."""
_DRAFT = re.compile(r"\.(?P<name>.+)\.(?P<process>\d+)\.new")


def written(path: Path, content: bytes) -> None:
    """Write a new file to the disk; raises OSError, FileExistsError where there is something already."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        write_at(handle, 0, content)
        sync(handle)
    finally:
        os.close(handle)


def write_whole(path: Path, content: bytes, *, new: bool = False, like: Path | None = None) -> None:
    """Write a file so that it is there whole or not at all; raises OSError.

    new : FileExistsError where something is there, which is replaced otherwise
    like : a file whose permissions it gets, by default those of the one that it replaces
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}.new")
    clear_drafts(path.parent, path.name)
    try:
        written(draft, content)
        with contextlib.suppress(FileNotFoundError):
            shutil.copymode(like or path, draft)
        (_named_anew if new else os.replace)(draft, path)
        sync_folder(path.parent)
    except OSError as failure:
        raise OSError(failure.errno, failure.strerror, str(path)) from None
    finally:
        with contextlib.suppress(OSError):
            draft.unlink(missing_ok=True)


def _named_anew(draft: Path, path: Path) -> None:
    try:
        os.link(draft, path)
    except OSError:  # also on a file system without hard links
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from None
        os.rename(draft, path)


def write_at(handle: int, offset: int, content: bytes) -> None:
    """Write all of `content` from an offset on; raises OSError."""
    os.lseek(handle, offset, os.SEEK_SET)
    left = memoryview(content)
    while left:
        left = left[os.write(handle, left) :]


def read_at(handle: int, offset: int, size: int) -> bytes:
    """Return as many bytes from an offset on as there are, at most `size`; raises OSError."""
    os.lseek(handle, offset, os.SEEK_SET)
    parts, left = list[bytes](), size
    while left and (part := os.read(handle, min(left, _PIECE))):
        parts.append(part)
        left -= len(part)
    return b"".join(parts)


def sync(handle: int) -> None:
    """Wait until the content of an open file is on the disk; raises OSError."""
    getattr(os, "fdatasync", os.fsync)(handle)


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk; raises OSError."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    except OSError as failure:
        if failure.errno not in (errno.EINVAL, errno.ENOTSUP):  # a file system that knows no such wish
            raise
    finally:
        os.close(handle)


def clear_drafts(folder: Path, name: str) -> None:
    """Remove what writers that are gone have left of a file."""
    with contextlib.suppress(OSError):
        for path in drafts_left(folder, name):
            if path.is_file():
                path.unlink(missing_ok=True)


def drafts_left(folder: Path, name: str) -> list[Path]:
    """Return what writers that are gone have left of a file or folder; raises OSError."""
    found = ((path, _DRAFT.fullmatch(path.name)) for path in sorted(folder.iterdir()))
    return [path for path, of in found if of and of["name"] == name and not is_running(int(of["process"]))]


def is_running(process: int) -> bool:
    """Whether there is such a process besides this one."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return process != os.getpid()


if sys.platform == "win32":
    import msvcrt

    _TAKE, _LEAVE = msvcrt.LK_NBLCK, msvcrt.LK_UNLCK

    def _hold(handle: int, how: int) -> None:
        os.lseek(handle, 2**30, os.SEEK_SET)  # far behind what is written
        msvcrt.locking(handle, how, 1)

else:
    import fcntl

    _TAKE, _LEAVE, _hold = fcntl.LOCK_EX | fcntl.LOCK_NB, fcntl.LOCK_UN, fcntl.flock


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
    while True:
        try:
            _hold(handle, _TAKE)
            break
        except (BlockingIOError, PermissionError):
            looks += 1
            if looks > _LOOKS and time.monotonic() > until:
                raise HeldError from None
            time.sleep(_NAP * random.random())
    try:
        yield
    finally:
        _hold(handle, _LEAVE)
        _last_left[handle] = time.monotonic()
