"""Places, questions and accuracies in the words and units of the workshop."""

from __future__ import annotations

import numpy as np

from axiscal.accuracy.yardstick import Accuracy
from axiscal.campaign.campaign import Campaign
from axiscal.campaign.ending import Ended
from axiscal.machine.kinematics import frames
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place_texts import direction_text, place_text, reading_unit
from axiscal.measurement.setup import Setup
from axiscal.record.events import Asked
from axiscal.units import to_unit

_COMING = {1: "from below", -1: "from above"}
"""Words for the two directions."""


def micrometres(length: float) -> str:
    """Return a length in um with three significant digits."""
    value = to_unit(length, "um")
    return f"{value:.3g} um" if abs(value) < 1000 else f"{value:.0f} um"


def way_text(setup: Setup) -> str:
    """Return which way a set-up reads: "along x", "about -y" or "along (0.6, 0.8, 0)"."""
    return f"{'along' if INSTRUMENTS[setup.instrument].reads == 'length' else 'about'} {direction_text(setup)}"


def question_text(campaign: Campaign, asked: Asked) -> str:
    """Return what the operator is to do."""
    axes, setup = campaign.description.machine.axes, campaign.description.setup(asked.place.setup)
    parked = [k for k in range(len(axes)) if k not in setup.moves]
    come = ", ".join(f"{axes[k].name} {_COMING[s]}" for k, s in enumerate(asked.place.approach) if s)
    lines = [
        f'Reading {asked.reading}: set-up "{setup.name}", {setup.instrument} {way_text(setup)}',
        f"  go to     {place_text(axes, asked.place.pose, setup.moves)}",
        f"  coming    {come}" if come else "",
        _in_touch(campaign, asked),
        f"  parked    {place_text(axes, asked.place.pose, parked)}" if parked else "",
        f'  then      axiscal record {campaign.path} "VALUE {reading_unit(setup)}"',
    ]
    return "\n".join(line for line in lines if line)


def _in_touch(campaign: Campaign, asked: Asked) -> str:
    """Say at which ball a reading is taken, and how the machine has to go there; nothing where none is touched."""
    setup, machine = campaign.description.setup(asked.place.setup), campaign.description.machine
    if setup.contact == "free" or not len(setup.balls or (setup.station or ())):
        return ""
    held = "all axes together, the tool point held (TRAORI, TCPM, G43.4)"
    way = held if setup.contact == "held" else "off the ball, turn, and back to it"
    if setup.artefact is None:
        return f"  the way   {way}"
    tip = frames(machine, np.array([asked.place.pose])).tcp
    ball = setup.artefact.balls[int(setup.artefact.nearest(tip, setup.balls)[0])]
    return f"  at        ball {ball.name} of {setup.artefact.name}: {way}"


def asked_text(campaign: Campaign, asked: Asked) -> str:
    """Return which reading was asked for: 'reading 7 in "laser" at X = 120 mm'."""
    setup = campaign.description.setup(asked.place.setup)
    where = place_text(campaign.description.machine.axes, asked.place.pose, setup.moves)
    return f'reading {asked.reading} in "{setup.name}" at {where}'


def question_document(campaign: Campaign, asked: Asked | Ended) -> dict[str, object]:
    """Return the question, or why there is none, as the document `axiscal-next/1`."""
    if isinstance(asked, Ended):
        return {"schema": "axiscal-next/1", "question": None, "stop": asked.because}
    return {"schema": "axiscal-next/1", "question": campaign.request(asked).message(), "stop": None}


def accuracy_text(known: Accuracy, rms: float | None, worst: float | None) -> str:
    """Return the standard uncertainty with the targets, where there are any."""
    parts = [("standard uncertainty RMS", known.rms, rms), ("worst", known.worst, worst)]
    return ", ".join(
        f"{name} {micrometres(value)}" + (f" (target {micrometres(target)})" if target is not None else "")
        for name, value, target in parts
    )


def count_text(count: int, noun: str) -> str:
    """Return "1 reading", "3 readings"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
