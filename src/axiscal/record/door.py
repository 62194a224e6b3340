"""The door of a record: what is refused there, and what the file system may say, in sentences."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator
from pathlib import Path

from axiscal.document.durable import HeldError, read_at
from axiscal.exceptions import NewerError, RecordError
from axiscal.language.spoken import said
from axiscal.record.lines import FORM, DamageError, counts

BINARY = getattr(os, "O_BINARY", 0)  # only Windows has it
ALL = 1 << 62
"""Bytes: as many as there are."""
_LINES = re.compile(rb' \{"a":"[0-9a-f]{64}"| \d{4}-\d\d-\d\dT')
"""What a line of any form has behind its hash."""


def opened(file: Path, path: Path) -> int:
    """Return a file opened to be read; raises RecordError for what is none."""
    if file.exists() and not file.is_file():
        inside = next(iter(sorted(path.glob("*.axiscal"))), "a file *.axiscal")
        raise RecordError("This is a folder, a pipe or a device", "Name the record: {inside}", path, inside=inside)
    try:
        return os.open(file, os.O_RDONLY | BINARY)
    except FileNotFoundError:
        raise RecordError("There is no such record", "Start one with `axiscal step start CAMPAIGN`", path) from None
    except OSError as error:
        remedy = "Name a file you may read"
        raise RecordError("The record cannot be opened: {strerror}", remedy, path, strerror=error.strerror) from error


def refuse_other_form(block: bytes, handle: int, path: Path) -> None:
    """Raise RecordError for a file that is no record, or of a form to come, DamageError for a head that was changed."""
    try:
        counts(block)
    except DamageError:
        form = re.match(rb"axiscal record (\d{1,9}) ", block)
        if form is not None and int(form[1]) > FORM:
            what = "This record was written by a newer axiscal (form {form}; this one knows {known})"
            remedy = "Install the newer version to go on with it; nothing was changed"
            raise NewerError(what, remedy, path, form=int(form[1]), known=FORM) from None
        if form is not None or _LINES.search(read_at(handle, 0, ALL)):
            raise
        if block[:16] == b"SQLite format 3\0" and block[68:72] == b"AXIS":
            remedy = "Bring it into today's: python tools/bring_first_form.py RECORD NEW"
            raise RecordError("This record is of the first form, an SQLite database", remedy, path) from None
        remedy = "Name a record, a file *.axiscal; `axiscal step start CAMPAIGN` makes one"
        raise RecordError("This file is not a campaign record", remedy, path) from None


@contextlib.contextmanager
def record_errors(path: Path) -> Iterator[None]:
    """Turn what the file system or a foreign writer did into a RecordError."""
    try:
        yield
    except NewerError as error:
        raise error.placed(path) from None
    except DamageError as error:
        raise RecordError("The record is damaged: {reason}", restoring(path), path, reason=error) from error
    except FileExistsError:
        refuse_existing(path)
        raise
    except HeldError:
        remedy = "Close it or wait, then give the command again"
        raise RecordError("Another program holds this record and is writing", remedy, path) from None
    except OSError as error:
        what = "The record cannot be written here ({reason})"
        remedy = "Put it where there is room and you may write; everything acknowledged before is kept"
        raise RecordError(what, remedy, path, reason=error.strerror or error) from error


def refuse_existing(path: Path) -> None:
    """Raise RecordError if there is something at `path` already."""
    if path.exists():
        remedy = "Go on with it by `axiscal step next`, or name another file for the record"
        raise RecordError("This file exists already", remedy, path) from None


def restoring(path: Path) -> str:
    """Return what to do about a damaged record."""
    what = "Restore it from a copy, or save what stands whole: {command}; the file has been left as it was"
    return said(what, command=repairing(path))


def repairing(path: Path) -> str:
    """Return the command that makes a new record of what stands whole."""
    return f"axiscal data repair {path} {path.with_name(f'{path.stem}-repaired.axiscal')}"
