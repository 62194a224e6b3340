"""The sign of a reading in words: what a person sees when it is positive."""

from __future__ import annotations

from axiscal.language.spoken import said
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.place_texts import direction_text
from axiscal.measurement.setup import Setup, Vector


def sign_text(setup: Setup) -> str:
    """Return when a reading of the set-up is positive; all are of the tool, seen from the workpiece."""
    instrument = INSTRUMENTS[setup.instrument]
    if instrument.values > 1:
        return said("+ where the tool stands too far towards {way}, seen from the workpiece", way="+x, +y, +z")
    if not instrument.model.directed:
        return said("+ where the distance is longer than it should be")
    way = _signed(direction_text(setup))
    if instrument.reads == "angle":
        turned = "+ where the tool is turned too far about {way} by the right hand, seen from the workpiece"
        return said(turned, way=way)
    return said("+ where the tool stands too far towards {way}, seen from the workpiece", way=way)


def ways(setup: Setup) -> tuple[Vector, ...]:
    """Return the directions along or about which readings are positive; none where it is a distance."""
    instrument = INSTRUMENTS[setup.instrument]
    if instrument.values > 1:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    return (setup.direction,) if instrument.model.directed else ()


def reads_text(setup: Setup) -> str:
    """Return what a set-up reads: "x, y and z", "the distance from its station", "along x" or "about -y"."""
    instrument = INSTRUMENTS[setup.instrument]
    if instrument.values > 1:
        return said("x, y and z")
    if setup.stations:
        return said("the distances from its {count} stations, in their order", count=len(setup.stations))
    if not instrument.model.directed:
        return said("the distance from its station")
    way = direction_text(setup)
    return said("along {way}", way=way) if instrument.reads == "length" else said("about {way}", way=way)


def _signed(direction: str) -> str:
    return direction if direction[0] in "-(" else f"+{direction}"
