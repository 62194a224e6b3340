"""An index of all campaigns of a store, kept where this computer's user keeps what can be made anew."""

from __future__ import annotations

import contextlib
import hashlib
import os
from pathlib import Path
from typing import Self

from axiscal.ports.postgres.address import store_address
from axiscal.ports.postgres.server_log import all_there
from axiscal.record.folder_index import FolderIndex, Stamp

_DIGITS = 15
"""Of a digest that a number of SQLite holds."""


class StoreIndex(FolderIndex):
    """The index of the store that AXISCAL_STORE names, open; a context manager."""

    @classmethod
    def of_store(cls) -> Self:
        """Return the index; where it cannot be kept, one that is gone afterwards.  Raises RecordError."""
        address = store_address(None)
        folder = _caches() / "axiscal" / hashlib.sha256(address.shown.encode()).hexdigest()[:16]
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        return cls._kept_in(folder)

    def _there(self) -> list[tuple[Path, Stamp]]:
        return [(each.path, (each.last, int(each.digest[:_DIGITS] or "0", 16))) for each in all_there()]

    def _path(self, name: str) -> Path:
        return Path(name)


def _caches() -> Path:
    """Return the folder of the user for what can be made anew."""
    named = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return Path(named) if named else Path.home() / ".cache"
