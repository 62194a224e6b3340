"""`axiscal shop bring`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json
from axiscal.cli.printing import complain, say_either
from axiscal.cli.texts import count_text
from axiscal.exceptions import RecordError
from axiscal.ports.fleet.shop_list import Brought, brought


def bring(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The shop's folder of records.")],
    records: Annotated[list[Path], typer.Argument(metavar="RECORD...", help="Records, files *.axiscal.")],
    json: Json = False,
) -> None:
    """Bring records from a laptop into the shop's folder.

    A record that the folder has already goes on to what is brought, whatever its name. Less never overwrites more. A
    record that has gone on in the folder by itself is left there and named. Two campaigns of the same name both find
    room.

    \b
    Example:
      axiscal shop bring /srv/records mill.axiscal results/campaign.axiscal
    """
    done, faults = list[tuple[Path, Brought]](), list[RecordError]()
    for record in records:
        try:
            done.append((record, brought(folder, record)))
        except RecordError as fault:
            faults.append(fault)
    rows = [
        {"record": str(record), "file": str(found.file), "what": found.what, "events": found.events}
        for record, found in done
    ]
    document = {"brought": rows, "refused": [str(each) for each in faults]}
    if json or done:
        say_either(json, "axiscal-bring/1", document, [_words(*each) for each in done])
    for refused in faults:
        complain(str(refused))
    if faults:
        raise typer.Exit(1)


def _words(record: Path, found: Brought) -> str:
    if found.what == "there already":
        return f"{record}: the folder has it, in {found.file}."
    added = count_text(found.events, "event")
    return f"{record}: {found.file} {'is new' if found.what == 'new' else 'has gone on'}, by {added}."
