"""`axiscal verify`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.acceptance.check import Check
from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say, say_document
from axiscal.record.durable import write_whole
from axiscal.report.check_report import judgement_document, judgement_text, plan_lines, plan_rows


def verify(
    record: RecordFile,
    found: Annotated[
        Path | None, typer.Option(metavar="FOUND.csv", help="Readings without the tables (as found).")
    ] = None,
    left: Annotated[
        Path | None, typer.Option(metavar="LEFT.csv", help="The same readings with the tables (as left).")
    ] = None,
    tolerance: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Largest deviation allowed; default: from the target.")
    ] = None,
    to: Annotated[
        str, typer.Option(metavar="CONTROLLER", help="The control whose tables are loaded, as in `axiscal export`.")
    ] = "csv",
    points: Annotated[
        int | None,
        typer.Option(
            min=2, max=200, help="How many places to check; default: as many as the tables need, 12 at least."
        ),
    ] = None,
    plan: Annotated[Path | None, typer.Option(metavar="FILE.csv", help="Where to write the list of places.")] = None,
    source: Annotated[
        str | None, typer.Option(metavar="SOURCE", help="Read without a person: sim:SEED, truth:FILE, linuxcnc:SEED.")
    ] = None,
    json: Json = False,
) -> None:
    """Check a compensated machine at places that were not read before, and say pass, fail or undecided.

    First it plans: each table at its ends and where it corrects most, then where the machine should be worst, and best.
    Read these places without the tables and with them; then give both files. A reading decides only with its
    uncertainty (ISO 14253-1). A table that is missing or has the wrong sign fails; tables not checked are named.

    \b
    Examples:
      axiscal verify mill.axiscal --points 12 --plan check.csv
      axiscal verify mill.axiscal --found found.csv --left left.csv --tolerance "5 um"
      axiscal verify mill.axiscal --source linuxcnc:7 --to linuxcnc
    """

    if (found is None) != (left is None):
        raise typer.BadParameter("give --found and --left together, or neither to get a plan")
    if found is not None and (plan is not None or source is not None):
        raise typer.BadParameter("--plan and --source are for new readings, --found and --left for readings taken")
    with Campaign.open(record, write=False) as campaign:
        check = Check.of(campaign, to)
    if found is not None and left is not None:
        readings = check.read(found, left)
    elif source is not None:
        readings = check.asked(source, check.planned(points))
    else:
        _plan(check, points, plan, json)
        return
    judgement = check.judged(readings, tolerance)
    if json:
        say_document(judgement_document(judgement))
    else:
        say(judgement_text(judgement))


def _plan(check: Check, points: int | None, plan: Path | None, json: bool) -> None:

    chosen = check.planned(points)
    rows = plan_rows(check, chosen)
    sheet = check.sheet(chosen)
    if plan is not None:
        write_whole(plan, sheet.encode())
    if json:
        say_document({"schema": "axiscal-verify/1", "plan": rows})
        return
    for line in plan_lines(rows):
        say(line)
    if plan is not None:
        values = ", ".join(name for name in sheet.splitlines()[0].split(",") if name.startswith("value"))
        say(f"\nCopy {plan} to found.csv and left.csv, and fill in {values} without the tables and with them.")
