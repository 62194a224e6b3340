"""[programs] of campaign.toml, and the same words on a command line: how programs go to their readings."""

from __future__ import annotations

from dataclasses import replace

from axiscal.description.campaign_schema import ProgramsTable
from axiscal.description.target import coordinate
from axiscal.document import Document, shown
from axiscal.exceptions import DescriptionError, Faults
from axiscal.machine import Machine
from axiscal.machine.driving import Driving, move_groups
from axiscal.units import parse_quantity

_SLOWEST = 1e-3 / 60
"""1 mm/min: programs write whole numbers."""


def read_driving(table: ProgramsTable, machine: Machine, document: Document) -> Driving:
    """Return how programs are driven; raises DescriptionError or UnitError at the line that is wrong."""
    faults, driving = Faults(), Driving(dwell=table.dwell, tcp=table.tcp)
    for key in ("clearance", "order", "feed"):
        with faults.noted(), document.placed("programs", key):
            driving = stated(driving, machine, **{key: getattr(table, key)})
    faults.refuse()
    return driving


def stated(
    driving: Driving,
    machine: Machine,
    clearance: str | None = None,
    order: str | None = None,
    feed: str | None = None,
    dwell: bool | None = None,
) -> Driving:
    """Return the driving with what is said in its place; None leaves it as it is.  Raises as `read_driving` does.

    clearance : "Z=-5 mm"; order : "Z,X Y"; feed : "500 mm/min"
    """
    if clearance is not None:
        driving = replace(driving, clearance=_clearance(clearance, machine))
    if order is not None:
        driving = replace(driving, order=tuple(tuple(group.split()) for group in order.split(",")))
        move_groups(machine, driving)
    if feed is not None:
        driving = replace(driving, feed=_feed(feed))
    return driving if dwell is None else replace(driving, dwell=dwell)


def _clearance(text: str, machine: Machine) -> tuple[str, float]:
    """Return the axis and where it is clear, m or rad."""
    name, equals, place = (part.strip() for part in text.partition("="))
    if not equals:
        raise DescriptionError("{text} is not AXIS=PLACE", 'Write something such as "Z=-5 mm"', text=shown(text))
    return name, coordinate(place, machine.axis(name))


def _feed(text: str) -> float:
    """Return the feed near a place, m/s."""
    feed = parse_quantity(text, "speed")
    if feed < _SLOWEST * (1 - 1e-9):
        raise DescriptionError("{text} is slower than 1 mm/min", 'Give a feed such as "500 mm/min"', text=shown(text))
    return feed
