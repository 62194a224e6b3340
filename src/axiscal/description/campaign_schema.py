"""The keys of campaign.toml, as pydantic models; only `description` uses them."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from axiscal.description.artefact_schema import ArtefactTable
from axiscal.document import Angle, Length, QuantityText, Time
from axiscal.machine.entry import Sure

ControlName = Literal[
    "csv",
    "fanuc",
    "heidenhain",
    "isg",
    "isg-etalon",
    "klipper",
    "linuxcnc",
    "linuxcnc-volumetric",
    "marlin",
    "reprapfirmware",
    "sinumerik",
]
"""The controls that files are written for, as `compensation` knows them."""


class Table(BaseModel):
    """A table in which every key is known and no value is bent to fit."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class TargetTable(Table):
    """[target]: when to stop, and over what."""

    rms: Length | None = Field(None, examples=['"2 um"'])
    worst: Length | None = Field(None, examples=['"4 um"'])
    U: Length | None = Field(None, examples=['"12 um"'])
    readings: int | None = Field(None, examples=["40"])
    budget: Time | None = Field(None, examples=['"90 min"'])
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

    name: str = Field(examples=['"laser along X"'])
    instrument: str = Field(examples=['"interferometer"'])
    direction: str | list[float | int] | None = Field(None, examples=['"x"'])
    temperature: QuantityText | None = Field(None, examples=['"22.5 degC"'])
    temperature_std: QuantityText | None = Field(None, examples=['"0.2 K"'])
    expansion: QuantityText | None = Field(None, examples=['"11.7 um/m/K"'])
    expansion_std: QuantityText | None = Field(None, examples=['"1 um/m/K"'])
    type_b: dict[str, QuantityText] = Field(default={}, examples=['{ scale = "0.2 um/m", air = "0.3 um/m" }'])
    base: QuantityText | None = Field(None, examples=['"100 mm"'])
    station: list[QuantityText] | None = Field(None, examples=['["0 mm", "0 mm", "-300 mm"]'])
    stations: list[list[QuantityText]] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    moves: list[str] | None = Field(None, examples=['["X"]'])
    park: dict[str, QuantityText] = Field(default={}, examples=['{ Y = "250 mm" }'])
    noise: QuantityText | None = Field(None, examples=['"0.3 um"'])
    unknowns: dict[str, QuantityText] | None = Field(None, examples=['{ zero = "100 um" }'])
    resolution: QuantityText | None = Field(None, examples=['"1 um"'])
    bound: QuantityText | None = Field(None, examples=['"2 um"'])
    dead_band: QuantityText | None = Field(None, examples=['"2 um"'])
    one_sided: str | None = Field(None, examples=['"+"', '"- 30 um"'])
    setup_time: Time | None = Field(None, examples=['"30 min"'])
    settle: Time | None = Field(None, examples=['"1 s"'])
    reading_time: Time | None = Field(None, examples=['"3 s"'])
    raster: dict[str, QuantityText] = Field(default={}, examples=['{ X = "10 mm" }'])
    approach: Literal["both", "+", "-"] = Field("+", examples=['"both"'])
    drift: QuantityText | None = Field(None, examples=['"2 um/h"'])
    warm: bool = Field(False, examples=["true"])
    artefact: str | None = Field(None, examples=['"three spheres"'])
    ball: str | list[str] | None = Field(None, examples=['["low", "high"]'])
    mounted: int = Field(1, ge=1, examples=["2"])
    reach: dict[str, list[QuantityText]] = Field(default={}, examples=['{ X = ["150 mm", "450 mm"] }'])
    along: list[list[QuantityText]] | None = Field(None, examples=['[["0 mm", "0 mm", "0 mm"], […]]'])
    length: QuantityText | None = Field(None, examples=['"150 mm"'])
    stroke: QuantityText | None = Field(None, examples=['"1 mm"'])
    plane: str | list[str | list[float | int]] | None = Field(None, examples=['"xy"'])
    arc: list[QuantityText] | None = Field(None, examples=['["0 deg", "360 deg"]'])
    turning: dict[str, float | int] | None = Field(None, examples=["{ C = 1.0 }"])
    retract: Length | None = Field(None, examples=['"50 mm"'])
    sides: Literal["mean", "touched"] | None = Field(None, examples=['"mean"'])
    touches: Literal[3] | None = Field(None, examples=["3"])
    range: list[QuantityText] | None = Field(None, examples=['["1 m", "8 m"]'])
    sight: Angle | None = Field(None, examples=['"60 deg"'])
    faces: str | list[float | int] | None = Field(None, examples=['"z"'])
    serial: str = Field("", examples=['"XL-80 4711"'])
    certificate: str = Field("", examples=['"2026-0815, valid to 2027-03"'])


class ReportTable(Table):
    """[report]: who measured for whom; it stands in the report and in the certificate, no figure depends on it."""

    number: str = Field("", examples=['"2026-031"'])
    operator: str = Field("", examples=['"R. Turner"'])
    responsible: str = Field("", examples=['"M. Scholz"'])
    laboratory: str = Field("", examples=['"Calibration laboratory, Example GmbH"'])
    place: str = Field("", examples=['"Hall 3, 12345 Sampletown"'])
    country: str = Field("", examples=['"DE"'])
    customer: str = Field("", examples=['"Sample Gears Ltd"'])
    temperature: str = Field("", examples=['"machine 20.4 to 21.1 degC, room 21 degC"'])
    remarks: str = Field("", examples=['"after the repair of the Y axis"'])
    language: str = Field("", examples=['"de"'])


class ProgramsTable(Table):
    """[programs]: how programs for the control go to their readings."""

    clearance: str | None = Field(None, examples=['"Z=-5 mm"'])
    order: str | None = Field(None, examples=['"Z,X Y"'])
    feed: str | None = Field(None, examples=['"500 mm/min"'])
    dwell: bool = Field(False, examples=["true"])
    tcp: bool = Field(True, examples=["false"])


class SistersTable(Table):
    """[sisters]: machines of the same type whose records teach what this one is like."""

    records: str | list[str] | None = Field(None, examples=['"records/*.axiscal"'])
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
    compensation_active: bool | str | list[str] | None = Field(None, examples=["false", '"old/X.comp"'])
    controls: list[ControlName] = Field(default=["linuxcnc"], examples=['["sinumerik"]'])
    kept: float = Field(0.9, ge=0, le=1, examples=["0.9"])
    tool_length: Length | None = Field(None, examples=['"5 um"'])
    tool_eccentricity: Length | None = Field(None, examples=['"5 um"'])
    artefacts: list[ArtefactTable] = Field(default=[], examples=["[…]"])
    target: TargetTable = Field(default_factory=lambda: TargetTable.model_validate({}))
    sisters: SistersTable | None = Field(None, examples=['{ records = "records/*.axiscal" }'])
    programs: ProgramsTable = Field(default_factory=lambda: ProgramsTable.model_validate({}))
    report: ReportTable = Field(default_factory=lambda: ReportTable.model_validate({}))
    setups: list[SetupTable] = Field(examples=["[…]"])
