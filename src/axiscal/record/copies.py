"""Copies of a record: whole, to the letter, and only in the place of an earlier copy of the same one."""

from __future__ import annotations

from pathlib import Path

from axiscal.exceptions import RecordError
from axiscal.record.durable import write_whole
from axiscal.record.line_form import EventText
from axiscal.record.log import EventLog, in_one
from axiscal.record.store import Record, content_of, record_errors


def write_copy(log: EventLog, path: Path) -> None:
    """Write a copy of a log as a file, in the place of an earlier copy if there is one; raises as `refuse_other`."""
    if _is_itself(log, path):
        return
    refuse_other(log, path)
    with record_errors(path):
        write_whole(path, content_of(in_one([text.row for text in log.texts()]))[0])


def refuse_other(log: EventLog, path: Path) -> None:
    """Raise RecordError if there is something at `path` that is more than an earlier copy of this log."""
    if not path.exists() or _is_itself(log, path):
        return
    remedy = "Name another folder, or move it away"
    try:
        with Record.open(path, write=False) as there:
            kept = [_content(text.row) for text in there.texts()]
    except RecordError as failure:
        raise RecordError(f"A file with the name of the record is here already: {failure.what}", remedy, path) from None
    own = [_content(text.row) for text in log.texts()]
    if kept[:1] != own[:1]:
        raise RecordError("Another campaign's record is here already", remedy, path)
    if kept != own[: len(kept)]:
        raise RecordError("The copy that is here has gone on by itself", f"{remedy}; or go on with that one", path)


def _is_itself(log: EventLog, path: Path) -> bool:
    return path.exists() and log.path.exists() and path.samefile(log.path)


def _content(row: EventText) -> tuple[str, str, str]:
    return row.at, row.kind, row.payload
