"""`axiscal verify`."""

from __future__ import annotations

import shlex
import textwrap
from collections.abc import Sequence
from pathlib import Path

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.cli.printing import DOCUMENTS, say, say_document, say_either
from axiscal.cli.texts import opened_to_write
from axiscal.document.durable import write_whole
from axiscal.evaluation.check import Check
from axiscal.language.spoken import ending, listed, said
from axiscal.measurement.readers.text_file import exact_text
from axiscal.measurement.reading import Places
from axiscal.present.answer_of_campaign import advised_control
from axiscal.present.answer_words import WIDTH, template_of, wrapped
from axiscal.present.check_answer import check_details, check_document, check_plan, check_screen
from axiscal.tables import registry
from axiscal.tables.bump import other_way
from axiscal.tables.exporter import ExportOptions
from axiscal.units import parse_quantity


def verify(
    record: Path,
    found: Path | None = None,
    left: Path | None = None,
    tolerance: str | None = None,
    to: str | None = None,
    template: Path | None = None,
    bump: str | None = None,
    points: int | None = None,
    plan: Path | None = None,
    source: str | None = None,
    loaded: Path | None = None,
    details: bool = False,
) -> None:
    """Check a compensated machine at places not read before."""
    if bump is not None:
        _keep_sign(record, to, bump)
        return
    if (found is None) != (left is None):
        raise typer.BadParameter(said("give --found and --left together, or neither to get a plan"))
    if found is not None and left is not None and found.absolute() == left.absolute():
        raise typer.BadParameter(said("--found and --left are one file, and without and with the tables are two"))
    live = (source or "").partition(":")[0] == _LIVE
    taken = found is not None
    if (loaded is not None and not live) or (plan is not None and taken) or (source is not None and taken is not live):
        what = (
            "--found and --left are of readings taken, --plan and --source of new ones; --source {source} alone takes "
            "--found and --left, to read into, and --loaded"
        )
        raise typer.BadParameter(said(what, source=_LIVE))
    options = ExportOptions()
    if template is not None:
        options = ExportOptions(template=exact_text(template), template_name=str(template))
    with Campaign.open(record, write=False) as campaign:
        control = to or advised_control(campaign)
        registry.refuse_untaken(control, options.given)
        check = Check.from_campaign(campaign, control, options)
    again = f"axiscal verify {shlex.quote(str(record))} --to {check.tables.controller}"
    again += "" if template is None else f" --template {shlex.quote(str(template))}"
    if found is not None or source is not None:
        check.known(tolerance)  # before anything is touched
    if live and source is not None and found is not None and left is not None:
        places = check.planned(points, "sphere", check.known(tolerance))
        to_do = _read_live(check, source, places, (found, left), loaded)
        if to_do:
            say_either("axiscal-verify/1", {"verdict": None, "next": to_do}, [to_do])
            return
    if found is not None and left is not None:
        readings = check.read(found, left)
    elif source is not None:
        readings = check.asked(source, check.planned(points, tolerance=check.known(tolerance)))
    else:
        again += "" if tolerance is None else f" --tolerance {shlex.quote(tolerance)}"
        places = check.planned(points, tolerance=check.known(tolerance))
        (document, planned), sheet = check_plan(check, places), check.sheet(places)
        if plan is not None:
            write_whole(plan, sheet.encode())
        lines = [_wrapped(planned), *ending({said("Next"): _steps(sheet, plan, again)})]
        say_either("axiscal-verify/1", document, lines)
        return
    judged = check.judged(readings, tolerance)
    if DOCUMENTS.get():
        say_document(check_document(judged))
    elif details:
        say(_wrapped(check_details(judged)))
    else:
        loading = [said("load the exported files again, then")] if judged.faulty else []
        folder = f"axiscal status {shlex.quote(str(record.parent))}"
        coming = [folder] if judged.verdict == "promised" else [*loading, f"{again} --plan check.csv"]
        say("\n".join([*check_screen(judged), *ending({said("Next"): coming})]))


def _keep_sign(record: Path, to: str | None, bump: str) -> None:
    """Keep and say which way a control takes its tables.  bump : what it moved the tool by"""
    if to is None:
        raise typer.BadParameter(said("--bump is of one control: name it, --to CONTROLLER"))
    moved = parse_quantity(bump, "length")
    registry.unstated(to)
    other = other_way(moved)
    with opened_to_write(record) as campaign:
        campaign.bump(to, moved)
    found = said("The control takes its tables the other way round.") if other else said("As assumed.")
    kept = said(
        "The record keeps it, and its tables for {controller} follow; another --bump changes it.", controller=to
    )
    again = f"axiscal export {shlex.quote(str(record))} --to {shlex.quote(to)}{template_of(to)}"
    document = {"verdict": None, "sign": "other way round" if other else "as assumed", "next": again}
    say_either("axiscal-verify/1", document, [*wrapped(f"{found} {kept}"), *ending({said("Next"): [again]})])


_LIVE = "linuxcnc-live"
"""The machine that runs and reads spheres by itself."""


def _read_live(check: Check, source: str, places: Places, files: tuple[Path, Path], loaded: Path | None) -> str:
    """Let a machine read what is missing, without the tables or with them; returns what is to be done next.

    loaded : the folder of the tables that are to be in force; raises TableError for one without tables
    """
    from axiscal.ports.linuxcnc.live import InForce, attached_to

    machine, host = check.description.machine, source.partition(":")[2]
    before, after = check.sheets(places, *files)
    bare, tables = InForce(bool(check.description.compensation_active)), InForce(True)
    if loaded is not None:
        tables = InForce.from_folder(loaded)
    if not before.complete():
        before.fill(lambda: attached_to(host, machine, bare))
        if not after.complete():
            text = (
                "{found} holds the readings as found. Load the exported files and switch them on, then give the same "
                "command again: it reads as left, into {left}."
            )
            return said(text, found=before.file, left=after.file)
    if not after.complete():
        after.fill(lambda: attached_to(host, machine, tables))
    return ""


def _wrapped(lines: Sequence[str]) -> str:
    """Return lines of a terminal, what goes on further in."""
    return "\n".join(textwrap.fill(line, WIDTH, subsequent_indent="  ", break_on_hyphens=False) for line in lines)


def _steps(sheet: str, plan: Path | None, command: str) -> list[str]:
    """Return what to do next: write the places, or fill them in and let them be judged.

    command : without its last options
    """
    if plan is None:
        return [f"{command} --plan check.csv"]
    values = [name for name in sheet.splitlines()[0].split(",") if name.startswith("value")]
    return [
        said("copy {plan} to found.csv and left.csv", plan=plan),
        said("fill in {values}: found.csv without the tables, left.csv with them", values=listed(", ", values)),
        f"{command} --found found.csv --left left.csv",
    ]
