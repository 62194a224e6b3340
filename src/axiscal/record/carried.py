"""What a campaign carries of the one before: its readings as text that a record can hold."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path

from axiscal.document.gone import instead_of
from axiscal.exceptions import RecordError
from axiscal.record.accepted import Bumped
from axiscal.record.events import Warmed
from axiscal.record.payload import as_text
from axiscal.record.store import Record

TYPE = "axiscal-type/1"
"""The schema of what a type has taught."""


def carried_text(path: Path) -> str:
    """Return what a campaign names as its prior as text that a record can carry; raises RecordError.

    path : of a campaign record
    """
    with suppress(OSError), path.open("rb") as file:  # the record says what is wrong with it
        if TYPE.encode() in file.read(200):
            raise RecordError("{schema} is gone", instead_of("files", TYPE), path, schema=TYPE)
    state = Record.open(path, write=False).state()
    created = state.created
    if created is None or not state.readings:
        raise RecordError("The record has no readings", "Name a campaign that has been measured", path)
    bumps = *carried_bumps(created.prior_text), *state.told(Bumped)
    kept = {"readings": state.readings, "mounted": state.mounted, "warmed": state.told(Warmed), "bumped": bumps}
    return as_text({name: of for name, of in kept.items() if of} | {"created": created})


def carried_bumps(text: str) -> tuple[Bumped, ...]:
    """Return the bumps of a machine's controls in such a text; of a type there are none."""
    with suppress(ValueError, TypeError, AttributeError):  # what else is damaged in it is said where it is estimated by
        return tuple(Bumped(**each) for each in json.loads(text).get("bumped", ()))
    return ()
