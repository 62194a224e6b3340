"""`axiscal fleet`."""

from __future__ import annotations

from axiscal.cli.arguments import Json, Records
from axiscal.cli.printing import say_either, tell
from axiscal.cli.texts import count_text, micrometres
from axiscal.language.spoken import later, said
from axiscal.ports.fleet.shop_list import ShopList, ShopRecord, shop_list
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
