"""Copies of a record: whole, to the letter, and only in the place of an earlier copy of the same one."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from axiscal.document.durable import write_whole
from axiscal.document.gone import instead_of
from axiscal.exceptions import RecordError
from axiscal.record.accepted import Bumped
from axiscal.record.events import Event, Recorded
from axiscal.record.line_form import EventText
from axiscal.record.log import EventLog, in_one
from axiscal.record.payload import encode
from axiscal.record.store import Record, content_of, opened_log, record_errors

TYPE = "axiscal-type/1"
"""The schema of what a type has taught."""


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
        what = "A file with the name of the record is here already: {why}"
        raise RecordError(what, remedy, path, why=failure.what) from None
    own = [_content(text.row) for text in log.texts()]
    if kept[:1] != own[:1]:
        raise RecordError("Another campaign's record is here already", remedy, path)
    if kept != own[: len(kept)]:
        remedy = "Name another folder, or move it away; or go on with that one"
        raise RecordError("The copy that is here has gone on by itself", remedy, path)


def _is_itself(log: EventLog, path: Path) -> bool:
    return path.exists() and log.path.exists() and path.samefile(log.path)


def _content(row: EventText) -> tuple[str, str, str]:
    return row.at, row.kind, row.payload


def carried_text(path: Path) -> str:
    """Return what a campaign names as its prior as text that a record can carry; raises RecordError.

    path : of a campaign record
    """
    with suppress(OSError), path.open("rb") as file:  # the record says what is wrong with it
        if TYPE.encode() in file.read(200):
            raise RecordError("{schema} is gone", instead_of("files", TYPE), path, schema=TYPE)
    with opened_log(path, write=False) as record:
        state = record.state()
    created = state.created
    if created is None or not state.readings:
        raise RecordError("The record has no readings", "Name a campaign that has been measured", path)
    bumps = *carried_bumps(created.prior_text), *state.bumps
    kept: dict[str, Sequence[Event]] = {"mounted": state.mounted, "warmed": state.warmed, "bumped": bumps}
    kept = {"readings": [Recorded(reading) for reading in state.readings]} | {k: of for k, of in kept.items() if of}
    document: dict[str, Any] = {name: [json.loads(encode(each)[1]) for each in of] for name, of in kept.items()}
    document["created"] = json.loads(encode(created)[1])
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"), sort_keys=True)


def carried_bumps(text: str) -> tuple[Bumped, ...]:
    """Return the bumps of a machine's controls in such a text; of a type there are none."""
    with suppress(ValueError, TypeError, AttributeError):  # what else is damaged in it is said where it is estimated by
        return tuple(Bumped(**each) for each in json.loads(text).get("bumped", ()))
    return ()
