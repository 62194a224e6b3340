"""A finished campaign as text that another record carries, so that no record needs another file."""

from __future__ import annotations

import json
from pathlib import Path

from axiscal.exceptions import RecordError
from axiscal.record.events import Recorded
from axiscal.record.payload import encode
from axiscal.record.store import Record


def heritage_text(path: Path) -> str:
    """Return a campaign record as text that another record can carry; raises RecordError."""
    with Record.open(path, write=False) as record:
        state = record.state()
    created = state.created
    if created is None or not state.readings:
        raise RecordError("The record has no readings", "Name a campaign that has been measured", path)
    readings = [json.loads(encode(Recorded(reading))[1]) for reading in state.readings]
    document = {"created": json.loads(encode(created)[1]), "readings": readings}
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"), sort_keys=True)
