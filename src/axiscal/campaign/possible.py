"""Whether what a record says can have happened on its machine: places inside the travel, values that can be read."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

from axiscal.campaign.agreement_words import jump_before
from axiscal.description.campaign import CampaignDescription, description_of, with_mounted
from axiscal.description.fields import WARM
from axiscal.description.stated_type_b import takes_temperature
from axiscal.estimation.case import Case
from axiscal.estimation.known_rows import refuse_unmade
from axiscal.exceptions import InputError, ReadingError, RecordError, UnitError
from axiscal.language.spoken import said
from axiscal.measurement.reading import LARGEST, Place, reading_unit, refuse_other_values
from axiscal.measurement.setup import FINEST, Setup
from axiscal.record.accepted import Accepted, Bumped
from axiscal.record.carried import carried_bumps
from axiscal.record.door import restoring
from axiscal.record.events import Asked, Created, Event, Mounted, Noted, Planned, Recorded, State, Warmed
from axiscal.record.store import Record
from axiscal.units import format_quantity, parse_quantity, within
from axiscal_core.refusals import one

LONGEST_TEXT = 2000
"""Characters of a note or a reason that a person types; a matter of taste."""
_LEAST = 1e-12
"""m or rad: a hundredth of what may be said; beside a standard deviation below it nothing of an estimate is left."""
_LATEST = 1e10
"""Seconds from the beginning of a campaign, three hundred years: any bound that is still a date would do."""
_SLACK = 1e-6
"""Of the travel: rounding of places that were computed, far above that of a float and far below what is measured."""


def versions() -> dict[str, str]:
    """Return the versions of axiscal and of what it computes with, by name."""
    return {"axiscal": version("axiscal"), "numpy": version("numpy"), "python": platform.python_version()}


def described(record: Record) -> CampaignDescription:
    """Return the description that a record carries; raises RecordError where what happened cannot be on its machine."""
    state = record.state()
    if state.created is None:
        raise RecordError("The record is empty", "Start a campaign with `axiscal step start`", record.path)
    description = description_of(state.created)
    possible = Possible(description)
    for stored in record.events():
        try:
            possible.take(stored.event)
        except InputError as fault:
            what, number = "The record is damaged: event {number} cannot be: {reason}", stored.number
            raise RecordError(what, restoring(record.path), record.path, number=number, reason=fault.what) from None
    bumps = *(carried_bumps(text) if (text := state.created.prior_text) else ()), *state.told(Bumped)
    return replace(with_mounted(description, state.mounted, state.told(Warmed)), bumps=bumps)


def beginning_of(description: CampaignDescription) -> Created:
    """Return the event with which a campaign of a description begins; raises DescriptionError where it cannot."""
    one("Campaign.create", "description", description, CampaignDescription, 'read_campaign("campaign.toml")')
    refuse_unmade(Case(description))
    texts = description.machine.text, description.text, description.machine_source, description.source
    return Created(*texts, versions(), description.prior_text, *description.era)


def kept_text(text: str, what: str, remedy: str) -> str:
    """Return a note or a reason without the blanks about it; raises ReadingError for an empty one or a book.

    what : it is; remedy : where it is empty
    """
    text = text.strip()
    if not text:
        raise ReadingError("the {kind} is empty", remedy, kind=said(what))
    if len(text) > LONGEST_TEXT:
        shorter = "Write up to {most}, and say there in which file the rest is"
        raise ReadingError(
            "the {kind} has {count} characters", shorter, kind=said(what), count=len(text), most=LONGEST_TEXT
        )
    return text


def jump_told(state: State, setup: str | None, number: int, path: Path) -> Accepted:
    """Return the event that a zero was set anew, as a person tells it.

    setup : its name, by default of what is asked or was read last; number : of the first reading behind that
    Raises RecordError where none of its readings stands before that.
    """
    setup = _standing(state) if setup is None else setup
    mine = [reading.numbered(i) for i, reading in enumerate(state.readings) if reading.setup == setup]
    if not mine or not mine[0] < number <= state.free:
        what = 'No zero of "{setup}" can change before reading {number}: none of its readings stands before that'
        remedy = "Name a reading behind its first with --before, up to the next one, and the set-up with --setup"
        raise RecordError(what, remedy, path, setup=setup, number=number)
    return jump_before(setup, number)


def note_told(description: CampaignDescription, state: State, text: str) -> Noted | Warmed:
    """Return a note, or where the text is a temperature such as "21.4 degC", that of the scale that is read.

    Raises DescriptionError for one that no scale has, ReadingError where it changes nothing.
    """
    text = kept_text(text, "note", "Write what is to be kept in the record")
    plain = text.replace(",", ".")
    try:
        parse_quantity(plain, "temperature")
    except UnitError:
        return Noted(text)
    name, kelvin = _standing(state), within(plain, "temperature", *WARM)
    if not any(takes_temperature(each) for each in description.setups if each.name == name):
        what = '"{setup}" compares no length of the machine with one at 20 degC: its temperature changes nothing'
        raise ReadingError(what, "Write a sentence: note the workshop has {text}", setup=name, text=text)
    return Warmed(name, kelvin, text)


def _standing(state: State) -> str:
    """Return the set-up of what is asked, else read last, else planned first, "" for none."""
    last = state.readings[-1:] or state.plan[:1] if state.pending is None else [state.pending.place]
    gone = {each.name: each.setup for each in state.mounted}
    return next((gone.get(each.setup, each.setup) for each in last), "")


def refuse_unreadable(setup: Setup, values: Sequence[float], std: float | None, least: float = FINEST) -> None:
    """Raise ReadingError for what a set-up's instrument does not read.  values, std : m or rad; least : smallest std"""
    for value in (*values, std or 0.0):
        if not abs(value) < LARGEST:
            remedy = "Give the reading with its unit, such as 1.7 um"
            raise ReadingError("{value:g} m or rad is no deviation of a machine", remedy, value=value)
    refuse_other_values(setup, len(values))
    if std is not None and not std >= least:
        remedy = "Give one of at least 0.1 nm or 0.1 nrad, or none"
        shown = format_quantity(std, reading_unit(setup))
        raise ReadingError("{std} is no standard deviation", remedy, std=shown)


_BACK = "Put it back from a copy"


class Possible:
    """What can happen on the machine of a campaign, with its set-ups by the names that they have had."""

    def __init__(self, description: CampaignDescription) -> None:
        self._axes = description.machine.axes
        self._setups = {setup.name: setup for setup in description.setups}

    def take(self, event: Event) -> None:
        """Take an event in; raises RecordError, ReadingError where it cannot be."""
        match event:
            case Recorded(reading):
                self._refuse_place(reading)
                refuse_unreadable(self._setups[reading.setup], reading.values, reading.std, _LEAST)
                if reading.time is not None and not abs(reading.time) < _LATEST:
                    raise RecordError("{seconds:g} s after its beginning", _BACK, seconds=reading.time)
            case Asked(place=place):
                self._refuse_place(place)
            case Planned(places):
                for place in places:
                    self._refuse_place(place)
            case Warmed(setup):
                self._setup(setup)
            case Mounted(setup, name):
                self._mount(setup, name, name in self._setups)
            case Accepted(setups=setups, name=name):  # the same once more where that was taken back
                for setup in setups:
                    self._setup(setup)
                if name:
                    self._mount(setups[0], name, name in self._setups and self._setups[name].name == name)

    def _setup(self, name: str) -> Setup:
        if name not in self._setups:
            raise RecordError('there is no set-up "{name}"', _BACK, name=name[:60])
        return self._setups[name]

    def _mount(self, setup: str, name: str, taken: bool) -> None:
        mounted = self._setup(setup)
        if taken:
            raise RecordError('there is a set-up "{name}" already', _BACK, name=name[:60])
        self._setups[name] = mounted

    def _refuse_place(self, at: Place) -> None:
        self._setup(at.setup)
        if other := {len(at.pose), len(at.approach)} - {len(self._axes)}:
            what = "the place has {count} coordinates, and the machine {axes} axes"
            raise RecordError(what, _BACK, count=max(other), axes=len(self._axes))
        for value, axis in zip(at.pose, self._axes, strict=True):
            (low, high), slack = axis.travel, _SLACK * axis.length
            if not low - slack <= value <= high + slack:
                place = format_quantity(value, axis.unit, 9)
                raise RecordError("{axis} = {shown} is outside the travel", _BACK, axis=axis.name, shown=place)
