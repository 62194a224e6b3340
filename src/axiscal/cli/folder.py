"""`axiscal fleet` and `axiscal shop bring`: the records of a shop in one folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.cli.arguments import Json, Records
from axiscal.cli.printing import complain, say_either, tell
from axiscal.cli.texts import count_text, micrometres
from axiscal.exceptions import RecordError
from axiscal.language.spoken import later, said
from axiscal.ports.fleet.shop_list import Brought, ShopList, ShopRecord, brought, shop_list
from axiscal.units import to_unit

_SHOWN = 12
"""Hex digits of a digest that are shown: enough to tell any two records."""
_HEADS = (
    later("machine"),
    later("measured"),
    later("readings"),
    later("target"),
    "RMS",
    "U (95 %)",
    later("agreement"),
    later("digest"),
    later("record"),
)


def fleet(folder: Records, json: Json = False) -> None:
    """List the records of a shop.

    Each line has machine, day, accuracy, target, and the digest of the record. What a record comes to is kept in your
    folder for caches, in `axiscal/fleet.json`, so that it is estimated only once; it can be thrown away. Records that
    are damaged, no records, or the same as another are named with the reason.

    \b
    Examples:
      axiscal fleet records
      axiscal fleet store:
    """
    found = shop_list(folder)
    if found.why_apart:
        tell(said("Nothing is kept for the next time: {why}.", why=found.why_apart))
    say_either(json, "axiscal-fleet/1", _document(found), _lines(found))


def _lines(found: ShopList) -> list[str]:
    rows = [tuple(map(said, _HEADS)), *(_row(each) for each in found.listed)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    for each in found.listed:
        minded = [each.known.trouble, each.remark]
        lines += [said("To be minded: {file}: {what}.", file=each.file.name, what=what) for what in minded if what]
    lines += [said("Left out: {file}: {why}.", file=file.name, why=why) for file, why in found.left_out]
    records, machines = count_text(len(found.listed), "record"), count_text(found.machines, "machine")
    events = count_text(sum(found.kinds.values()), "event")
    words = "{records} of {machines}; {events} in the folder."
    return [*lines, said(words, records=records, machines=machines, events=events)]


def _row(each: ShopRecord) -> tuple[str, ...]:
    known = each.known
    lengths = ["-" if value is None else micrometres(value) for value in (known.rms, known.expanded)]
    name = known.machine + (f" {known.serial}" if known.serial else "")
    day, target = (known.last or known.begun)[:10], known.target or "-"
    found = name, day, str(known.readings), target, *lengths, known.agreement or "-"
    return *found, each.chain[:_SHOWN], each.file.name


def _document(found: ShopList) -> dict[str, object]:
    return {
        "records": [
            {
                "record": each.file.name,
                "machine": each.known.machine,
                "serial": each.known.serial,
                "begun": each.known.begun,
                "last_reading": each.known.last or None,
                "readings": each.known.readings,
                "events": each.events,
                "target": each.known.target,
                "ended": each.known.ended or None,
                "rms_um": None if each.known.rms is None else to_unit(each.known.rms, "um"),
                "U_um": None if each.known.expanded is None else to_unit(each.known.expanded, "um"),
                "agreement": each.known.agreement or None,
                "digest": each.chain,
                "remarks": [said for said in (each.known.trouble, each.remark) if said],
            }
            for each in found.listed
        ],
        "left_out": [{"file": file.name, "why": why} for file, why in found.left_out],
        "events": dict(found.kinds),
    }


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
