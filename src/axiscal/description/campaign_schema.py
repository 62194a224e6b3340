"""The keys of campaign.toml, as pydantic models; only `description` uses them."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from axiscal.description.vectors import Direction, Span, Spot
from axiscal.document import Length, QuantityText, shown
from axiscal.document.validation import QuantityOf, ReadAs
from axiscal.exceptions import DescriptionError
from axiscal.language.spoken import LANGUAGES, later
from axiscal.machine.entry import Sure
from axiscal.machine.machine_schema import MachineFile
from axiscal.measurement.instrument import INSTRUMENTS
from axiscal.measurement.setup import FINEST
from axiscal.units import EXAMPLES, Dimension

_DIALECT = "https://json-schema.org/draft/2020-12/schema"

PLACED = 1e-3
TURNED = 1e-3
SCALE = 0.5e-6
CONE = math.radians(100.0)
LONGEST_NAME = 80
"""Characters of a name that still fits on a line of a program."""
_LONGEST = 500
"""Characters of a text in a report: a paragraph; a matter of taste."""
MOST_READINGS = 100_000
"""Weeks of measuring; whoever says more has slipped."""
_LONGEST_DOUBT = 0.1
"""m."""
_SLOWEST = 1e-3 / 60 * (1 - 1e-9)
"""1 mm/min, and rounding: programs write whole numbers."""
_LEAST = sys.float_info.min
"""Above zero."""


def _sized(dimension: Dimension, most: float, remedy: str) -> QuantityOf:
    return QuantityOf(dimension, FINEST, most, later("{text} is not possible here"), remedy)


def _above_zero(dimension: Dimension, example: str) -> QuantityOf:
    wrong, remedy = later("{text} is not above zero"), later("Give something such as {example}")
    return QuantityOf(dimension, _LEAST, math.inf, wrong, remedy, example)


def _not_negative(dimension: Dimension) -> QuantityOf:
    wrong, remedy = later("{text} is negative"), later('Give a size such as "{example}"')
    return QuantityOf(dimension, 0.0, math.inf, wrong, remedy, EXAMPLES[dimension])


def _doubt(key: str) -> QuantityOf:
    wrong = later("this is no std of where a tool's point sits")
    remedy = later('Give how well it is known, such as {example} = "5 um"; "0 um" where the zeros were set with it')
    return QuantityOf("length", 0.0, _LONGEST_DOUBT, wrong, remedy, key)


def _count(number: int) -> int:
    if number <= 0:
        raise DescriptionError("{text} is not above zero", "Give something such as readings = 40", text=number)
    if number > MOST_READINGS:
        remedy = "Give at most {most}"
        raise DescriptionError("{text} readings are too many", remedy, text=shown(number), most=MOST_READINGS)
    return number


def _name(text: str) -> str:
    if not text.strip() or text != text.strip() or not text.isprintable() or len(text) > LONGEST_NAME:
        remedy = "Give it up to {most} printable characters, without blanks at its ends"
        raise DescriptionError("{text} is not a name", remedy, text=shown(text), most=LONGEST_NAME)
    return text


def _printable(text: str) -> str:
    if len(text) > _LONGEST or not text.replace("\n", " ").isprintable():
        remedy = "Write up to {most} characters that can be printed"
        raise DescriptionError("{text} cannot stand in a report", remedy, text=shown(text), most=_LONGEST)
    return text


def _country(text: str) -> str:
    if text and not (len(text) == 2 and text.isascii() and text.isalpha()):
        raise DescriptionError("{text} is no country of two letters", 'Such as country = "DE"', text=shown(text))
    return text


def _language(text: str) -> str:
    if text and text not in LANGUAGES:
        known = ", ".join(f'language = "{short}" ({long})' for short, long in LANGUAGES.items())
        raise DescriptionError("{text} is no language of reports", "There are {known}", text=shown(text), known=known)
    return text


def _active(given: bool | str | list[str]) -> bool | tuple[str, ...]:
    """Return whether a compensation is active, or its files."""
    if isinstance(given, bool):
        return given
    names = (given,) if isinstance(given, str) else tuple(given)
    if not names or not all(name.strip() and name.isprintable() for name in names):
        remedy = 'Write false, true, or the files that are active, such as ["X.comp", "Y.comp"]'
        raise DescriptionError("compensation_active = {text} names no file", remedy, text=shown(given))
    return names


def _patterns(given: str | list[str]) -> tuple[str, ...]:
    """Return names of files, or patterns of such."""
    patterns = (given,) if isinstance(given, str) else tuple(given)
    wrong = next((each for each in patterns if not each.strip() or not each.isprintable()), None)
    if wrong is not None:
        raise DescriptionError("records = {text} names no file", 'Write "records/*.axiscal"', text=shown(wrong))
    return patterns


Name = Annotated[str, ReadAs(str, _name)]
Printable = Annotated[str, ReadAs(str, _printable)]
Patterns = Annotated[tuple[str, ...], ReadAs(str | list[str], _patterns)]
Active = Annotated[bool | tuple[str, ...], ReadAs(bool | str | list[str], _active)]
_ONE = later('Give one such as "{example}"')
Base = Annotated[float, QuantityOf("length", 0.0, math.inf, later("{text} is not a length"), _ONE, "100 mm")]
Bar = Annotated[float, QuantityOf("length", 5e-3, 5.0, later("{text} is no length of a bar"), _ONE, "150 mm")]
Sight = Annotated[
    float, QuantityOf("angle", _LEAST, math.pi, later("a sight is above 0 and at most 180 deg"), _ONE, "60 deg")
]
_STD = later('Give its std, such as "0.5 um/m", or "0 um/m"')
Scale = Annotated[float, QuantityOf("angle", 0.0, 1e-2, later("this is no scale"), _STD)]
Cone = Annotated[float, _sized("angle", math.pi, later("Give an angle above 0 and up to 180 deg"))]
Calibrated = Annotated[float, _sized("length", 1.0, later("Give a std above zero"))]
Placed = Annotated[float, _sized("length", 1.0, later("Give how far it may stand from there, above zero"))]
Turned = Annotated[float, _sized("angle", 1.0, later("Give a small angle above zero"))]
Turn = Annotated[float, QuantityOf("angle", -math.tau, math.tau, later("this is more than a turn"), _ONE, "90 deg")]
Diameter = Annotated[float, _sized("length", 1.0, later("Give that of a ball"))]
Duration = Annotated[float, _not_negative("time")]
Feed = Annotated[
    float,
    QuantityOf(
        "speed", _SLOWEST, math.inf, later("{text} is slower than 1 mm/min"), later('Give a feed such as "500 mm/min"')
    ),
]
Warmth = Annotated[float, _not_negative("temperature_difference")]
Growth = Annotated[float, _not_negative("expansion")]
"""What keys may say, in SI; several have bounds."""


class Table(BaseModel):
    """A table in which every key is known and no value is bent to fit."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


class GridTable(Table):
    """grid: balls of a plate, in rows and columns."""

    origin: Spot = Field(examples=['["0 mm", "0 mm", "50 mm"]'])
    count: list[int] = Field(examples=["[5, 5]"])
    pitch: list[Length] = Field(examples=['["80 mm", "80 mm"]'])
    along: list[Direction] = Field(default=[(1.0, 0.0, 0.0), (0.0, 1.0, 0.0)], examples=['["x", "y"]'])


class ArtefactTable(Table):
    """[[artefacts]]: what stands on the table to be read."""

    name: Name = Field(examples=['"three spheres"'])
    balls: dict[str, Spot] = Field(default={}, examples=['{ low = ["200 mm", "0 mm", "-80 mm"] }'])
    grid: GridTable | None = Field(None, examples=["{ origin = […], count = [5, 5], pitch = […] }"])
    diameter: Diameter | None = Field(None, examples=['"25 mm"'])
    calibrated: Calibrated | None = Field(None, examples=['"0.7 um"'])
    scale: Scale = Field(SCALE, examples=['"0.5 um/m"'])
    placed: Placed = Field(PLACED, examples=['"1 mm"'])
    turned: Turned = Field(TURNED, examples=['"1 mrad"'])
    free: Direction = Field((0.0, 0.0, 1.0), examples=['"z"'])
    cone: Cone = Field(CONE, examples=['"100 deg"'])
    keep_out: list[dict[str, Span]] = Field(default=[], examples=['[{ z = ["-300 mm", "-150 mm"] }]'])
    serial: Printable = Field("", examples=['"K3-0042"'])
    certificate: Printable = Field("", examples=['"PTB 50123/26"'])


ControlName = Literal[
    "csv",
    "fanuc",
    "heidenhain",
    "isg",
    "klipper",
    "klipper-volumetric",
    "linuxcnc",
    "linuxcnc-volumetric",
    "marlin",
    "reprapfirmware",
    "sinumerik",
]
"""The controls that files are written for, as `compensation` knows them."""


class TargetTable(Table):
    """[target]: when to stop, and over what."""

    rms: Annotated[float, _above_zero("length", 'rms = "2 um"')] | None = Field(None, examples=['"2 um"'])
    worst: Annotated[float, _above_zero("length", 'worst = "4 um"')] | None = Field(None, examples=['"4 um"'])
    U: Annotated[float, _above_zero("length", 'U = "12 um"')] | None = Field(None, examples=['"12 um"'])
    readings: Annotated[int, ReadAs(int, _count)] | None = Field(None, examples=["40"])
    budget: Annotated[float, _above_zero("time", 'budget = "90 min"')] | None = Field(None, examples=['"90 min"'])
    volume: dict[str, list[QuantityText]] = Field(default={}, examples=['{ X = ["50 mm", "550 mm"] }'])
    part: dict[str, QuantityText | list[QuantityText]] | None = Field(
        None, examples=['{ radius = "200 mm", z = ["-100 mm", "100 mm"], B = ["-30 deg", "100 deg"] }']
    )
    aligned: bool | None = Field(None, examples=["true"])
    directions: list[Literal["x", "y", "z"]] = Field(default=["x", "y", "z"], examples=['["z"]'])
    criterion: Literal["volume", "rows", "joint", "worst"] | None = Field(None, examples=['"volume"'])
    refers_to: Literal["20 degC", "as read"] | None = Field(None, examples=['"20 degC"'])
    wants: list[str] = Field(default=[], examples=['["positioning X 5 um", "backlash X", "volume 20 um"]'])
    unchecked: Literal["refuse", "allow"] = Field("refuse", examples=['"allow"'])


class SetupTable(Table):
    """[[setups]]: one way to mount one instrument.

    Quantities whose dimension depends on the axis or on the instrument stay text.
    """

    name: Name = Field(examples=['"laser along X"'])
    instrument: str = Field(examples=['"interferometer"'])
    direction: str | list[float | int] | None = Field(None, examples=['"x"'])
    temperature: Annotated[float, QuantityOf("temperature")] | None = Field(None, examples=['"22.5 degC"'])
    temperature_std: Warmth | None = Field(None, examples=['"0.2 K"'])
    expansion: Annotated[float, QuantityOf("expansion")] | None = Field(None, examples=['"11.7 um/m/K"'])
    expansion_std: Growth | None = Field(None, examples=['"1 um/m/K"'])
    type_b: dict[str, QuantityText] = Field(default={}, examples=['{ scale = "0.2 um/m", air = "0.3 um/m" }'])
    base: Base | None = Field(None, examples=['"100 mm"'])
    station: Spot | None = Field(None, examples=['["0 mm", "0 mm", "-300 mm"]'])
    stations: list[Spot] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    choose_from: list[Spot] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    moves: list[str] | None = Field(None, examples=['["X"]'])
    park: dict[str, QuantityText] = Field(default={}, examples=['{ Y = "250 mm" }'])
    noise: QuantityText | None = Field(None, examples=['"0.3 um"'])
    unknowns: dict[str, QuantityText] | None = Field(None, examples=['{ zero = "100 um" }'])
    resolution: QuantityText | None = Field(None, examples=['"1 um"'])
    bound: QuantityText | None = Field(None, examples=['"2 um"'])
    dead_band: QuantityText | None = Field(None, examples=['"2 um"'])
    one_sided: str | None = Field(None, examples=['"+"', '"- 30 um"'])
    setup_time: Duration | None = Field(None, examples=['"30 min"'])
    settle: Duration | None = Field(None, examples=['"1 s"'])
    reading_time: Duration | None = Field(None, examples=['"3 s"'])
    raster: dict[str, QuantityText] = Field(default={}, examples=['{ X = "10 mm" }'])
    approach: Literal["both", "+", "-"] = Field("+", examples=['"both"'])
    drift: QuantityText | None = Field(None, examples=['"2 um/h"'])
    warm: bool = Field(False, examples=["true"])
    artefact: str | None = Field(None, examples=['"three spheres"'])
    ball: str | list[str] | None = Field(None, examples=['["low", "high"]'])
    at: Spot | None = Field(None, examples=['["300 mm", "200 mm", "0 mm"]'])
    turn: Turn | None = Field(None, examples=['"90 deg"'])
    mounted: int = Field(1, ge=1, examples=["2"])
    reach: dict[str, list[QuantityText]] = Field(default={}, examples=['{ X = ["150 mm", "450 mm"] }'])
    along: list[Spot] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    length: Bar | None = Field(None, examples=['"150 mm"'])
    stroke: Length | None = Field(None, examples=['"1 mm"'])
    plane: str | list[str | list[float | int]] | None = Field(None, examples=['"xy"'])
    arc: list[QuantityText] | None = Field(None, examples=['["0 deg", "360 deg"]'])
    turning: dict[str, float | int] | None = Field(None, examples=["{ C = 1.0 }"])
    retract: Length | None = Field(None, examples=['"50 mm"'])
    sides: Literal["mean", "touched"] | None = Field(None, examples=['"mean"'])
    touches: Literal[3] | None = Field(None, examples=["3"])
    range: Span | None = Field(None, examples=['["1 m", "8 m"]'])
    sight: Sight | None = Field(None, examples=['"60 deg"'])
    faces: Direction | None = Field(None, examples=['"z"'])
    serial: Printable = Field("", examples=['"XL-80 4711"'])
    certificate: Printable = Field("", examples=['"2026-0815, valid to 2027-03"'])


class ReportTable(Table):
    """[report]: who measured for whom; it stands in the report and in the certificate, no figure depends on it."""

    number: Printable = Field("", examples=['"2026-031"'])
    operator: Printable = Field("", examples=['"R. Turner"'])
    responsible: Printable = Field("", examples=['"M. Scholz"'])
    laboratory: Printable = Field("", examples=['"Calibration laboratory, Example GmbH"'])
    place: Printable = Field("", examples=['"Hall 3, 12345 Sampletown"'])
    country: Annotated[str, ReadAs(Printable, _country)] = Field("", examples=['"DE"'])
    customer: Printable = Field("", examples=['"Sample Gears Ltd"'])
    temperature: Printable = Field("", examples=['"machine 20.4 to 21.1 degC, room 21 degC"'])
    remarks: Printable = Field("", examples=['"after the repair of the Y axis"'])
    language: Annotated[str, ReadAs(Printable, _language)] = Field("", examples=['"de"'])


class ProgramsTable(Table):
    """[programs]: how programs for the control go to their readings."""

    clearance: str | None = Field(None, examples=['"Z=-5 mm"'])
    order: str | None = Field(None, examples=['"Z,X Y"'])
    feed: Feed | None = Field(None, examples=['"500 mm/min"'])
    dwell: bool = Field(False, examples=["true"])


class SistersTable(Table):
    """[sisters]: machines of the same type whose records teach what this one is like."""

    records: Patterns | None = Field(None, examples=['"records/*.axiscal"'])
    type: str | None = Field(None, examples=['"VMC-600"'])
    directions: int = Field(3, ge=0, le=10, examples=["3"])
    doubt: float | None = Field(None, gt=0, lt=1, examples=["0.1"])


class CampaignTable(Table):
    """The whole of campaign.toml."""

    machine: str = Field(examples=['"machine.toml"'])
    usual: Literal["on", "off"] = Field("on", examples=['"off"'])
    sure: Sure | None = Field(None, examples=['"well"'])
    scales: Literal["stated", "estimate"] | None = Field(None, examples=['"estimate"'])
    prior: str | None = Field(None, examples=['"last.axiscal"'])
    compensation_active: Active | None = Field(None, examples=["false", '"old/X.comp"'])
    controls: list[ControlName] = Field(default=["linuxcnc"], examples=['["sinumerik"]'])
    kept: float = Field(0.9, ge=0, le=1, examples=["0.9"])
    tool_length: Annotated[float, _doubt("tool_length")] | None = Field(None, examples=['"5 um"'])
    tool_eccentricity: Annotated[float, _doubt("tool_eccentricity")] | None = Field(None, examples=['"5 um"'])
    artefacts: list[ArtefactTable] = Field(default=[], examples=["[…]"])
    target: TargetTable = Field(default_factory=lambda: TargetTable.model_validate({}))
    sisters: SistersTable | None = Field(None, examples=['{ records = "records/*.axiscal" }'])
    programs: ProgramsTable = Field(default_factory=lambda: ProgramsTable.model_validate({}))
    report: ReportTable = Field(default_factory=lambda: ReportTable.model_validate({}))
    setups: list[SetupTable] = Field(examples=["[…]"])


def machine_schema() -> dict[str, Any]:
    """Return the schema of machine.toml."""
    return _schema(MachineFile, "machine.toml: the machine, stable over years")


def campaign_schema() -> dict[str, Any]:
    """Return the schema of campaign.toml; it knows the names of the instruments."""
    schema = _schema(CampaignTable, "campaign.toml: one calibration")
    schema["$defs"]["SetupTable"]["properties"]["instrument"]["enum"] = list(INSTRUMENTS)
    return schema


SCHEMAS: dict[str, Callable[[], dict[str, Any]]] = {"machine": machine_schema, "campaign": campaign_schema}
"""By the file that they describe."""


def _schema(model: type[BaseModel], title: str) -> dict[str, Any]:
    return {"$schema": _DIALECT, **_told(model.model_json_schema()), "title": title}


def _told(schema: dict[str, Any]) -> dict[str, Any]:
    """Return a schema for a person who writes the file: examples as it has them, no defaults in SI units."""
    told = {key: _below(key, value) for key, value in schema.items() if key not in ("default", "examples", "title")}
    if "examples" in schema:
        told["description"] = f"Such as {' or '.join(schema['examples'])}"
    return told


def _below(key: str, value: Any) -> Any:
    """Return what stands under a keyword: a schema, several of them by name or in a list, or anything else."""
    if key in ("properties", "$defs"):
        return {name: _told(each) for name, each in value.items()}
    if isinstance(value, list):
        return [_told(each) if isinstance(each, dict) else each for each in value]
    return _told(value) if isinstance(value, dict) else value
