"""`axiscal status`: where a campaign stands, or each campaign of a folder."""

from __future__ import annotations

from pathlib import Path

from axiscal.campaign.agreement_words import agreement_document, agreement_words, change_words
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text
from axiscal.campaign.evidence import evidence_words, signed_text
from axiscal.campaign.listing import standings
from axiscal.cli.outputs import standing_screen
from axiscal.cli.printing import DOCUMENTS, say, say_document, say_either
from axiscal.cli.texts import asked_screen
from axiscal.document.consent import asking
from axiscal.exceptions import CodeError, RecordError
from axiscal.language.spoken import counted, later, said
from axiscal.present.answer_of_campaign import standing_answer
from axiscal.present.guide.actions import contradictions
from axiscal.present.guide.progress import RecordStanding
from axiscal.present.guide.question import asked_text
from axiscal.present.plan_answer import coming_answer
from axiscal.record.accepted import Accepted
from axiscal.record.events import State
from axiscal.record.store import Record
from axiscal.units import said_quantity, to_unit


def status(record: Path, details: bool = False) -> None:
    """Say where a campaign stands, or each one of a folder."""
    if record.is_dir():
        _say_folder(record)
        return
    try:
        with asking(None), Campaign.open(record, write=False, changed=True) as campaign:
            _say_standing(campaign, details)
    except CodeError as unrun:
        _say_unrun(Record.open(record, write=False, changed=True), unrun)


def _say_standing(campaign: Campaign, details: bool) -> None:
    if DOCUMENTS.get():
        say_document(_document(campaign))
        return
    if details:
        say("\n".join(_lines(campaign)))
    say(standing_screen(campaign))


def _say_unrun(log: Record, unrun: CodeError) -> None:
    """Say what a record says by itself, where only code of somebody's could say more."""
    state = log.state()
    readings = counted("{count} reading", "{count} readings", len(state.readings))
    ended = "" if state.finished is None else said("Finished: {because}", because=because_text(state.finished))
    lines = [f"{log.path}: {readings}.", evidence_words(log), ended, str(unrun)]
    document = {"readings": len(state.readings), "finished": state.finished, "signed": signed_text(log) or None}
    say_either("axiscal-status/1", {**document, "unrun": str(unrun)}, filter(None, lines))


def _lines(campaign: Campaign) -> list[str]:
    state = campaign.state
    known = campaign.so_far().accuracy
    rms, worst = said_quantity(known.rms, "um"), said_quantity(known.worst, "um")
    lines = [said("standard uncertainty RMS {rms}, worst {worst}", rms=rms, worst=worst)]
    if state.readings:
        lines.append(agreement_words(campaign.estimate(), campaign.path))
    for gap in state.skipped:
        done = said("Left the set-up at") if gap.whole else said("Skipped")
        lines.append(f"{done} {asked_text(campaign, gap.asked)}: {gap.reason}")
    lines += [said("Accepted: {change}", change=change_words(each)) for each in state.told(Accepted)]
    lines.append(said("The record is {signed}", signed=signed_text(campaign.log) or said("unsigned")))
    lines += [said("Noted {at}: {text}", at=note.at[:16].replace("T", " "), text=note.text) for note in state.notes]
    if state.finished is not None:
        return [*lines, said("Finished: {because}", because=because_text(state.finished))]
    return [*lines, asked_screen(campaign, state.pending)] if state.pending else lines


def _document(campaign: Campaign) -> dict[str, object]:
    """Return where a campaign stands.

    answer : the same as of the last screen; question : the open one, as a source is asked
    target : limits that end the campaign; None for one that does not count
    reached, finished : why it may end, and has, as the record keeps it; mind : what readings contradict
    planned : what is known after the plan, before the first reading
    skipped : readings that could not be taken
    signed : who answers for how much of the record, and whether it was changed since
    """
    known, planned, answer = campaign.so_far(), coming_answer(campaign), standing_answer(campaign)
    state, target = campaign.state, campaign.description.target
    rms, worst = (None if value is None else to_unit(value, "um") for value in (target.rms, target.worst))
    budget = None if target.budget is None else to_unit(target.budget, "min")
    return {
        "schema": "axiscal-status/1",
        "machine": campaign.description.machine.name,
        "readings": len(state.readings),
        "minutes": to_unit(campaign.seconds(), "min"),
        "rms_um": to_unit(known.accuracy.rms, "um"),
        "worst_um": to_unit(known.accuracy.worst, "um"),
        "answer": answer.model_dump(mode="json") | {"rows": [row.model_dump(mode="json") for row in answer.rows]},
        "planned": None if planned is None else planned.model_dump(mode="json"),
        "target": {"rms_um": rms, "worst_um": worst, "readings": target.readings, "budget_min": budget},
        "reached": None if state.finished is not None else campaign.reached(),
        "finished": state.finished,
        "agreement": agreement_document(known.agreement),
        "mind": contradictions(campaign),
        "question": campaign.request(state.pending).message() if state.pending else None,
        "accepted": [change_words(each) for each in state.told(Accepted)],
        "notes": [{"text": note.text, "at": note.at, "after_reading": note.after} for note in state.notes],
        "signed": signed_text(campaign.log) or None,
        "skipped": [
            campaign.request(gap.asked).message() | {"reason": gap.reason, "set_up_left": gap.whole}
            for gap in state.skipped
        ],
    }


def _say_folder(folder: Path) -> None:
    """Say where the campaigns of a folder stand; raises RecordError where it has no record."""
    found, faults = standings(sorted(folder.glob("*.axiscal")))
    if not found and not faults:
        raise RecordError("There is no campaign record in this folder", "Name a folder of records, *.axiscal", folder)
    records = [RecordStanding.of(each, folder) for each in found]
    rows = [[said(head) for head in _HEADS]]
    for each, (*_, state) in zip(records, found, strict=True):
        rows.append([each.record, each.machine, each.last[:10], _standing_text(state), each.next or "-"])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    lines += [said("Left out: {why}", why=str(fault)) for fault in faults]
    document = {"records": [each.model_dump() for each in records], "left_out": [str(fault) for fault in faults]}
    say_either("axiscal-folder/1", document, lines)


_HEADS = later("record"), later("machine"), later("last"), later("state"), later("next")


def _standing_text(state: State) -> str:
    count, coming, result = (
        counted("{count} reading", "{count} readings", len(state.readings)),
        len(state.coming),
        state.result,
    )
    if state.finished is None:
        return said("{readings}, {coming} to come", readings=count, coming=coming) if coming else count
    if result.agreement == "contradict":
        return said("{readings}, finished: they contradict each other", readings=count)
    if result.rms is None:
        return said("{readings}, finished", readings=count)
    return said("{readings}, finished: RMS {rms}", readings=count, rms=said_quantity(result.rms, "um"))
