"""A place as it is typed: "X=120 mm Y=250 mm", "X+ Y-"."""

from __future__ import annotations

import re

from axiscal.campaign.campaign import Campaign
from axiscal.description.placed_readings import placed_approach, placed_pose
from axiscal.exceptions import ReadingError
from axiscal.machine import Machine
from axiscal.measurement.place import Place
from axiscal.measurement.setup import Setup
from axiscal.units import parse_quantity

_ENTRY = re.compile(r"\s*([A-Z][0-9]?)\s*=\s*([^=,;]*?)\s*(?:[,;]|(?=\s[A-Z][0-9]?\s*=)|$)")
_DIRECTION = re.compile(r"([A-Z][0-9]?)([+−-])")


def typed_place(campaign: Campaign, setup: str | None, at: str, approach: str | None) -> Place:
    """Return the place of a reading that was not asked for; raises ReadingError, UnitError or DescriptionError.

    setup : name; None is the set-up of the question that is open, or the only one there is
    """
    chosen, machine = _setup(campaign, setup), campaign.description.machine
    pose = placed_pose(chosen, machine, _position(at, machine))
    return Place(chosen.name, pose, placed_approach(chosen, machine, _directions(approach or "")))


def _setup(campaign: Campaign, name: str | None) -> Setup:
    description, pending = campaign.description, campaign.state.pending
    if name is None and pending is None and len(description.setups) > 1:
        names = ", ".join(f'"{setup.name}"' for setup in description.setups)
        raise ReadingError("the campaign has several set-ups", "Name one with --setup: {names}", names=names)
    return description.setup(name or (pending.place.setup if pending else description.setups[0].name))


def _position(text: str, machine: Machine) -> dict[str, float]:
    position: dict[str, float] = {}
    at = 0
    while text[at:].strip():
        found = _ENTRY.match(text, at)
        if found is None or found[1] in position:
            remedy = 'Write each axis once, as in --at "X=120 mm Y=250 mm"'
            raise ReadingError('"{text}" is not a place', remedy, text=text)
        axis = machine.axis(found[1])
        position[found[1]] = parse_quantity(found[2], axis.dimension)
        at = found.end()
    return position


def _directions(text: str) -> dict[str, int]:
    directions: dict[str, int] = {}
    for word in re.split(r"[\s,;]+", text.strip()):
        found = _DIRECTION.fullmatch(word)
        if word and (found is None or found[1] in directions):
            remedy = 'Write each axis once, as in --approach "X+ Y-"'
            raise ReadingError('"{text}" is not an approach', remedy, text=text)
        if found:
            directions[found[1]] = 1 if found[2] == "+" else -1
    return directions
