"""`axiscal shop due`."""

from __future__ import annotations

from datetime import UTC, date, datetime
from typing import Annotated

import typer

from axiscal.cli.arguments import Json, Records, positive_length
from axiscal.cli.printing import say_either
from axiscal.cli.texts import count_text, micrometres
from axiscal.language.spoken import said
from axiscal.ports.fleet.due_dates import DueMachine, Shop, due_dates, titles
from axiscal.record.copies import records_of
from axiscal.units import to_unit


def due(
    folder: Records,
    target: Annotated[
        str | None, typer.Option(metavar="RMS", help='What is to be kept, such as "4 um"; default: of each campaign.')
    ] = None,
    today: Annotated[str | None, typer.Option(metavar="YYYY-MM-DD", help="Another day than today.")] = None,
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
    wanted = None if target is None else positive_length(target)
    found = due_dates(records_of(folder), _day(today), wanted, tables)
    say_either(json, "axiscal-due/1", _document(found), _lines(found, tables))


def _day(text: str | None) -> date:
    if text is None:
        return datetime.now(UTC).date()
    try:
        return date.fromisoformat(text)
    except ValueError:
        raise typer.BadParameter(
            said('"{text}" is no day such as 2026-03-01', text=text), param_hint="--today"
        ) from None


def _lines(found: Shop, tables: str | None) -> list[str]:
    names = titles(found.machines)
    width = max(map(len, names))
    last, now, target, when = said("last"), said("RMS now"), said("target"), said("due")
    lines = [f"{said('machine'):{width}}  {last:10}  {now:>9}  {target:>9}  {when}"]
    lines += [_line(machine, f"{name:{width}}") for machine, name in zip(found.machines, names, strict=True)]
    (once, once_std), (year, year_std) = found.aging.at_once, found.aging.yearly
    pairs = count_text(found.aging.pairs, "pair")
    learnt, assumed = "learnt from {pairs} of campaigns", "assumed: no machine was measured again"
    source = said(learnt, pairs=pairs) if found.aging.pairs else said(assumed)
    words = "Kept at once {once:.2f} ± {once_std:.2f}, and in a year {year:.2f} ± {year_std:.2f} of it: {source}."
    lines.append(said(words, once=once, once_std=once_std, year=year, year_std=year_std, source=source))
    all_of, those = "Tables: all that was found is taken away.", "Tables: those of {control}."
    lines.append(said(all_of) if tables is None else said(those, control=tables))
    return lines + [said("Left out: {file}: {why}.", file=each.file, why=each.left_out) for each in found.left_out]


def _line(machine: DueMachine, name: str) -> str:
    day = said("not within 20 years") if machine.due is None else machine.due.isoformat()
    if machine.due == machine.last:
        day = _at_once(machine)
    rms, target = micrometres(machine.now), micrometres(machine.target)
    time = said("{minutes:.0f} min the last time", minutes=machine.minutes)
    if machine.renewed:
        time = said("{time}, renewed since: {parts}", time=time, parts=", ".join(machine.renewed))
    return f"{name}  {machine.last}  {rms:>9}  {target:>9}  {day} ({time})"


def _at_once(machine: DueMachine) -> str:
    if machine.then > machine.target:
        return said("at once: its last campaign was not as good")
    words = "at once: its last campaign came to {rms}, and what is not kept is more"
    return said(words, rms=micrometres(machine.then))


def _document(found: Shop) -> dict[str, object]:
    (once, once_std), (year, year_std) = found.aging.at_once, found.aging.yearly
    return {
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
        "kept_at_once": {"mean": once, "std": once_std},
        "kept_in_a_year": {"mean": year, "std": year_std},
        "pairs": found.aging.pairs,
        "left_out": [{"file": each.file, "why": each.left_out} for each in found.left_out],
    }
