"""The next reading as the person at the machine has to know it: what to mount, where to go, from which side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from axiscal.campaign.campaign import Campaign
from axiscal.language.spoken import said
from axiscal.machine.kinematics import frames
from axiscal.measurement.place_texts import place_text, reading_unit
from axiscal.measurement.setup import Setup
from axiscal.present.guide.axis_places import axis_places
from axiscal.present.guide.expectation import Expectation, expectation
from axiscal.present.guide.sign import sign_text
from axiscal.record.events import Asked


@dataclass(frozen=True, eq=False, slots=True)
class Question:
    """The words for one reading; those that do not apply are empty.

    number : of the reading; mount : whether the set-up has to be mounted first
    go, parked : coordinates; coming : sides of the last motion; touch : the ball, and how to get there
    again : which reading was taken there before; decides : between which causes it decides
    unit : of the values when none is typed; expected : what earlier readings say of it
    """

    number: int
    setup: Setup
    mount: bool
    go: str
    coming: str
    touch: str
    again: str
    parked: str
    sign: str
    unit: str
    expected: Expectation

    @classmethod
    def of(cls, campaign: Campaign, asked: Asked) -> Question:
        """Return the words for what is asked."""
        setup, readings = campaign.description.setup(asked.place.setup), campaign.state.readings
        return cls(
            number=asked.reading,
            setup=setup,
            mount=not readings or readings[-1].setup != setup.name,
            go=go_text(campaign, asked),
            coming=coming_text(campaign, asked),
            touch=touch_text(campaign, asked),
            again=again_text(campaign, asked),
            parked=parked_text(campaign, asked),
            sign=sign_text(setup),
            unit=reading_unit(setup),
            expected=expectation(campaign.estimate(), asked.place),
        )


def go_text(campaign: Campaign, asked: Asked) -> str:
    """Return where the axes go that move: "X = 120 mm"."""
    return _coordinates_text(campaign, asked, moves=True)


def parked_text(campaign: Campaign, asked: Asked) -> str:
    """Return where the other axes stand."""
    return _coordinates_text(campaign, asked, moves=False)


def _coordinates_text(campaign: Campaign, asked: Asked, *, moves: bool) -> str:
    """Return coordinates in the order of the control's display, as many digits as it shows."""
    chosen = [place for place in axis_places(campaign, asked) if place.moves is moves]
    return ", ".join(f"{place.axis} = {place.shown} {place.unit}" for place in chosen)


def coming_text(campaign: Campaign, asked: Asked) -> str:
    """Return from which sides to come: "X from below"; empty where none matters."""
    below, above = said("from below"), said("from above")
    sided = [place for place in axis_places(campaign, asked) if place.side]
    return ", ".join(f"{place.axis} {below if place.side == '+' else above}" for place in sided)


def touch_text(campaign: Campaign, asked: Asked) -> str:
    """Return at which ball a reading is taken, and how the machine has to go there; empty where none is touched."""
    setup, machine = campaign.description.setup(asked.place.setup), campaign.description.machine
    if setup.contact == "free" or not len(setup.balls or (setup.station or ())):
        return ""
    held = setup.contact == "held"
    turning, together = said("off the ball, turn, and back to it"), said("all axes together, the tool point held")
    way = f"{together} (TRAORI, TCPM, G43.4)" if held else turning
    if setup.artefact is None:
        return way
    tip = frames(machine, np.array([asked.place.pose])).tcp
    ball = setup.artefact.balls[int(setup.artefact.nearest(tip, setup.balls)[0])]
    return said("ball {ball} of {artefact}: {way}", ball=ball.name, artefact=setup.artefact.name, way=way)


def again_text(campaign: Campaign, asked: Asked) -> str:
    """Return which reading was taken at the same place before: together they show whether a zero has wandered."""
    readings = campaign.state.readings
    there = [reading.numbered(n) for n, reading in enumerate(readings) if reading.place == asked.place]
    return said("where reading {number} was taken: go there anew, do not copy it", number=there[-1]) if there else ""


def asked_text(campaign: Campaign, asked: Asked) -> str:
    """Return which reading was asked for: 'reading 7 in "laser" at X = 120 mm'."""
    setup = campaign.description.setup(asked.place.setup)
    where = place_text(campaign.description.machine.axes, asked.place.pose, setup.moves)
    return said('reading {number} in "{setup}" at {place}', number=asked.reading, setup=setup.name, place=where)
