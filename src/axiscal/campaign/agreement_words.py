"""Words on the agreement of readings: with each other, with the mistake that explains a contradiction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import NAMED, Agreement, Checks, Explained, Mistake
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
    asked = [question(known, each) for each in found.explained]
    if not found.contradicts and asked:
        either = listed(said(" Or: "), asked)
        return said("{count}. {asked} ({odds})", count=count, asked=either, odds=odds_text(found.explained[0]))
    if not found.contradicts:
        unused = [(known.readings[index], index) for index in sorted(known.left_out)]
        names = [put("{number} ({setup})", number=r.numbered(i), setup=quoted(r.setup)) for r, i in unused]
        short = "{agreeing} of {count} readings agree; not used: {names}"
        used = {"agreeing": found.agreeing, "count": found.count}
        text = said(short, names=joined(names, _UNUSED), **used) if names else count
        return listed("; ", [text, *([checks_words(known.checks)] if known.checks.each else [])])
    chance = put("p = {p:.1g}", p=found.p)
    if found.described is not None:
        cause = mistake_words(found.described, known)
        return said("The readings contradict each other ({chance}): {causes}", chance=chance, causes=cause)
    if not found.explained:
        what = "The readings contradict each other ({chance}), and no single mistake explains it: {count}"
        return said(what, chance=chance, count=count)
    causes = listed(said("; or "), [mistake_words(each, known) for each in found.explained])
    text = said("The readings contradict each other ({chance}): {causes}", chance=chance, causes=causes)
    if record is None:
        return text
    cause = found.explained[0].mistake
    return said("{text}. If so: axiscal step accept {record} {cause}", text=text, record=record, cause=cause)


def checks_words(checks: Checks) -> str:
    """Return how many checks are as promised, and s."""
    kept = {"kept": checks.as_promised, "count": len(checks.each)}
    if checks.s is None:
        return said("checks: {kept} of {count} as promised", **kept)
    return said("checks: {kept} of {count} as promised, s = {s:.2f}", s=checks.s, **kept)


def mistake_words(each: Explained, known: Estimation) -> str:
    """Return what went wrong, and what to do about it."""
    setups = known.stated.description.setups
    names = [setups[index].name for index in each.setups]
    if each.mistake == "direction":
        return said("correct direction of {axes} in the machine's file", axes=listed(", ", [*each.axes]))
    if each.mistake == "place":
        what = (
            '"{setup}" does not stand where the campaign says. Correct its place there, or put it there and read it '
            "again"
        )
        return said(what, setup=names[0])
    if each.mistake == "still":
        what = '"{setup}" shows one value at all places. Look whether it touches and follows; read it again'
        return said(what, setup=names[0])
    if each.mistake == "noise":
        what = '"{setup}" scatters by {share:.1g} of its stated noise. Check unit and display, or state its own noise'
        return said(what, setup=names[0], share=each.factor)
    if each.mistake == "jump":
        if (artefact := setups[each.setups[0]].artefact) is not None:
            what = (
                '"{artefact}" moved in "{setup}" before {reading}. Fix it, and take readings before and after it again'
            )
            return said(what, artefact=artefact.name, setup=names[0], reading=known.name_of(each.reading))
        if each.backlash:
            what = 'the zero of "{setup}" jumped before {reading}; or {axis} has that backlash: accept backlash'
            axis = _turned(known, each)
            return said(what, setup=names[0], reading=known.name_of(each.reading), axis=axis)
        what = 'the zero of "{setup}" jumped before {reading}. Take readings before and after it again'
        return said(what, setup=names[0], reading=known.name_of(each.reading))
    if stretch := _stretch_words(each, known):
        what = "{what} (or the earlier ones do: accept earlier). Correct them"
        return said("{what}. Correct them" if each.last >= 0 else what, what=stretch)
    if each.mistake == "sign":
        return said('all values of "{setup}" have the wrong sign. Record them anew with the other sign', setup=names[0])
    if each.mistake == "unit":
        what = 'all values of "{setup}" are {factor:.4g} times what they should be. Check their unit'
        if each.reading >= 0:
            what = "from {reading} on, values are {factor:.4g} times what they should be. Check the display's unit"
        return said(what, setup=names[0], factor=each.factor, reading=known.name_of(each.reading))
    if each.mistake == "stuck":
        what = "from {reading} on, values repeat what was shown before. If the instrument is stuck, read there again"
        return said(what, reading=known.name_of(each.reading))
    if each.mistake == "shifted":
        return said('the values of "{setup}" belong to the place before or after. Check their order', setup=names[0])
    if each.mistake == "frame":
        what = (
            'the values of "{setup}" are along the machine\'s x, y, z, which do not turn with the table. Give what the '
            "control found as found_x_mm, found_y_mm, found_z_mm"
        )
        return said(what, setup=names[0])
    return said('the values of "{setup}" and "{other}" are swapped', setup=names[0], other=names[1])


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
    setup, reading = known.stated.description.setups[named.setups[0]], known.readings[named.reading]
    if named.mistake == "shifted":
        return said('Do the values of "{setup}" belong to the place before or after?', setup=setup.name)
    if named.mistake == "still":
        return said('Does "{setup}" show one value at all places, though the machine moves?', setup=setup.name)
    number = reading.numbered(named.reading)
    if named.mistake == "stuck":
        what = 'From reading {number} on "{setup}" shows again what it showed before. Is it stuck?'
        return said(what, setup=setup.name, number=number)
    if named.backlash:
        what = '"{setup}" shows a step before reading {number}, where {axis} turned: zero set anew, or backlash?'
        return said(what, setup=setup.name, number=number, axis=_turned(known, named))
    if setup.artefact is not None:
        what = 'Was "{artefact}" moved in "{setup}" before reading {number}?'
        return said(what, artefact=setup.artefact.name, setup=setup.name, number=number)
    return said('Was the zero of "{setup}" set anew before reading {number}?', setup=setup.name, number=number)


def _turned(known: Estimation, jump: Explained) -> str:
    """Return the axis that turned where a jump may be backlash."""
    described = known.stated.description
    return described.machine.axes[described.setups[jump.setups[0]].moves[0]].name


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
    name, factor = accepted.setups[0], accepted.factor
    if accepted.mistake == "jump":
        what = 'the readings of "{setup}" before reading {number} have a zero of their own'
        return said(what, setup=name, number=accepted.reading)
    if accepted.mistake == "backlash":
        return said('the step of "{setup}" before reading {number} is backlash', setup=name, number=accepted.reading)
    if accepted.mistake == "swapped":
        return said('"{setup}" and "{other}" exchange their values', setup=name, other=accepted.setups[1])
    if accepted.mistake == "stuck":
        names = listed(", ", [quoted(each) for each in accepted.setups])
        what = "values of {setups} that repeat the one before, from reading {number} on, are left out"
        return said(what, setups=names, number=accepted.reading)
    if accepted.mistake == "still":
        return said('the values of "{setup}" so far are left out', setup=name)
    if accepted.mistake == "frame":
        return said('the values of "{setup}" so far are turned from the machine to the workpiece', setup=name)
    if accepted.mistake == "sides":
        return said('the sides of "{setup}" {stretch} are exchanged', setup=name, stretch=_between(accepted))
    if accepted.mistake == "mirrored":
        what = 'the values of "{setup}" {stretch} change their order, from turn to turn'
        return said(what, setup=name, stretch=_between(accepted))
    if accepted.mistake != "shifted":
        what = 'the values of "{setup}" so far are multiplied by {factor:.6g}'
        if not (accepted.reading or accepted.last):
            return said(what, setup=name, factor=factor)
        what = 'the values of "{setup}" {stretch} are multiplied by {factor:.6g}'
        return said(what, setup=name, factor=factor, stretch=_between(accepted))
    if factor > 0:
        return said('the values of "{setup}" move to the reading behind; the first one is left out', setup=name)
    return said('the values of "{setup}" move to the reading before; the last one is left out', setup=name)
