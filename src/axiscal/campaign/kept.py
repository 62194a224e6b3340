"""What readings make known, kept beside the record, so that the next command looks at the new ones only.

    kept = Kept(path, first_event)
    known = kept.recalled(readings)
    kept.keep(known)
    verdict = kept.standing(readings, lambda: standing(target, known))
    kept.close()

It is never needed: what cannot be read, does not belong to this campaign, or was made by other programs is not there,
and what is recalled is only what the first readings of the record made known, while others are to follow: what is
concluded, and signed, is found from the record alone. Only classes of the rooms up to the estimate are made from it,
and arrays: nothing in it can be called.

    file = a title, "key SHA-256-of-the-rest", the rest; key: the campaign's description, the programs, their files

Answers about exactly these readings (accuracy, verdict, odds) have a small file of their own, whose key holds them,
written when all is closed, and beside the copy of a record that results are delivered with.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import math
import pickle
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeGuard, TypeVar

from axiscal.accuracy.yardstick import Accuracy
from axiscal.campaign.ended_words import ends_by_accuracy
from axiscal.campaign.versions import versions
from axiscal.estimation.estimation import Estimation
from axiscal.estimation.reviewed import costly
from axiscal.estimation.soundness import is_sound
from axiscal.estimation.watching import watched_so_far
from axiscal.inference.contradiction import PRIOR, Explanation, Watched
from axiscal.language.spoken import spoken_now
from axiscal.measurement.reading import Reading
from axiscal.record.durable import write_whole
from axiscal.record.events import Event, Mounted, Stored
from axiscal.record.payload import encode

FEWEST = 64
"""Of fewer readings all is found anew in less time than a file would save."""
FEWEST_ANSWERED = 8
"""Of fewer readings even the verdict is found anew in less than a second."""
_EVERY = 32
"""So many readings later it is kept anew: taking them in again is quick, unless one of them has all weighed again."""
_TITLE = b"axiscal known 1\n"
Answer = TypeVar("Answer")
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


DAMAGE = (
    *(pickle.UnpicklingError, ValueError, TypeError, AttributeError, KeyError, IndexError, EOFError, ImportError),
    *(ArithmeticError, MemoryError, RecursionError, AssertionError),
)
"""What reading a file, or going on from what it holds, raises that is not one of ours."""


class Kept:
    """What is known of one campaign, beside its record.

    first : its first event, which holds the description; mounted : set-ups that were mounted anew since
    """

    def __init__(self, record: Path, first: Stored, mounted: Sequence[Mounted] = ()) -> None:
        self._record, self._described, self._count = record, (first.event, *mounted), 0
        self._answers: dict[str, object] | None = None
        self._readings: tuple[Reading, ...] = ()
        self._found = False

    def recalled(self, readings: Sequence[Reading]) -> Estimation | None:
        """Return what the first of the readings made known; None where nothing was kept, or of other readings."""
        if len(readings) < FEWEST:
            return None
        found = _read(kept_beside(self._record), _key(*self._described))
        if not isinstance(found, Estimation) or not _begins(found, readings):
            return None
        self._count = len(found.readings)
        return found

    def keep(self, known: Estimation) -> None:
        """Write what is known where it has grown by enough, or a new reading was costly to look at.

        Where the folder takes no file it is not kept.
        """
        count = len(known.readings)
        little = 0 <= count - self._count < _EVERY and not costly(known.stages.absorbed, self._count)
        if count < FEWEST or little or not self._record.exists():
            return  # a record on a server has no place beside it
        self._count = count
        with contextlib.suppress(OSError, pickle.PicklingError, TypeError, RecursionError, MemoryError):
            _write(kept_beside(self._record), _key(*self._described), known)

    def forget(self) -> None:
        """Let what is known be written next in the place of what was recalled, however little it has grown."""
        self._count = 0

    def standing(
        self, readings: tuple[Reading, ...], find: Callable[[], str | None], ended: bool = False
    ) -> str | None:
        """Return why an accuracy asks for no more than exactly these readings; None where it does.

        find : it, where it is not kept; ended : no other readings are to follow
        """
        return self._answered(_named("standing", ended), readings, ends_by_accuracy, lambda: find() or "") or None

    def sentence(self, of: str, readings: tuple[Reading, ...], find: Callable[[], str]) -> str:
        """Return a sentence about exactly these readings in the language that is spoken.  find : as of `standing`"""
        return self._answered(f"{of}, {spoken_now()}", readings, _is_said, lambda: str(find()))

    def watched(self, readings: tuple[Reading, ...], known: Callable[[], Estimation], ended: bool = False) -> Watched:
        """Return the e-value after exactly these readings.  known : by them, where it is not kept; ended : no more"""
        return self._answered(_named("watched", ended), readings, _is_watched, lambda: watched_so_far(known()))

    def accuracy(self, readings: tuple[Reading, ...], known: Callable[[], Estimation], ended: bool = False) -> Accuracy:
        """Return how well the machine is known by exactly these readings.  known, ended : as of `watched`"""
        name = _named("accuracy", ended)
        return Accuracy(*self._answered(name, readings, _is_accuracy, lambda: tuple(known().accuracy)))

    def seconds(self, readings: tuple[Reading, ...], find: Callable[[], float]) -> float:
        """Return the machine time that exactly these readings took, s.  find : it, where it is not kept"""
        return self._answered("seconds", readings, _is_time, find)

    def _answered(
        self,
        name: str,
        readings: tuple[Reading, ...],
        is_one: Callable[[object], TypeGuard[Answer]],
        find: Callable[[], Answer],
    ) -> Answer:
        """Return an answer, found now where none was kept or what was kept is none.  is_one : tells an answer"""
        if self._answers is None or self._readings != readings:
            self._answers, self._readings, self._found = self._recalled_answers(readings), readings, False
        kept = self._answers.get(name)
        if is_one(kept):
            return kept
        found = find()
        self._answers[name], self._found = found, True
        return found

    def _recalled_answers(self, readings: tuple[Reading, ...]) -> dict[str, object]:
        if len(readings) < FEWEST_ANSWERED:
            return {}
        found = _read(answers_beside(self._record), self._key_of(readings))
        return found if isinstance(found, dict) else {}

    def close(self) -> None:
        """Write the answers where new ones were found."""
        if self._found and self._record.exists():
            self._found = False
            self.leave(self._record)

    def leave(self, record: Path) -> None:
        """Write the answers beside a record: this one, or a copy of it."""
        if self._answers and len(self._readings) >= FEWEST_ANSWERED:
            with contextlib.suppress(OSError, pickle.PicklingError, TypeError, RecursionError, MemoryError):
                _write(answers_beside(record), self._key_of(self._readings), self._answers)

    def _key_of(self, readings: tuple[Reading, ...]) -> str:
        return hashlib.sha256(f"{_key(*self._described)} {readings!r}".encode()).hexdigest()


def _begins(found: Estimation, readings: Sequence[Reading]) -> bool:
    """Return whether what was kept is of the first of these readings; not where somebody made it up in parts."""
    try:
        return found.stages.timed.begins(readings) and is_sound(found)
    except DAMAGE:
        return False


def _named(answer: str, ended: bool) -> str:
    return f"{answer} at the end" if ended else answer


def _is_said(kept: object) -> TypeGuard[str]:
    return isinstance(kept, str)


def _is_time(kept: object) -> TypeGuard[float]:
    return isinstance(kept, float) and 0.0 <= kept < math.inf


def _is_accuracy(kept: object) -> TypeGuard[tuple[float, ...]]:
    return isinstance(kept, tuple) and len(kept) == len(Accuracy._fields) and all(map(_is_time, kept))


def _is_watched(kept: object) -> TypeGuard[Watched]:
    match kept:
        case Watched(tuple() as explanations, float(), float()):
            return all(map(_is_explanation, explanations))
    return False


def _is_explanation(kept: object) -> bool:
    match kept:
        case Explanation(str() as family, str(), float(), float(), float(), float(), int() | None):
            return family in PRIOR
    return False


def kept_beside(record: Path) -> Path:
    """Return the file in which it is kept."""
    return record.with_name(f".{record.name}.known")


def answers_beside(record: Path) -> Path:
    """Return the file in which answers about all its readings are kept."""
    return record.with_name(f".{record.name}.answers")


def _write(path: Path, key: str, known: Estimation | dict[str, object]) -> None:
    """Write a file in the place of an earlier one; raises OSError."""
    buffer = io.BytesIO()
    _KnownWriter(buffer, protocol=5).dump(known)
    content = buffer.getvalue()
    write_whole(path, _TITLE + f"{key} {hashlib.sha256(content).hexdigest()}\n".encode() + content)


def _read(path: Path, key: str) -> object:
    """Return what a file holds; None where it is not whole, or was kept under another key."""
    try:
        title, said, body = path.read_bytes().split(b"\n", 2)
    except (OSError, ValueError):
        return None
    if title + b"\n" != _TITLE or said != f"{key} {hashlib.sha256(body).hexdigest()}".encode():
        return None
    try:
        return _KnownReader(io.BytesIO(body)).load()
    except DAMAGE:
        return None


def _key(*described: Event) -> str:
    """Return the key of what is known of a campaign: what describes it, and the programs that find it."""
    said = [part for event in described for part in encode(event)]
    return hashlib.sha256(json.dumps([*said, versions(), _sources()]).encode()).hexdigest()


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
