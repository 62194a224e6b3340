"""A check of loaded tables by a person: what is read where, and what was typed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Self

from axiscal.campaign.campaign import Campaign
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.document.durable import write_whole
from axiscal.evaluation.check import Check, tolerance_of
from axiscal.exceptions import InputError
from axiscal.language.spoken import listed, said
from axiscal.measurement.readers.csv_readings import filled_sheet
from axiscal.measurement.reading import Reading, place_text, reading_units
from axiscal.present.answer import AnswerDocument
from axiscal.present.check_answer import check_plan, check_sentences
from axiscal.present.guide.question import measured
from axiscal.present.guide.slips import display_text
from axiscal.present.sentences import spelt
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
    def of(cls, campaign: Campaign, control: str, virtual: str) -> Self:
        """Return where tables of a control are to be checked.  virtual : the source of a machine, "" of a real one"""
        check, found = Check.from_campaign(campaign, control), list[CheckPlace]()
        places, tolerance = check.planned(tolerance=check.known(None)), tolerance_of(check.description.target, None)
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
            tolerance="" if tolerance is None else spelt(f"{digits(to_unit(tolerance, 'um'))} um"),
            places=found,
        )


class CheckJudged(AnswerDocument):
    """What a check says; faults : what is wrong, by its field ("tolerance", "found.0", "left.0")."""

    verdict: str = ""
    sentences: Sequence[str] = ()
    faults: Mapping[str, str] = {}

    @classmethod
    def of(cls, check: Check, found: Sequence[str], left: Sequence[str], tolerance: str, folder: Path) -> Self:
        """Return what readings say that were typed, or what is wrong with each; raises ReadingError.

        found, left : in the order of the places; folder : takes them as two files, as `axiscal verify` takes them
        """
        places, faults = check.planned(tolerance=check.known(None)), dict[str, str]()
        sides = [list[Reading](), list[Reading]()]
        for side, texts, readings in zip(("found", "left"), (found, left), sides, strict=True):
            for n, place in enumerate(places.listed(check.description.setups)):
                text = texts[n] if n < len(texts) else ""
                try:
                    value, *others = measured(text, check.description.setup(place.setup)).tolist()
                except InputError as failure:
                    faults[f"{side}.{n}"] = str(failure) if text.strip() else said("missing")
                else:
                    readings.append(Reading(place.setup, place.pose, place.approach, value, others=tuple(others)))
        try:
            check.known(tolerance.strip() or None)
        except InputError as failure:
            faults["tolerance"] = str(failure)
        if faults:
            return cls(faults=faults)
        refuse_implausible(sides[0], check.description, said("without the tables"))
        for name, each in zip(("found.csv", "left.csv"), sides, strict=True):
            write_whole(folder / name, filled_sheet(check.description.machine.axes, each).encode())
        judged = check.judged((tuple(sides[0]), tuple(sides[1])), tolerance.strip() or None)
        return cls(verdict=judged.verdict, sentences=[spelt(line) for line in check_sentences(judged)])
