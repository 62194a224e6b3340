"""`axiscal data copy`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import count_text
from axiscal.record.opening import file_name, is_stored


def copy_record(
    record: RecordFile,
    to: Annotated[
        Path | None,
        typer.Argument(metavar="TO", help="A file or a folder that exists; default: RECORD.copy."),
    ] = None,
    json: Json = False,
) -> None:
    """Copy a record, checked and whole.

    Another command may be writing to it. The copy takes the place of an earlier copy of the same record, and of nothing
    else.

    \b
    Example:
      axiscal data copy mill.axiscal /media/stick
    """

    name = file_name(record).name
    beside = Path(name) if is_stored(record) else record.with_name(f"{name}.copy")
    target = beside if to is None else to / name if to.is_dir() else to
    with Campaign.open(record, write=False) as campaign:
        campaign.copy(target)
        state = campaign.state
    if json:
        document = {"copy": str(target), "readings": len(state.readings), "event": state.last, "hash": state.name}
        say_document({"schema": "axiscal-copy/1", **document})
    else:
        count = count_text(len(state.readings), "reading")
        say(f"{target} holds {count}, up to event {state.last} of the record, {state.name[:12]}.")
