"""Mistakes that the readings name: those that a person accepts, and what that changes, in words."""

from __future__ import annotations

from pathlib import Path

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import NAMED, Explained
from axiscal.exceptions import RecordError
from axiscal.language.spoken import listed, said
from axiscal.record.accepted import Accepted


def acceptance(each: Explained, known: Estimation) -> Accepted:
    """Return the event that puts right a mistake that readings name."""
    names = tuple(known.stated.description.setups[index].name for index in each.setups)
    number = 0 if each.reading < 0 else known.readings[each.reading].numbered(each.reading)
    if each.mistake == "jump":
        return Accepted("jump", names, number, name=f"{names[0]}, before reading {number}")
    return Accepted(each.mistake, names, number, 1 / each.factor if each.mistake == "unit" else each.factor)


def named(known: Estimation, cause: str, setup: str | None, path: Path) -> Accepted:
    """Return the likeliest mistake of a kind that readings name.

    setup : whose readings, where several are named; path : of the record
    Raises RecordError where they do not name it, or for several set-ups.
    """
    each = [acceptance(found, known) for found in known.agreement.explained]
    mine = [one for one in each if one.mistake == cause and (setup is None or setup in one.setups)]
    if not mine:
        found = dict.fromkeys(said('{cause} of "{setup}"', cause=one.mistake, setup=one.setups[0]) for one in each)
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
    if accepted.mistake == "swapped":
        return said('"{setup}" and "{other}" exchange their values', setup=name, other=accepted.setups[1])
    if accepted.mistake != "shifted":
        what = 'the values of "{setup}" so far are multiplied by {factor:.6g}'
        if accepted.reading:
            what = 'the values of "{setup}" from reading {number} on are multiplied by {factor:.6g}'
        return said(what, setup=name, factor=factor, number=accepted.reading)
    if factor > 0:
        return said('the values of "{setup}" move to the reading behind; the first one is left out', setup=name)
    return said('the values of "{setup}" move to the reading before; the last one is left out', setup=name)
