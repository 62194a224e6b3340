"""Where several tracers stand that read at once: `stations` of a set-up."""

from __future__ import annotations

from axiscal.description.campaign_schema import SetupTable
from axiscal.description.vectors import spot
from axiscal.exceptions import DescriptionError
from axiscal.measurement.instrument import Instrument
from axiscal.measurement.instruments.distance import MOST
from axiscal.measurement.setup import Vector


def stations_of(table: SetupTable, usual: Instrument) -> tuple[Vector, ...]:
    """Return where tracers stand that read at once; none where one instrument reads.  Raises DescriptionError."""
    said = table.stations
    if said is None:
        return ()
    if usual.name != "tracer":
        what = f"several stations are read at once by length-only tracers, and this set-up has a {usual.name}"
        raise DescriptionError(what, 'Write instrument = "tracer", or a set-up for each of the others')
    if table.station is not None:
        what = "it is said twice where it stands, by station and by stations"
        raise DescriptionError(what, "Keep station for one tracer, stations for those that read at once")
    if not 2 <= len(said) <= MOST:
        what = f"{len(said)} {'station' if len(said) == 1 else 'stations'} cannot be read at once here"
        raise DescriptionError(what, f"Name two to {MOST}; one alone is station, more are set-ups of their own")
    stations = tuple(spot(each) for each in said)
    if len(set(stations)) < len(stations):
        raise DescriptionError("two of the stations are the same place", "Give each tracer its own")
    return stations
