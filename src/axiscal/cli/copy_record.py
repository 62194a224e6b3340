"""`axiscal data copy`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.possible import described
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say_either
from axiscal.cli.texts import count_text
from axiscal.exceptions import NewerError
from axiscal.language.spoken import said
from axiscal.record.copies import write_copy
from axiscal.record.log import EventLog
from axiscal.record.opening import file_name, is_stored, opened_log


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
    with opened_log(record, write=False) as log:
        readings = _readings(log)
        write_copy(log, target)
        last, name = log.last(), log.name
    count = count_text(last, "event") if readings is None else count_text(readings, "reading")
    document = {"copy": str(target), "readings": readings, "event": last, "hash": name}
    words = said(
        "{copy} holds {count}, up to event {last} of the record, {digest}.",
        copy=target,
        count=count,
        last=last,
        digest=name[:12],
    )
    say_either(json, "axiscal-copy/1", document, [words])


def _readings(log: EventLog) -> int | None:
    """Return how many readings a record has, checked; None where only a newer version can know."""
    try:
        described(log)
        return len(log.state().readings)
    except NewerError:
        return None
