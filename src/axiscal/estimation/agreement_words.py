"""Words on the agreement of the readings with each other, and on the mistake that explains a contradiction."""

from __future__ import annotations

from pathlib import Path

from axiscal.estimation.estimation import Estimation
from axiscal.estimation.promise.agreement import Agreement, Explained
from axiscal.language.spoken import listed, put, said


def agreement_words(known: Estimation, record: Path | None = None) -> str:
    """Return how many readings agree with the others, or that they contradict, with the mistakes that are named.

    record : its path, where the command that accepts the likeliest one is said besides
    """
    found = known.agreement
    count = said("{agreeing} of {count} readings agree with the others", agreeing=found.agreeing, count=found.count)
    if not found.contradicts:
        return count
    chance = put("p = {p:.1g}", p=found.p)
    if found.against:
        what = "The readings contradict each other ({chance}): correct direction of {axes} in the machine's file"
        return said(what, chance=chance, axes=listed(", ", [*found.against]))
    if not found.explained:
        what = "The readings contradict each other ({chance}), and no single mistake explains it: {count}"
        return said(what, chance=chance, count=count)
    causes = listed(said("; or "), [mistake_words(each, known) for each in found.explained])
    text = said("The readings contradict each other ({chance}): {causes}", chance=chance, causes=causes)
    if record is None:
        return text
    cause = found.explained[0].mistake
    return said("{text}. If so: axiscal accept {record} {cause}", text=text, record=record, cause=cause)


def mistake_words(each: Explained, known: Estimation) -> str:
    """Return what went wrong, and what to do about it."""
    setups = known.stated.description.setups
    names = [setups[index].name for index in each.setups]
    if each.mistake == "jump":
        if (artefact := setups[each.setups[0]].artefact) is not None:
            what = (
                '"{artefact}" moved in "{setup}" before {reading}. Fix it, and take readings before and after it again'
            )
            return said(what, artefact=artefact.name, setup=names[0], reading=known.name_of(each.reading))
        what = 'the zero of "{setup}" jumped before {reading}. Take readings before and after it again'
        return said(what, setup=names[0], reading=known.name_of(each.reading))
    if each.mistake == "sign":
        return said('all values of "{setup}" have the wrong sign. Record them anew with the other sign', setup=names[0])
    if each.mistake == "unit":
        what = 'all values of "{setup}" are {factor:.4g} times what they should be. Check their unit'
        return said(what, setup=names[0], factor=each.factor)
    if each.mistake == "shifted":
        return said('the values of "{setup}" belong to the place before or after. Check their order', setup=names[0])
    return said('the values of "{setup}" and "{other}" are swapped', setup=names[0], other=names[1])


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
