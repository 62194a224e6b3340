"""`axiscal verify`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.arguments import Json, RecordFile
from axiscal.cli.printing import say, say_document, tell_progress
from axiscal.document.durable import write_whole
from axiscal.evaluation.acceptance.check import Check
from axiscal.measurement.place import Places
from axiscal.present.check_answer import check_answer, check_text, plan_lines, plan_rows


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
        str | None,
        typer.Option(
            metavar="SOURCE",
            help="Read without a person: sim:SEED, truth:FILE, linuxcnc:SEED; or by linuxcnc-live:HOST into FOUND and "
            "LEFT.",
        ),
    ] = None,
    loaded: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="With linuxcnc-live: the exported folder, for LinuxCNC is to hold its files."),
    ] = None,
    json: Json = False,
) -> None:
    """Check a compensated machine at places not read before.

    It says pass, fail or undecided. First it plans: each table at its ends and where it corrects most, then where the
    machine should be worst, and best. Read these places without the tables and with them; then give both files. A
    reading decides only with its uncertainty (ISO 14253-1). A table that is missing or has the wrong sign fails; tables
    not checked are named.

    \b
    Examples:
      axiscal verify mill.axiscal --points 12 --plan check.csv
      axiscal verify mill.axiscal --found found.csv --left left.csv --tolerance "5 um"
      axiscal verify mill.axiscal --source linuxcnc:7 --to linuxcnc
      axiscal verify mill.axiscal --to linuxcnc-volumetric --source linuxcnc-live --found found.csv --left left.csv
    """

    if (found is None) != (left is None):
        raise typer.BadParameter("give --found and --left together, or neither to get a plan")
    if found is not None and left is not None and found.absolute() == left.absolute():
        raise typer.BadParameter("--found and --left are one file, and without and with the tables are two")
    kind, _, host = (source or "").partition(":")
    live = kind == "linuxcnc-live"
    if live and (found is None or plan is not None):
        raise typer.BadParameter("linuxcnc-live reads into two files: give --found and --left, and no --plan")
    if loaded is not None and not live:
        raise typer.BadParameter("--loaded is for --source linuxcnc-live")
    if found is not None and not live and (plan is not None or source is not None):
        raise typer.BadParameter("--plan and --source are for new readings, --found and --left for readings taken")
    with Campaign.open(record, write=False) as campaign:
        check = Check.of(campaign, to)
    if found is not None or source is not None:
        check.allowed(tolerance)  # before anything is touched
    if live and found is not None and left is not None:
        places = check.planned(points, "sphere", check.allowed(tolerance))
        to_do = _read_live(check, host, places, (found, left), loaded)
        if to_do:
            _say_next(to_do, json)
            return
    if found is not None and left is not None:
        readings = check.read(found, left)
    elif source is not None:
        readings = check.asked(source, check.planned(points, tolerance=check.allowed(tolerance)))
    else:
        _plan(check, check.planned(points, tolerance=check.tightest(tolerance)), plan, json)
        return
    answer = check_answer(check.judged(readings, tolerance), len(readings[0]))
    if json:
        say_document(answer.model_dump(mode="json", by_alias=True))
    else:
        say(check_text(answer))


def _read_live(check: Check, host: str, places: Places, files: tuple[Path, Path], loaded: Path | None) -> str:
    """Let LinuxCNC read what is missing, without the tables or with them; returns what is to be done next."""
    from axiscal.ports.linuxcnc.live import InForce, attached_to

    machine = check.description.machine
    with_tables = InForce(True) if loaded is None else InForce.of(loaded)
    before, after = check.sheets(places, *files)
    if not before.complete():
        found = InForce(bool(check.description.compensation_active))
        before.fill(lambda: attached_to(host, machine, found), _tell_read)
        if not after.complete():
            return (
                f"{before.file} holds the readings as found. Load the exported files and switch them on, then give the "
                f"same command again: it reads as left, into {after.file}."
            )
    if not after.complete():
        after.fill(lambda: attached_to(host, machine, with_tables), _tell_read)
    return ""


def _tell_read(file: Path, read: int, of: int) -> None:
    tell_progress(f"{file}: reading {read} of {of}")


def _say_next(text: str, json: bool) -> None:
    if json:
        say_document({"schema": "axiscal-verify/1", "verdict": None, "next": text})
    else:
        say(text)


def _plan(check: Check, chosen: Places, plan: Path | None, json: bool) -> None:
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
