"""`axiscal step record` and `skip`, and the log of measuring programs as readings of a campaign."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import typer

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.cli.printing import mind_lines, say_either, tell
from axiscal.cli.texts import opened_to_write, question_of
from axiscal.description.campaign import CampaignDescription
from axiscal.description.placed_readings import logged_readings, placed_approach, placed_pose, placed_readings
from axiscal.exceptions import ReadingError, RecordError
from axiscal.language.spoken import counted, joined, later, listed, quoted, said
from axiscal.measurement.readers.columns import approach_of
from axiscal.measurement.reading import Place, Reading, place_text, reading_unit, shown_pose, units_of
from axiscal.measurement.setup import Setup
from axiscal.present.answer_of_campaign import cost_sentence, cost_words
from axiscal.present.guide.actions import contradictions, doubted, last_doubt, open_question, others_doubted
from axiscal.present.guide.question import asked_text, measured
from axiscal.units import format_quantity, parse_quantity, to_unit
from axiscal_core.machine import Machine

_ASK = later("Ask for the next one: axiscal step next {record}")


def record(
    record: Path,
    value: list[str] | None = None,
    std: str | None = None,
    at: str | None = None,
    setup: str | None = None,
    approach: str | None = None,
    accept: bool = False,
    log: Path | None = None,
    programs: Path = Path("programs"),
    then_next: bool = False,
) -> None:
    """Keep a reading: actual minus commanded."""
    text = " ".join(value or [])
    if log is not None:
        if text or at or setup or approach or std or accept or then_next:
            raise typer.BadParameter(said("--log brings readings of its own; it takes only --programs and --json"))
        _record_log(record, log, programs)
        return
    if not value:
        raise typer.BadParameter(said("give either VALUE or --log FILE"))
    if at is None and (setup or approach):
        raise typer.BadParameter(said("--setup and --approach belong to --at"))
    with opened_to_write(record) as campaign:
        # first: what is misspelt is said at once
        if at is None:
            place = campaign.open_question().place
        else:
            chosen, machine = _setup(campaign, setup), campaign.description.machine
            pose = placed_pose(chosen, machine, _position(at, machine))
            place = Place(chosen.name, pose, placed_approach(chosen, machine, _directions(approach or "")))
        mounted, stands = campaign.description.setup(place.setup), (campaign.description.machine, place.pose)
        number, *others = measured(text, mounted, stands, bare=False).tolist()
        noise = None if std is None else parse_quantity(std, mounted.reads_each[0])
        before = doubted(campaign)
        left = _left(campaign, place)
        kept = campaign.record(number, noise, place, accepted=accept, others=tuple(others))
        doubt = last_doubt(campaign)
        found = [*others_doubted(campaign, before), _assumed(campaign, kept, approach) if at else "", left]
        minded = [sentence for sentence in (*contradictions(campaign), *found, open_question(campaign)) if sentence]
        document, line = _kept(campaign, kept)
        document |= {"surprise": None if doubt is None else round(doubt.surprise, 2), "mind": minded}
        _answered(campaign, document, [line, *mind_lines(*minded)], then_next=then_next)


def _answered(campaign: Campaign, document: dict[str, object], lines: Sequence[str], *, then_next: bool) -> None:
    """Say what was done with the question, and ask the next one where that is wanted."""
    coming = said(_ASK, record=campaign.path)
    if then_next:
        question, coming = question_of(campaign, campaign.next())
        document |= {"next": {"schema": "axiscal-next/1", **question}}
    say_either("axiscal-record/1", document, [*lines, coming])
    if not then_next:
        with suppress(RecordError):  # it is kept; what cannot be added to it is found out by `next`
            campaign.go_on()


def _record_log(record: Path, log: Path, programs: Path) -> None:
    """Keep the readings of a log; raises RecordError where they are in the record already."""
    with opened_to_write(record) as campaign:
        placed = placed_log(log, programs, campaign.description)
        kept = {(each.place, each.values) for each in campaign.state.readings}
        for each in placed:
            if (each.place, each.values) in kept:
                what = "the reading of line {number} is in the record already"
                raise RecordError(what, "This log was recorded before", log, number=each.line)
        first = campaign.state.free
        campaign.adopt(tuple(each.under(number) for number, each in enumerate(placed, start=first)))
        count = len(campaign.state.readings)
        words = counted("Kept {count} reading of {log}.", "Kept {count} readings of {log}.", len(placed), log=log)
        document = {"logged": len(placed), "readings": count}
        say_either("axiscal-record/1", document, [words, said(_ASK, record=record)])


def _left(campaign: Campaign, place: Place) -> str:
    """Return what it costs to leave the set-up that was asked for, for a place in another one; "" for nothing."""
    asked = campaign.state.pending
    if asked is None or asked.place.setup == place.setup or not (costs := cost_words(campaign, rest=True)):
        return ""
    text = (
        'this leaves "{setup}", which costs, where nothing more is read there: {costs}; to stay, take this back: '
        "axiscal step undo."
    )
    return said(text, setup=asked.place.setup, costs=costs)


def _assumed(campaign: Campaign, reading: Reading, approach: str | None) -> str:
    """Return what is supposed of the sides from which the axes came, where nobody said."""
    setup, machine = campaign.description.setup(reading.setup), campaign.description.machine
    silent = [machine.axes[k].name for k in setup.sided if not reading.approach[k]]
    if approach is not None or not silent:
        return ""
    turned = [e.axis for e in machine.stated if e.kind == "reversal" and e.axis in silent]
    wider = "; the reading counts as less sure, by half the reversal of {axes}"
    text = (
        "without --approach nothing is supposed of the side from which {axes} came{wider}. If you know it, take this "
        'back (axiscal step undo) and add it, as in --approach "{example}".'
    )
    return said(
        text,
        axes=joined(silent),
        wider=said(wider, axes=joined(turned)) if turned else "",
        example=" ".join(f"{name}+" for name in silent),
    )


def _kept(campaign: Campaign, reading: Reading) -> tuple[dict[str, object], str]:
    """Return what was kept, as a document and in words."""
    setup, axes = campaign.description.setup(reading.setup), campaign.description.machine.axes
    unit, count = reading_unit(setup), len(campaign.state.readings)
    document: dict[str, object] = {
        "reading": reading.number,
        "readings": count,
        "setup": reading.setup,
        "position": shown_pose(axes, reading.pose),
        "value": to_unit(reading.value, unit),
        "unit": unit,
    }
    place, values = place_text(axes, reading.pose, setup.moves), map(format_quantity, reading.values, units_of(setup))
    text = "Kept reading {number}: {value} at {place} ({count} so far)."
    return document, said(text, number=reading.number, value=listed(", ", [*values]), place=place, count=count)


_BETWEEN = re.compile(r"\s*[,;]\s*|\s+(?=[^\W\d_]\w*\s*=)")
"""Between two axes of a place."""


def _setup(campaign: Campaign, name: str | None) -> Setup:
    """Return a set-up by its name; without one that of the question that is open, or the only one there is."""
    description, pending = campaign.description, campaign.state.pending
    if name is None and pending is None and len(description.setups) > 1:
        names = listed(", ", [quoted(setup.name) for setup in description.setups])
        raise ReadingError("the campaign has several set-ups", "Name one with --setup: {names}", names=names)
    return description.setup(name or (pending.place.setup if pending else description.setups[0].name))


def _position(text: str, machine: Machine) -> dict[str, float]:
    parts = [part.partition("=") for part in _BETWEEN.split(text.strip()) if part]
    names = [name.strip() for name, _, _ in parts]
    if not all(equals for _, equals, _ in parts) or len({*names}) < len(names):
        raise ReadingError('"{text}" is not a place', 'Write each axis once, as in --at "X=120 mm Y=250 mm"', text=text)
    return {
        name: parse_quantity(at, machine.axis(name).dimension) for name, (_, _, at) in zip(names, parts, strict=True)
    }


def _directions(text: str) -> dict[str, int]:
    if (directions := approach_of(text)) is None:
        remedy = 'Write each axis once, as in --approach "X+ Y-"'
        raise ReadingError('"{text}" is not an approach', remedy, text=text)
    return directions


def skip(record: Path, reason: list[str], leave: bool = False, then_next: bool = False) -> None:
    """Skip the reading that is asked for, with its reason."""
    why = " ".join(reason)
    with opened_to_write(record) as campaign:
        costs = cost_words(campaign, rest=leave)
        asked = campaign.skip(why, rest=leave)
        done = "Left the set-up at {reading}: {reason}" if leave else "Skipped {reading}: {reason}"
        lines = [said(done, reading=asked_text(campaign, asked), reason=why.strip()), cost_sentence(costs)]
        lines += [said("Take it back: axiscal step undo {record}", record=record)] if costs else []
        document: dict[str, object] = {"skipped": asked.reading, "set_up_left": leave, "costs": costs}
        _answered(campaign, document, lines, then_next=then_next)


def placed_log(log: Path, programs: Path, description: CampaignDescription) -> tuple[Reading, ...]:
    """Return the readings of a log; raises ReadingError.  programs : the folder of the programs that wrote it"""
    raw, told = logged_readings(log, programs, description)
    for sentence in told:
        tell(said("Mind: {sentence}", sentence=sentence))
    if not raw:
        raise ReadingError("no reading of this log is whole", "Run the programs again", log)
    placed = placed_readings(raw, description, log)
    refuse_implausible(placed, description, log)
    return placed
