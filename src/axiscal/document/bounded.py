"""The bytes of a file that somebody named: at most so many, and without waiting for a pipe that nobody writes into."""

from __future__ import annotations

import errno
import os
import select
import stat
from pathlib import Path

_PATIENCE = 1.0
"""Seconds to wait for the first byte of a pipe; any that a person would wait for would do."""
_PIECE = 1 << 20
"""Bytes read at once; any would do."""


def bounded_content(path: str | Path, most: int) -> bytes:
    """Return the bytes of a file or a pipe.

    Raises OSError for what is neither, cannot be read, or has more than `most` bytes; ValueError for no name of a file.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0))
    try:
        _wait(handle, str(path))
        content, left = list[bytes](), most + 1
        while left and (piece := os.read(handle, min(left, _PIECE))):
            content.append(piece)
            left -= len(piece)
    finally:
        os.close(handle)
    if not left:
        raise OSError(errno.EFBIG, f"it has more than {_megabytes(most)}", str(path))
    return b"".join(content)


def _wait(handle: int, name: str) -> None:
    """Wait for a pipe; raises OSError for what can be read without an end, or never."""
    mode = os.fstat(handle).st_mode
    if stat.S_ISREG(mode):
        return
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder", name)
    if not stat.S_ISFIFO(mode):
        raise OSError(errno.EINVAL, "it is a device and no file", name)
    if not select.select([handle], [], [], _PATIENCE)[0]:
        raise OSError(errno.EPIPE, "it is a pipe that nobody writes into", name)
    os.set_blocking(handle, True)


def _megabytes(most: int) -> str:
    return f"{most // 1_000_000} MB" if most >= 1_000_000 else f"{most // 1000} kB"
