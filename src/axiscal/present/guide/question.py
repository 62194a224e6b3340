"""The next reading as the person at the machine has to know it: what to mount, where to go, from which side.

So much has to be known: the position of each axis, and the side from which it comes there; what a person sees when the
reading is positive, and what it should show; where to park and what to zero where a set-up is mounted first.

What a person types at the prompt stands here too: a value, or a word for something else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.estimation.prediction import expectation
from axiscal.exceptions import ReadingError
from axiscal.language.spoken import counted, later, said
from axiscal.measurement.reading import (
    asked_values,
    place_text,
    reading_unit,
    refuse_other_values,
    sense,
    shown_coordinate,
    units_of,
)
from axiscal.measurement.setup import SQUARE, Setup
from axiscal.measurement.touched import off_ball
from axiscal.numerics import Array
from axiscal.present.answer import AnswerDocument
from axiscal.record.events import Asked
from axiscal.units import parse_quantity, to_unit
from axiscal_core.machine import Machine

_PLAIN = re.compile(r"[+−-]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)(?:[eE][+-]?[0-9]+)?")
_MORE = re.compile(r"\s*[+−-]?[0-9.,]")
_SEVERAL = re.compile(r"\s*[;/]\s*|\s*,\s+|(?<=[^\W\d]),|\s+(?=[+−-]?[.,]?[0-9])")


Stands = tuple[Machine, Sequence[float]]
"""A machine and the pose (q,) at which it stands, m or rad."""
_FOUND = later("found")  # before the places of X, Y, Z at which a ball was met
ACTIONS = ("undo", "skip", "note", "leave", "stop", "pause", "help", "anew", "more")
"""What can be typed instead of a reading; `more` once a target is reached."""
_SHORT = {"u": "undo", "s": "skip", "n": "note", "l": "leave", "a": "anew", "q": "pause", "p": "pause", "?": "help"}
_SHORT |= {"h": "help", "quit": "pause", "exit": "pause", "finish": "stop", "end": "stop"}


def action(word: str) -> str | None:
    """Return what a word asks for, in English or in the language that is spoken; None for none, "" for no word."""
    known = _SHORT | {each: each for each in ACTIONS} | {said(each).lower(): each for each in ACTIONS}
    return known.get(word.lower()) if word else ""


def typed(campaign: Campaign, text: str) -> Array:
    """Return the reading that was typed for what is asked, as `measured`; raises RecordError where nothing is."""
    place, described = campaign.open_question().place, campaign.description
    return measured(text, described.setup(place.setup), (described.machine, place.pose))


def measured(text: str, setup: Setup, stands: Stands | None = None, *, bare: bool = True) -> Array:
    """Return the reading that was typed, (k,) m or rad; raises ReadingError or UnitError.

    stands : as it was asked to, by which `found X Y Z` is a reading
    bare : a number is in the unit of the set-up where none is said; else it has to have one. A place found is in mm.
    Decimals come after a point or a comma. Three values are parted by blanks, semicolons or commas with a blank.
    """
    if stands is not None and (met := _found_at(text, setup, stands)) is not None:
        return met
    if bare and (not text.strip() or text.strip()[0].isalpha()):
        what = said('"{text}" is no reading', text=text.strip())
        raise ReadingError(what, said("Type the number that the instrument shows"))
    each = zip(_value_texts(text.strip(), setup), units_of(setup), setup.reads_each, strict=True)
    return np.array([parse_quantity(_with_unit(part, unit) if bare else part, reads) for part, unit, reads in each])


def _found_at(text: str, setup: Setup, stands: Stands) -> Array | None:
    """Return the reading, (3,) m, of `found X Y Z`, where the machine's axes stood with a ball found; None of another.

    Raises ReadingError or UnitError.
    """
    word, _, places = text.strip().partition(" ")
    if word.lower() not in (_FOUND, said(_FOUND).lower()):
        return None
    refuse_other_values(setup, len("XYZ"))
    machine, pose = stands
    met = [parse_quantity(_with_unit(part, "mm"), "length") for part in _value_texts(places, setup)]
    return np.array(off_ball(machine, setup, np.array(pose), met))


def _with_unit(text: str, unit: str) -> str:
    """Return a number with a decimal point and its unit, which is `unit` where none is said; another text as it is.

    Raises ReadingError for digits behind a number.
    """
    found = _PLAIN.match(text)
    if found is None:
        return text
    if _MORE.match(text, found.end()):
        what = said('"{text}" is no number', text=text)
        raise ReadingError(what, said("Write its digits together, with one point or comma, as in 1234.5"))
    return found[0].replace(",", ".").replace("−", "-") + (text[found.end() :].strip() or unit)


def degrees(text: str) -> str:
    """Return a temperature as it was typed, in degC where no unit is said; raises UnitError for another text."""
    text = f"{text.strip()} degC" if _PLAIN.fullmatch(text.strip()) else text.strip()
    parse_quantity(text.replace(",", "."), "temperature")
    return text


def _value_texts(text: str, setup: Setup) -> list[str]:
    """Return the texts of the values of a reading; a unit after the last alone is of all. Raises ReadingError."""
    count = len(setup.names)
    parts = _SEVERAL.split(text.strip()) if count > 1 else [text]
    if len(parts) != count:
        given = counted("one value", "{count} values", len(parts))
        what = said('"{text}" is {given}, and the instrument gives {count}', text=text, given=given, count=count)
        raise ReadingError(what, said("Type each of {names}", names=asked_values(setup)))
    if len({*units_of(setup)}) > 1:
        return parts
    numbers = [_PLAIN.match(part) for part in parts]
    bare = [number is not None and number.end() == len(part) for part, number in zip(parts, numbers, strict=True)]
    if all(bare[:-1]) and (last := numbers[-1]) is not None:
        unit = parts[-1][last.end() :]
        return [*(part + unit for part in parts[:-1]), parts[-1]]
    if any(bare):
        what = said('"{text}" has a unit for some of its values', text=text)
        raise ReadingError(what, said("Give one unit after the last, or one for each"))
    return parts


_DIGITS = 4
"""Behind the point: one more than controls show; a reading there differs by less than its noise."""


class AxisPlace(AnswerDocument):
    """axis : its name; value : in its unit, mm or deg; moves : whether the set-up moves it

    diameter : whether its display shows diameters; value is the radius
    changed : whether it stood elsewhere at the reading before, or there was none
    side : "+" where it comes from below, "-" from above, "" where that does not matter
    """

    axis: str
    value: float
    unit: str
    moves: bool
    changed: bool
    side: Literal["+", "-", ""]
    diameter: bool = False

    @property
    def shown(self) -> str:
        """The coordinate to a tenth of a micrometre, or of a thousandth of a degree, without zeros behind."""
        return f"{round(self.value, _DIGITS) + 0.0:.{_DIGITS}f}".rstrip("0").rstrip(".")


class ExpectedNumber(AnswerDocument):
    """What one number of the reading is expected to be: mean, and half of the band that is shown."""

    mean: float
    half: float


class Question(AnswerDocument):
    """The reading to take. `mount` says whether its set-up has to be mounted first; mounting : names and what to do

    touch : the ball, and how to get there; again : which reading has been taken there before, in words
    check : that the place was drawn at random, in words
    unit : of the values when none is typed; units : of each of them; asks : what is to be typed, with its unit
    names : of the numbers of a reading, x, y, z or those of stations; "" of a single one
    """

    number: int
    setup: str
    instrument: str
    mount: bool
    mount_sentence: str
    mounting: Sequence[tuple[str, str]]
    places: list[AxisPlace]
    touch: str
    again: str
    check: str = ""
    sign: str
    unit: str
    expected: list[ExpectedNumber]
    names: list[str]
    units: list[str]
    asks: str

    @classmethod
    def from_campaign(cls, campaign: Campaign, asked: Asked) -> Question:
        """Return what is asked."""
        setup, readings = campaign.description.setup(asked.place.setup), campaign.state.readings
        places, touch, unit = axis_places(campaign, asked), touch_text(campaign, asked), reading_unit(setup)
        mean, std = expectation(campaign.estimate(), asked.place)
        means, halves = to_unit(mean, unit).tolist(), to_unit(BAND * std, unit).tolist()
        there = [reading.numbered(n) for n, reading in enumerate(readings) if reading.place == asked.place]
        # readings of the same place show together whether a zero has wandered
        anew = "where reading {number} was taken: go there anew, do not copy it"
        again = said(anew, number=there[-1]) if there else ""
        return cls(
            number=asked.reading,
            setup=setup.name,
            instrument=setup.title,
            mount=not readings or readings[-1].setup != setup.name,
            mount_sentence=mount_sentence(setup, places),
            mounting=mount_steps(setup, places, touch),
            places=places,
            touch=touch,
            again=again,
            check=said("drawn at random: what the others promise is judged by it") if asked.place.check else "",
            sign=sign_on(campaign.description.machine, setup),
            unit=unit,
            expected=[ExpectedNumber(mean=mean, half=half) for mean, half in zip(means, halves, strict=True)],
            names=list(setup.names),
            units=list(units_of(setup)),
            asks=asked_values(setup),
        )

    def surprise(self, values: Array) -> float:
        """Return by how many standard deviations the most surprising of the numbers is away.  values : (k,) m or rad"""
        means, halves = np.array([(each.mean, each.half) for each in self.expected]).T
        return float(np.max(BAND * np.abs(to_unit(values, self.unit) - means) / halves))


def question_text(places: Sequence[AxisPlace], touch: str, sign: str, *others: tuple[str, str]) -> str:
    """Return where to go, how, when a reading is positive, and other lines, each behind its name; none is empty."""
    sides = {"+": said("from below"), "-": said("from above")}
    rows = (
        (said("go to"), coordinates_text(places, moves=True)),
        (said("coming"), ", ".join(f"{place.axis} {sides[place.side]}" for place in places if place.side)),
        (said("parked"), coordinates_text(places, moves=False)),
        (said("touch"), touch),
        (said("sign"), sign),
        *others,
    )
    return "\n".join(f"  {name:<9} {what}" for name, what in rows if what)


def coordinates_text(places: Sequence[AxisPlace], *, moves: bool) -> str:
    """Return where the axes go that move, or where the others stand: "X = 120 mm", in the order of the display."""
    found = []
    for place in places:
        text = f"{place.axis} = {place.shown} {place.unit}"
        if place.diameter:
            twice = place.model_copy(update={"value": 2 * place.value}).shown
            text = said("{place} (the diameter {twice} mm)", place=text, twice=twice)
        found += [text] if place.moves is moves else []
    return ", ".join(found)


def touch_text(campaign: Campaign, asked: Asked) -> str:
    """Return at which ball a reading is taken, and how the machine turns there; empty where there is neither."""
    setup, machine = campaign.description.setup(asked.place.setup), campaign.description.machine
    if setup.contact == "free" or not len(setup.balls or (setup.station or ())):
        return ""
    together = said("all axes together, the tool point held")
    way = f"{together} (TRAORI, TCPM, G43.4)" if setup.contact == "held" else said("off the ball, turn, and back to it")
    if setup.artefact is None:
        return way if any(machine.axes[k].rotary for k in setup.moves) else ""
    tip = machine.frames(np.array([asked.place.pose])).tcp
    ball = setup.artefact.balls[int(setup.artefact.nearest(tip, setup.balls)[0])]
    return said("ball {ball} of {artefact}: {way}", ball=ball.name, artefact=setup.artefact.name, way=way)


def asked_text(campaign: Campaign, asked: Asked) -> str:
    """Return which reading was asked for: 'reading 7 in "laser" at X = 120 mm'."""
    setup = campaign.description.setup(asked.place.setup)
    where = place_text(campaign.description.machine.axes, asked.place.pose, setup.moves)
    return said('reading {number} in "{setup}" at {place}', number=asked.reading, setup=setup.name, place=where)


def axis_places(campaign: Campaign, asked: Asked) -> list[AxisPlace]:
    """Return where the axes are to stand, linear axes first, by their letters, as a control shows them."""
    setup, readings = campaign.description.setup(asked.place.setup), campaign.state.readings
    before = readings[-1].pose if readings else None
    found = (
        AxisPlace(
            axis=axis.name,
            value=shown_coordinate(asked.place.pose[k], axis),
            unit=axis.unit,
            moves=k in setup.moves,
            changed=before is None or before[k] != asked.place.pose[k],
            side={1: "+", -1: "-"}.get(asked.place.approach[k], ""),
            diameter=axis.diameters,
        )
        for k, axis in enumerate(campaign.description.machine.axes)
    )
    return sorted(found, key=lambda place: (place.unit != "mm", place.axis))


def sign_on(machine: Machine, setup: Setup) -> str:
    """Return when a reading is positive, and that x, y and z turn with a table where one turns in the set-up."""
    sign, axes = sense(setup).sign, [machine.axes[k] for k in setup.moves]
    turns = any(axis.rotary and axis.workpiece_side for axis in axes) and "x" in setup.names
    return said("{sign}; x, y and z turn with the table", sign=sign) if turns else sign


BAND = 2.0
"""Standard deviations about the expectation that are shown; a matter of taste."""
SURPRISING = 4.0
"""Standard deviations from which a person is asked before a reading is kept: one in 16,000 by chance."""


def mount_sentence(setup: Setup, places: Sequence[AxisPlace]) -> str:
    """Return what to mount and what it will read."""
    reads, moving = sense(setup).reads, [place.axis for place in places if place.moves]
    words, stands = "mount: {instrument}; it reads {reads}", ""
    square = next((unknown.owner for unknown in setup.unknowns if unknown.name in SQUARE), "")
    if setup.artefact is not None:
        words = "set up {artefact}, and mount: {instrument}; it reads {reads}"
        stands = setup.artefact.standing
    mounted = said(words, artefact=stands, instrument=square or said(setup.title), reads=reads)
    return said("{mounted}, while {axis} moves", mounted=mounted, axis=moving[0]) if len(moving) == 1 else mounted


def mount_steps(setup: Setup, places: Sequence[AxisPlace], touch: str) -> tuple[tuple[str, str], ...]:
    """Return the steps, each as a short name and what to do."""
    zeroed = any(unknown.name.startswith("zero") for unknown in setup.unknowns)
    first = said("zero its display, roughly") if zeroed else ""
    if zeroed and setup.usual.contact == "retracted":  # as printers and controls say where a probe touches
        first = said("touch; type minus the coordinate there: 0.042 mm is -0.042 mm")
    steps = (
        (said("park"), coordinates_text(places, moves=False)),
        (said("go to"), coordinates_text(places, moves=True)),
        (said("at"), touch),
        (said("then"), first),
    )
    return tuple(step for step in steps if step[1])
