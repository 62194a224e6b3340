"""What readings make known, kept beside the record, so that the next command looks at the new ones only.

    kept = Kept(path, first_event)
    known = kept.recalled(readings)
    kept.keep(known)

It is never needed: what cannot be read, does not belong to this campaign, or was made by other programs is not there,
and what is recalled is only what the first readings of the record made known, while others are to follow: what is
concluded, and signed, is found from the record alone. Only classes of the rooms up to the estimate are made from it,
and arrays: nothing in it can be called.

    file = a title, "key SHA-256-of-the-rest", the rest; key: the campaign's description, the programs, their files
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import pickle
from collections.abc import Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any

from axiscal.campaign.versions import versions
from axiscal.estimation.estimation import Estimation
from axiscal.measurement.reading import Reading
from axiscal.record.durable import write_whole
from axiscal.record.events import Event, Stored
from axiscal.record.payload import encode

FEWEST = 64
"""Of fewer readings all is found anew in less time than a file would save."""
_EVERY = 32
"""So many readings later it is kept anew: taking them in again is quick."""
_TITLE = b"axiscal known 1\n"
_ROOMS = {
    "accuracy",
    "belief",
    "description",
    "error_model",
    "estimation",
    "inference",
    "machine",
    "measurement",
    "numerics",
}
"""Whose classes may be made: they hold numbers, and making one does nothing."""
_NUMPY = {
    ("numpy", "dtype"),
    ("numpy", "ndarray"),
    ("numpy._core.multiarray", "_reconstruct"),
    ("numpy._core.multiarray", "scalar"),
    ("numpy._core.numeric", "_frombuffer"),
    ("numpy.core.multiarray", "_reconstruct"),
    ("numpy.core.multiarray", "scalar"),
    ("numpy.core.numeric", "_frombuffer"),
}
_PLAIN = {("builtins", name) for name in ("frozenset", "set", "slice", "range", "complex")} | {
    ("collections", "OrderedDict"),
    ("pathlib", "PosixPath"),
    ("pathlib", "WindowsPath"),
    ("pathlib._local", "PosixPath"),
    ("pathlib._local", "WindowsPath"),
}


_DAMAGE = (
    *(pickle.UnpicklingError, ValueError, TypeError, AttributeError, KeyError, IndexError, EOFError, ImportError),
    *(OverflowError, MemoryError, RecursionError),
)
"""What reading a file raises that is not one of ours."""


class Kept:
    """What is known of one campaign, beside its record.  first : its first event, which holds the description"""

    def __init__(self, record: Path, first: Stored) -> None:
        self._record, self._first, self._count = record, first, 0

    def recalled(self, readings: Sequence[Reading]) -> Estimation | None:
        """Return what the first of the readings made known; None where nothing was kept, or of other readings."""
        if len(readings) < FEWEST:
            return None
        found = _read(kept_beside(self._record), _key(self._first.event))
        if found is None or not found.stages.timed.begins(readings):
            return None
        self._count = len(found.readings)
        return found

    def keep(self, known: Estimation) -> None:
        """Write what is known where it has grown by enough; where the folder takes no file it is not kept."""
        count = len(known.readings)
        if count < FEWEST or 0 <= count - self._count < _EVERY or not self._record.exists():
            return  # a record on a server has no place beside it
        self._count = count
        with contextlib.suppress(OSError, pickle.PicklingError, TypeError, RecursionError, MemoryError):
            _write(kept_beside(self._record), _key(self._first.event), known)


def kept_beside(record: Path) -> Path:
    """Return the file in which it is kept."""
    return record.with_name(f".{record.name}.known")


def _write(path: Path, key: str, known: Estimation) -> None:
    """Write a file in the place of an earlier one; raises OSError."""
    buffer = io.BytesIO()
    _KnownWriter(buffer, protocol=5).dump(known)
    content = buffer.getvalue()
    write_whole(path, _TITLE + f"{key} {hashlib.sha256(content).hexdigest()}\n".encode() + content)


def _read(path: Path, key: str) -> Estimation | None:
    """Return what a file holds; None where it is not whole, or was kept under another key."""
    try:
        title, said, body = path.read_bytes().split(b"\n", 2)
    except (OSError, ValueError):
        return None
    if title + b"\n" != _TITLE or said != f"{key} {hashlib.sha256(body).hexdigest()}".encode():
        return None
    try:
        found = _KnownReader(io.BytesIO(body)).load()
    except _DAMAGE:
        return None
    return found if isinstance(found, Estimation) else None


def _key(created: Event) -> str:
    """Return the key of what is known of a campaign: its description, and the programs that find it."""
    return hashlib.sha256(json.dumps([*encode(created), versions(), _sources()]).encode()).hexdigest()


@cache
def _sources() -> str:
    """Return a name of the program's files as they are, so that another state of the program recalls nothing."""
    folder = Path(__file__).resolve().parents[1]
    found = [path for path in folder.rglob("*.py") if path.is_file()]
    files = sorted((str(path.relative_to(folder)), path.stat()) for path in found)
    return hashlib.sha256(repr([(name, at.st_size, at.st_mtime_ns) for name, at in files]).encode()).hexdigest()


def _read_only(found: dict[Any, Any]) -> MappingProxyType[Any, Any]:
    return MappingProxyType(found)


class _KnownWriter(pickle.Pickler):
    """A pickler that also takes mappings that may only be read."""

    def reducer_override(self, value: object) -> Any:
        """Return how such a mapping is made again."""
        if isinstance(value, MappingProxyType):
            return _read_only, (dict(value),)
        return NotImplemented


class _KnownReader(pickle.Unpickler):
    """An unpickler that makes arrays, and classes of the rooms up to the estimate, and nothing else."""

    def find_class(self, module: str, name: str) -> Any:
        """Return a class by name; raises UnpicklingError for anything else."""
        if (module, name) == (__name__, "_read_only"):
            return _read_only
        room = module.split(".")
        if room[0] == "axiscal" and len(room) > 1 and room[1] in _ROOMS and "." not in name:
            found = getattr(import_module(module), name)
            if isinstance(found, type) and found.__module__ == module:
                return found
        if (module, name) in _NUMPY | _PLAIN:
            return getattr(import_module(module), name)
        raise pickle.UnpicklingError(f"{module}.{name} is not made from what was kept")
