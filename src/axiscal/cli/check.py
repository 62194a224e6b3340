"""`axiscal shop check`."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say_either
from axiscal.description.placed_readings import placed_readings
from axiscal.document.durable import write_whole
from axiscal.measurement.readers.files import read_any
from axiscal.ports.fleet.quick_check import CHANCE, READINGS, Checked, QuickCheck
from axiscal.ports.fleet.worn_machine import YEAR, aging


def check(
    record: RecordFile,
    found: Annotated[
        Path | None, typer.Argument(metavar="READINGS.csv", help="The check readings; without it, where to take them.")
    ] = None,
    readings: Annotated[int, typer.Option(metavar="N", help="So many readings.", min=2, max=200)] = READINGS,
    plan: Annotated[
        Path | None, typer.Option(metavar="FILE.csv", help="Write the places as a file to fill in.")
    ] = None,
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
        begun = datetime.fromisoformat(campaign.begun)
        share = kept if kept is not None else _usual(begun)
        asked = QuickCheck.of(campaign, share, tables)
    if found is None:
        _planned(asked, readings, plan, json)
        return
    described = asked.case.description
    judged = asked.judged(placed_readings(read_any(found), described, found), tables_active or tables is not None)
    document = {
        "in_order": judged.in_order,
        "chance": judged.chance,
        "chi_square": judged.chi_square,
        "numbers": judged.count,
        "kept": share,
    }
    say_either(json, "axiscal-check/1", document, [_said(judged, share)])


def _usual(begun: datetime) -> float:
    """Return the share that is kept as a rule since a day."""
    since = datetime.now(UTC) - (begun if begun.tzinfo else begun.replace(tzinfo=UTC))
    return aging([]).kept(max(since, timedelta(0)).total_seconds() / YEAR)[0]


def _planned(asked: QuickCheck, readings: int, plan: Path | None, as_json: bool) -> None:
    places = asked.planned(readings)
    sheet = asked.sheet(places)
    if plan is not None:
        write_whole(plan, sheet.encode())
    lines = sheet.splitlines()
    told = lines if plan is None else [f"{len(places)} places are in {plan}: fill in the values, then check it."]
    say_either(as_json, "axiscal-check/1", {"places": lines, "readings": len(places)}, told)


def _said(judged: Checked, kept: float) -> str:
    figures = f"chi-square {judged.chi_square:.1f} of {judged.count}, P = {judged.chance:.2g}, {kept:.0%} taken as kept"
    if judged.in_order:
        return f"In order: the readings are as the last campaign and its age foretell ({figures})."
    return (
        f"Measure again: a machine that changed as is usual would read so in less than {CHANCE:.0%} of all cases "
        f"({figures})."
    )
