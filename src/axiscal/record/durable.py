"""Writing that lasts: what these functions have written is on the disk when they return, and outlives the power."""

from __future__ import annotations

import contextlib
import errno
import os
import re
from pathlib import Path

_DRAFT = re.compile(r"\.(?P<name>.+)\.(?P<process>\d+)\.new")


def draft_of(path: Path) -> Path:
    """Return the name under which this process writes `path` before it is published."""
    return path.with_name(f".{path.name}.{os.getpid()}.new")


def written(path: Path, content: bytes) -> None:
    """Write a new file to the disk; raises OSError, FileExistsError where there is something already."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        write_at(handle, 0, content)
        sync(handle)
    finally:
        os.close(handle)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file, in the place of an earlier one, so that it is there whole or not at all; raises OSError."""
    draft = draft_of(path)
    try:
        draft.unlink(missing_ok=True)
        written(draft, content)
        os.replace(draft, path)
        sync_folder(path.parent)
    except OSError as failure:
        with contextlib.suppress(OSError):
            draft.unlink(missing_ok=True)
        raise OSError(failure.errno, failure.strerror, str(path)) from None


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
    while left and (part := os.read(handle, left)):
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


def clear_drafts(folder: Path, name: str = "") -> None:
    """Remove what writers that are gone have left in a folder, of one file or of all; a folder not ours is left."""
    with contextlib.suppress(OSError):
        for path in folder.iterdir():
            found = _DRAFT.fullmatch(path.name)
            if found and name in ("", found["name"]) and not _runs(int(found["process"])):
                path.unlink(missing_ok=True)


def _runs(process: int) -> bool:
    if process == os.getpid():
        return False
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True
