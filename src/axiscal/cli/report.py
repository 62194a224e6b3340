"""`axiscal finish`, `report` and `step status`: the results of a campaign, and where it stands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from axiscal.answers.answer_of_campaign import results_of, standing_answer
from axiscal.campaign.agreement_words import agreement_document, agreement_words, change_words, membership_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text
from axiscal.campaign.evidence import evidence_words, signed_text
from axiscal.cli.arguments import Anyway, Details, Json, OwnRecord, ReportLanguage, ResultsFolder
from axiscal.cli.outputs import standing_screen, write_outputs
from axiscal.cli.printing import say, say_document, say_either
from axiscal.cli.texts import accuracy_text, asked_screen, opened_to_write
from axiscal.description.type_text import is_type_text
from axiscal.document.consent import asking
from axiscal.document.gone import instead_of
from axiscal.exceptions import CodeError, RecordError
from axiscal.language.spoken import capital, counted, decimals, listed, said
from axiscal.present.delivery import write_report
from axiscal.present.guide.progress import contradictions
from axiscal.present.guide.question import asked_text
from axiscal.present.plan_answer import coming_answer
from axiscal.present.result_set import RECORD
from axiscal.present.summarising import Extras, summarise
from axiscal.record.copies import opened_log
from axiscal.record.log import EventLog
from axiscal.units import format_quantity, to_unit


def report(
    record: OwnRecord,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE.html", help="Where to write it, .html or .pdf; default: beside the record."),
    ] = None,
    language: ReportLanguage = None,
) -> None:
    """Write the report of a campaign, finished or not.

    The report is a page that needs no network, or a PDF. It is in the language that --language or AXISCAL_LANGUAGE
    names, else in that of campaign.toml ([report] language), else in English.

    \b
    Examples:
      axiscal report mill.axiscal --out mill.html
      axiscal report mill.axiscal --out mill.pdf --language de
    """

    target = out or record.with_suffix(".html")
    option = f"report --out FILE{target.suffix.lower()}"
    if instead := instead_of("options", option):
        raise typer.BadParameter(said("{name} is gone. {instead}.", name=option, instead=instead))
    if target.suffix.lower() not in (".html", ".htm", ".pdf"):
        what = "the report is an HTML page or a PDF, and {out} is the name of neither"
        names = ", ".join(target.with_suffix(suffix).name for suffix in (".html", ".pdf"))
        raise RecordError(what, "Write it to one of {names}", target, out=target.name, names=names)
    with Campaign.open(record, write=False) as campaign:
        summary = summarise(campaign, campaign.estimate(ended=True), Extras(answer=standing_answer(campaign)))
    target.parent.mkdir(parents=True, exist_ok=True)
    write_report(summary, target, language)
    say(said("The report is in {file}.", file=target))


def finish(
    record: OwnRecord, out: ResultsFolder = None, anyway: Anyway = False, details: Details = False, json: Json = False
) -> None:
    """End a campaign and write its results.

    A finished campaign is written again, into the same folder if you like; `axiscal step undo` takes the end back.

    \b
    Example:
      axiscal finish mill.axiscal --out results
    """

    with opened_to_write(record) as campaign:
        folder = out or results_of(record)
        campaign.refuse_other(folder / RECORD)
        campaign.finish()
        write_outputs(campaign, folder, as_json=json, details=details, anyway=anyway)


def status(record: OwnRecord, details: Details = False, json: Json = False) -> None:
    """Say where a campaign stands.

    It shows readings, accuracy, minutes, skipped readings, and the question that is open. Code of an instrument that
    came with a record is not run.

    \b
    Example:
      axiscal step status mill.axiscal
    """

    try:
        with asking(None), Campaign.open(record, write=False, changed=True) as campaign:
            _say_standing(campaign, details, json)
    except CodeError as unrun:
        with opened_log(record, write=False, changed=True) as log:
            _say_unrun(log, unrun, json)


def _say_standing(campaign: Campaign, details: bool, as_json: bool) -> None:
    if as_json:
        say_document(_document(campaign))
        return
    if details:
        say("\n".join(_lines(campaign)))
    say(standing_screen(campaign))
    for each in campaign.state.newer:
        say(said("An entry of a newer version: {kind}. It says nothing of the readings.", kind=each.kind))
    for person, numbers in _by_others(campaign).items():
        readings = listed(", ", [str(number) for number in numbers])
        say(said("By {person}: readings {readings}.", person=person, readings=readings))


def _say_unrun(log: EventLog, unrun: CodeError, as_json: bool) -> None:
    """Say what a record says by itself, where only code of somebody's could say more."""
    state = log.state()
    readings = counted("{count} reading", "{count} readings", len(state.readings))
    ended = "" if state.finished is None else said("Finished: {because}", because=because_text(state.finished))
    lines = [f"{log.path}: {readings}.", evidence_words(log), ended, str(unrun)]
    document = {"readings": len(state.readings), "finished": state.finished, "signed": signed_text(log) or None}
    say_either(as_json, "axiscal-status/1", {**document, "unrun": str(unrun)}, filter(None, lines))


def _by_others(campaign: Campaign) -> dict[str, list[int]]:
    """Return the numbers of the readings that others took than who began the campaign, by person."""
    found: dict[str, list[int]] = {}
    for index, reading in enumerate(campaign.state.readings):
        if reading.by:
            found.setdefault(reading.by, []).append(reading.numbered(index))
    return found


def _lines(campaign: Campaign) -> list[str]:
    status, description = campaign.status(), campaign.description
    state, target = status.state, description.target
    lines = [
        said(
            "{machine}: {readings}, {minutes} of machine time",
            machine=description.machine.name,
            readings=counted("{count} reading", "{count} readings", len(state.readings)),
            minutes=decimals(format_quantity(status.seconds, "min", 3)),
        ),
        said("standard uncertainty {accuracy}", accuracy=accuracy_text(status.accuracy, target.rms, target.worst)),
    ]
    if state.readings:
        lines.append(agreement_words(campaign.estimate(), campaign.path))
    if sisters := _sisters(campaign):
        lines.append(capital(sisters))
    for gap in state.skipped:
        done = said("Left the set-up at") if gap.whole else said("Skipped")
        lines.append(f"{done} {asked_text(campaign, gap.asked)}: {gap.reason}")
    lines += [said("Accepted: {change}", change=change_words(each)) for each in state.accepted]
    lines.append(said("The record is {signed}", signed=signed_text(campaign) or said("unsigned")))
    lines += [said("Noted {at}: {text}", at=note.at[:16].replace("T", " "), text=note.text) for note in state.notes]
    if state.finished is not None:
        return [*lines, said("Finished: {because}", because=because_text(state.finished))]
    if status.reached is not None:
        words = "Reached: {what}. End it: axiscal finish {record}"
        lines.append(said(words, what=because_text(status.reached), record=campaign.path))
    return [*lines, asked_screen(campaign, state.pending)] if state.pending else lines


def _sisters(campaign: Campaign) -> str:
    """Return whether the machine is like its sisters, in words, "" for one without; only then is it estimated."""
    return membership_words(campaign.estimate()) if is_type_text(campaign.description.prior_text) else ""


def _document(campaign: Campaign) -> dict[str, object]:
    """Return where a campaign stands.

    answer : the same as of the last screen; question : the open one, as a source is asked
    target : limits that end the campaign; None for one that does not count
    reached, finished : why it may end, and has, as the record keeps it; mind : what readings contradict
    planned : what is known after the plan, before the first reading
    signed : who answers for how much of the record, and whether it was changed since
    newer : kinds of entries that a newer version has written; skipped : readings that could not be taken
    by : readings that others took than who began the campaign, by person
    """
    status, planned = campaign.status(), coming_answer(campaign)
    state, target = status.state, campaign.description.target
    rms, worst = (None if value is None else to_unit(value, "um") for value in (target.rms, target.worst))
    budget = None if target.budget is None else to_unit(target.budget, "min")
    return {
        "schema": "axiscal-status/1",
        "machine": campaign.description.machine.name,
        "readings": len(state.readings),
        "minutes": to_unit(status.seconds, "min"),
        "rms_um": to_unit(status.accuracy.rms, "um"),
        "worst_um": to_unit(status.accuracy.worst, "um"),
        "answer": standing_answer(campaign).model_dump(mode="json"),
        "planned": None if planned is None else planned.model_dump(mode="json"),
        "target": {"rms_um": rms, "worst_um": worst, "readings": target.readings, "budget_min": budget},
        "reached": status.reached,
        "finished": state.finished,
        "agreement": agreement_document(status.agreement),
        "mind": contradictions(campaign),
        "sisters": _sisters(campaign) or None,
        "question": campaign.request(state.pending).message() if state.pending else None,
        "accepted": [change_words(each) for each in state.accepted],
        "by": _by_others(campaign),
        "notes": [{"text": note.text, "at": note.at, "after_reading": note.after} for note in state.notes],
        "newer": [each.kind for each in state.newer],
        "signed": signed_text(campaign) or None,
        "skipped": [
            campaign.request(gap.asked).message() | {"reason": gap.reason, "set_up_left": gap.whole}
            for gap in state.skipped
        ],
    }
