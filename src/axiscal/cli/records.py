"""`axiscal data copy`, `salvage` and `sign`."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.evidence import signed_text
from axiscal.campaign.possible import beginning_of, described
from axiscal.campaign.salvaging import salvaged
from axiscal.cli.arguments import Json, OwnRecord, RecordFile
from axiscal.cli.printing import say_either
from axiscal.cli.texts import opened_to_write
from axiscal.description.campaign import read_campaign
from axiscal.document.consent import asking
from axiscal.exceptions import CodeError, NewerError
from axiscal.language.spoken import counted, said
from axiscal.record.copies import write_copy
from axiscal.record.log import rows_of
from axiscal.record.signing import key_file, make_key
from axiscal.record.store import opened_log


def copy_record(
    record: RecordFile,
    to: Annotated[
        Path | None, typer.Argument(metavar="TO", help="A file or a folder that exists; default: RECORD.copy.")
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

    beside = record.with_name(f"{record.name}.copy")
    target = beside if to is None else to / record.name if to.is_dir() else to
    with opened_log(record, write=False) as log:
        try:
            with suppress(CodeError), asking(None):
                described(log)  # checked
            readings: int | None = len(log.state().readings)
        except NewerError:  # only a newer version can know
            readings = None
        write_copy(log, target)
        last, name = log.last(), log.name
    count = counted("{count} reading", "{count} readings", readings or 0)
    if readings is None:
        count = counted("{count} event", "{count} events", last)
    document = {"copy": str(target), "readings": readings, "event": last, "hash": name}
    words = said(
        "{copy} holds {count}, up to event {last} of the record, {digest}.",
        copy=target,
        count=count,
        last=last,
        digest=name[:12],
    )
    say_either(json, "axiscal-copy/1", document, [words])


def salvage(
    record: RecordFile,
    new: Annotated[Path, typer.Argument(metavar="NEW", help="The record to make.")],
    beginning: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A copy of the record, or its campaign.toml, where event 1 is lost."),
    ] = None,
    json: Json = False,
) -> None:
    """Make a new record of all that stands whole in a damaged one.

    An event counts where sums and chains show that it is as it was written. What is missing is printed, and kept as a
    note in the new record. The damaged file stays as it is.

    \b
    Example:
      axiscal data salvage mill.axiscal mill-salvaged.axiscal
    """
    first = None
    if beginning is not None and beginning.suffix == ".toml":  # what would begin now
        first = rows_of([beginning_of(read_campaign(beginning))])[0]
    elif beginning is not None:
        with opened_log(beginning, write=False) as begun:
            first = begun.texts()[0].row
    found = salvaged(record, new, first)
    document = {"record": str(new), "readings": len(found.state.readings), "events": found.entries}
    lists = {"missing": list(found.missing), "left_out": list(found.left), "seams": list(found.seams)}
    readings = counted("{count} reading", "{count} readings", len(found.state.readings))
    events = counted("{count} event", "{count} events", found.entries)
    lines = [f"{new} holds {readings}, from {events} of {record} that stand whole."]
    lines += [f"Missing: {words}" for words in found.missing] or ["Nothing is missing."]
    lines += [f"Left out: {words}" for words in found.left]
    lines += [f"Seam: {words}" for words in found.seams]
    if found.missing:
        lines.append("Mind: a missing entry may have taken a reading back; look at those before it.")
    say_either(json, "axiscal-salvage/1", document | lists, lines)


def sign(record: OwnRecord, json: Json = False) -> None:
    """Sign a record with your key.

    Your key is made the first time; keep its file to yourself. The signature stands for all that was recorded before.

    \b
    Example:
      axiscal data sign mill.axiscal
    """
    make_key()
    with opened_to_write(record) as campaign:
        campaign.sign()
        found = campaign.signed()
        assert found is not None
        document = {"record": str(record), "event": found.number, **found.by._asdict(), "holds": found.holds}
        words = f"{record}: {signed_text(campaign)}. Public key: {found.by.key}. Keep {key_file()} to yourself."
        say_either(json, "axiscal-signature/1", document, [words])
