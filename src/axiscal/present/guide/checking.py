"""A check of loaded tables by a person: what is read where, and what was typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

from axiscal.answers.answer import AnswerDocument
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.document.durable import write_whole
from axiscal.evaluation.check import Check, FoundAndLeft, Taken
from axiscal.exceptions import InputError
from axiscal.language.spoken import listed, said
from axiscal.measurement.readers.csv_readings import filled_sheet
from axiscal.measurement.reading import Places, Reading, place_text, reading_units
from axiscal.present.check_answer import check_answer, check_plan, check_sentences
from axiscal.present.guide.question import measured
from axiscal.present.guide.slips import display_text
from axiscal.present.sentences import spelt
from axiscal.record.signing import hand_now
from axiscal.units import digits, to_unit


class CheckPlace(AnswerDocument):
    """A place to read without the tables and with them.  shows : on a virtual machine what is read each time"""

    setup: str
    place: str
    unit: str
    shows: Sequence[str]


class CheckToTake(AnswerDocument):
    """A check of loaded tables: what is read and why, in words; tolerance : the largest deviation, as text"""

    sentences: Sequence[str]
    tolerance: str
    places: Sequence[CheckPlace]

    @classmethod
    def of(cls, check: Check, virtual: str) -> Self:
        """Return where tables are to be checked.  virtual : the source of a virtual machine, "" of a real one"""
        places, found = check.planned(tolerance=check.allowed(None)), list[CheckPlace]()
        sides = check.asked(virtual, places) if virtual else ()
        axes, sides_of = check.description.machine.axes, {1: said("from below"), -1: said("from above")}
        for n, place in enumerate(places.listed(check.description.setups)):
            setup = check.description.setup(place.setup)
            came = [f"{axes[k].name} {sides_of[place.approach[k]]}" for k in setup.moves if place.approach[k]]
            where = listed(", ", [place_text(axes, place.pose, setup.moves), *came])
            shows = [display_text(readings[n].values, setup) for readings in sides]
            found.append(CheckPlace(setup=place.setup, place=where, unit=reading_units(setup), shows=shows))
        return cls(
            sentences=[spelt(line) for line in check_plan(check, places)[1]],
            tolerance=f"{digits(to_unit(check.allowed(None) or check.tables.certain, 'um'))} um",
            places=found,
        )


class CheckJudged(AnswerDocument):
    """What a check says; faults : what is wrong, by its field ("tolerance", "found.0", "left.0")."""

    verdict: str = ""
    sentences: Sequence[str] = ()
    faults: Mapping[str, str] = {}

    @classmethod
    def of(cls, check: Check, found: Sequence[str], left: Sequence[str], tolerance: str, folder: Path) -> Self:
        """Return what readings say that were typed, or what is wrong with each.  folder : takes them as two files"""
        places = check.planned(tolerance=check.allowed(None))
        readings, faults = typed_readings(check, places, found, left, tolerance)
        if faults:
            return cls(faults=faults)
        for name, each in zip(("found.csv", "left.csv"), readings, strict=True):  # as `axiscal verify` takes them
            write_whole(folder / name, filled_sheet(check.description.machine.axes, each).encode())
        judged, taken = check.judged(readings, tolerance), Taken(hand_now().person, "page")
        answer = check_answer(judged, len(places), check.tables.certain, taken)
        return cls(verdict=answer.verdict, sentences=[spelt(line) for line in check_sentences(answer)])


def typed_readings(
    check: Check, places: Places, found: Sequence[str], left: Sequence[str], tolerance: str
) -> tuple[FoundAndLeft, dict[str, str]]:
    """Return the readings of both sides that a person typed, and what is wrong by its field; raises ReadingError.

    found, left : in the order of places.  Fields are "found.0", "left.3", "tolerance"
    """
    faults, sides = dict[str, str](), dict[str, tuple[Reading, ...]]()
    for side, texts in (("found", found), ("left", left)):
        readings = list[Reading]()
        for n, place in enumerate(places.listed(check.description.setups)):
            try:
                typed = measured(texts[n] if n < len(texts) else "", check.description.setup(place.setup))
            except InputError as failure:
                faults[f"{side}.{n}"] = str(failure)
            else:
                value, *others = typed.tolist()
                readings.append(Reading(place.setup, place.pose, place.approach, value, others=tuple(others)))
        sides[side] = tuple(readings)
    try:
        check.allowed(tolerance)
    except InputError as failure:
        faults["tolerance"] = str(failure)
    if not faults:
        refuse_implausible(sides["found"], check.description, said("without the tables"))
    return (sides["found"], sides["left"]), faults
