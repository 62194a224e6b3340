"""The keys of [[artefacts]] in campaign.toml, as pydantic models."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from axiscal.document import Angle, Length, QuantityText


class _Keys(BaseModel):
    """A table in which every key is known and no value is bent to fit."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class GridTable(_Keys):
    """grid: balls of a plate, in rows and columns."""

    origin: list[QuantityText] = Field(examples=['["0 mm", "0 mm", "50 mm"]'])
    count: list[int] = Field(examples=["[5, 5]"])
    pitch: list[QuantityText] = Field(examples=['["80 mm", "80 mm"]'])
    along: list[str] = Field(default=["x", "y"], examples=['["x", "y"]'])


class ArtefactTable(_Keys):
    """[[artefacts]]: what stands on the table to be read."""

    name: str = Field(examples=['"three spheres"'])
    balls: dict[str, list[QuantityText]] = Field(default={}, examples=['{ low = ["200 mm", "0 mm", "-80 mm"] }'])
    grid: GridTable | None = Field(None, examples=["{ origin = […], count = [5, 5], pitch = […] }"])
    diameter: Length | None = Field(None, examples=['"25 mm"'])
    calibrated: Length | None = Field(None, examples=['"0.7 um"'])
    scale: Angle | None = Field(None, examples=['"0.5 um/m"'])
    placed: Length | None = Field(None, examples=['"1 mm"'])
    turned: Angle | None = Field(None, examples=['"1 mrad"'])
    free: str | list[float | int] = Field("z", examples=['"z"'])
    cone: Angle | None = Field(None, examples=['"100 deg"'])
    keep_out: list[dict[str, list[QuantityText]]] = Field(default=[], examples=['[{ z = ["-300 mm", "-150 mm"] }]'])
    serial: str = Field("", examples=['"K3-0042"'])
    certificate: str = Field("", examples=['"PTB 50123/26"'])
