"""Words on the agreement of readings: with each other, with the mistake that explains a contradiction."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import Agreement, Checks
from axiscal.estimation.promise.mistake import NAMED, Explained, Mistake
from axiscal.exceptions import RecordError
from axiscal.language.spoken import WORDS, capital, joined, listed, put, quoted, said
from axiscal.record.accepted import Accepted

_MOST = 1e6
"""Odds beyond which nobody reads the digits."""
_UNUSED = 3
"""Readings that a sentence names; the others are counted."""


def agreement_words(known: Estimation, record: Path | None = None) -> str:
    """Return how many readings agree and which are not used, or that they contradict, with the mistakes that are named.

    record : its path, where the command that accepts the likeliest one is said besides
    """
    found = known.agreement
    if known.readings and not found.count:
        what = "0 of {count} readings are used: each is farther off than what is stated allows. Check unit and place"
        return said(what, count=len(known.readings))
    count = said("{agreeing} of {count} readings agree with the others", agreeing=found.agreeing, count=found.count)
    if not found.contradicts and found.explained:
        either = listed(said(" Or: "), [question(known, each) for each in found.explained])
        return said("{count}. {asked} ({odds})", count=count, asked=either, odds=odds_text(found.explained[0]))
    if not found.contradicts:
        unused = [(known.readings[index], index) for index in sorted(known.left_out)]
        names = [put("{number} ({setup})", number=r.numbered(i), setup=quoted(r.setup)) for r, i in unused]
        short = "{agreeing} of {count} readings agree; not used: {names}"
        used = {"agreeing": found.agreeing, "count": found.count}
        text = said(short, names=joined(names, _UNUSED), **used) if names else count
        return listed("; ", [text, *([checks_words(known.checks)] if known.checks.each else [])])
    chance = put("p = {p:.1g}", p=found.p)
    named = [found.described] if found.described else found.explained
    if not named:
        what = "The readings contradict each other ({chance}), and no single mistake explains it: {count}"
        return said(what, chance=chance, count=count)
    causes = listed(said("; or "), [mistake_words(each, known) for each in named])
    text = said("The readings contradict each other ({chance}): {causes}", chance=chance, causes=causes)
    if record is None or found.described:
        return text
    return said("{text}. If so: axiscal step accept {record} {cause}", text=text, record=record, cause=named[0].mistake)


def checks_words(checks: Checks) -> str:
    """Return how many checks are as promised, and s."""
    kept = {"kept": checks.as_promised, "count": len(checks.each)}
    if checks.s is None:
        return said("checks: {kept} of {count} as promised", **kept)
    return said("checks: {kept} of {count} as promised, s = {s:.2f}", s=checks.s, **kept)


def mistake_words(each: Explained, known: Estimation) -> str:
    """Return what went wrong, and what to do about it."""
    if stretch := _stretch_words(each, known):
        what = "{what} (or the earlier ones do: accept earlier). Correct them"
        return said("{what}. Correct them" if each.last >= 0 else what, what=stretch)
    return _said_of(WORDS["mistakes"], each, known)


def _said_of(words: Mapping[str, str], each: Explained, known: Estimation) -> str:
    """Return what a table of words says of a mistake."""
    described, kind = known.stated.description, str(each.mistake)
    setups, reading = [described.setups[index] for index in each.setups], known.readings[each.reading]
    artefact = setups[0].artefact if setups else None
    if kind == "jump":
        kind = "backlash" if each.backlash else "jump" if artefact is None else "moved"
    if kind == "unit" and each.reading >= 0:
        kind = "unit_since"
    values = {"factor": each.factor, "number": reading.numbered(each.reading), "reading": known.name_of(each.reading)}
    axis = described.machine.axes[setups[0].moves[0]].name if kind == "backlash" else ""
    first, second = (*(setup.name for setup in setups), "", "")[:2]
    moved, axes = "" if artefact is None else artefact.name, listed(", ", [*each.axes])
    return said(words[kind], setup=first, other=second, artefact=moved, axis=axis, axes=axes, **values)


_STRETCHES: dict[Mistake, str] = WORDS["stretches"]


def _stretch_words(each: Explained, known: Estimation) -> str:
    """Return what is wrong from one reading to another, "" for a mistake of another kind."""
    if each.mistake not in _STRETCHES or each.reading < 0:
        return ""
    event = acceptance(each, known)
    return said(_STRETCHES[each.mistake], setup=event.setups[0], stretch=_between(event))


def _between(event: Accepted) -> str:
    """Return from which reading to which one something is wrong."""
    if event.last:
        return said("from reading {first} to {last}", first=max(event.reading, 1), last=event.last)
    return said("from reading {first} on", first=event.reading)


def question(known: Estimation, named: Explained) -> str:
    """Return what a person is asked about a mistake where the readings agree."""
    if stretch := _stretch_words(named, known):
        return put("{what}?", what=capital(stretch))
    return _said_of(WORDS["mistakes"] | WORDS["questions"], named, known)


def odds_text(each: Explained) -> str:
    """Return how likely a mistake is beside none: "33 : 1", "1 : 12"."""
    if each.odds >= 1:
        return put("{odds} : 1", odds=f"{each.odds:.0f}" if each.odds < _MOST else said("more than a million"))
    return put("1 : {odds:.0f}", odds=1 / each.odds)


def agreement_document(found: Agreement) -> dict[str, object]:
    """Return whether readings agree, for JSON."""
    return {
        "readings": found.count,
        "agreeing": found.agreeing,
        "c2": found.c2,
        "p": found.p,
        "contradict": found.contradicts,
        "explained": [{"mistake": each.mistake, "odds": each.odds} for each in found.explained],
    }


def acceptance(each: Explained, known: Estimation) -> Accepted:
    """Return the event that puts right a mistake that readings name."""
    names = tuple(known.stated.description.setups[index].name for index in each.setups)
    number = 0 if each.reading < 0 else known.readings[each.reading].numbered(each.reading)
    if each.mistake == "jump":
        return jump_before(names[0], number)
    last = 0 if each.last < 0 else known.readings[each.last].numbered(each.last)
    return Accepted(each.mistake, names, number, 1 / each.factor if each.mistake == "unit" else each.factor, last=last)


def _answers(each: Explained, known: Estimation) -> Iterator[tuple[str, Accepted]]:
    """Yield the events that put a mistake right, with what a person says for each."""
    event = acceptance(each, known)
    yield each.mistake, event
    if each.backlash:
        yield "backlash", replace(event, mistake="backlash", name="")
    if each.mistake in _STRETCHES and event.reading and not event.last:
        yield "earlier", replace(event, reading=0, last=event.reading - 1)


def jump_before(setup: str, number: int) -> Accepted:
    """Return the event that the zero of a set-up is another one from a reading on.  number : of that reading"""
    return Accepted("jump", (setup,), number, name=f"{setup}, before reading {number}")


def named(known: Estimation, cause: str, setup: str | None, path: Path) -> Accepted:
    """Return the likeliest mistake of a kind that readings name.

    setup : whose readings, where several are named; path : of the record
    Raises RecordError where they do not name it, or for several set-ups.
    """
    each = [answer for found in known.agreement.explained for answer in _answers(found, known)]
    mine = [one for said_so, one in each if said_so == cause and (setup is None or setup in one.setups)]
    if not mine:
        found = dict.fromkeys(said('{cause} of "{setup}"', cause=name, setup=one.setups[0]) for name, one in each)
        others = listed(", ", list(found)) if found else said("no mistake")
        what = 'The readings do not name "{cause}" of "{setup}" at more than {most:g} : 1; they name {others}'
        if setup is None:
            what = 'The readings do not name "{cause}" at more than {most:g} : 1; they name {others}'
        remedy = "Look at what they name: axiscal step accept {path}"
        raise RecordError(what, remedy, path, cause=cause, setup=setup, most=NAMED, others=others, path=path)
    if len({one.setups for one in mine}) > 1 and setup is None:
        names = ", ".join(dict.fromkeys(f'"{one.setups[0]}"' for one in mine))
        remedy = "Say which one with --setup NAME"
        raise RecordError('The readings name "{cause}" of {names}', remedy, path, cause=cause, names=names)
    return mine[0]


def change_words(accepted: Accepted) -> str:
    """Return what an accepted mistake changes."""
    kind = accepted.mistake
    if kind in ("sign", "unit"):
        kind = "times_between" if accepted.reading or accepted.last else "times"
    if kind == "shifted":
        kind = "behind" if accepted.factor > 0 else "before"
    name, *others = accepted.setups
    setups, stretch = listed(", ", [quoted(each) for each in accepted.setups]), _between(accepted)
    values = {"setups": setups, "number": accepted.reading, "factor": accepted.factor, "stretch": stretch}
    return said(_CHANGES[kind], setup=name, other="".join(others), **values)


_CHANGES: dict[str, str] = WORDS["changes"]
