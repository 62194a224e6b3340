"""machine.toml as it is written: its tables and their keys."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field, StrictInt, StrictStr

from axiscal.document import QuantityText


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ToolTable(_Table):
    """[tool]"""

    length: QuantityText = Field("0 mm", examples=['"120 mm"'])


class AxisTable(_Table):
    """[axes.X]"""

    travel: tuple[QuantityText, QuantityText] = Field(examples=['["0 mm", "600 mm"]'])
    speed: QuantityText | None = Field(None, examples=['"10 m/min"'])
    acceleration: QuantityText | None = Field(None, examples=['"2 m/s^2"'])
    overrun: QuantityText | None = Field(None, examples=['"2 mm"'])
    origin: tuple[QuantityText, QuantityText, QuantityText] | None = Field(
        None, examples=['["0 mm", "0 mm", "-150 mm"]']
    )
    limits: tuple[QuantityText, QuantityText] | None = Field(None, examples=['["-720 deg", "1080 deg"]'])
    direction: StrictStr | None = Field(None, examples=['"reversed"', '"iso"'])


class ErrorTable(_Table):
    """An entry of [errors]"""

    std: QuantityText | None = Field(None, examples=['"10 um"'])
    band: QuantityText | None = Field(None, examples=['"40 um"'])
    knots: StrictInt | None = Field(None, examples=["13"])
    spacing: QuantityText | None = Field(None, examples=['"50 mm"'])
    length: QuantityText | None = Field(None, examples=['"150 mm"'])
    rest: QuantityText | None = Field(None, examples=['"0.5 um"', '"estimate"'])
    period: QuantityText | None = Field(None, examples=['"5 mm"'])


class MachineFile(_Table):
    """The whole file"""

    name: StrictStr | None = Field(None, examples=['"Three-axis mill"'])
    chain: StrictStr = Field(examples=["\"w-X'-Y'-b-Z-t\""])
    tool: ToolTable = ToolTable()
    axes: dict[str, AxisTable] = Field(examples=['{ X = { travel = ["0 mm", "600 mm"] } }'])
    errors: dict[str, ErrorTable] = Field(examples=['{ EXX = { std = "10 um" } }'])
