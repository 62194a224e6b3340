"""A check of loaded tables by a person: what is read where, and what was typed."""

from __future__ import annotations

from collections.abc import Sequence

from axiscal.answers.answer import AnswerDocument
from axiscal.campaign.wrong_unit import refuse_implausible
from axiscal.evaluation.check import Check, FoundAndLeft
from axiscal.exceptions import InputError
from axiscal.language.spoken import listed, said
from axiscal.measurement.reading import Places, Reading, place_text, reading_unit
from axiscal.present.guide.slips import display_text, value_of


class CheckPlace(AnswerDocument):
    """A place to read without the tables and with them.  shows : on a virtual machine what is read each time"""

    setup: str
    place: str
    unit: str
    shows: Sequence[str]


def check_places(check: Check, places: Places, virtual: str) -> list[CheckPlace]:
    """Return what a person reads, place by place.  virtual : the source of a virtual machine, "" of a real one"""
    sides = check.asked(virtual, places) if virtual else ()
    found = list[CheckPlace]()
    for n, place in enumerate(places.listed(check.description.setups)):
        setup = check.description.setup(place.setup)
        axes, sides_of = check.description.machine.axes, {1: said("from below"), -1: said("from above")}
        came = [f"{axes[k].name} {sides_of[place.approach[k]]}" for k in setup.moves if place.approach[k]]
        where = listed(", ", [place_text(axes, place.pose, setup.moves), *came])
        shows = [display_text(readings[n].values, setup) for readings in sides]
        found.append(CheckPlace(setup=place.setup, place=where, unit=reading_unit(setup), shows=shows))
    return found


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
                typed = value_of(texts[n] if n < len(texts) else "", check.description.setup(place.setup))
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
