"""`axiscal salvage`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.possible import beginning_of
from axiscal.campaign.salvaging import Salvaged, salvaged
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say_either
from axiscal.cli.texts import count_text
from axiscal.ports.fleet.type_learning import campaign_with_sisters
from axiscal.record.line_form import EventText
from axiscal.record.log import rows_of
from axiscal.record.store import Record


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
    found = salvaged(record, new, None if beginning is None else _first(beginning))
    document = {"record": str(new), "readings": len(found.state.readings), "events": found.entries}
    lists = {"missing": list(found.missing), "left_out": list(found.left)}
    say_either(json, "axiscal-salvage/1", document | lists, _lines(record, new, found))


def _first(file: Path) -> EventText:
    """Return the entry with which a campaign begins: that of a record, or of a description that would begin now."""
    if file.suffix != ".toml":
        with Record.open(file, write=False) as record:
            return record.texts()[0].row
    return rows_of([beginning_of(campaign_with_sisters(file))])[0]


def _lines(record: Path, new: Path, found: Salvaged) -> list[str]:
    readings, events = count_text(len(found.state.readings), "reading"), count_text(found.entries, "event")
    lines = [f"{new} holds {readings}, from {events} of {record} that stand whole."]
    lines += [f"Missing: {words}" for words in found.missing] or ["Nothing is missing."]
    lines += [f"Left out: {words}" for words in found.left]
    if found.missing:
        lines.append("Mind: a missing entry may have taken a reading back; look at those before it.")
    return lines
