"""What one kind of trial came to: a row of the table."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import BinaryIO, NamedTuple

DISK = "AXISCAL_DISK"
"""Variable of the environment: a folder on the disk, or the share, that is tried."""
MEMORY = Path("/dev/shm")
"""A disk in memory, where there is one: what a fault leaves does not depend on how long the disk is waited for."""


Say = Callable[[str], object]
"""Says a line to whoever waits for it."""


@contextmanager
def scratch() -> Iterator[Path]:
    """Yield an empty folder, on the disk that is tried if one is named."""
    with TemporaryDirectory(dir=os.environ.get(DISK) or (MEMORY if MEMORY.is_dir() else None)) as name:
        yield Path(name)


class Forked(NamedTuple):
    """A process of its own.  said : the lines that it writes, to be read to their end"""

    process: int
    said: BinaryIO

    def lines(self) -> list[str]:
        """Return the lines that it wrote, once it has ended, but for a last one that was cut off."""
        with self.said:
            lines = self.said.read().decode().splitlines(keepends=True)
        os.waitpid(self.process, 0)
        return [line.strip() for line in lines if line.endswith("\n")]


def forked(work: Callable[[Say], None]) -> Forked:
    """Let a process of its own do some work, which says lines."""
    reading, writing = os.pipe()
    child, write = os.fork(), os.write  # as they are before any fault is put in their place
    if child:
        os.close(writing)
        return Forked(child, os.fdopen(reading, "rb"))
    try:
        work(lambda line: write(writing, f"{line}\n".encode()))
    finally:
        os._exit(0)


@dataclass(frozen=True, slots=True)
class Trial:
    """What was tried, how often, and how often something was lost, mixed or silent."""

    what: str
    tried: int
    lost: int
    detail: str = ""
