"""What one kind of trial came to: a row of the table."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

DISK = "AXISCAL_DISK"
"""Variable of the environment: a folder on the disk, or the share, that is tried."""
MEMORY = Path("/dev/shm")
"""A disk in memory, where there is one: what a fault leaves does not depend on how long the disk is waited for."""


@contextmanager
def scratch() -> Iterator[Path]:
    """Yield an empty folder, on the disk that is tried if one is named."""
    with TemporaryDirectory(dir=os.environ.get(DISK) or (MEMORY if MEMORY.is_dir() else None)) as name:
        yield Path(name)


@dataclass(frozen=True, slots=True)
class Trial:
    """What was tried, how often, and how often something was lost, mixed or silent."""

    what: str
    tried: int
    lost: int
    detail: str = ""
