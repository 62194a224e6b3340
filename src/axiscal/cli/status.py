"""`axiscal step status`."""

from __future__ import annotations

from axiscal.answers.answer import StatusAnswer, StatusNote, StatusTarget
from axiscal.answers.answer_of_campaign import standing_answer
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import because_text
from axiscal.cli.arguments import Details, Json, OwnRecord
from axiscal.cli.outputs import standing_screen
from axiscal.cli.printing import say, say_document
from axiscal.cli.texts import accuracy_text, count_text, question_text, signed_text
from axiscal.estimation.agreement_words import agreement_document, agreement_words, change_words, membership_words
from axiscal.estimation.type_prior import is_type_text
from axiscal.language.spoken import capital, decimals, said
from axiscal.present.guide.progress import contradictions
from axiscal.present.guide.question import asked_text
from axiscal.present.plan_answer import coming_answer
from axiscal.units import format_quantity, to_unit


def status(record: OwnRecord, details: Details = False, json: Json = False) -> None:
    """Say where a campaign stands.

    It shows readings, accuracy, minutes, skipped readings, and the question that is open.

    \b
    Example:
      axiscal step status mill.axiscal
    """

    with Campaign.open(record, write=False) as campaign:
        if json:
            say_document(_document(campaign).model_dump(mode="json", by_alias=True))
            return
        if details:
            say("\n".join(_lines(campaign)))
        say(standing_screen(campaign))
        for each in campaign.state.newer:
            say(said("An entry of a newer version: {kind}. It says nothing of the readings.", kind=each.kind))


def _lines(campaign: Campaign) -> list[str]:
    status, description = campaign.status(), campaign.description
    state, target = status.state, description.target
    lines = [
        said(
            "{machine}: {readings}, {minutes} of machine time",
            machine=description.machine.name,
            readings=count_text(len(state.readings), "reading"),
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
    lines.append(said("The record is {signed}", signed=signed_text(campaign)))
    lines += [said("Noted {at}: {text}", at=note.at[:16].replace("T", " "), text=note.text) for note in state.notes]
    if state.finished is not None:
        return [*lines, said("Finished: {because}", because=because_text(state.finished))]
    if status.reached is not None:
        words = "Reached: {what}. End it: axiscal finish {record}"
        lines.append(said(words, what=because_text(status.reached), record=campaign.path))
    return [*lines, question_text(campaign, state.pending)] if state.pending else lines


def _sisters(campaign: Campaign) -> str:
    """Return whether the machine is like its sisters, in words, "" for one without; only then is it estimated."""
    return membership_words(campaign.estimate()) if is_type_text(campaign.description.prior_text) else ""


def _document(campaign: Campaign) -> StatusAnswer:
    status = campaign.status()
    state = status.state
    target = campaign.description.target
    rms, worst = (None if value is None else to_unit(value, "um") for value in (target.rms, target.worst))
    budget = None if target.budget is None else to_unit(target.budget, "min")
    return StatusAnswer(
        machine=campaign.description.machine.name,
        readings=len(state.readings),
        minutes=to_unit(status.seconds, "min"),
        rms_um=to_unit(status.accuracy.rms, "um"),
        worst_um=to_unit(status.accuracy.worst, "um"),
        answer=standing_answer(campaign),
        planned=coming_answer(campaign),
        target=StatusTarget(rms_um=rms, worst_um=worst, readings=target.readings, budget_min=budget),
        reached=status.reached,
        finished=state.finished,
        agreement=agreement_document(status.agreement),
        mind=contradictions(campaign),
        sisters=_sisters(campaign) or None,
        question=campaign.request(state.pending).message() if state.pending else None,
        accepted=[change_words(each) for each in state.accepted],
        notes=[StatusNote(text=note.text, at=note.at, after_reading=note.after) for note in state.notes],
        newer=[each.kind for each in state.newer],
        skipped=[
            campaign.request(gap.asked).message() | {"reason": gap.reason, "set_up_left": gap.whole}
            for gap in state.skipped
        ],
    )
