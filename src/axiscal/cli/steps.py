"""`axiscal step next`, `undo`, `note` and `accept`."""

from __future__ import annotations

from pathlib import Path

import typer

from axiscal.campaign.agreement_words import (
    acceptance,
    agreement_document,
    agreement_words,
    change_words,
    mistake_words,
    odds_text,
)
from axiscal.campaign.campaign import Campaign
from axiscal.cli.printing import say_either
from axiscal.cli.texts import opened_to_write, question_of
from axiscal.language.spoken import put, said
from axiscal.present.guide import actions


def accept(record: Path, cause: str | None = None, setup: str | None = None, before: int | None = None) -> None:
    """Accept a mistake, or tell that a zero was set anew."""
    if before is not None and cause != "jump":
        raise typer.BadParameter(said("--before N belongs to jump"))
    if cause is None:
        with Campaign.open(record, write=False) as campaign:
            document, lines = _named(campaign)
    else:
        with opened_to_write(record) as campaign:
            document, lines = _accepted(campaign, cause, setup, before)
    say_either("axiscal-accept/1", document, lines)


def _named(campaign: Campaign) -> tuple[dict[str, object], list[str]]:
    """Return what the readings name, as a document and in words."""
    known = campaign.estimate()
    if not known.agreement.explained:
        return {"agreement": agreement_document(known.agreement)}, [
            put("{agreement}.", agreement=agreement_words(known, campaign.path))
        ]
    lines = []
    for each in known.agreement.explained:
        words, change = mistake_words(each, known), change_words(acceptance(each, known))
        lines += [
            put("{mistake}, {odds}: {words}.", mistake=each.mistake, odds=odds_text(each), words=words),
            put("  {accepted}.", accepted=said("Accepted: {change}", change=change)),
        ]
    lines.append(said("Accept one: axiscal step accept {record} CAUSE", record=campaign.path))
    return {"agreement": agreement_document(known.agreement)}, lines


def _accepted(
    campaign: Campaign, cause: str, setup: str | None, number: int | None
) -> tuple[dict[str, object], list[str]]:
    """Accept a mistake, and return how the readings agreed before and agree now, as a document and in words.

    number : of the reading before which a zero was set anew, as a person says
    """
    before = campaign.estimate()
    change = change_words(campaign.accept(cause, setup, number))
    now = campaign.estimate()
    lines = [
        said("Before: {agreement}.", agreement=agreement_words(before, campaign.path)),
        put("{accepted}.", accepted=said("Accepted: {change}", change=change)),
        said("Now: {agreement}.", agreement=agreement_words(now, campaign.path)),
        said("Go on: axiscal step next {record}; take it back: axiscal step undo {record}", record=campaign.path),
    ]
    agreements = {"before": agreement_document(before.agreement), "agreement": agreement_document(now.agreement)}
    return {"accepted": cause, "change": change, **agreements}, lines


def next_reading(record: Path, beyond: bool = False) -> None:
    """Say which reading to take next."""
    with opened_to_write(record) as campaign:
        document, text = question_of(campaign, campaign.next(beyond=beyond))
        say_either("axiscal-next/1", document, [text])


def undo(record: Path) -> None:
    """Take back the last reading, skip, accepted mistake or end."""
    with opened_to_write(record) as campaign:
        number, taken = actions.last_step(campaign)[1], campaign.state.undo
        sentence = actions.undo(campaign)
        undone = type(taken[-1].event).__name__.lower()
    document = {"undone": undone, "reading": number, "readings": len(campaign.state.readings)}
    say_either("axiscal-undo/1", document, [sentence])


def note(record: Path, text: list[str]) -> None:
    """Keep a sentence in the record."""
    with opened_to_write(record) as campaign:
        sentence = actions.note(campaign, " ".join(text))
        kept = campaign.state.notes
    document = {"note": kept[-1].text, "at": kept[-1].at, "notes": len(kept)}
    say_either("axiscal-note/1", document, [sentence])
