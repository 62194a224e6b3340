"""A finished campaign as text that another record carries, so that no record needs another file."""

from __future__ import annotations

import json
from pathlib import Path

from axiscal.exceptions import RecordError
from axiscal.record.events import Recorded
from axiscal.record.payload import encode
from axiscal.record.store import Record

_TYPE = '"axiscal-type/'
"""In the first line of what a type has taught, which is carried as it is."""


def carried_text(path: Path) -> str:
    """Return what a campaign names as its prior as text that a record can carry; raises RecordError.

    path : of a campaign record, or of what `axiscal type learn` wrote
    """
    try:
        with path.open("rb") as file:
            start = file.read(200)
        if start[:1] == b"{" and _TYPE in start.decode("utf-8", "replace"):
            return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise RecordError("The file of the type is damaged", "Learn it anew with `axiscal type learn`", path) from None
    except OSError:
        pass  # the record says what is wrong with it
    return heritage_text(path)


def heritage_text(path: Path) -> str:
    """Return a campaign record as text that another record can carry; raises RecordError."""
    with Record.open(path, write=False) as record:
        state = record.state()
    created = state.created
    if created is None or not state.readings:
        raise RecordError("The record has no readings", "Name a campaign that has been measured", path)
    mounted = [json.loads(encode(each)[1]) for each in state.mounted]
    readings = [json.loads(encode(Recorded(reading))[1]) for reading in state.readings]
    document = {"created": json.loads(encode(created)[1]), "readings": readings} | (
        {"mounted": mounted} if mounted else {}
    )
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
