"""`axiscal fleet`, `shop bring`, `due` and `check`: the records of a shop, and whether a machine has changed."""

from __future__ import annotations

from datetime import UTC, date, datetime, timedelta
from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.cli.arguments import Json, PlacesFile, RecordFile, Records, above_zero
from axiscal.cli.printing import complain, say_either, tell
from axiscal.description.placed_readings import placed_readings
from axiscal.document.durable import write_whole
from axiscal.exceptions import RecordError
from axiscal.language.spoken import counted, ending, later, said
from axiscal.measurement.readers.csv_readings import Around
from axiscal.measurement.readers.files import recognised
from axiscal.ports.fleet.due_dates import DueMachine, Shop, due_dates, titles
from axiscal.ports.fleet.quick_check import CHANCE, READINGS, QuickCheck
from axiscal.ports.fleet.shop_list import Brought, ShopList, ShopRecord, brought, shop_list
from axiscal.ports.fleet.worn_machine import YEAR, aging
from axiscal.record.copies import records_of
from axiscal.units import said_quantity, to_unit


def due(
    folder: Records,
    target: Annotated[
        str | None, typer.Option(metavar="RMS", help='What is to be kept, such as "4 um"; default: of each campaign.')
    ] = None,
    today: Annotated[
        date | None, typer.Option(metavar="YYYY-MM-DD", parser=date.fromisoformat, help="Another day than today.")
    ] = None,
    tables: Annotated[
        str | None,
        typer.Option(metavar="CONTROLLER", help="Whose tables are loaded; default: all that was found is taken away."),
    ] = None,
    json: Json = False,
) -> None:
    """Say when each machine is due for calibration.

    It says how far off each is by now with the tables of its last campaign, and until when that will do. How much a
    machine changes, at once and with the years, is learnt from machines that were measured again: records with the same
    `serial` in machine.toml. Where none was, nine tenths are taken to be kept, and as much in a year.

    \b
    Examples:
      axiscal shop due records
      axiscal shop due records --target "4 um"
      axiscal shop due store: --tables sinumerik
    """
    wanted = None if target is None else above_zero(target, "length")
    found = due_dates(records_of(folder), today or datetime.now(UTC).date(), wanted, tables)
    document = {
        "machines": [
            {
                "machine": each.name,
                "record": each.record.name,
                "last": each.last.isoformat(),
                "minutes": each.minutes,
                "target_um": to_unit(each.target, "um"),
                "rms_then_um": to_unit(each.then, "um"),
                "rms_um": to_unit(each.now, "um"),
                "due": None if each.due is None else each.due.isoformat(),
                "renewed": list(each.renewed),
            }
            for each in found.machines
        ],
        "kept_at_once": dict(zip(("mean", "std"), found.aging.at_once, strict=True)),
        "kept_in_a_year": dict(zip(("mean", "std"), found.aging.yearly, strict=True)),
        "pairs": found.aging.pairs,
        "left_out": [{"file": each.file, "why": each.left_out} for each in found.left_out],
    }
    say_either(json, "axiscal-due/1", document, _lines_of_due(found, tables))


def _lines_of_due(found: Shop, tables: str | None) -> list[str]:
    names = titles(found.machines)
    width = max(map(len, names))
    last, now, target, when = said("last"), said("RMS now"), said("target"), said("due")
    lines = [f"{said('machine'):{width}}  {last:10}  {now:>9}  {target:>9}  {when}"]
    lines += [_line(machine, f"{name:{width}}") for machine, name in zip(found.machines, names, strict=True)]
    (once, once_std), (year, year_std) = found.aging.at_once, found.aging.yearly
    pairs = counted("{count} pair", "{count} pairs", found.aging.pairs)
    learnt, assumed = "learnt from {pairs} of campaigns", "assumed: no machine was measured again"
    source = said(learnt, pairs=pairs) if found.aging.pairs else said(assumed)
    words = "Kept at once {once:.2f} ± {once_std:.2f}, and in a year {year:.2f} ± {year_std:.2f} of it: {source}."
    lines.append(said(words, once=once, once_std=once_std, year=year, year_std=year_std, source=source))
    all_of, those = "Tables: all that was found is taken away.", "Tables: those of {control}."
    lines.append(said(all_of) if tables is None else said(those, control=tables))
    return lines + [said("Left out: {file}: {why}.", file=each.file, why=each.left_out) for each in found.left_out]


def _line(machine: DueMachine, name: str) -> str:
    rms, target = (said_quantity(each, "um") for each in (machine.now, machine.target))
    time = said("{minutes:.0f} min the last time", minutes=machine.minutes)
    if machine.renewed:
        time = said("{time}, renewed since: {parts}", time=time, parts=", ".join(machine.renewed))
    return f"{name}  {machine.last}  {rms:>9}  {target:>9}  {machine.day_text} ({time})"


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


def fleet(
    folder: Records,
    estimate: Annotated[bool, typer.Option("--estimate", help="Estimate the others; hundreds take minutes.")] = False,
    json: Json = False,
) -> None:
    """List the records of a shop.

    Each line has machine, day, accuracy, target, and the digest of the record. RMS, U and agreement are what a campaign
    came to when it ended; "-" stands for one that goes on, or that an earlier version ended. Records that are damaged,
    no records, or the same as another are named with the reason.

    \b
    Examples:
      axiscal fleet records
      axiscal fleet store:
    """
    found = shop_list(folder, estimate)
    document = {
        "records": [
            {
                "record": each.copy.file.name,
                "machine": each.machine,
                "serial": each.serial,
                "begun": each.begun,
                "last_reading": each.last or None,
                "readings": each.readings,
                "events": len(each.copy.chains),
                "target": each.target,
                "ended": each.ended or None,
                "rms_um": None if each.result.rms is None else to_unit(each.result.rms, "um"),
                "U_um": None if each.result.expanded is None else to_unit(each.result.expanded, "um"),
                "agreement": each.result.agreement or None,
                "digest": each.copy.chain,
                "remarks": list(each.remarks),
            }
            for each in found.listed
        ],
        "left_out": [{"file": file.name, "why": why} for file, why in found.left_out],
        "events": dict(found.kinds),
    }
    say_either(json, "axiscal-fleet/1", document, _lines(found))


def _lines(found: ShopList) -> list[str]:
    rows = [tuple(map(said, _HEADS)), *(_row(each) for each in found.listed)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    minded = [(each.copy.file.name, what) for each in found.listed for what in each.remarks]
    lines += [said("To be minded: {file}: {what}.", file=file, what=what) for file, what in minded]
    lines += [said("Left out: {file}: {why}.", file=file.name, why=why) for file, why in found.left_out]
    records = counted("{count} record", "{count} records", len(found.listed))
    machines = counted("{count} machine", "{count} machines", found.machines)
    events = counted("{count} event", "{count} events", sum(found.kinds.values()))
    words = "{records} of {machines}; {events} in all."
    return [*lines, said(words, records=records, machines=machines, events=events)]


def _row(each: ShopRecord) -> tuple[str, ...]:
    result = each.result
    lengths = ["-" if value is None else said_quantity(value, "um") for value in (result.rms, result.expanded)]
    name = each.machine + (f" {each.serial}" if each.serial else "")
    day, target = (each.last or each.begun)[:10], each.target or "-"
    found = name, day, str(each.readings), target, *lengths, result.agreement or "-"
    return *found, each.copy.chain[:_SHOWN], each.copy.file.name


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
        lines = list[str]()
        for record, found in done:
            added = counted("{count} event", "{count} events", found.events)
            how = "is new" if found.what == "new" else "has gone on"
            there = f"{record}: the folder has it, in {found.file}."
            lines.append(there if found.what == "there already" else f"{record}: {found.file} {how}, by {added}.")
        say_either(json, "axiscal-bring/1", document, lines)
    for refused in faults:
        complain(str(refused))
    if faults:
        raise typer.Exit(1)


def check(
    record: RecordFile,
    found: Annotated[
        Path | None, typer.Argument(metavar="READINGS.csv", help="The check readings; without it, where to take them.")
    ] = None,
    readings: Annotated[int, typer.Option(metavar="N", help="So many readings.", min=2, max=200)] = READINGS,
    plan: PlacesFile = None,
    kept: Annotated[
        float | None,
        typer.Option(
            metavar="P", help="Share of each error that is as it was; default: by the time since.", min=0.0, max=1.0
        ),
    ] = None,
    tables_active: Annotated[
        bool,
        typer.Option(
            "--tables-active", help="They were taken with tables of this campaign that take all away that was found."
        ),
    ] = False,
    tables: Annotated[
        str | None,
        typer.Option(metavar="CONTROLLER", help="They were taken with the tables of this campaign for this control."),
    ] = None,
    json: Json = False,
) -> None:
    """Check by a dozen readings whether a machine has changed.

    It says whether the machine is still as its last campaign left it, or needs a new campaign. First it names
    the places that tell most of a machine that has changed since. Then it judges the readings: out of order is what a
    machine that changes as is usual would read in less than one of a hundred cases.

    \b
    Examples:
      axiscal shop check mill.axiscal --plan check.csv
      axiscal shop check mill.axiscal check.csv
      axiscal shop check mill.axiscal check.csv --tables sinumerik
    """
    with Campaign.open(record, write=False) as campaign:
        since = max(datetime.now(UTC) - datetime.fromisoformat(campaign.begun), timedelta(0))
        share = aging([]).kept(since.total_seconds() / YEAR)[0] if kept is None else kept
        asked, stated = QuickCheck.from_campaign(campaign, share, tables), campaign.description
    if found is None:
        places = asked.planned(readings)
        sheet = asked.sheet(places)
        lines = told = sheet.splitlines()
        if plan is not None:
            write_whole(plan, sheet.encode())
            again = f"axiscal shop check {quote(str(record))} {quote(str(plan))}"
            filled = said("{count} places are in {plan}: fill in the values.", count=len(places), plan=plan)
            told = [filled, *ending({said("Next"): [again]})]
        say_either(json, "axiscal-check/1", {"places": lines, "readings": len(places)}, told)
        return
    read = recognised(found, Around(stated.machine.axes, stated.setups))
    placed = placed_readings(read.found.readings, stated, found)
    refuse_implausible(placed, stated, found)
    tell(read.sentence([each.setup for each in placed]))
    judged = asked.judged(placed, tables_active or tables is not None)
    document = {
        "in_order": judged.in_order,
        "chance": judged.chance,
        "chi_square": judged.chi_square,
        "numbers": judged.count,
        "kept": share,
    }
    test = "chi-square {square:.1f} of {count}, P = {chance:.2g}, {kept:.0%} taken as kept"
    figures = said(test, square=judged.chi_square, count=judged.count, chance=judged.chance, kept=share)
    text = "Measure again: a machine that changed as usual would read so in less than {least:.0%} of cases ({figures})."
    if judged.in_order:
        text = "In order: the readings are as the last campaign and its age foretell ({figures})."
    say_either(json, "axiscal-check/1", document, [said(text, least=CHANCE, figures=figures)])
