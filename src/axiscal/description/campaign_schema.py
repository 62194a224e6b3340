"""The keys of campaign.toml, as pydantic models; only `description` uses them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Annotated, Literal

from pydantic import Field

from axiscal.description.artefacts import ArtefactTable
from axiscal.description.fields import (
    Active,
    Bar,
    Base,
    Coordinates,
    Direction,
    Doubt,
    Duration,
    Ends,
    Growth,
    Language,
    Name,
    Printable,
    Span,
    Spans,
    Spot,
    Turn,
    Warm,
    Warmth,
    arc_ends,
    coordinate,
    line_ends,
    nodes,
    plane_ways,
    read_instrument,
)
from axiscal.description.screws import Ground, ScrewsTable
from axiscal.description.target import TargetTable
from axiscal.document import Length, QuantityText, meant, shown
from axiscal.document.gone import instead_of
from axiscal.document.toml_table import AS_TUPLE, Table
from axiscal.document.validation import Beside, EachAs, QuantityOf, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.measurement.setup import FINEST, MOST, Nodes, Setup, Vector, reads_as
from axiscal.units import find_unit, format_quantity, within
from axiscal_core.theta import Sure

_FASTEST = 1e-3 / 60
"""A zero that wanders by more than 1 mm (1 mrad) a minute is loose."""


def _by_instrument(read: Callable[[str, type[Setup]], float]) -> ReadAs:
    """Return what reads a key by the instrument of its set-up; where that is wrong itself, it is not read."""

    def made(text: str, known: Beside) -> float:
        kind = known.data.get("instrument")
        if kind is not None and not kind.alike:
            raise DescriptionError(
                "the numbers of {instrument} are not alike", "Say it in its class", instrument=kind.instrument
            )
        return 0.0 if kind is None else read(text, kind)

    return ReadAs(QuantityText, made, by=True)


_SHOWN = _by_instrument(lambda text, kind: within(text, kind.reads, FINEST))
"""Reads a size of what an instrument reads, m or rad."""


def stated_drift(text: str, kind: type[Setup]) -> float:
    """Return the rate that a set-up states, m/s or rad/s; raises DescriptionError or UnitError for none."""
    angular = kind.reads == "angle"
    return 0.0 if text.strip() == "0" else within(text, "rotation_speed" if angular else "speed", 0.0, _FASTEST)


def _type_b(name: str, text: str, known: Beside) -> float:
    """Return the size of a cause that no reading shows."""
    if (kind := known.data.get("instrument")) is None:
        return 0.0
    causes = {row.name: row for row in kind.type_b if row.name not in ("temperature", "expansion")}  # which have keys
    if name not in causes:
        what = "{name} is not known of an instrument such as this {instrument}"
        raise DescriptionError(what, meant(name, causes), name=shown(name), instrument=kind.instrument)
    return within(text, find_unit(causes[name].unit).dimension, 0.0)


def _unknown(name: str, text: str, known: Beside) -> float:
    """Return the std of an unknown, m or rad; which there are depends on where it is read."""
    if instead := instead_of("keys", f"setups.unknowns.{name}"):
        raise DescriptionError("{name} is gone", instead, name=name)
    kind = known.data.get("instrument")
    return within(text, (kind.unknown_reads if kind else {}).get(name, reads_as(name)), FINEST)


def _moves(names: Sequence[str], known: Beside) -> tuple[int, ...]:
    indices = [known.context.machine.index(name) for name in names]
    if len(set(indices)) < len(indices):
        raise DescriptionError("{text} names an axis twice", "Name each axis once", text=shown(names))
    return tuple(sorted(indices))


def _step(name: str, text: str, known: Beside) -> float:
    """Return the raster of an axis, or of a coordinate of a line, a circle or a sphere, m or rad."""
    dimension = _COORDINATES.get(name) or known.context.machine.axis(name).dimension
    return within(text, dimension, FINEST)


_COORDINATES: dict[str, Literal["length", "angle"]] = {
    "along": "length",
    "arc": "angle",
    "azimuth": "angle",
    "elevation": "angle",
}


def _turning(name: str, rate: float, known: Beside) -> float:
    if not known.context.machine.axis(name).rotary:
        raise DescriptionError("{name} does not turn", "Name a rotary axis: the linear ones follow", name=name)
    return rate


def _stroke(stroke: float, known: Beside) -> float:
    if not 0 < stroke < (known.data.get("length") or math.inf):
        raise DescriptionError("a stroke is above zero and below the length of the bar", 'Give "1 mm"')
    return stroke


def _stations(said: Sequence[Vector], known: Beside) -> tuple[Vector, ...]:
    """Return where tracers stand that read at once."""
    if known.data.get("station") is not None:
        what = "it is said twice where it stands"
        raise DescriptionError(what, "Keep station for one tracer, stations for those that read at once")
    if not 2 <= len(set(said)) == len(said) <= MOST:
        remedy = "Name two to {most}; one alone is station, more are set-ups of their own"
        raise DescriptionError("these are not two or more different places", remedy, most=MOST)
    return tuple(said)


def _distances(ends: Ends) -> Ends:
    if ends[0] < 0:
        near = format_quantity(ends[0], "mm")
        raise DescriptionError("{size} is no distance", 'Write ["1 m", "8 m"]', size=near)
    return ends


class SetupTable(Table):
    """[[setups]]: one way to mount one instrument."""

    name: Name = Field(examples=['"laser along X"'])
    # Before what is read by it: pydantic goes from key to key.
    instrument: Annotated[type[Setup], ReadAs(str, read_instrument, by=True)] = Field(examples=['"interferometer"'])
    direction: Direction | None = Field(None, examples=['"x"'])
    offset: Spot | None = Field(None, examples=['["-33 mm", "-46 mm", "0 mm"]'])
    temperature: Warm | None = Field(None, examples=['"22.5 degC"'])
    temperature_std: Warmth | None = Field(None, examples=['"0.2 K"'])
    expansion: Annotated[float, QuantityOf("expansion")] | None = Field(None, examples=['"11.7 um/m/K"'])
    expansion_std: Growth | None = Field(None, examples=['"1 um/m/K"'])
    type_b: Annotated[dict[str, float], EachAs(dict[str, QuantityText], _type_b)] = Field(
        default={}, examples=['{ scale = "0.2 um/m", air = "0.3 um/m" }']
    )
    base: Base | None = Field(None, examples=['"100 mm"'])
    station: Spot | None = Field(None, examples=['["0 mm", "0 mm", "-300 mm"]'])
    stations: Annotated[tuple[Vector, ...], ReadAs(list[Spot], _stations, by=True)] = Field(
        (), examples=['[["0 mm", "0 mm", "0 mm"], […]]']
    )
    choose_from: list[Spot] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    moves: Annotated[tuple[int, ...], ReadAs(list[str], _moves, by=True)] | None = Field(None, examples=['["X"]'])
    park: Coordinates = Field(default={}, examples=['{ Y = "250 mm" }'])
    noise: Annotated[float, _SHOWN] | None = Field(None, examples=['"0.3 um"'])
    unknowns: Annotated[dict[str, float], EachAs(dict[str, QuantityText], _unknown)] | None = Field(
        None, examples=['{ zero = "100 um" }']
    )
    resolution: Annotated[float, _SHOWN] = Field(0.0, examples=['"1 um"'])
    setup_time: Duration | None = Field(None, examples=['"30 min"'])
    settle: Duration | None = Field(None, examples=['"1 s"'])
    reading_time: Duration | None = Field(None, examples=['"3 s"'])
    raster: Annotated[dict[str, float], EachAs(dict[str, QuantityText], _step)] = Field(
        default={}, examples=['{ X = "10 mm" }']
    )
    approach: Literal["both", "+", "-"] | None = Field(None, examples=['"both"'])
    drift: Annotated[float, _by_instrument(stated_drift)] | None = Field(None, examples=['"2 um/h"'])
    warm: bool = Field(False, examples=["true"])
    artefact: str | None = Field(None, examples=['"three spheres"'])
    ball: str | list[str] | None = Field(None, examples=['["low", "high"]'])
    at: Spot | None = Field(None, examples=['["300 mm", "200 mm", "0 mm"]'])
    turn: Turn | None = Field(None, examples=['"90 deg"'])
    mounted: int = Field(1, ge=1, examples=["2"])
    reach: Spans = Field(default={}, examples=['{ X = ["150 mm", "450 mm"] }'])
    map: Annotated[
        dict[str, Nodes], EachAs(dict[str, Annotated[tuple[QuantityText, QuantityText, int], AS_TUPLE]], nodes)
    ] = Field(default={}, examples=['{ X = ["20 mm", "280 mm", 5], Y = ["20 mm", "280 mm", 5] }'])
    along: Annotated[tuple[Vector, Vector], ReadAs(Annotated[tuple[Spot, Spot], AS_TUPLE], line_ends)] | None = Field(
        None, examples=['[["0 mm", "0 mm", "0 mm"], […]]']
    )
    length: Bar | None = Field(None, examples=['"150 mm"'])
    lengths: dict[str, Annotated[tuple[Vector, Vector], ReadAs(Annotated[tuple[Spot, Spot], AS_TUPLE], line_ends)]] = (
        Field(default={}, examples=['{ low = [["0 mm", "0 mm", "0 mm"], ["100 mm", "0 mm", "0 mm"]] }'])
    )
    stroke: Annotated[float, ReadAs(Length, _stroke, by=True)] | None = Field(None, examples=['"1 mm"'])
    plane: Annotated[tuple[Vector, Vector], ReadAs(str | list[str | list[float | int]], plane_ways)] | None = Field(
        None, examples=['"xy"']
    )
    arc: Annotated[Ends, ReadAs(list[QuantityText], arc_ends)] | None = Field(None, examples=['["0 deg", "360 deg"]'])
    turning: Annotated[dict[str, float], EachAs(dict[str, float | int], _turning)] = Field(
        default={}, examples=["{ C = 1.0 }"]
    )
    retract: Length | None = Field(None, examples=['"50 mm"'])
    range: Annotated[Ends, ReadAs(Span, _distances)] = Field((0.0, math.inf), examples=['["1 m", "8 m"]'])
    sight: Annotated[float, QuantityOf("angle", FINEST, math.pi)] | None = Field(None, examples=['"60 deg"'])
    faces: Direction | None = Field(None, examples=['"z"'])
    serial: Printable = Field("", examples=['"XL-80 4711"'])
    certificate: Printable = Field("", examples=['"2026-0815, valid to 2027-03"'])


class ReportTable(Table):
    """[report]: who measured for whom; it stands in the report, no figure depends on it."""

    number: Printable = Field("", examples=['"2026-031"'])
    operator: Printable = Field("", examples=['"R. Turner"'])
    responsible: Printable = Field("", examples=['"M. Scholz"'])
    laboratory: Printable = Field("", examples=['"Calibration laboratory, Example GmbH"'])
    place: Printable = Field("", examples=['"Hall 3, 12345 Sampletown"'])
    customer: Printable = Field("", examples=['"Sample Gears Ltd"'])
    temperature: Printable = Field("", examples=['"machine 20.4 to 21.1 degC, room 21 degC"'])
    remarks: Printable = Field("", examples=['"after the repair of the Y axis"'])
    language: Language = Field("", examples=['"de"'])


def _clearance(text: str, known: Beside) -> tuple[str, float]:
    """Return the axis and where it is clear, m or rad."""
    name, equals, place = (part.strip() for part in text.partition("="))
    if not equals:
        raise DescriptionError("{text} is not AXIS=PLACE", 'Write something such as "Z=-5 mm"', text=shown(text))
    return name, coordinate(place, known.context.machine.axis(name))


class ProgramsTable(Table):
    """[programs]: how programs for the control go to their readings."""

    clearance: Annotated[tuple[str, float], ReadAs(str, _clearance, by=True)] | None = Field(
        None, examples=['"Z=-5 mm"']
    )
    dwell: bool = Field(False, examples=["true"])


class CampaignTable(Table):
    """The whole of campaign.toml."""

    machine: str = Field(examples=['"machine.toml"'])
    usual: Literal["on", "off"] = Field("on", examples=['"off"'])
    sure: Sure | None = Field(None, examples=['"well"'])
    scales: Literal["stated", "estimate"] | None = Field(None, examples=['"estimate"'])
    prior: str | None = Field(None, examples=['"last.axiscal"'])
    compensation_active: Active | None = Field(None, examples=["false", '"old/X.comp"'])
    zero_at: Ground | None = Field(None, examples=['["150 mm", "150 mm"]'])
    controls: list[str] = Field(default=["linuxcnc"], examples=['["sinumerik"]'])
    kept: float = Field(0.9, ge=0, le=1, examples=["0.9"])
    tool_length: Doubt | None = Field(None, examples=['"5 um"'])
    tool_eccentricity: Doubt | None = Field(None, examples=['"5 um"'])
    artefacts: list[ArtefactTable] = Field(default=[], examples=["[…]"])
    target: TargetTable = Field(default_factory=lambda: TargetTable.model_validate({}))
    programs: ProgramsTable = Field(default_factory=lambda: ProgramsTable.model_validate({}))
    report: ReportTable = Field(default_factory=lambda: ReportTable.model_validate({}))
    screws: ScrewsTable | None = Field(None, examples=['{ thread = "CW-M4", places = {…} }'])
    setups: list[SetupTable] = Field(examples=["[…]"])
